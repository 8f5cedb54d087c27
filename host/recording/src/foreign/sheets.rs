//! The sheets of a workbook: which of them is the table, and what it says as text.

use super::archive::only_one;
use super::as_text::refused;
use crate::error::Fault;
use crate::limits::{MIN_SAMPLES, MOST_BYTES_WHOLE};
use std::collections::BTreeSet;
use std::rc::Rc;

pub(super) const WHAT: &str = "workbook of a spreadsheet";

/// More columns than these are not read.
pub(super) const MOST_COLUMNS: usize = 256;

/// More sheets than these neither.
pub(super) const MOST_SHEETS: usize = 64;

/// phyphox calls so what was measured. What it makes of that stands in other sheets.
const MEASURED: &str = "Raw Data";

/// A sheet with its rows.
pub(super) struct Sheet {
    pub(super) name: String,
    pub(super) rows: Vec<Row>,
}

/// What stands in a row, each with its column: a cell far to the right takes no more room than any.
pub(super) type Row = Vec<(usize, Cell)>;

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Cell {
    /// As it stands there.
    Number(String),
    /// Many cells may share it.
    Text(Rc<str>),
}

/// The table, and what its sheet is called.
pub(super) fn table(sheets: &[Sheet], notes: &mut Vec<String>) -> Result<(Vec<u8>, String), Fault> {
    let tables: Vec<&Sheet> = sheets.iter().filter(|sheet| sheet.is_table()).collect();
    let names: Vec<&String> = tables.iter().map(|sheet| &sheet.name).collect();
    let measured = || names.iter().copied().find(|name| name.trim().eq_ignore_ascii_case(MEASURED));
    let chosen = only_one(&names).or_else(measured);
    let Some(sheet) = tables.iter().find(|sheet| Some(&sheet.name) == chosen) else {
        return Err(refused(WHAT, &none_of(&names)));
    };
    if sheets.len() > 1 {
        notes.push(note(&sheet.name, &names));
    }
    Ok((sheet.text()?.into_bytes(), sheet.name.clone()))
}

fn note(name: &String, tables: &[&String]) -> String {
    let others: Vec<&String> = tables.iter().copied().filter(|other| *other != name).collect();
    let left = if others.is_empty() { String::new() } else { format!(", and not {}", listed(&others)) };
    format!("sheet {name} read from the workbook{left}")
}

fn none_of(tables: &[&String]) -> String {
    match tables.len() {
        0 => "none of its sheets is a table of numbers; save the sheet as CSV in that program".to_owned(),
        n => format!(
            "it has {n} sheets of numbers ({}), and none is called {MEASURED}: save the sheet as CSV, the one with the \
             swing, or call that one {MEASURED}",
            listed(tables)
        ),
    }
}

fn listed(names: &[&String]) -> String {
    names.iter().map(|name| name.as_str()).collect::<Vec<_>>().join(", ")
}

impl Sheet {
    /// Has it as many rows of numbers as a recording?
    fn is_table(&self) -> bool {
        let has_number = |row: &&Row| row.iter().any(|(_, cell)| matches!(cell, Cell::Number(_)));
        self.rows.iter().filter(has_number).count() >= MIN_SAMPLES
    }

    /// As text, without the columns in which nothing stands.
    fn text(&self) -> Result<String, Fault> {
        let used: BTreeSet<usize> = self.rows.iter().flatten().map(|(column, _)| *column).collect();
        let used: Vec<usize> = used.into_iter().collect();
        let mut text = String::new();
        for row in &self.rows {
            text.push_str(&line(row, &used));
            // A text that many cells share can be far larger than the file.
            if text.len() as u64 >= MOST_BYTES_WHOLE {
                return Err(Fault::TooLarge);
            }
        }
        Ok(text)
    }
}

fn line(row: &Row, used: &[usize]) -> String {
    let mut words = vec![String::new(); used.len()];
    for (column, cell) in row {
        if let Ok(idx) = used.binary_search(column) {
            words[idx] = cell.in_words();
        }
    }
    words.join(";") + "\n"
}

impl Cell {
    fn in_words(&self) -> String {
        match self {
            Self::Number(number) => number.clone(),
            Self::Text(text) => format!("\"{}\"", text.replace(['"', '\n', '\r'], " ")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheet(name: &str, n_rows: usize) -> Sheet {
        let row = |idx: usize| vec![(0, Cell::Number(idx.to_string())), (300, Cell::Number(format!("{idx}.5")))];
        Sheet { name: name.to_owned(), rows: (0..n_rows).map(row).collect() }
    }

    #[test]
    fn of_several_sheets_of_numbers_what_was_measured_is_taken() {
        let all = ["Autocorrelation", "raw data", "Resonance"].map(|name| sheet(name, MIN_SAMPLES));
        let mut notes = Vec::new();
        let (text, name) = table(&all, &mut notes).unwrap();
        assert_eq!((name.as_str(), text.starts_with(b"0;0.5\n1;1.5\n")), ("raw data", true));
        assert_eq!(notes, ["sheet raw data read from the workbook, and not Autocorrelation, Resonance"]);
        // Named so, but with nothing in it.
        let bare = [sheet("Raw Data", MIN_SAMPLES - 1), sheet("Run 1", 40), sheet("Run 2", 40)];
        let refused = table(&bare, &mut Vec::new()).unwrap_err().to_string();
        assert!(refused.contains("(Run 1, Run 2), and none is called Raw Data: save the sheet as CSV"), "{refused}");
        assert!(refused.contains("or call that one Raw Data"), "{refused}");
    }

    #[test]
    fn a_text_that_all_cells_share_does_not_fill_the_memory() {
        let long: Rc<str> = "x".repeat(1 << 20).into();
        let row = || vec![(0, Cell::Number("1".to_owned())), (1, Cell::Text(Rc::clone(&long)))];
        let sheet = Sheet { name: "A".to_owned(), rows: (0..300).map(|_| row()).collect() };
        assert!(matches!(table(&[sheet], &mut Vec::new()), Err(Fault::TooLarge)));
    }
}
