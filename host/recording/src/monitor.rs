//! Lines of serial monitors and plotters: clock times before an arrow, labels before the numbers, brackets around a row.
//!
//! `12:34:05.120 -> 120,57.3`, `[12:34:05.120] 57.3`, `[1055ms] angle=57.3`, `I (1055) main: angle=57.3`,
//! `2026-03-01 12:34:05,120 - rig - INFO - 57.3`, `t:120 angle:57.3`, `Time: 120 ms, Angle: 57.3 deg`, `(0.12, 57.3)`, `log=[0.12, 57.3]`.
//! Tables of Markdown, `| 0.12 | 57.3 |`, are parted by bars.
//! Each line becomes the row that somebody could have printed without them; the labels become the names of the columns.

use super::cell::{Cell, Numerals, number_and_unit};
use super::clock;
use super::groups::Groups;
use super::row::{Separator, find_separator, split};
use super::units::time_unit;
use super::words::{Meaning, is_unit, meaning};
use std::ops::Range;

/// A label before a number is shorter.
const MOST_LETTERS: usize = 40;

/// What the rows of a file are dressed in.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Dress {
    /// Each row begins with the clock time at which a monitor showed it.
    arrow: Option<Arrow>,
    /// What parts the numbers behind such a time, where they are several.
    behind: Option<Separator>,
    /// A word with which each row begins, which gives its place to the clock time where that is kept.
    word: Option<String>,
    /// Names that stand before the numbers, with a unit behind the number if there is one.
    pub(super) labels: Option<Vec<String>>,
    /// Some cells hold several numbers.
    groups: Option<Groups>,
    /// What stands before the brackets around each row: `log=` of `log=[0.12, 57.3]`.
    before_brackets: Option<String>,
    /// Bars part the cells.
    has_bars: bool,
}

/// What becomes of the clock times before an arrow.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Arrow {
    /// The rows have a time of their own, which is the better one.
    Drop,
    /// It is the only time that there is.
    Keep,
}

impl Dress {
    /// What most of the first lines wear.
    pub(super) fn of(lines: &[&str]) -> Self {
        let behind: Vec<(&str, &str)> = lines.iter().filter_map(|line| behind_arrow(line)).collect();
        // A program that writes the time itself needs no other one.
        let is_stamped = lines.iter().any(|line| behind_stamp(line).is_some());
        let is_clock = !is_stamped && behind.iter().any(|(time, _)| clock::read(time).is_some());
        let behind: Vec<&str> = behind.into_iter().map(|(_, rest)| rest).collect();
        let has_arrow = 2 * behind.len() > lines.len();
        let bare = if has_arrow { &behind } else { lines };
        let labels = common_labels(bare);
        let word = common_word(&behind).filter(|_| has_arrow && labels.is_none());
        let arrow = has_arrow.then(|| {
            let has_time = match &labels {
                Some(labels) => labels.iter().any(|label| matches!(meaning(label), Meaning::Time { .. })),
                None if word.is_some() => has_rising_column(&behind),
                // A program that prints how long it runs prints no other time.
                None => {
                    is_clock && 2 * behind.iter().filter(|rest| n_words_with_digits(rest) > 1).count() > behind.len()
                }
            };
            if has_time { Arrow::Drop } else { Arrow::Keep }
        });
        let before_brackets = common_before_brackets(lines).filter(|_| !has_arrow && labels.is_none());
        let groups = Groups::of(lines).filter(|_| !has_arrow && before_brackets.is_none());
        let n_bars = lines.iter().filter(|line| between_bars(line).is_some()).count();
        let has_bars = !has_arrow && labels.is_none() && 2 * n_bars > lines.len();
        let is_kept = arrow == Some(Arrow::Keep) && labels.is_none();
        let behind = is_kept.then(|| several(&behind)).flatten();
        let word = word.filter(|_| is_kept);
        Self { arrow, behind, word, labels, groups, before_brackets, has_bars }
    }

    /// The row in plain text; lines in another dress stay as they are.
    pub(super) fn undress(&self, line: &str) -> Option<String> {
        if self.has_bars {
            return between_bars(line);
        }
        if let Some(groups) = &self.groups {
            return Some(groups.apart(line));
        }
        if let Some(before) = &self.before_brackets {
            return between_brackets(line.trim_start().strip_prefix(before)?).map(str::to_owned);
        }
        let (time, rest) = match self.arrow {
            Some(_) => behind_arrow(line).map_or((None, line), |(time, rest)| (Some(time), rest)),
            None => (None, line),
        };
        let time = time.filter(|_| self.arrow == Some(Arrow::Keep));
        let rest = match &self.word {
            Some(word) => behind_word(rest, word).unwrap_or(rest),
            None => rest,
        };
        let row = match &self.labels {
            Some(labels) => pairs(rest).filter(|pairs| names_of(pairs) == *labels).map(|pairs| in_one_row(&pairs)),
            None => between_brackets(rest).map(str::to_owned),
        };
        match (row, time) {
            (row, Some(time)) => Some(format!("{time}\t{}", self.in_cells(row.as_deref().unwrap_or(rest)))),
            (None, None) if rest.len() != line.len() => Some(rest.to_owned()),
            (row, None) => row,
        }
    }

    fn in_cells(&self, row: &str) -> String {
        self.behind.map_or_else(|| row.to_owned(), |separator| split(row, separator).join("\t"))
    }

    /// The columns that held three numbers and more in brackets.
    pub(super) fn vectors(&self) -> Vec<Range<usize>> {
        self.groups.as_ref().map_or(Vec::new(), Groups::vectors)
    }

    /// The names of the columns, where they stand before the numbers.
    pub(super) fn names(&self) -> Option<Vec<String>> {
        let clock = (self.arrow == Some(Arrow::Keep)).then(|| "clock".to_owned());
        Some(clock.into_iter().chain(self.labels.clone()?).collect())
    }
}

/// The time before ` -> ` or in brackets, of a clock or since the program began, and what stands behind.
fn behind_arrow(line: &str) -> Option<(&str, &str)> {
    let in_brackets = || line.trim_start().strip_prefix('[')?.split_once(']');
    let found = line.split_once("->").or_else(in_brackets).map(|(time, rest)| (time.trim(), rest.trim()));
    let is_time = |(time, _): &(&str, &str)| clock::read(time).is_some() || is_span(time);
    found.filter(is_time).or_else(|| behind_level(line)).or_else(|| behind_stamp(line))
}

/// The date and time that Python's logging writes, `2026-03-01 12:00:00,005`, with a comma that parts nothing, and what stands
/// behind it and the name and level of the logger.
fn behind_stamp(line: &str) -> Option<(&str, &str)> {
    let line = line.trim_start();
    let end = line.match_indices(' ').nth(1).map_or(line.len(), |(end, _)| end);
    let (stamp, rest) = line.split_at_checked(end)?;
    let (second, _) = stamp.split_once(',').filter(|(_, thousandths)| thousandths.len() == 3)?;
    let is_stamp = second.contains(' ') && clock::read(stamp).is_some_and(|moment| moment.day.is_some());
    let is_parted_otherwise = rest.trim_start().starts_with([';', ',']);
    (is_stamp && !is_parted_otherwise).then(|| (stamp, rest.rsplit(" - ").next().unwrap_or(rest).trim()))
}

/// `1055ms`, `1.055 s`.
fn is_span(text: &str) -> bool {
    let is_one = |(number, unit): (&str, &str)| number.parse::<f64>().is_ok() && time_unit(unit).is_some();
    number_and_unit(text).is_some_and(is_one)
}

/// Of a line of a chip's log, `I (1055) main: angle=57.3`, the milliseconds since it began and the words.
fn behind_level(line: &str) -> Option<(&str, &str)> {
    let (time, rest) =
        line.trim_start().strip_prefix(['E', 'W', 'I', 'D', 'V'])?.strip_prefix(" (")?.split_once(") ")?;
    let (_, words) = rest.split_once(": ")?;
    time.parse::<u64>().ok().map(|_| (time, words.trim()))
}

/// What parts several numbers; of a lone one the comma is a decimal mark.
fn several(lines: &[&str]) -> Option<Separator> {
    let separator = find_separator(lines);
    let is_several = |line: &&str| split(line, separator).len() > 1;
    let is_lone = separator == Separator::Comma && !lines.iter().any(|line| line.contains(['.', ' ']));
    (!is_lone && lines.iter().any(is_several)).then_some(separator)
}

/// The word with which all of these lines begin that have numbers behind it: `ypr\t-0.14\t92.00`.
fn common_word<'a>(lines: &[&'a str]) -> Option<String> {
    let first_word = |line: &&'a str| Some(line.split_at_checked(line.find(is_parting)?)?.0);
    let mut all: Vec<&str> = lines.iter().filter_map(first_word).filter(|word| is_word(word)).collect();
    all.sort_unstable();
    let most = all.chunk_by(|a, b| a == b).max_by_key(|run| run.len())?;
    (2 * most.len() > lines.len()).then(|| most[0].to_owned())
}

fn is_parting(letter: char) -> bool {
    letter.is_whitespace() || matches!(letter, ',' | ';')
}

fn is_word(text: &str) -> bool {
    text.starts_with(|letter: char| letter.is_alphabetic() || letter == '$') && Numerals::new().read(text) == Cell::Text
}

/// What stands behind the word and what parts it from the numbers.
fn behind_word<'a>(line: &'a str, word: &str) -> Option<&'a str> {
    let rest = line.strip_prefix(word)?.trim_start();
    Some(rest.strip_prefix([',', ';']).unwrap_or(rest).trim_start())
}

/// Does one of the numbers rise from each line to the next, as a time does?
fn has_rising_column(lines: &[&str]) -> bool {
    let separator = find_separator(lines);
    let mut numerals = Numerals::new();
    let mut number = |cell: &str| match numerals.read(cell) {
        Cell::Number(number) => number,
        _ => f64::NAN,
    };
    let mut cells_of = |line: &&str| split(line, separator).into_iter().map(&mut number).collect::<Vec<f64>>();
    let rows: Vec<Vec<f64>> = lines.iter().map(&mut cells_of).collect();
    let rises = |idx: usize| rows.windows(2).all(|pair| pair[1].get(idx) > pair[0].get(idx));
    let n_columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    rows.len() > 1 && (0..n_columns).any(rises)
}

fn n_words_with_digits(text: &str) -> usize {
    let words = text.split(|letter: char| letter.is_whitespace() || matches!(letter, ',' | ';'));
    words.filter(|word| word.bytes().any(|byte| byte.is_ascii_digit())).count()
}

/// The cells between bars; nothing of the line that parts the names from the rows.
fn between_bars(line: &str) -> Option<String> {
    let line = line.trim();
    let inside = line.strip_prefix('|').unwrap_or(line);
    let inside = inside.strip_suffix('|').unwrap_or(inside);
    let cells: Vec<&str> = inside.split('|').map(str::trim).collect();
    let is_rule = cells.iter().all(|cell| cell.contains('-') && cell.trim_matches(['-', ':']).is_empty());
    (cells.len() > 1).then(|| if is_rule { String::new() } else { cells.join("\t") })
}

/// `(0.1, 0.2)` and `[0.1, 0.2]`, as a program prints several values at once; `(ms),(V)` are two pairs, and `(m),` is a unit beside
/// an empty cell.
fn between_brackets(line: &str) -> Option<&str> {
    let line = line.trim();
    let line = line.strip_suffix(',').unwrap_or(line);
    let inside = |open, close| line.strip_prefix(open)?.strip_suffix(close).filter(|row| !row.contains([open, close]));
    let has_values = |row: &&str| row.contains(',') || row.bytes().any(|byte| byte.is_ascii_digit());
    inside('(', ')').or_else(|| inside('[', ']')).filter(has_values)
}

/// What stands before the brackets in more than half of the lines, if these hold several numbers.
fn common_before_brackets(lines: &[&str]) -> Option<String> {
    let before = |line: &&'_ str| {
        let line = line.trim();
        let (before, _) = line.split_at_checked(line.find(['(', '['])?)?;
        let is_label =
            before.starts_with(char::is_alphabetic) && before.len() < MOST_LETTERS && !before.contains([',', ';']);
        let row = between_brackets(&line[before.len()..]).filter(|_| is_label)?;
        let cells: Vec<&str> = row.split([',', ';', ' ', '\t']).filter(|cell| !cell.is_empty()).collect();
        let are_numbers = cells.len() > 1 && cells.iter().all(|cell| cell.parse::<f64>().is_ok());
        are_numbers.then(|| before.to_owned())
    };
    let mut all: Vec<String> = lines.iter().filter_map(before).collect();
    all.sort_unstable();
    let most = all.chunk_by(|a, b| a == b).max_by_key(|run| run.len())?;
    (2 * most.len() > lines.len()).then(|| most[0].clone())
}

/// A label, its number, and the unit behind it.
struct Pair<'a> {
    label: &'a str,
    number: &'a str,
    unit: &'a str,
}

/// The labels that more than half of the lines have.
fn common_labels(lines: &[&str]) -> Option<Vec<String>> {
    let mut all: Vec<Vec<String>> = lines.iter().filter_map(|line| Some(names_of(&pairs(line)?))).collect();
    all.sort();
    let most = all.chunk_by(|a, b| a == b).max_by_key(|run| run.len())?;
    (2 * most.len() > lines.len()).then(|| most[0].clone())
}

fn names_of(pairs: &[Pair]) -> Vec<String> {
    pairs.iter().map(|pair| format!("{} {}", pair.label, pair.unit).trim().to_owned()).collect()
}

fn in_one_row(pairs: &[Pair]) -> String {
    pairs.iter().map(|pair| pair.number).collect::<Vec<_>>().join("\t")
}

/// The whole line as labels and numbers in turn; `None` where it is anything else.
fn pairs(line: &str) -> Option<Vec<Pair<'_>>> {
    let mut rest = line.trim();
    let mut pairs = Vec::new();
    while !rest.is_empty() {
        let (label, behind) = rest.split_once([':', '='])?;
        let label = label.trim();
        let is_name = label.starts_with(char::is_alphabetic)
            && label.len() < MOST_LETTERS
            && !label.contains([',', ';', '"', '{']);
        let behind = behind.trim_start();
        let end = behind.find(|letter: char| !matches!(letter, '0'..='9' | '+' | '-' | '.' | 'e' | 'E'));
        let (number, behind) = behind.split_at(end.unwrap_or(behind.len()));
        if !is_name || number.parse::<f64>().is_err() {
            return None;
        }
        let (unit, behind) = unit_before(behind);
        pairs.push(Pair { label, number, unit });
        rest = behind.trim_start_matches(|letter: char| letter.is_whitespace() || matches!(letter, ',' | ';' | '|'));
    }
    (!pairs.is_empty()).then_some(pairs)
}

/// The unit at the beginning, if there is one, and what follows it.
fn unit_before(text: &str) -> (&str, &str) {
    let bare = text.trim_start();
    let end =
        bare.find(|letter: char| letter.is_whitespace() || matches!(letter, ',' | ';' | '|')).unwrap_or(bare.len());
    let (word, rest) = bare.split_at(end);
    if !word.is_empty() && is_unit(word) { (word, rest) } else { ("", text) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(lines: &[&str], names: Option<&[&str]>, rows: &[Option<&str>]) {
        let dress = Dress::of(lines);
        let found = dress.names();
        assert_eq!(
            found.as_deref(),
            names.map(|names| names.iter().map(|n| (*n).to_owned()).collect::<Vec<_>>()).as_deref()
        );
        let found: Vec<Option<String>> = lines.iter().map(|line| dress.undress(line)).collect();
        let rows: Vec<Option<String>> = rows.iter().map(|row| row.map(str::to_owned)).collect();
        assert_eq!(found, rows, "{lines:?}");
    }

    #[test]
    fn labels_before_numbers_become_names() {
        check(&["t:0 angle:57.3", "t:10\tangle:-5e-1"], Some(&["t", "angle"]), &[Some("0\t57.3"), Some("10\t-5e-1")]);
        check(
            &["ready", "Time: 0 ms, Angle = 1.5 deg", "Time: 10 ms, Angle = 1.4 deg", "Time: 20 ms, Angle = 1.2 deg"],
            Some(&["Time ms", "Angle deg"]),
            &[None, Some("0\t1.5"), Some("10\t1.4"), Some("20\t1.2")],
        );
    }

    #[test]
    fn the_clock_of_a_monitor_is_taken_only_where_there_is_no_other_time() {
        check(&["12:34:05.120 -> 120,57.3", "12:34:05.130 -> 130,57.2"], None, &[Some("120,57.3"), Some("130,57.2")]);
        check(
            &["12:34:05.120 -> 57.3", "12:34:05.130 -> 57.2"],
            None,
            &[Some("12:34:05.120\t57.3"), Some("12:34:05.130\t57.2")],
        );
        check(
            &["[2026-03-01 12:34:05.120] 57.3", "[2026-03-01 12:34:05.130] 57.2"],
            None,
            &[Some("2026-03-01 12:34:05.120\t57.3"), Some("2026-03-01 12:34:05.130\t57.2")],
        );
        check(&["(ms),(V)", "0.1,1.5"], None, &[None, None]);
        check(&["12:34:05.120 -> angle:7"], Some(&["clock", "angle"]), &[Some("12:34:05.120\t7")]);
        let two = ["12:34:05.120 -> angle=57.3 deg, raw=652"];
        check(&two, Some(&["clock", "angle deg", "raw"]), &[Some("12:34:05.120\t57.3\t652")]);
        let spans = ["[1055ms] enc=512 vel=-3", "[1065 ms] enc=510 vel=-4"];
        let rows = [Some("1055ms\t512\t-3"), Some("1065 ms\t510\t-4")];
        check(&spans, Some(&["clock", "enc", "vel"]), &rows);
        check(&["[0.105s] 57.3, 2", "[0.110s] 57.2, 2"], None, &[Some("0.105s\t57.3\t2"), Some("0.110s\t57.2\t2")]);
        check(&["[0.105s] 57,3", "[0.110s] 57,2"], None, &[Some("0.105s\t57,3"), Some("0.110s\t57,2")]);
        check(&["I (1055) main: angle=57.3 deg"], Some(&["clock", "angle deg"]), &[Some("1055\t57.3")]);
        check(&["[57.3 deg] 12", "I (me) main: 5"], None, &[None, None]);
        check(&["12:34:05.120 -> t=120, angle=57.3"], Some(&["t", "angle"]), &[Some("120\t57.3")]);
        let stamps = ["2026-03-01 12:34:05,120 -57.3, -0.5", "2026-03-01 12:34:05,130 -57.2, 0.25"];
        let rows = [Some("2026-03-01 12:34:05,120\t-57.3\t-0.5"), Some("2026-03-01 12:34:05,130\t-57.2\t0.25")];
        check(&stamps, None, &rows);
        let levels = ["2026-03-01 12:34:05,120 - rig - INFO - -57.3", "2026-03-01 12:34:05,130 - rig - INFO - 1.5"];
        let rows = [Some("2026-03-01 12:34:05,120\t-57.3"), Some("2026-03-01 12:34:05,130\t1.5")];
        check(&levels, None, &rows);
        check(&["2026-03-01 12:34:05,120,57.3", "01.03.2026 12:34:05,130 ; 5"], None, &[None, None]);
    }

    #[test]
    fn the_clock_of_a_monitor_stands_in_the_place_of_a_word_before_each_row() {
        let lines = ["12:34:05.120 -> ypr\t-0.1\t57.3", "12:34:05.130 -> ypr\t-0.1\t57.2"];
        check(&lines, None, &[Some("12:34:05.120\t-0.1\t57.3"), Some("12:34:05.130\t-0.1\t57.2")]);
        // A time of its own is the better one.
        let timed = ["12:34:05.120 -> imu, 120, 57.3", "12:34:05.130 -> imu, 130, 57.2"];
        check(&timed, None, &[Some("imu, 120, 57.3"), Some("imu, 130, 57.2")]);
        check(&["ypr\t-0.1\t57.3", "ypr\t-0.1\t57.2"], None, &[None, None]);
    }

    #[test]
    fn bars_of_a_markdown_table_part_its_cells() {
        let lines = ["| t (s) | theta |", "|:---|---:|", "| 0.0 | -1.5 |", "0.1 | 1.4", "words"];
        check(&lines, None, &[Some("t (s)\ttheta"), Some(""), Some("0.0\t-1.5"), Some("0.1\t1.4"), None]);
        check(&["t=1|angle=2"], Some(&["t", "angle"]), &[Some("1\t2")]);
    }

    #[test]
    fn brackets_around_a_row_fall_off_and_plain_rows_stay() {
        check(&["(0.0, 1.5)", "[0.1, 1.4],"], None, &[Some("0.0, 1.5"), Some("0.1, 1.4")]);
        check(&["0.0,1.5", "Time (s),Angle", "12:00:01,3", "a: b"], None, &[None, None, None, None]);
        let lines = ["# started", "log=[t,phi]", "log=[0.0,1.5]", "log=[0.1,1.4]", "log=[0.2,-1]", "log=[0.3,0.5]"];
        check(&lines, None, &[None, Some("t,phi"), Some("0.0,1.5"), Some("0.1,1.4"), Some("0.2,-1"), Some("0.3,0.5")]);
        check(&["Read (0.0, 1.5)", "Read (0.1, 1.4)"], None, &[Some("0.0, 1.5"), Some("0.1, 1.4")]);
        check(&["Angle (3)", "Angle (4)"], None, &[None, None]);
    }
}
