//! The layout of a table: where its rows begin, what parts their cells, and what the columns are called.

use super::Line;
use crate::cell::{Cell, Numerals};
use crate::error::Fault;
use crate::monitor::Dress;
use crate::preamble::{self, Preamble};
use crate::row::{Separator, Typical, find_separator, is_comment, looks_like_number, split};
use crate::{header, heading};

/// A table has fewer columns; in a file of more lines they would be something else.
const MOST_COLUMNS: usize = 1000;

pub(super) struct Layout {
    pub(super) separator: Separator,
    pub(super) first_row_idx: usize,
    pub(super) n_columns: usize,
    pub(super) names: Option<Vec<String>>,
    pub(super) numerals: Numerals,
    /// The line of the names, where a row is stuck to them.
    pub(super) glued_line: Option<usize>,
    /// Settings in numbers above the rows.
    pub(super) settings: Option<Preamble>,
}

impl Layout {
    /// From the first lines of a file.
    pub(super) fn of(held: &[Line], dress: &Dress) -> Result<Self, Fault> {
        let texts: Vec<&str> = held.iter().map(|line| line.text.as_str()).collect();
        let separator = find_separator(&texts);
        let typical = Typical::of(&texts, separator);
        let is_row = |line: &&str| !is_comment(line) && typical.is_row(line, separator);
        let (first_row_idx, settings) = first_row(&texts, separator, is_row)?;
        let n_columns = split(texts[first_row_idx], separator).len();
        if n_columns > MOST_COLUMNS {
            return Err(Fault::TooWide { line: held[first_row_idx].number, n_columns });
        }
        let above_idx = settings.as_ref().map_or(0, |settings| settings.end_idx);
        let above = texts[above_idx..first_row_idx].iter().copied().filter(|line| !header::says_rate(line));
        let above: Vec<&str> = above.collect();
        if separator == Separator::Comma && names_fit_pairs(above.last(), n_columns) {
            return Err(Fault::BareCommas);
        }
        let ends_empty =
            || texts[first_row_idx..].iter().filter(|line| is_row(line)).all(|row| ends_empty(row, separator));
        let names = dress
            .names()
            .or_else(|| heading::names(&above, separator, n_columns))
            .or_else(|| ends_empty().then(|| heading::names(&above, separator, n_columns - 1)).flatten())
            .or_else(|| {
                let names = heading::of_fewer(&above, separator, n_columns)?;
                let rows = texts[first_row_idx..].iter().copied().filter(|line| is_row(line));
                Some(of_their_columns(names, rows, separator, n_columns))
            });
        let is_glued = |idx: &usize| has_glued_row(texts[*idx], separator, n_columns);
        Ok(Self {
            separator,
            first_row_idx,
            n_columns,
            names,
            numerals: learnt(&texts[first_row_idx..], separator),
            glued_line: first_row_idx.checked_sub(1).filter(is_glued).map(|idx| held[idx].number),
            settings,
        })
    }
}

/// Where the first row stands: behind settings in numbers, where there are some.
fn first_row(
    texts: &[&str],
    separator: Separator,
    is_row: impl Fn(&&str) -> bool,
) -> Result<(usize, Option<Preamble>), Fault> {
    let first_from = |from: usize| {
        let found = texts[from..].iter().position(&is_row);
        found.map(|idx| from + idx).ok_or(Fault::NoNumbers { n_lines: texts.len() })
    };
    let first = first_from(0)?;
    match preamble::find(texts, first, separator) {
        Some(settings) => Ok((first_from(first.max(settings.end_idx))?, Some(settings))),
        None => Ok((first, None)),
    }
}

/// Fewer names than columns: R writes none above the numbers of the rows, others forget the last ones.
fn of_their_columns<'a>(
    names: Vec<String>,
    rows: impl Iterator<Item = &'a str>,
    separator: Separator,
    n_columns: usize,
) -> Vec<String> {
    let mut numerals = Numerals::new();
    let mut number = |row: &Vec<&str>, idx: usize| match row.get(idx).map(|cell| numerals.read(cell)) {
        Some(Cell::Number(number)) => Some(number),
        _ => None,
    };
    let first: Vec<_> = rows.map(|row| split(row, separator)).map(|row| [number(&row, 0), number(&row, 1)]).collect();
    let steps = |idx: usize| {
        first.windows(2).map(move |pair| pair[0][idx].zip(pair[1][idx]).map(|(before, here)| here - before))
    };
    let are_rows = names.len() + 1 == n_columns
        && steps(0).all(|step| step == Some(1.0))
        && steps(1).all(|step| step.is_some_and(|step| step > 0.0));
    let n_before = usize::from(are_rows);
    let mut all = vec![String::new(); n_before];
    all.extend(names);
    all.resize(n_columns, String::new());
    all
}

/// A separator behind the last cell.
fn ends_empty(row: &str, separator: Separator) -> bool {
    let fields = split(row, separator);
    fields.len() > 1 && fields.last().is_some_and(|last| last.is_empty())
}

/// Names, and behind the last of them the numbers of a row: `t theta0.0 0.12`.
fn has_glued_row(line: &str, separator: Separator, n_columns: usize) -> bool {
    let fields = split(line, separator);
    let is_number = |field: &&str| looks_like_number(field, separator);
    let ends_in_number =
        |name: &str| name.contains(char::is_alphabetic) && name.ends_with(|end: char| end.is_ascii_digit());
    n_columns > 1
        && fields.len() + 1 == 2 * n_columns
        && !fields[..n_columns].iter().any(is_number)
        && fields[n_columns..].iter().all(is_number)
        && ends_in_number(fields[n_columns - 1])
}

/// Half as many names as fields: commas that are decimal marks as well as separators.
fn names_fit_pairs(line: Option<&&str>, n_columns: usize) -> bool {
    let names = line.map_or(0, |line| split(line, Separator::Comma).len());
    names >= 2 && n_columns == 2 * names
}

/// The marks of the numbers in the first rows.
fn learnt(texts: &[&str], separator: Separator) -> Numerals {
    let mut numerals = Numerals::new();
    let cells = texts.iter().filter(|line| !is_comment(line)).flat_map(|line| split(line, separator));
    for cell in cells {
        numerals.read(cell);
    }
    numerals.without_doubts()
}
