//! Projects of CASSY Lab 1 (`.lab`), which are text: what is measured, and a table of all of it.
//!
//! In: after `CL4` four lines for each quantity, its name, symbol, unit and settings: the index, the time, the frequency of
//! a spectrum, and each channel behind two lines of its own. Then the table's size and its rows, which begin with their
//! index; empty rows are left out. What stands behind them, such as the spectrum, is no measurement.
//! Source: 173 such projects of three laboratories; beside 20 of them stand the tables that the program exported.

use super::as_text::{refused, text_of};
use crate::error::Fault;
use std::borrow::Cow;

/// Numbers in a line of a quantity's settings; those in front of a channel are more or fewer.
const N_SETTINGS: usize = 16;

/// The place of the frequency of the spectrum among the quantities.
const FREQUENCY: usize = 2;

/// With what the first line of a channel begins that is computed as a spectrum, and not at these times.
const SPECTRUM: &str = "10 4";

/// The letters of the font Symbol that a unit may have: 1000 Ω and 0.001 ms are no kW and no second of another size.
const IN_UNITS: [(&str, &str); 2] = [("&W", "Ω"), ("&m", "µ")];

/// The table of the project.
pub(super) fn table(bytes: &[u8]) -> Result<Vec<u8>, Fault> {
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => encoding_rs::mem::decode_latin1(bytes),
    };
    let lines: Vec<&str> = text.lines().collect();
    let begin = (1..lines.len()).find(|idx| n_columns(&lines, *idx).is_some());
    let found = begin.and_then(|begin| {
        let n_columns = n_columns(&lines, begin)?;
        Some((names(&lines[..begin], n_columns)?, columns(&lines[begin + 1..], n_columns)))
    });
    let Some((names, columns)) = found else {
        return Err(refused(
            "project of CASSY Lab 1 (.lab)",
            "open it there, and export the table with time and angle as text",
        ));
    };
    Ok(text_of(&names[1..], &columns[1..]))
}

/// Fields of a row of the table, where this line tells how large the table is and a row stands behind it.
fn n_columns(lines: &[&str], idx: usize) -> Option<usize> {
    let (n_columns, n_rows) = lines[idx].split_once(' ')?;
    let (n_columns, _): (usize, usize) = (n_columns.parse().ok()?, n_rows.parse().ok()?);
    row(lines.get(idx + 1)?, n_columns).map(|_| n_columns)
}

/// The numbers of a row; `NAN` is an empty cell.
fn row(line: &str, n_columns: usize) -> Option<Vec<f64>> {
    let cells: Vec<&str> = line.trim_end_matches('\t').split('\t').collect();
    let numbers: Option<Vec<f64>> = cells.iter().map(|cell| cell.parse().ok()).collect();
    numbers.filter(|numbers| n_columns > 1 && numbers.len() == n_columns)
}

fn columns(lines: &[&str], n_columns: usize) -> Vec<Vec<f64>> {
    let rows: Vec<Vec<f64>> = lines.iter().map_while(|line| row(line, n_columns)).collect();
    (0..n_columns).map(|idx| rows.iter().map(|row| row[idx]).collect()).collect()
}

/// Names with units of the table's columns, if there are as many quantities.
fn names(head: &[&str], n_columns: usize) -> Option<Vec<String>> {
    let settings = (5..head.len()).filter(|idx| is_settings(head[*idx]));
    let is_in_table = |(place, idx): &(usize, usize)| *place < FREQUENCY || !head[idx - 5].starts_with(SPECTRUM);
    let quantities = settings.enumerate().filter(|(place, _)| *place != FREQUENCY).filter(is_in_table);
    let names: Vec<String> = quantities.map(|(_, idx)| name(head[idx - 3], head[idx - 2], head[idx - 1])).collect();
    (names.len() == n_columns).then_some(names)
}

fn is_settings(line: &str) -> bool {
    let mut words = line.split(' ');
    let n = words.clone().count();
    n == N_SETTINGS && words.all(|word| word.parse::<f64>().is_ok())
}

fn name(quantity: &str, symbol: &str, unit: &str) -> String {
    let unit = IN_UNITS.iter().fold(unit.to_owned(), |unit, (letter, greek)| unit.replace(letter, greek));
    let in_unit = if unit.is_empty() { String::new() } else { format!(" ({unit})") };
    format!("{quantity} {}{in_unit}", symbol.replace('&', ""))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fmt::Write;

    const SETTINGS: &str = "0 80 10 0 3 0 0 1 0 0 0 0 0 -0.014 1 1";

    /// A project of two channels, one of them computed as this says, with a spectrum behind the table.
    fn project(unit: &str, computed: &str, n_columns: usize, rows: &str) -> String {
        let built_in = ["Index\nn\n", "Zeit\nt\ns", "Frequenz\nf\nHz"].map(|name| format!("{name}\n{SETTINGS}\n"));
        let channel = |kind: &str, name: &str| format!("{kind}\n1 0 0 0 2500 0\n{name}\n{SETTINGS}\n");
        format!(
            "CL4\n180 0.1\n{}2 1\n{}{}{n_columns} 900\n{rows}1 0 0\n-1\n2 3\n0\t7\t\n0.5\t8\t\n",
            built_in.concat(),
            channel("0 1 0 1", &format!("Winkel\n&b_A1\n{unit}")),
            channel(computed, "neue Größe\nf_1\nV"),
        )
    }

    fn check(text: &str, expected: &str) {
        for bytes in [text.as_bytes().to_vec(), text.replace('\n', "\r\n").into_bytes()] {
            assert_eq!(String::from_utf8(table(&bytes).unwrap()).unwrap(), expected);
        }
    }

    #[test]
    fn the_table_of_a_project_has_names_and_units() {
        let rows = "1\t0\t1.5\t\n2\t0.5\tNAN\t\n5\t2\t-1\t\n";
        check(&project("°", "10 4 0 0", 3, rows), "\"Zeit t (s)\";\"Winkel b_A1 (°)\"\n0;1.5\n0.5;NaN\n2;-1\n");
        let rows = "1\t0\t1.5\t7\t\n";
        let both = "\"Zeit t (s)\";\"Winkel b_A1 (µs)\";\"neue Größe f_1 (V)\"\n0;1.5;7\n";
        check(&project("&ms", "10 1 -1 2*U", 4, rows), both);
    }

    #[test]
    fn a_project_that_is_otherwise_is_refused_with_what_to_do() {
        let five = project("°", "10 4 0 0", 5, "1\t0\t1.5\t7\t8\t\n");
        for text in [five.as_str(), "CL4\n180 0.1\n", "CL4\nZeit\n3 3\n1 2 3\n"] {
            let fault = table(text.as_bytes()).unwrap_err().to_string();
            assert!(fault.contains("CASSY Lab 1") && fault.contains("export the table"), "{fault}");
        }
    }

    #[test]
    fn a_swing_in_a_project_is_a_recording() {
        let mut rows = String::new();
        for idx in 0..400 {
            let time_s = 0.05 * f64::from(idx);
            let angle = 2.0 * (-0.05 * time_s).exp() * (5.0 * time_s).cos();
            writeln!(rows, "{}\t{time_s}\t{angle}\t", idx + 1).unwrap();
        }
        let text = project("°", "10 4 0 0", 3, &rows);
        let (bytes, _, _) = encoding_rs::WINDOWS_1252.encode(&text);
        let recording = crate::read_bytes("pendel.lab", &bytes, &crate::ReadOptions::default()).unwrap();
        assert_eq!(recording.len(), 400);
        assert!((recording.angles_rad()[0] - 2_f64.to_radians()).abs() < 1e-9);
    }
}
