//! Rows of a table: what parts their fields, and which fields are numbers.

use super::cell::{Cell, Numerals, is_missing, number_and_unit};
use super::clock;

/// What parts the fields of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Separator {
    Semicolon,
    Tab,
    Comma,
    Space,
}

/// All of them.
pub(super) const SEPARATORS: [Separator; 4] =
    [Separator::Semicolon, Separator::Tab, Separator::Comma, Separator::Space];

pub(super) fn is_comment(line: &str) -> bool {
    let line = line.trim_start();
    ["#", "%", "//"].iter().any(|mark| line.starts_with(mark))
}

/// The separator with which the first lines give the most numbers and the least else.
pub(super) fn find_separator(texts: &[&str]) -> Separator {
    let lines = || texts.iter().filter(|line| !is_comment(line));
    let score = |separator: Separator| lines().map(|line| score_of_line(line, separator)).sum::<usize>();
    let mut best = (Separator::Comma, 0);
    for separator in SEPARATORS {
        let score = score(separator);
        if score > best.1 {
            best = (separator, score);
        }
    }
    best.0
}

fn score_of_line(line: &str, separator: Separator) -> usize {
    // Beside tabs a space parts thousands or words.
    if separator == Separator::Space && line.contains('\t') && n_numbers(line, Separator::Tab) >= 2 {
        return 0;
    }
    let n_filled = split(line, separator).iter().filter(|field| !field.is_empty()).count();
    let n_numbers = n_numbers(line, separator);
    if n_numbers < 2 { 0 } else { 2 * n_numbers - n_filled }
}

/// What most lines with numbers are like: a line such as `serial;7` above the table is no row.
pub(super) struct Typical {
    n_numbers: usize,
    n_fields: usize,
}

impl Typical {
    pub(super) fn of(texts: &[&str], separator: Separator) -> Self {
        let lines = || texts.iter().filter(|line| !is_comment(line) && n_numbers(line, separator) > 0);
        let n_numbers = most_frequent(lines().map(|line| n_numbers(line, separator)));
        let n_fields = most_frequent(lines().map(|line| split(line, separator).len()));
        Self { n_numbers, n_fields }
    }

    /// As many numbers as usual, or as many fields, all of them numbers or gaps.
    pub(super) fn is_row(&self, line: &str, separator: Separator) -> bool {
        let fields = split(line, separator);
        let n = fields.iter().filter(|field| looks_like_number(field, separator)).count();
        let all = || fields.iter().all(|field| is_missing(field) || looks_like_number(field, separator));
        n_numbers(line, separator) >= self.n_numbers || (n > 0 && fields.len() == self.n_fields && all())
    }
}

/// At least 1.
fn most_frequent(counts: impl Iterator<Item = usize>) -> usize {
    let mut counts: Vec<usize> = counts.collect();
    counts.sort_unstable();
    counts.chunk_by(|a, b| a == b).max_by_key(|run| run.len()).map_or(1, |run| run[0])
}

/// How many numbers a line has; 0 when fewer than half of its fields are numbers.
pub(super) fn n_numbers(line: &str, separator: Separator) -> usize {
    let fields = split(line, separator);
    let n = fields.iter().filter(|field| looks_like_number(field, separator)).count();
    if 2 * n >= fields.len() { n } else { 0 }
}

/// A number, NaN too, or a clock time. Between commas a space does not part thousands.
pub(super) fn looks_like_number(field: &str, separator: Separator) -> bool {
    let is_number = || field.parse::<f64>().is_ok() || matches!(Numerals::new().read(field), Cell::Number(_));
    let number = number_and_unit(field).map_or(field, |(number, _)| number);
    let parts_thousands = separator != Separator::Comma || !number.contains(' ');
    (parts_thousands && is_number()) || clock::read(field).is_some()
}

pub(super) fn split(line: &str, separator: Separator) -> Vec<&str> {
    let line = line.trim_end_matches(['\r', ' ']);
    match separator {
        Separator::Space => line.split_ascii_whitespace().map(bare).collect(),
        Separator::Semicolon => split_outside_quotes(line, ';'),
        Separator::Tab => split_outside_quotes(line, '\t'),
        Separator::Comma => split_outside_quotes(line, ','),
    }
}

fn split_outside_quotes(line: &str, separator: char) -> Vec<&str> {
    let mut inside = false;
    line.split(|letter: char| {
        inside ^= letter == '"';
        letter == separator && !inside
    })
    .map(bare)
    .collect()
}

fn bare(field: &str) -> &str {
    field.trim().trim_matches('"').trim()
}
