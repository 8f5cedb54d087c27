//! The study as one table: a row a recording, a column a number, for spreadsheets, R and pandas.
//!
//! SI units. Rows by rig and name, columns of numbers by the order in which they first appear; no clock and no machine
//! has a say in it, so that equal studies give equal tables.

use super::folder::TABLE_BEGINS;
use super::rig::RigView;
use super::row::{Number, Row};
use std::collections::HashSet;

/// What stands before the numbers.
const FIXED: [&str; 13] = [
    "rig",
    "recording",
    "recorded",
    "problem",
    "samples",
    "duration_s",
    "amplitude_rad",
    "period_s",
    "noise",
    "error",
    "left_over",
    "file_sha256",
    "model_sha256",
];

/// The whole table.
pub fn table(rigs: &[RigView]) -> String {
    let mut rows: Vec<&Row> = rigs.iter().flat_map(|rig| &rig.rows).collect();
    rows.sort_by(|a, b| a.key.cmp(&b.key));
    let columns = columns(&rows);
    let header = FIXED.iter().map(|name| (*name).to_owned());
    let of_numbers = columns.iter().flat_map(|(symbol, _)| [symbol.clone(), format!("{symbol}_std")]);
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut write = |cells: Vec<String>| writer.write_record(cells).expect("memory has room");
    write(header.chain(of_numbers).collect());
    rows.iter().for_each(|row| write(cells(row, &columns)));
    let bytes = writer.into_inner().expect("memory has room");
    let text = String::from_utf8(bytes).expect("texts were written");
    debug_assert!(text.starts_with(TABLE_BEGINS));
    text
}

/// Symbol and effect of every number that occurs.
fn columns(rows: &[&Row]) -> Vec<(String, String)> {
    let mut seen = HashSet::new();
    let mut columns = Vec::new();
    for number in rows.iter().filter_map(|row| row.found()).flat_map(|found| &found.numbers) {
        let column = (number.symbol.clone(), number.effect.clone());
        if seen.insert(column.clone()) {
            columns.push(column);
        }
    }
    columns
}

fn cells(row: &Row, columns: &[(String, String)]) -> Vec<String> {
    let found = row.found();
    let number = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:e}"));
    let mut cells = vec![
        row.key.rig.clone(),
        row.key.recording.clone(),
        row.recorded.clone().unwrap_or_default(),
        row.outcome.as_ref().err().cloned().unwrap_or_default(),
        found.map_or(String::new(), |found| found.n_samples.to_string()),
        number(found.map(|found| found.duration_s)),
        number(found.map(|found| found.amplitude_rad)),
        number(found.and_then(|found| found.period_s)),
        number(found.map(|found| found.noise_rad)),
        number(found.map(|found| found.error_rad)),
        found.map_or(String::new(), |found| found.left.clone()),
        row.origin.file_hash.clone(),
        row.origin.model_hash.clone(),
    ];
    for (symbol, effect) in columns {
        let is_it = |number: &&Number| number.symbol == *symbol && number.effect == *effect;
        let own = found.and_then(|found| found.numbers.iter().find(is_it));
        cells.push(number(own.map(|own| own.value)));
        cells.push(number(own.and_then(|own| own.std)));
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::super::rig::tests::row;
    use super::*;

    #[test]
    fn every_number_stands_in_its_column() {
        let text = table(&[RigView::new("rig", vec![row("swing.csv", 0.5, 0.25)])]);
        let lines: Vec<Vec<&str>> = text.lines().map(|line| line.split(',').collect()).collect();
        let of = |column: &str| lines[1][lines[0].iter().position(|name| *name == column).unwrap()];
        let expected = [
            ("rig", "rig"),
            ("recording", "swing.csv"),
            ("samples", "100"),
            ("duration_s", "2e1"),
            ("amplitude_rad", "1e0"),
            ("period_s", "1e0"),
            ("noise", "1e-3"),
            ("error", "2e-3"),
            ("left_over", "noise"),
            ("Mc", "5e-1"),
            ("Mc_std", "2.5e-1"),
        ];
        for (column, value) in expected {
            assert_eq!(of(column), value, "{column}: {text}");
        }
    }
}
