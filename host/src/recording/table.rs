//! Bytes of any CSV-like file → lines, separator, column names and where the numbers begin.
//!
//! Understands `,` `;` tab and spaces, decimal commas (unless `,` separates), comment and header lines of any number,
//! byte order marks, CRLF, UTF-16 and Latin-1. Rows are split here but judged in `read.rs`.

use super::columns::{Meaning, is_unit, meaning};
use super::error::Fault;

/// How many lines are looked at to find the separator.
const N_LINES_LOOKED_AT: usize = 200;

/// A text with its lines counted from 1 and its layout found.
pub(super) struct Table {
    text: String,
    separator: Separator,
    /// Index of the first line of numbers.
    first_row_idx: usize,
    /// Column names, when a line above the numbers has them.
    pub(super) names: Option<Vec<String>>,
    /// Columns of the first row.
    pub(super) n_columns: usize,
}

/// One row of the table.
pub(super) struct Row<'a> {
    /// Line, counted from 1.
    pub(super) line: usize,
    pub(super) fields: Vec<&'a str>,
    /// Whether a line end follows; without one the row may be cut off.
    pub(super) is_complete: bool,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Separator {
    Semicolon,
    Tab,
    Comma,
    Space,
}

const SEPARATORS: [Separator; 4] = [Separator::Semicolon, Separator::Tab, Separator::Comma, Separator::Space];

impl Table {
    /// Finds the layout of a file.
    pub(super) fn new(bytes: &[u8]) -> Result<Self, Fault> {
        let text = decode(bytes)?;
        if text.trim().is_empty() {
            return Err(Fault::Empty);
        }
        let separator = find_separator(&text);
        let lines: Vec<&str> = text.lines().collect();
        let n_typical = typical_n_numbers(&text, separator);
        let is_row = |line: &&str| !is_comment(line) && n_numbers(line, separator) >= n_typical;
        let no_numbers = Fault::NoNumbers { n_lines: lines.len() };
        let first_row_idx = lines.iter().position(is_row).ok_or(no_numbers)?;
        let n_columns = split(lines[first_row_idx], separator).len();
        let names = find_names(&lines[..first_row_idx], separator, n_columns);
        Ok(Self { separator, first_row_idx, names, n_columns, text })
    }

    /// Comment lines with their numbers from 1.
    pub(super) fn comments(&self) -> impl Iterator<Item = (usize, &str)> {
        self.text.lines().enumerate().filter(|(_, line)| is_comment(line)).map(|(idx, line)| (idx + 1, line))
    }

    /// Rows from the first one of numbers on, without comments and blank lines.
    pub(super) fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        self.text
            .split_inclusive('\n')
            .enumerate()
            .skip(self.first_row_idx)
            .filter(|(_, line)| !line.trim().is_empty() && !is_comment(line))
            .map(|(idx, line)| Row {
                line: idx + 1,
                fields: split(line.trim_end_matches(['\n', '\r']), self.separator),
                is_complete: line.ends_with('\n'),
            })
    }

    /// What a message calls column `idx`.
    pub(super) fn column_name(&self, idx: usize) -> String {
        match self.names.as_ref().and_then(|names| names.get(idx)) {
            Some(name) if !name.is_empty() => format!("{idx} ({name})"),
            _ => idx.to_string(),
        }
    }

    /// What a message lists as the columns there are.
    pub(super) fn available(&self) -> String {
        match &self.names {
            Some(names) => format!("the columns {}", names.join(", ")),
            None => format!("{} columns without names, counted from 0", self.n_columns),
        }
    }

    /// The field as a number. NaN and infinity parse here; the caller refuses them.
    pub(super) fn number(&self, field: &str) -> Option<f64> {
        number(field, self.separator)
    }
}

fn decode(bytes: &[u8]) -> Result<String, Fault> {
    match bytes {
        [0xff, 0xfe, rest @ ..] => return refuse_control(utf16(rest, u16::from_le_bytes)),
        [0xfe, 0xff, rest @ ..] => return refuse_control(utf16(rest, u16::from_be_bytes)),
        _ => {}
    }
    let bytes = bytes.strip_prefix(&[0xef, 0xbb, 0xbf]).unwrap_or(bytes);
    // A power cut can leave zero bytes behind the last block written.
    let n_kept = bytes.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1);
    let bytes = &bytes[..n_kept];
    let latin_1 = || bytes.iter().map(|byte| char::from(*byte)).collect();
    refuse_control(std::str::from_utf8(bytes).map_or_else(|_| latin_1(), str::to_owned))
}

fn utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> String {
    let units: Vec<u16> = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]])).collect();
    String::from_utf16_lossy(&units)
}

/// Text has no control characters except tab, line ends and form feed.
fn refuse_control(text: String) -> Result<String, Fault> {
    let is_foreign = |byte: u8| byte < 0x20 && !matches!(byte, b'\t' | b'\n' | b'\r' | 0x0c);
    match text.bytes().position(is_foreign) {
        None => Ok(text),
        Some(position) => Err(Fault::NotText { byte: text.as_bytes()[position], position }),
    }
}

fn is_comment(line: &str) -> bool {
    let line = line.trim_start();
    ["#", "%", "//"].iter().any(|mark| line.starts_with(mark))
}

/// The separator with which the first lines give the most numbers and the least else.
fn find_separator(text: &str) -> Separator {
    let score = |separator: Separator| -> usize {
        let lines = text.lines().filter(|line| !is_comment(line)).take(N_LINES_LOOKED_AT);
        lines.map(|line| score_of_line(line, separator)).sum()
    };
    let mut best = (Separator::Comma, 0);
    for separator in SEPARATORS {
        if score(separator) > best.1 {
            best = (separator, score(separator));
        }
    }
    best.0
}

fn score_of_line(line: &str, separator: Separator) -> usize {
    let n_fields = split(line, separator).len();
    let n_numbers = n_numbers(line, separator);
    if n_numbers < 2 { 0 } else { 2 * n_numbers - n_fields }
}

/// How many numbers most lines have, at least 1: a line such as `serial;7` above the table is no row.
fn typical_n_numbers(text: &str, separator: Separator) -> usize {
    let lines = text.lines().filter(|line| !is_comment(line)).take(N_LINES_LOOKED_AT);
    let mut counts: Vec<usize> = lines.map(|line| n_numbers(line, separator)).filter(|n| *n > 0).collect();
    counts.sort_unstable();
    counts.chunk_by(|a, b| a == b).max_by_key(|run| run.len()).map_or(1, |run| run[0])
}

/// How many numbers a line has; 0 when fewer than half of its fields are numbers.
fn n_numbers(line: &str, separator: Separator) -> usize {
    let fields = split(line, separator);
    let n = fields.iter().filter(|field| number(field, separator).is_some()).count();
    if 2 * n >= fields.len() { n } else { 0 }
}

fn number(field: &str, separator: Separator) -> Option<f64> {
    if separator == Separator::Comma || !field.contains(',') {
        return field.parse().ok();
    }
    field.replacen(',', ".", 1).parse().ok()
}

fn split(line: &str, separator: Separator) -> Vec<&str> {
    let line = line.trim_end_matches(['\r', ' ']);
    match separator {
        Separator::Space => line.split_whitespace().map(bare).collect(),
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

/// The line of names: the last one above the numbers with as many fields, or a comment whose words we know.
fn find_names(lines_above: &[&str], separator: Separator, n_columns: usize) -> Option<Vec<String>> {
    let candidates: Vec<&str> =
        lines_above.iter().copied().filter(|line| !is_comment(line) && !line.trim().is_empty()).collect();
    let with_all_columns = |line: &&str| split_names(line, separator).len() >= n_columns;
    let Some(last) = candidates.last().filter(|line| with_all_columns(line)) else {
        return names_in_comment(lines_above, separator, n_columns);
    };
    let names = split_names(last, separator);
    let above = candidates.len().checked_sub(2).map(|idx| split_names(candidates[idx], separator));
    match above.filter(|above| above.len() == names.len() && names.iter().all(|cell| is_unit(cell))) {
        Some(above) => Some(above.iter().zip(&names).map(|(name, unit)| format!("{name} {unit}")).collect()),
        None => Some(names),
    }
}

fn names_in_comment(lines_above: &[&str], separator: Separator, n_columns: usize) -> Option<Vec<String>> {
    let names = split_names(lines_above.iter().rev().find(|line| is_comment(line))?, separator);
    let is_known = names.iter().any(|name| meaning(name) != Meaning::Other);
    (is_known && names.len() == n_columns).then_some(names)
}

/// Names separated by spaces keep their unit in brackets: `Time [s] Angle [deg]` are two.
fn split_names(line: &str, separator: Separator) -> Vec<String> {
    let line = line.trim_start_matches(['#', '%', '/', ' ']);
    let line = match separator {
        Separator::Space => line.replace(" [", "[").replace(" (", "("),
        _ => line.to_owned(),
    };
    split(&line, separator).into_iter().map(str::to_owned).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(text: &str) -> (Separator, Option<Vec<String>>, usize) {
        let table = Table::new(text.as_bytes()).unwrap();
        (table.separator, table.names, table.first_row_idx)
    }

    fn names(names: &[&str]) -> Option<Vec<String>> {
        Some(names.iter().map(|name| (*name).to_owned()).collect())
    }

    #[test]
    fn separators_and_names_are_found() {
        let cases = [
            ("t,theta\n0,1\n0.1,2\n", Separator::Comma, names(&["t", "theta"]), 1),
            ("t;theta\n0,1;1,5\n0,2;2\n", Separator::Semicolon, names(&["t", "theta"]), 1),
            ("t\ttheta\n0,1\t1,5\n", Separator::Tab, names(&["t", "theta"]), 1),
            ("0,1 1,5\n0,2 2,5\n", Separator::Space, None, 0),
            ("Time [s] Angle [deg]\n0.1 1.5\n", Separator::Space, names(&["Time[s]", "Angle[deg]"]), 1),
            ("# a\n# t theta\n0.1 1.5\n", Separator::Space, names(&["t", "theta"]), 2),
            ("Logger 5\n\ntime;angle\ns;deg\n0;1\n", Separator::Semicolon, names(&["time s", "angle deg"]), 4),
            ("\u{feff}t,theta\r\n0,1\r\n", Separator::Comma, names(&["t", "theta"]), 1),
            ("\"t\",\"angle, raw\"\n\"0\",\"1\"\n", Separator::Comma, names(&["t", "angle, raw"]), 1),
            ("theta\n0.1\n0.2\n", Separator::Comma, names(&["theta"]), 1),
        ];
        for (text, separator, names, first_row_idx) in cases {
            assert_eq!(layout(text), (separator, names, first_row_idx), "{text:?}");
        }
    }

    #[test]
    fn utf_16_and_latin_1_are_read() {
        let utf_16: Vec<u8> = "\u{feff}t,angle (°)\n0,1\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert_eq!(Table::new(&utf_16).unwrap().names, names(&["t", "angle (°)"]));
        let latin_1 = b"t,angle (\xb0)\n0,1\n";
        assert_eq!(Table::new(latin_1).unwrap().names, names(&["t", "angle (°)"]));
    }

    #[test]
    fn binary_garbage_is_named_as_such() {
        assert!(matches!(Table::new(b"\x7fELF\x02\x01\x01\0\0\x03"), Err(Fault::NotText { byte: 2, .. })));
    }

    #[test]
    fn zero_bytes_left_by_a_power_cut_are_dropped() {
        assert_eq!(Table::new(b"t,theta\n0,1\n\0\0\0\0").unwrap().rows().count(), 1);
    }
}
