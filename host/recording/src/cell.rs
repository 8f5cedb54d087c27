//! Numbers as people of many countries write them: decimal points and commas, thousands marks, and cells without one.
//!
//! `1.5`, `1,5`, `1,234.5`, `1.234,5`, `1 234,5` and `1'234.5` are read. One mark alone is the decimal mark, unless the
//! file showed before which one is; where that comes too late, the file is refused rather than misread.

use super::words::is_unit;

/// The minus sign of typesetters, which some programs write in place of the hyphen.
const MINUS: char = '\u{2212}';

/// What stands in a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Cell {
    /// A number; may be infinite, which the caller refuses.
    Number(f64),
    /// Nothing was measured: empty, NaN, NA, `-`.
    Missing,
    /// Something else.
    Text,
    /// A number whose marks contradict those of earlier cells.
    Contradiction,
}

/// The decimal mark of a file, as far as it is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Decimal {
    Unknown,
    Point,
    Comma,
}

/// Reads the cells of one file.
#[derive(Debug, Clone)]
pub(super) struct Numerals {
    decimal: Decimal,
    /// A lone point or comma was read as the decimal mark, and might have been the other thing.
    doubtful_points: bool,
    doubtful_commas: bool,
}

impl Numerals {
    /// A file of which nothing is known yet.
    pub(super) fn new() -> Self {
        Self { decimal: Decimal::Unknown, doubtful_points: false, doubtful_commas: false }
    }

    /// What is known, for another beginning: cells that were looked at are not yet read.
    pub(super) fn without_doubts(self) -> Self {
        Self { decimal: self.decimal, ..Self::new() }
    }

    /// Reads one cell, and learns from it.
    pub(super) fn read(&mut self, cell: &str) -> Cell {
        self.with_a_point(cell.trim_ascii()).map_or_else(|| self.read_any(cell), Cell::Number)
    }

    fn read_any(&mut self, cell: &str) -> Cell {
        if let Some(degrees) = of_degrees_and_minutes(cell) {
            return Cell::Number(degrees);
        }
        let cell = without_mark_of_text(cell.trim()).trim_end_matches('°').trim_end();
        if is_missing(cell) {
            return Cell::Missing;
        }
        if cell.contains(MINUS) {
            return self.read_any(&cell.replace(MINUS, "-"));
        }
        match self.bare(cell) {
            Cell::Text => number_and_unit(cell).map_or(Cell::Text, |(number, _)| self.bare(number)),
            found => found,
        }
    }

    /// What most cells of most files are, read at once: a number with a point.
    fn with_a_point(&mut self, cell: &str) -> Option<f64> {
        let is_of_number = |byte: &u8| byte.is_ascii_digit() || matches!(byte, b'.' | b'-' | b'+' | b'e' | b'E');
        if self.decimal == Decimal::Comma || !cell.as_bytes().iter().all(is_of_number) {
            return None;
        }
        let number = cell.parse().ok()?;
        let n_behind = cell.len() - 1 - cell.rfind('.')?;
        self.doubtful_points |= self.decimal == Decimal::Unknown && n_behind == 3;
        Some(number)
    }

    fn bare(&mut self, cell: &str) -> Cell {
        if !cell.contains(is_mark) {
            return cell.parse().map_or(Cell::Text, Cell::Number);
        }
        self.with_marks(cell).unwrap_or(Cell::Text)
    }

    fn with_marks(&mut self, cell: &str) -> Option<Cell> {
        let (n_points, n_commas) = (cell.matches('.').count(), cell.matches(',').count());
        let other_marks = cell.contains(is_space_or_apostrophe);
        let comma_is_decimal = match (n_points, n_commas) {
            (0, 0) => self.decimal == Decimal::Comma,
            (0, 1) => self.decimal != Decimal::Point,
            (1, 0) => self.decimal == Decimal::Comma,
            (0, _) => false,
            (_, 0) => true,
            (1, 1) => cell.rfind(',') > cell.rfind('.'),
            (_, 1) => true,
            (1, _) => false,
            _ => return None,
        };
        let (decimal, thousands) = if comma_is_decimal { (',', '.') } else { ('.', ',') };
        let number = plain(cell, decimal, thousands)?.parse().ok()?;
        let is_proof = n_points + n_commas > 1;
        if is_proof && !self.learn(if comma_is_decimal { Decimal::Comma } else { Decimal::Point }) {
            return Some(Cell::Contradiction);
        }
        let has_three = |mark: char| cell.rsplit(mark).next().is_some_and(|last| last.len() == 3);
        if self.decimal == Decimal::Unknown && !other_marks {
            self.doubtful_points |= n_points == 1 && has_three('.');
            self.doubtful_commas |= n_commas == 1 && has_three(',');
        }
        Some(Cell::Number(number))
    }

    /// The decimal mark is known now; false if that comes too late.
    fn learn(&mut self, decimal: Decimal) -> bool {
        let too_late = self.decimal == Decimal::Unknown
            && match decimal {
                Decimal::Point => self.doubtful_commas,
                Decimal::Comma => self.doubtful_points,
                Decimal::Unknown => false,
            };
        let fits = self.decimal == Decimal::Unknown || self.decimal == decimal;
        self.decimal = decimal;
        fits && !too_late
    }
}

/// Degrees of `57°17'`, `-0°17.5′` and `57° 17' 30"`; the mark of the seconds may be lost as a quote is.
fn of_degrees_and_minutes(cell: &str) -> Option<f64> {
    let (degrees, rest) = cell.trim().split_once('°')?;
    let (minutes, seconds) = rest.split_once(['\'', '′', '’'])?;
    let plain = |text: &str| text.trim().replace(MINUS, "-").parse::<f64>().ok();
    // Programs that round write 60.
    let sixtieths = |text: &str| plain(text).filter(|value| (0.0..=60.0).contains(value));
    let seconds = match seconds.trim().trim_end_matches(['"', '″', '”', '\'']) {
        "" => 0.0,
        seconds => sixtieths(seconds)?,
    };
    let size = plain(degrees)?.abs() + sixtieths(minutes)? / 60.0 + seconds / 3600.0;
    Some(if degrees.trim().starts_with(['-', MINUS]) { -size } else { size })
}

/// A number and the unit behind it, if there is one: `57.3 deg`, `12.5°`; that of minutes is the one of degrees.
pub(super) fn number_and_unit(cell: &str) -> Option<(&str, &str)> {
    let cell = cell.trim();
    if of_degrees_and_minutes(cell).is_some() {
        return Some((cell, "°"));
    }
    let end = cell.rfind(|letter: char| letter.is_ascii_digit() || letter == '.')?;
    let (number, unit) = cell.split_at(end + 1);
    is_unit(unit.trim()).then(|| (number.trim_end(), unit.trim()))
}

/// A spreadsheet's apostrophe before what is to be shown as it was typed: `'0:00:01.25`.
pub(super) fn without_mark_of_text(cell: &str) -> &str {
    cell.strip_prefix('\'').filter(|rest| !rest.contains('\'')).unwrap_or(cell)
}

/// Is there nothing in the cell?
pub(super) fn is_missing(cell: &str) -> bool {
    const WORDS: [&str; 10] = ["", "-", "--", "nan", "na", "n/a", "#n/a", "null", "none", "#num!"];
    let bare = cell.trim().trim_start_matches(['-', '+']);
    WORDS.iter().any(|word| bare.eq_ignore_ascii_case(word))
}

fn is_mark(letter: char) -> bool {
    letter == '.' || letter == ',' || is_space_or_apostrophe(letter)
}

/// No-break and thin spaces are thousands marks in French and in ISO 80000; the Swiss write apostrophes.
fn is_space_or_apostrophe(letter: char) -> bool {
    matches!(letter, ' ' | '\u{a0}' | '\u{202f}' | '\u{2009}' | '\'' | '’')
}

/// The number without thousands marks and with a decimal point; `None` where the groups are not of three digits.
fn plain(cell: &str, decimal: char, thousands: char) -> Option<String> {
    let (whole, fraction) = cell.split_once(decimal).map_or((cell, None), |(whole, rest)| (whole, Some(rest)));
    if fraction.is_some_and(|fraction| fraction.contains(is_mark)) {
        return None;
    }
    let is_thousands = |letter: char| letter == thousands || is_space_or_apostrophe(letter);
    let digits = whole.trim_start_matches(['-', '+']);
    let mut groups = digits.split(is_thousands);
    let first = groups.next()?;
    let are_groups = digits.contains(is_thousands)
        && (1..=3).contains(&first.len())
        && groups.all(|group| group.len() == 3 && group.bytes().all(|byte| byte.is_ascii_digit()));
    if digits.contains(is_thousands) && !are_groups {
        return None;
    }
    let whole: String = whole.chars().filter(|letter| !is_thousands(*letter)).collect();
    Some(fraction.map_or_else(|| whole.clone(), |fraction| format!("{whole}.{fraction}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_many_countries_are_read() {
        let cases = [
            ("1.5", 1.5),
            ("-1,5", -1.5),
            ("1,234.5", 1234.5),
            ("1.234,5", 1234.5),
            ("1.234.567,5", 1_234_567.5),
            ("1,234,567", 1_234_567.0),
            ("1 234,5", 1234.5),
            ("1\u{202f}234,5", 1234.5),
            ("1'234.5", 1234.5),
            ("-1.5e-3", -1.5e-3),
            ("1,5E-3", 1.5e-3),
            (".5", 0.5),
            ("12.5°", 12.5),
            ("+7", 7.0),
            ("57.3 deg", 57.3),
            ("57°15'", 57.25),
            ("-0° 30.6′", -0.51),
            ("1°30'36\"", 1.51),
            ("1°30'36", 1.51),
            ("1°60'", 2.0),
            ("120ms", 120.0),
            ("-1,5 Grad", -1.5),
            ("\u{2212}1.5e\u{2212}2", -0.015),
        ];
        for (text, number) in cases {
            assert_eq!(Numerals::new().read(text), Cell::Number(number), "{text}");
        }
    }

    #[test]
    fn what_is_read_at_once_is_what_all_else_makes_of_it() {
        for decimal in [Decimal::Unknown, Decimal::Point, Decimal::Comma] {
            for text in [
                "1.5", "-1.250", " 12.345 ", "1.5e3", "-1.5E-3", ".5", "5.", "+.125", "1.0e999", ".", "-.", "1.2.3",
                "12", "-",
            ] {
                let known = Numerals { decimal, ..Numerals::new() };
                let (mut at_once, mut by_all) = (known.clone(), known);
                assert_eq!(at_once.read(text), by_all.read_any(text), "{text}");
                assert_eq!(format!("{at_once:?}"), format!("{by_all:?}"), "{text}");
            }
        }
    }

    #[test]
    fn the_unit_of_minutes_is_that_of_degrees() {
        assert_eq!(number_and_unit("57°17'"), Some(("57°17'", "°")));
        assert_eq!(number_and_unit("57°x'"), None);
    }

    #[test]
    fn what_is_no_number_is_told_from_what_is_missing() {
        for text in ["", " ", "NaN", "-nan", "NA", "#N/A", "null", "-"] {
            assert_eq!(Numerals::new().read(text), Cell::Missing, "{text}");
        }
        for text in ["57°75'", "1°2'x", "°5'", "oops", "1.2.3,4,5", "1,23.5", "12:00", "1.5 apples", "deg", "1 2"] {
            assert_eq!(Numerals::new().read(text), Cell::Text, "{text}");
        }
        assert_eq!(Numerals::new().read("1e999"), Cell::Number(f64::INFINITY));
    }

    #[test]
    fn marks_that_come_too_late_to_be_understood_are_a_contradiction() {
        let last = |cells: &[&str]| {
            let mut numerals = Numerals::new();
            cells.iter().map(|cell| numerals.read(cell)).last().unwrap()
        };
        assert_eq!(last(&["1,234.5", "1,234"]), Cell::Number(1234.0));
        assert_eq!(last(&["0,5", "1.234,5", "1.234"]), Cell::Number(1234.0));
        assert_eq!(last(&["999.5", "1,000.5"]), Cell::Number(1000.5));
        assert_eq!(last(&["1,234", "1,000.5"]), Cell::Contradiction);
        assert_eq!(last(&["0.123", "1.000,5"]), Cell::Contradiction);
        assert_eq!(last(&["1,234.5", "1.234,5"]), Cell::Contradiction);
    }
}
