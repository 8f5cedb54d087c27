//! Lines of any CSV-like file → separator, column names, and rows one after the other.
//!
//! Understands `,` `;` tab and spaces, quoted fields, comment and header lines of any number. The layout is found from the
//! first lines; rows are split here but judged in `read.rs`.

mod layout;

use super::cell::{Cell, Numerals, is_missing};
use super::error::Fault;
use super::header;
use super::monitor::Dress;
use super::preamble::Preamble;
use super::row::{Separator, find_separator, is_comment, looks_like_number, split};
use super::source::Lines;
use super::words::is_gyroscope;
use layout::Layout;
use std::collections::VecDeque;
use std::ops::Range;

/// How many lines are looked at to find the layout.
const N_LINES_LOOKED_AT: usize = 200;

/// A line that the file of a model has, and no recording.
const MODEL_FILE: &str = "[pendulum]";

/// A message lists so many names at most: more are read by nobody.
const MOST_SHOWN: usize = 30;

/// Where each line is a quantity there are no more of them …
const MOST_QUANTITIES: usize = 8;

/// … and no fewer numbers in it.
const FEWEST_TURNED: usize = 100;

/// Words that label the rows stand in the first columns.
const MOST_LABELS: usize = 8;

/// Comments and blank lines above the table may be more.
const MOST_LINES_HELD: usize = 5000;

/// A text with its lines counted from 1 and its layout found.
pub(super) struct Table<'a> {
    lines: Lines<'a>,
    /// Lines read to find the layout, from the first row of numbers on.
    held: VecDeque<Line>,
    separator: Separator,
    /// Column names, when a line above the numbers has them.
    pub(super) names: Option<Vec<String>>,
    /// Columns of the first row.
    pub(super) n_columns: usize,
    /// What the first rows tell of the decimal mark.
    pub(super) numerals: Numerals,
    comments: Vec<(usize, String)>,
    dress: Dress,
    row: Line,
    n_lines: usize,
    /// The file has a quantity a line.
    pub(super) is_turned: bool,
    /// The file is called after a gyroscope, or was so in its archive.
    pub(super) is_of_gyroscope: bool,
    /// The file is called so, was so in its archive, or what stands in it.
    called: Vec<String>,
    /// The line of the names, where a row is stuck to them.
    pub(super) glued_line: Option<usize>,
    /// Settings in numbers above the rows.
    pub(super) settings: Option<Preamble>,
}

/// One line.
#[derive(Debug, Clone, Default)]
struct Line {
    /// Counted from 1.
    number: usize,
    text: String,
    /// Whether a line end follows; without one the row may be cut off.
    is_complete: bool,
}

impl<'a> Table<'a> {
    /// Finds the layout of a file.
    pub(super) fn new(mut lines: Lines<'a>) -> Result<Self, Fault> {
        let mut held = first_lines(&mut lines)?;
        if held.iter().any(|line| line.text.trim() == MODEL_FILE) {
            return Err(Fault::ModelFile);
        }
        let dress = undressed(&mut held);
        if held.iter().all(|line| line.text.trim().is_empty()) {
            return Err(Fault::Empty);
        }
        let turned = turned(&held);
        let is_turned = turned.is_some();
        let held = turned.unwrap_or(held);
        let layout = Layout::of(&held, &dress)?;
        let mut table = Self {
            is_of_gyroscope: lines.name.as_deref().is_some_and(is_gyroscope),
            called: lines.name.iter().cloned().collect(),
            lines,
            n_lines: held.len(),
            comments: remarks(&held, layout.first_row_idx),
            held: held.into_iter().skip(layout.first_row_idx).collect(),
            row: Line::default(),
            dress,
            is_turned,
            separator: layout.separator,
            names: layout.names,
            n_columns: layout.n_columns,
            numerals: layout.numerals,
            glued_line: layout.glued_line,
            settings: layout.settings,
        };
        table.called.extend(table.labels());
        Ok(table)
    }

    /// What always stands in the columns of words.
    fn labels(&self) -> Vec<String> {
        let label = |idx: usize| {
            let first = self.first_cells(idx).next()?;
            (self.is_of_words(idx) && self.first_cells(idx).all(|cell| cell == first)).then(|| first.to_owned())
        };
        (0..self.n_columns.min(MOST_LABELS)).filter_map(label).collect()
    }

    /// Comment lines among the first lines, with their numbers from 1.
    pub(super) fn comments(&self) -> impl Iterator<Item = (usize, &str)> {
        self.comments.iter().map(|(number, text)| (*number, text.as_str()))
    }

    /// Goes on to the next row, past comments and blank lines; false behind the last.
    pub(super) fn advance(&mut self) -> Result<bool, Fault> {
        loop {
            match self.held.pop_front() {
                Some(line) => self.row = line,
                None => {
                    let Some(is_complete) = self.lines.next_into(&mut self.row.text)? else { return Ok(false) };
                    self.n_lines += 1;
                    self.row.number = self.n_lines;
                    self.row.is_complete = is_complete;
                    if let Some(plain) = self.dress.undress(&self.row.text) {
                        self.row.text = plain;
                    }
                }
            }
            if !self.row.text.trim().is_empty() && !is_comment(&self.row.text) {
                return Ok(true);
            }
        }
    }

    /// The fields of the row.
    pub(super) fn fields(&self) -> Vec<&str> {
        split(&self.row.text, self.separator)
    }

    /// Then no cell can be seen to be empty.
    pub(super) fn is_parted_by_spaces(&self) -> bool {
        self.separator == Separator::Space
    }

    /// Do the names of the columns stand in the row again?
    pub(super) fn is_heading(&self) -> bool {
        let bare = |name: &str| name.to_lowercase().replace(char::is_whitespace, "");
        let fields: Vec<String> = self.fields().into_iter().map(bare).collect();
        self.names.as_ref().is_some_and(|names| names.iter().map(|name| bare(name)).eq(fields))
    }

    /// Line of the row, counted from 1.
    pub(super) fn line(&self) -> usize {
        self.row.number
    }

    /// Whether a line end follows the row; without one it may be cut off.
    pub(super) fn is_complete(&self) -> bool {
        self.row.is_complete
    }

    /// The fields of the first row, before any was read.
    pub(super) fn first_fields(&self) -> Vec<&str> {
        self.held.front().map(|line| split(&line.text, self.separator)).unwrap_or_default()
    }

    /// The numbers of a column in the first rows, as far as they are some, before any row was read.
    pub(super) fn first_numbers(&self, idx: usize) -> Vec<f64> {
        let mut numerals = self.numerals.clone();
        let mut number = |line: &Line| match numerals.read(split(&line.text, self.separator).get(idx)?) {
            Cell::Number(number) => Some(number),
            _ => None,
        };
        self.held.iter().map_while(&mut number).collect()
    }

    /// Do its numbers in the first rows change?
    pub(super) fn moves(&self, idx: usize) -> bool {
        self.first_numbers(idx).windows(2).any(|pair| pair[0] != pair[1])
    }

    /// Does anything stand in a column in the first rows, before any row was read?
    pub(super) fn is_filled(&self, idx: usize) -> bool {
        self.first_cells(idx).any(|cell| !is_missing(cell))
    }

    /// Are half of its cells in the first rows numbers, from the first filled one on? Settings beside a table are fewer, and
    /// a sensor may begin to measure later than its clock.
    pub(super) fn is_of_numbers(&self, idx: usize) -> bool {
        let mut numerals = self.numerals.clone();
        let cells = || self.first_cells(idx).skip_while(|cell| is_missing(cell));
        let n_numbers = cells().filter(|cell| matches!(numerals.read(cell), Cell::Number(_))).count();
        n_numbers > 0 && 2 * n_numbers >= cells().count()
    }

    /// The columns of axes that stood in brackets.
    pub(super) fn vectors(&self) -> Vec<Range<usize>> {
        self.dress.vectors()
    }

    /// Stands nothing in it in the first rows?
    pub(super) fn is_empty_at_first(&self, idx: usize) -> bool {
        self.first_cells(idx).all(is_missing)
    }

    /// Stands a word in each of its cells in the first rows?
    pub(super) fn is_of_words(&self, idx: usize) -> bool {
        let is_word = |cell: &str| cell.contains(char::is_alphabetic) && !looks_like_number(cell, self.separator);
        self.first_cells(idx).all(|cell| is_word(cell) && !is_missing(cell))
    }

    /// Takes what the file is called.
    pub(super) fn call(&mut self, name: &str) {
        self.is_of_gyroscope |= is_gyroscope(name);
        self.called.push(name.to_owned());
    }

    /// Is the file called so, a column, or what always stands in a column of words?
    pub(super) fn is_called(&self, is_it: impl Fn(&str) -> bool) -> bool {
        self.called.iter().chain(self.names.iter().flatten()).any(|name| is_it(name))
    }

    /// Is a cell among the first rows nothing but the unit of a voltage?
    pub(super) fn says_volts(&self) -> bool {
        let is_volt = |cell: &str| matches!(cell, "V" | "mV" | "Volt" | "Volts");
        (0..self.n_columns).any(|idx| self.first_cells(idx).any(is_volt))
    }

    /// One cell for each of the first rows; empty where the row is shorter.
    pub(super) fn first_cells(&self, idx: usize) -> impl Iterator<Item = &str> {
        let rows = self.held.iter().filter(|line| !line.text.trim().is_empty() && !is_comment(&line.text));
        rows.map(move |line| split(&line.text, self.separator).get(idx).copied().unwrap_or_default())
    }

    /// What a message calls column `idx`.
    pub(super) fn column_name(&self, idx: usize) -> String {
        match self.names.as_ref().and_then(|names| names.get(idx)) {
            Some(name) if !name.is_empty() => format!("{idx} ({name})"),
            _ => idx.to_string(),
        }
    }

    /// Does the name of a column say this? Of one without a name it is false.
    pub(super) fn says(&self, idx: usize, is_it: impl Fn(&str) -> bool) -> bool {
        self.names.as_ref().and_then(|names| names.get(idx)).is_some_and(|name| is_it(name))
    }

    /// What a message lists as the columns there are.
    pub(super) fn available(&self) -> String {
        let Some(names) = &self.names else {
            return format!("{} columns without names, counted from 0", self.n_columns);
        };
        let is_there = |idx: &usize| !names[*idx].trim().is_empty() || self.is_filled(*idx);
        let shown = (0..names.len()).filter(is_there).map(|idx| match names[idx].trim() {
            "" => format!("{idx} without a name"),
            name => name.to_owned(),
        });
        let shown: Vec<String> = shown.collect();
        match shown.len().checked_sub(MOST_SHOWN).filter(|n_more| *n_more > 0) {
            Some(n_more) => format!("the columns {} and {n_more} more", shown[..MOST_SHOWN].join(", ")),
            None => format!("the columns {}", shown.join(", ")),
        }
    }
}

/// Comments, and above the rows what says the rate, with their line numbers.
fn remarks(held: &[Line], first_row_idx: usize) -> Vec<(usize, String)> {
    let is_remark = |(idx, line): &(usize, &Line)| {
        is_comment(&line.text) || (*idx < first_row_idx && header::says_rate(&line.text))
    };
    held.iter().enumerate().filter(is_remark).map(|(_, line)| (line.number, line.text.clone())).collect()
}

fn first_lines(lines: &mut Lines) -> Result<Vec<Line>, Fault> {
    let mut held = Vec::new();
    let mut n_filled = 0;
    let mut line = Line::default();
    while n_filled < N_LINES_LOOKED_AT && held.len() < MOST_LINES_HELD {
        let Some(is_complete) = lines.next_into(&mut line.text)? else { break };
        n_filled += usize::from(!line.text.trim().is_empty() && !is_comment(&line.text));
        held.push(Line { number: held.len() + 1, text: std::mem::take(&mut line.text), is_complete });
    }
    Ok(held)
}

/// The rows of a file that has a quantity a line, as programs write an array of arrays.
fn turned(held: &[Line]) -> Option<Vec<Line>> {
    let filled = held.iter().filter(|line| !line.text.trim().is_empty() && !is_comment(&line.text));
    let texts: Vec<&str> = filled.map(|line| line.text.as_str()).collect();
    if !(2..=MOST_QUANTITIES).contains(&texts.len()) {
        return None;
    }
    let separator = find_separator(&texts);
    let quantities: Vec<Vec<&str>> = texts.iter().map(|text| split(text, separator)).collect();
    let n = quantities[0].len();
    if n < FEWEST_TURNED || quantities.iter().any(|quantity| quantity.len() != n) {
        return None;
    }
    let row = |idx: usize| quantities.iter().map(|quantity| quantity[idx]).collect::<Vec<_>>().join("\t");
    Some((0..n).map(|idx| Line { number: idx + 1, text: row(idx), is_complete: true }).collect())
}

/// Takes off the first lines what a serial monitor or plotter put around their numbers.
fn undressed(held: &mut [Line]) -> Dress {
    let filled = |line: &&Line| !line.text.trim().is_empty() && !is_comment(&line.text);
    let texts: Vec<&str> = held.iter().filter(filled).map(|line| line.text.as_str()).collect();
    let dress = Dress::of(&texts);
    for line in held.iter_mut() {
        if let Some(plain) = dress.undress(&line.text) {
            line.text = plain;
        }
    }
    dress
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(bytes: &[u8]) -> Result<Table<'_>, Fault> {
        Table::new(Lines::of(bytes, &mut Vec::new())?)
    }

    fn layout(text: &str) -> (Separator, Option<Vec<String>>, usize) {
        let table = table(text.as_bytes()).unwrap();
        (table.separator, table.names.clone(), table.held[0].number - 1)
    }

    fn names(names: &[&str]) -> Option<Vec<String>> {
        Some(names.iter().map(|name| (*name).to_owned()).collect())
    }

    #[test]
    fn a_model_file_is_known_as_such() {
        let fault = |text: &str| table(text.as_bytes()).err();
        let model =
            "# a model\nformat = 1\n\n[pendulum]\nmass = 0.1466 # kg\nlength = 0.1562\n\n[effect.viscous]\nMw = 5e-4\n";
        assert!(matches!(fault(model), Some(Fault::ModelFile)));
        assert!(matches!(fault("not a number\nin any line\n"), Some(Fault::NoNumbers { .. })));
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
    fn a_separator_behind_the_last_cell_takes_no_names_away() {
        for text in ["t,theta\n0,1,\n1,2,\n", "t\ttheta\n0\t1\t\n1\t2\t\n", "t;theta;\n0;1;\n1;2;\n"] {
            let found = layout(text).1.unwrap_or_default();
            assert_eq!(found[..2], ["t", "theta"], "{text}");
        }
        assert_eq!(layout("t,theta\n0,1,5\n1,2,5\n").1, None);
    }

    /// A logger that got one more value than its header, and R's `write.table`, whose rows begin with their numbers.
    #[test]
    fn fewer_names_than_columns_are_those_of_the_first_ones_or_behind_the_numbers_of_the_rows() {
        let cases = [
            ("t_ms,theta,seq\n127,1.5,3,9\n132,1.4,4,10\n137,1.2,5,10\n", ["t_ms", "theta", "seq", ""]),
            ("# log on:\n# t,theta,omega\n0.1,1.5,3,9\n0.2,1.4,4,10\n", ["t", "theta", "omega", ""]),
            (
                "\"t\" \"theta\" \"omega\"\n\"1\" 0.1 1.5 3\n\"2\" 0.2 1.4 4\n\"3\" 0.3 1.2 5\n",
                ["", "t", "theta", "omega"],
            ),
            ("t theta omega\n1 0.1 1.5 3\n2 0.1 1.4 4\n3 0.0 1.2 5\n", ["t", "theta", "omega", ""]),
        ];
        for (text, expected) in cases {
            assert_eq!(layout(text).1, names(&expected), "{text:?}");
        }
        // Two names of five columns are a caption, and so are words that name nothing.
        for text in
            ["t,theta\n0,1,2,3,4\n1,1,2,3,5\n", "our,old,rig\n0,1,2,3\n1,1,2,4\n", "angle,t,x\n0,1,2,3\n1,1,2,4\n"]
        {
            assert_eq!(layout(text).1, None, "{text:?}");
        }
    }

    #[test]
    fn utf_16_and_latin_1_are_read() {
        let utf_16: Vec<u8> = "\u{feff}t,angle (°)\n0,1\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert_eq!(table(&utf_16).unwrap().names, names(&["t", "angle (°)"]));
        let latin_1 = b"t,angle (\xb0)\n0,1\n";
        assert_eq!(table(latin_1).unwrap().names, names(&["t", "angle (°)"]));
    }

    #[test]
    fn binary_garbage_is_named_as_such() {
        assert!(matches!(table(b"\x7fELF\x02\x01\x01\0\0\x03"), Err(Fault::NotText { byte: 2, .. })));
    }

    #[test]
    fn zero_bytes_left_by_a_power_cut_are_dropped() {
        let mut table = table(b"t,theta\n0,1\n\0\0\0\0").unwrap();
        assert!(table.advance().unwrap() && !table.advance().unwrap());
    }

    #[test]
    fn comments_keep_their_lines_and_columns_their_names() {
        let table = table(b"# rate\nt,,theta\n# comment: brass\n0,1,2\n1,2,3\n").unwrap();
        assert_eq!(table.comments().collect::<Vec<_>>(), [(1, "# rate"), (3, "# comment: brass")]);
        assert_eq!([0, 1, 2].map(|idx| table.column_name(idx)), ["0 (t)", "1", "2 (theta)"]);
    }
}
