//! Settings above a table: a row of names and one of numbers, such as `sample_rate, duration` over `1000, 5`, before the rows
//! of another shape or the names of the columns. Read as rows, they would say how many columns there are.

use super::cell::{Cell, Numerals};
use super::heading;
use super::row::{Separator, is_comment, n_numbers, split};

/// So many rows alike show where the table begins; a file of fewer is no recording.
const ROWS_ALIKE: usize = 10;

/// More rows than these are no settings.
const MOST_ROWS: usize = 3;

/// What stands above a table.
pub(super) struct Preamble {
    /// The first line behind it.
    pub(super) end_idx: usize,
    /// Its numbers, as they stand there.
    pub(super) values: String,
    /// Hz, if it says so.
    pub(super) rate_hz: Option<f64>,
}

/// Looks for settings from the first line that could be a row.
pub(super) fn find(texts: &[&str], first_row_idx: usize, separator: Separator) -> Option<Preamble> {
    let is_filled = |idx: &usize| !is_comment(texts[*idx]) && !texts[*idx].trim().is_empty();
    let lines: Vec<usize> = (first_row_idx..texts.len()).filter(is_filled).collect();
    let n_fields = |idx: usize| split(texts[idx], separator).len();
    let are_rows = |lines: &[usize]| {
        let rows = &lines[..lines.len().min(ROWS_ALIKE)];
        let is_row = |idx: &usize| n_numbers(texts[*idx], separator) > 0 && n_fields(*idx) == n_fields(rows[0]);
        rows.len() == ROWS_ALIKE && rows.iter().all(is_row)
    };
    let is_heading = |idx: usize| {
        let line = &texts[idx..=idx];
        n_numbers(texts[idx], separator) == 0 && heading::says_columns(line, separator, n_fields(idx))
    };
    let end = (1..=MOST_ROWS.min(lines.len().saturating_sub(1))).find(|n| {
        let is_of_other_shape = *n == 1 && n_fields(lines[0]) > n_fields(lines[1]) && are_rows(&lines[1..]);
        is_of_other_shape || (is_heading(lines[*n]) && are_rows(&lines[n + 1..]))
    })?;
    let values = texts[first_row_idx].trim().to_owned();
    Some(Preamble { end_idx: lines[end], values, rate_hz: rate_hz(texts, first_row_idx, separator) })
}

/// Of the names in the line above the numbers the one that is a rate.
fn rate_hz(texts: &[&str], row_idx: usize, separator: Separator) -> Option<f64> {
    let names = texts[..row_idx].iter().rev().find(|line| !line.trim().is_empty())?;
    let is_rate = |name: &str| {
        let name = name.to_lowercase();
        ["rate", "hz", "abtast", "échantillon", "muestreo"].iter().any(|word| name.contains(word)) || name == "fs"
    };
    let (names, numbers) = (split(names, separator), split(texts[row_idx], separator));
    let mut values = names.iter().zip(numbers).filter(|(name, _)| is_rate(name)).map(|(_, number)| number);
    match Numerals::new().read(values.next()?) {
        Cell::Number(rate_hz) if rate_hz > 0.0 => Some(rate_hz),
        _ => None,
    }
}
