//! A row of the table while its cells are read.

use crate::cell::{Cell, Numerals};
use crate::error::Fault;
use crate::table::Table;

/// A row of the table while its cells are read.
pub(super) struct Row<'a> {
    pub(super) table: &'a Table<'a>,
    pub(super) fields: Vec<&'a str>,
}

/// Why a row is no sample.
pub(super) enum Skipped {
    /// Nothing was measured.
    Gap { column: usize },
    /// What stands there is no number.
    Fault(Fault),
}

impl From<Fault> for Skipped {
    fn from(fault: Fault) -> Self {
        Self::Fault(fault)
    }
}

impl<'a> Row<'a> {
    pub(super) fn field(&self, idx: usize) -> Result<&'a str, Fault> {
        let (line, n_found) = (self.table.line(), self.fields.len());
        let short = || Fault::ShortRow { line, n_found, column: self.table.column_name(idx) };
        // Between spaces nobody can write an empty cell: a row of the time alone has no value.
        let is_alone = self.table.is_parted_by_spaces() && n_found == 1 && idx > 0;
        self.fields.get(idx).copied().or(is_alone.then_some("")).ok_or_else(short)
    }

    /// A finite number without which the row is no sample.
    pub(super) fn needed(&self, column: usize, numerals: &mut Numerals) -> Result<f64, Skipped> {
        self.number(column, numerals)?.ok_or(Skipped::Gap { column })
    }

    /// A finite number; `None` where nothing was measured.
    pub(super) fn number(&self, idx: usize, numerals: &mut Numerals) -> Result<Option<f64>, Fault> {
        let text = self.field(idx)?;
        match numerals.read(text) {
            Cell::Number(number) if number.is_finite() => Ok(Some(number)),
            Cell::Missing => Ok(None),
            Cell::Contradiction => {
                Err(Fault::ThousandsTooLate { line: self.table.line(), value: text.chars().take(40).collect() })
            }
            _ => Err(self.not_a_number(idx, text)),
        }
    }

    pub(super) fn not_a_number(&self, idx: usize, text: &str) -> Fault {
        Fault::NotANumber {
            place: format!("line {}", self.table.line()),
            column: self.table.column_name(idx),
            value: text.chars().take(40).collect(),
        }
    }
}

pub(super) fn as_code(line: usize, number: f64) -> Result<u16, Fault> {
    if number.fract() != 0.0 || !(0.0..=f64::from(u16::MAX)).contains(&number) {
        return Err(Fault::BadCode { line, value: number.to_string() });
    }
    Ok(number as u16)
}
