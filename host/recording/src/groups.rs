//! Cells that hold several numbers in brackets: `"(1392, 685)",0.033`, as a program writes a point that it keeps in one column,
//! and `[0.1, 0.2, 9.8]; [3, 4, 5]; 0.01`, as it prints what its sensors give.
//!
//! Each becomes as many cells, and the name above them as many names.

use super::cell::is_missing;
use super::row::{Separator, split};
use std::ops::Range;

/// More in one cell are a list, such as a whole recording: a matrix that turns a sensor has nine.
const MOST_IN_A_CELL: usize = 9;

/// What the cells of such a column are called behind its name, as far as that.
const NAMES: [&str; 3] = ["x", "y", "z"];

/// Columns of groups.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Groups {
    separator: Separator,
    /// How many numbers each column holds.
    n_in_columns: Vec<usize>,
}

impl Groups {
    /// The columns in which most of the first lines have as many numbers in brackets.
    pub(super) fn of(lines: &[&str]) -> Option<Self> {
        let found = |separator: Separator| {
            let cells: Vec<Vec<&str>> = lines.iter().map(|line| split_outside(line, separator)).collect();
            let n_columns = cells.iter().map(Vec::len).max()?;
            let sizes =
                |column: usize| cells.iter().filter_map(move |cells| group(cells.get(column)?)).map(|it| it.len());
            let n_in_columns: Vec<usize> = (0..n_columns).map(|column| common(sizes(column), lines.len())).collect();
            // A row that is nothing but a group is one in brackets.
            let has_more = |cells: &Vec<&str>| cells.iter().filter(|cell| !cell.is_empty()).count() > 1;
            (cells.iter().any(has_more) && n_in_columns.iter().any(|n| *n > 1))
                .then_some(Self { separator, n_in_columns })
        };
        [Separator::Comma, Separator::Semicolon, Separator::Tab, Separator::Space].into_iter().find_map(found)
    }

    /// The columns, each number for itself, that hold three numbers and more, as the axes of a sensor.
    pub(super) fn vectors(&self) -> Vec<Range<usize>> {
        let mut end = 0;
        let places = self.n_in_columns.iter().map(|n| {
            end += n;
            end - n..end
        });
        places.filter(|place| place.len() >= NAMES.len()).collect()
    }

    /// The line with a cell for each number.
    pub(super) fn apart(&self, line: &str) -> String {
        let cells = split_outside(line, self.separator);
        // Words parted by spaces are no names above the cells.
        if self.separator == Separator::Space && cells.len() != self.n_in_columns.len() {
            return line.to_owned();
        }
        let apart =
            |(column, cell): (usize, &str)| match (self.n_in_columns.get(column).copied().unwrap_or(1), group(cell)) {
                (1, _) => vec![cell.to_owned()],
                (n, Some(numbers)) if numbers.len() == n => numbers.iter().map(|number| (*number).to_owned()).collect(),
                (n, None) if is_missing(cell) => vec![cell.to_owned(); n],
                (n, _) => (0..n).map(|at| format!("{cell} {}", name(at))).collect(),
            };
        cells.into_iter().enumerate().flat_map(apart).collect::<Vec<_>>().join("\t")
    }
}

fn name(at: usize) -> String {
    NAMES.get(at).map_or_else(|| (at + 1).to_string(), |name| (*name).to_owned())
}

/// How many numbers more than half of the lines have there; 1 where they have no group.
fn common(sizes: impl Iterator<Item = usize>, n_lines: usize) -> usize {
    let mut sizes: Vec<usize> = sizes.collect();
    sizes.sort_unstable();
    let most = sizes.chunk_by(|a, b| a == b).max_by_key(|run| run.len());
    most.filter(|run| 2 * run.len() > n_lines).map_or(1, |run| run[0])
}

/// The cells of a line; what parts them parts nothing within brackets.
fn split_outside(line: &str, separator: Separator) -> Vec<&str> {
    if !line.contains(['(', '[']) {
        return split(line, separator);
    }
    let parts = |letter: char| match separator {
        Separator::Comma => letter == ',',
        Separator::Semicolon => letter == ';',
        Separator::Tab => letter == '\t',
        Separator::Space => letter.is_ascii_whitespace(),
    };
    let (mut depth, mut is_quoted) = (0_usize, false);
    let cells = line.trim_end().split(|letter: char| {
        match letter {
            '"' => is_quoted ^= true,
            '(' | '[' => depth += 1,
            ')' | ']' => depth = depth.saturating_sub(1),
            _ => {}
        }
        parts(letter) && depth == 0 && !is_quoted
    });
    let bare = cells.map(|cell| cell.trim().trim_matches('"').trim());
    bare.filter(|cell| separator != Separator::Space || !cell.is_empty()).collect()
}

/// The numbers of `(1392, 685)`, `[1392. 685.]` and `[0.1; 0.2; 9.8]`.
fn group(cell: &str) -> Option<Vec<&str>> {
    let inside = |open, close| cell.trim().strip_prefix(open)?.strip_suffix(close);
    let inside = inside('(', ')').or_else(|| inside('[', ']'))?.trim();
    let numbers: Vec<&str> = inside.split([',', ';', ' ', '\t']).filter(|number| !number.is_empty()).collect();
    let are_numbers = numbers.iter().all(|number| number.parse::<f64>().is_ok());
    (are_numbers && (2..=MOST_IN_A_CELL).contains(&numbers.len())).then_some(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(lines: &[&str], expected: Option<&[&str]>) {
        let groups = Groups::of(lines);
        let found = groups.map(|groups| lines.iter().map(|line| groups.apart(line)).collect::<Vec<_>>());
        let expected = expected.map(|lines| lines.iter().map(|line| (*line).to_owned()).collect::<Vec<_>>());
        assert_eq!(found, expected);
    }

    #[test]
    fn a_cell_with_a_pair_becomes_two() {
        check(
            &["position,time", "\"(13, 6)\",0.1", "\"(14, -7.5)\",0.2", ",0.3", "\"(15, 8)\",0.4"],
            Some(&["position x\tposition y\ttime", "13\t6\t0.1", "14\t-7.5\t0.2", "\t\t0.3", "15\t8\t0.4"]),
        );
        check(&["0.1;[1. 2.]", "0.2;[ 3  4 ]"], Some(&["0.1\t1.\t2.", "0.2\t3\t4"]));
        check(&["(0.1, 2)", "(0.2, 3)"], None);
        check(&["t,theta (rad)", "0.1,0.2", "0.2,0.3"], None);
    }

    #[test]
    fn what_parts_the_cells_parts_nothing_within_brackets() {
        let of_sensors = ["[0.1, -0.2, 9.8]; [3.5, 4, 5]; 0.01", "[0.1, -0.3, 9.7]; [3.0, 4, 6]; 0.02"];
        let apart: &[&str] = &["0.1\t-0.2\t9.8\t3.5\t4\t5\t0.01", "0.1\t-0.3\t9.7\t3.0\t4\t6\t0.02"];
        check(&of_sensors, Some(apart));
        check(&of_sensors.map(|line| line.replace(';', ",")).each_ref().map(String::as_str), Some(apart));
        check(&of_sensors.map(|line| line.replace(';', "")).each_ref().map(String::as_str), Some(apart));
        check(
            &["t,gyro", "0.1,\"[1, 2, 3]\"", "0.2,\"[4, 5, 6]\"", "0.3,", "0.4,\"[7, 8, 9]\""],
            Some(&["t\tgyro x\tgyro y\tgyro z", "0.1\t1\t2\t3", "0.2\t4\t5\t6", "0.3\t\t\t", "0.4\t7\t8\t9"]),
        );
        // A list in a cell is no sensor's.
        check(&["7,\"[1, 2, 3, 4, 5, 6, 7, 8, 9, 10]\"", "8,\"[1, 2, 3, 4, 5, 6, 7, 8, 9, 10]\""], None);
    }
}
