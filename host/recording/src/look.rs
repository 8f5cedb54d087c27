//! The first rows of a file as they stand there, for somebody who says which column is what.

use super::error::{Fault, ReadError};
use super::read::open;
use super::source::Lines;
use super::table::Table;
use serde::Serialize;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// More columns than this nobody chooses from.
const MOST_COLUMNS: usize = 64;

/// A cell is shown up to so many characters.
const LONGEST_CELL: usize = 24;

/// Names of the columns, and the first rows.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Look {
    /// As in the file, or numbers from 0.
    pub columns: Vec<String>,
    /// One list of cells a row.
    pub rows: Vec<Vec<String>>,
}

/// Looks at the first rows of the file at `path`.
///
/// # Errors
/// No table can be found.
pub fn look(path: &Path, n_rows: usize) -> Result<Look, ReadError> {
    let rows = open(path).and_then(|file| first_rows(BufReader::new(file), n_rows));
    rows.map_err(|fault| ReadError { file: path.display().to_string(), fault })
}

fn first_rows(reader: impl BufRead, n_rows: usize) -> Result<Look, Fault> {
    let mut table = Table::new(Lines::of(reader, &mut Vec::new())?)?;
    let names = table.names.clone().unwrap_or_default();
    let n_columns = names.len().max(table.n_columns).min(MOST_COLUMNS);
    let shown = |cell: &str| cell.trim().chars().take(LONGEST_CELL).collect::<String>();
    let name = |idx: usize| names.get(idx).map(|name| shown(name)).filter(|name| !name.is_empty());
    let columns = (0..n_columns).map(|idx| name(idx).unwrap_or_else(|| idx.to_string())).collect();
    let mut rows = Vec::new();
    while rows.len() < n_rows && table.advance()? {
        rows.push(table.fields().into_iter().take(n_columns).map(shown).collect());
    }
    Ok(Look { columns, rows })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_first_rows_are_shown_as_they_stand_there() {
        let look = first_rows(&b"Zeit;Winkel\n0,00;12,5\n0,01;12,4\n0,02;12,1\n"[..], 2).unwrap();
        assert_eq!(look.columns, ["Zeit", "Winkel"]);
        assert_eq!(look.rows, [["0,00", "12,5"], ["0,01", "12,4"]]);
        let bare = first_rows(&b"0.0 1.5\n0.1 1.4\n"[..], 8).unwrap();
        assert_eq!((bare.columns, bare.rows.len()), (vec!["0".to_owned(), "1".to_owned()], 2));
        assert!(first_rows(&b"words only\n"[..], 8).is_err());
    }
}
