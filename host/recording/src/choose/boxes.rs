//! Boxes that a detector draws around what it finds, by two corners and the middle between them.

use super::super::cell::{Cell, Numerals};
use super::super::limits::MIN_SAMPLES;
use super::super::table::Table;
use super::super::words::{Meaning, meaning};
use super::names::listed;

/// The middle may be off by this share of the box, as where a small box has whole pixels. With half of it one of ten pixels
/// would be missed; twice of it is still far from a corner, which is off by half of the box.
const OFF_MIDDLE: f64 = 0.05;

/// The middles of boxes, and the columns of their corners.
pub(super) struct Boxes {
    pub(super) x: usize,
    pub(super) y: usize,
    corners: Vec<usize>,
}

impl Boxes {
    /// Three columns of x and three of y, of which in each row one lies in the middle of the others.
    pub(super) fn of(table: &Table) -> Option<Self> {
        let (x, sides) = middle(table, Meaning::X)?;
        let (y, ends) = middle(table, Meaning::Y)?;
        Some(Self { x, y, corners: [sides, ends].concat() })
    }

    /// Says which columns were taken.
    pub(super) fn note(&self, table: &Table) -> String {
        let (taken, corners) = (listed(table, &[self.x, self.y]), listed(table, &self.corners));
        format!("{taken} taken as the point: in each row they are the middle of the box of {corners}")
    }
}

/// The column in the middle, and the two others.
fn middle(table: &Table, wanted: Meaning) -> Option<(usize, [usize; 2])> {
    let names = table.names.as_deref()?;
    let all: Vec<usize> = (0..names.len()).filter(|idx| meaning(&names[*idx]) == wanted).collect();
    let [a, b, c] = all[..] else { return None };
    [(a, [b, c]), (b, [a, c]), (c, [a, b])].into_iter().find(|(middle, ends)| lies_between(table, *middle, *ends))
}

fn lies_between(table: &Table, middle: usize, ends: [usize; 2]) -> bool {
    let [middle, low, high] = [middle, ends[0], ends[1]].map(|idx| numbers(table, idx));
    let whole =
        |((low, high), middle): ((&Option<f64>, &Option<f64>), &Option<f64>)| Some(((*low)?, (*high)?, (*middle)?));
    let rows: Vec<(f64, f64, f64)> = low.iter().zip(&high).zip(&middle).filter_map(whole).collect();
    let is_between =
        |(low, high, middle): &(f64, f64, f64)| (middle - (low + high) / 2.0).abs() < OFF_MIDDLE * (high - low).abs();
    rows.len() >= MIN_SAMPLES && rows.iter().all(is_between)
}

/// Those of the first rows, of which some may have none.
fn numbers(table: &Table, idx: usize) -> Vec<Option<f64>> {
    let mut numerals: Numerals = table.numerals.clone();
    let mut number = |cell: &str| match numerals.read(cell) {
        Cell::Number(number) => Some(number),
        _ => None,
    };
    table.first_cells(idx).map(&mut number).collect()
}
