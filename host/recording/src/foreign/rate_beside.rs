//! How many samples a second there are, where a number beside the data of a file says so.

use crate::header::said_rate_hz;
use crate::limits::LONGEST_STEP_S;
use crate::words::{Meaning, meaning};

/// A line above the table, of a number by its name that says how many samples a second there are; none where something may be the
/// time, or two say otherwise.
pub(super) fn line_above<'a>(
    numbers: impl Iterator<Item = (&'a str, f64)>,
    names: &[String],
    columns: &[Vec<f64>],
    notes: &mut Vec<String>,
) -> String {
    let is_time = |name: &String| matches!(meaning(name), Meaning::Time { .. });
    let n_rows = columns.iter().map(Vec::len).max().unwrap_or(0);
    let may_be_time = |column: &Vec<f64>| column.len() == n_rows && rises(column);
    if names.iter().any(is_time) || columns.iter().any(may_be_time) {
        return String::new();
    }
    let said = |(name, number): (&str, f64)| {
        let rate_hz = said_rate_hz(&name.to_lowercase(), &number.to_string())?;
        (rate_hz * LONGEST_STEP_S > 1.0).then(|| (format!("{name} = {number}"), rate_hz))
    };
    let all: Vec<(String, f64)> = numbers.filter_map(said).collect();
    let Some((number, rate_hz)) = all.first().filter(|(_, rate_hz)| all.iter().all(|other| other.1 == *rate_hz)) else {
        return String::new();
    };
    notes.push(format!("{number} beside the data is read like a line above the table, Sampling rate: {rate_hz} Hz"));
    format!("# Sampling rate: {rate_hz} Hz\n")
}

/// Does it, from one to the next?
pub(super) fn rises(column: &[f64]) -> bool {
    column.windows(2).all(|pair| pair[1] > pair[0])
}
