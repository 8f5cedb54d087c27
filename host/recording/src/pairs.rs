//! Cells that hold a pair: `"(1392, 685)",0.033`, as a program writes a point that it keeps in one column.
//!
//! Each becomes two cells, and the name above them two names.

use super::cell::is_missing;
use super::row::{Separator, split};

/// Columns of pairs.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Pairs {
    separator: Separator,
    columns: Vec<usize>,
}

impl Pairs {
    /// The columns in which most of the first lines have a pair.
    pub(super) fn of(lines: &[&str]) -> Option<Self> {
        let found = |separator: Separator| {
            let cells: Vec<Vec<&str>> = lines.iter().map(|line| split(line, separator)).collect();
            let n_columns = cells.iter().map(Vec::len).max()?;
            let has =
                |column: usize| cells.iter().filter(|cells| cells.get(column).is_some_and(|c| is_pair(c))).count();
            let columns: Vec<usize> = (0..n_columns).filter(|column| 2 * has(*column) > lines.len()).collect();
            // A row that is nothing but a pair is one in brackets.
            (n_columns > 1 && !columns.is_empty()).then_some(Self { separator, columns })
        };
        [Separator::Comma, Separator::Semicolon, Separator::Tab].into_iter().find_map(found)
    }

    /// The line with a cell for each number.
    pub(super) fn apart(&self, line: &str) -> String {
        let mut apart = Vec::new();
        for (column, cell) in split(line, self.separator).into_iter().enumerate() {
            match (self.columns.contains(&column), of_pair(cell)) {
                (false, _) => apart.push(cell.to_owned()),
                (true, Some((x, y))) => apart.extend([x.to_owned(), y.to_owned()]),
                (true, None) if is_missing(cell) => apart.extend([cell.to_owned(), cell.to_owned()]),
                (true, None) => apart.extend([format!("{cell} x"), format!("{cell} y")]),
            }
        }
        apart.join("\t")
    }
}

fn is_pair(cell: &str) -> bool {
    of_pair(cell).is_some()
}

/// `(1392, 685)` and `[1392. 685.]`.
fn of_pair(cell: &str) -> Option<(&str, &str)> {
    let inside = |open, close| cell.trim().strip_prefix(open)?.strip_suffix(close);
    let inside = inside('(', ')').or_else(|| inside('[', ']'))?.trim();
    let (x, y) = inside.split_once(',').or_else(|| inside.split_once(char::is_whitespace))?;
    let is_number = |text: &str| text.parse::<f64>().is_ok();
    let (x, y) = (x.trim(), y.trim());
    (is_number(x) && is_number(y)).then_some((x, y))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(lines: &[&str], expected: Option<&[&str]>) {
        let pairs = Pairs::of(lines);
        let found = pairs.map(|pairs| lines.iter().map(|line| pairs.apart(line)).collect::<Vec<_>>());
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
}
