//! The rows of a table, one after the other: samples, gaps, and what is no row.

use super::row::{Row, Skipped, as_code};
use super::{MOST_COLUMNS, Samples};
use crate::cell::{Cell, Numerals, is_missing};
use crate::chosen::{Sources, TimeSource};
use crate::error::Fault;
use crate::limits::MOST_SAMPLES;
use crate::table::Table;
use crate::{Measured, clock, words};

/// Recordings of one length may end a row apart.
const FEWEST_APART: usize = 2;

/// A summary below a table has no more lines.
const MOST_BELOW: usize = 20;

impl Samples {
    /// Reads all rows, of however many runs; what is dropped is noted.
    pub(in super::super) fn collect(
        table: &mut Table,
        sources: &Sources,
        is_ours: bool,
        notes: &mut Vec<String>,
    ) -> Result<Self, Fault> {
        let mut rows = Rows::new(table, sources, is_ours);
        while table.advance()? {
            rows.take(table, notes)?;
        }
        rows.check_side_by_side(table)?;
        Ok(rows.finish(notes))
    }

    /// Reads one row as a whole or not at all.
    fn take(
        &mut self,
        table: &Table,
        sources: &Sources,
        columns: &[usize],
        numerals: &mut Numerals,
    ) -> Result<(), Skipped> {
        let row = Row { table, fields: table.fields() };
        let mut readings = [0.0; MOST_COLUMNS];
        for (reading, column) in readings.iter_mut().zip(columns) {
            *reading = row.needed(*column, numerals)?;
        }
        let code = match sources.code {
            Some(column) => Some(as_code(table.line(), row.needed(column, numerals)?)?),
            None => None,
        };
        let time = match sources.time {
            TimeSource::Rate(_) => None,
            TimeSource::Column { idx, .. } | TimeSource::Counter { idx, .. } => Some(row.needed(idx, numerals)?),
            TimeSource::Clock { idx } => Some(self.clock_s(&row, idx)?.ok_or(Skipped::Gap { column: idx })?),
        };
        let rest_s = match sources.parted {
            Some(parted) => row.needed(parted.rest, numerals)? * parted.unit.seconds(),
            None => 0.0,
        };
        if let Some(idx) = sources.run {
            // A short row has the cell as empty as one between commas is.
            self.labels.push(row.fields.get(idx).copied().unwrap_or_default());
        }
        self.times.extend(time.map(|time| time + rest_s));
        self.readings.iter_mut().zip(readings).for_each(|(list, reading)| list.push(reading));
        self.codes.extend(code);
        for (list, column) in self.others.iter_mut().zip(&sources.others) {
            list.push(row.number(*column, numerals).ok().flatten().unwrap_or(f64::NAN));
        }
        Ok(())
    }
}

/// The rows that were read, and what was left out of them.
struct Rows<'a> {
    samples: Samples,
    sources: &'a Sources,
    columns: Vec<usize>,
    is_ours: bool,
    numerals: Numerals,
    /// Rows that have a time, and those that left it behind.
    n_rows: u32,
    missing: Missing,
    wordy: Missing,
    /// Rows with words in place of a time: a summary where no sample comes behind them.
    below: Vec<Fault>,
    /// The last rows in which readings and the time before them go on or end together, and the time that was told does not.
    n_apart: usize,
    /// What each column beside the readings held last, and at each sample.
    latest: Vec<f64>,
    held: Vec<Vec<f64>>,
}

impl<'a> Rows<'a> {
    fn new(table: &Table, sources: &'a Sources, is_ours: bool) -> Self {
        let columns = sources.reading.columns();
        let lists = |n: usize| vec![Vec::new(); n];
        // Messages have names.
        let n_beside = if table.names.is_some() { sources.others.len() } else { 0 };
        let samples = Samples {
            readings: lists(columns.len()),
            others: lists(sources.others.len()),
            headings: vec![0],
            says_steps: sources.time.column().is_some_and(|idx| table.says(idx, words::is_step)),
            ..Samples::default()
        };
        Self {
            samples,
            sources,
            columns,
            is_ours,
            numerals: table.numerals.clone(),
            n_rows: 0,
            missing: Missing::default(),
            wordy: Missing::default(),
            below: Vec::new(),
            n_apart: 0,
            latest: vec![f64::NAN; n_beside],
            held: lists(n_beside),
        }
    }

    /// Of messages with a row each, that of a motor stands in rows without readings, and holds until the next one.
    fn look_beside(&mut self, table: &Table) {
        if self.latest.is_empty() {
            return;
        }
        let row = Row { table, fields: table.fields() };
        for (latest, column) in self.latest.iter_mut().zip(&self.sources.others) {
            if let Ok(Some(number)) = row.number(*column, &mut self.numerals) {
                *latest = number;
            }
        }
    }

    /// Takes what was held of columns of which nothing ever stands beside a reading.
    fn take_held(&mut self) {
        for (list, held) in self.samples.others.iter_mut().zip(&mut self.held) {
            if list.len() == held.len() && list.iter().all(|number| number.is_nan()) {
                *list = std::mem::take(held);
            }
        }
    }

    /// Counts the last rows in which the time that was told stands where the readings don't, as the time before them, or the other
    /// way round: one that is missing now and then may be told.
    fn look_side_by_side(&mut self, table: &Table) {
        let (Some(own), Some(told)) = (self.sources.passed_time, self.sources.time.column()) else { return };
        let fields = table.fields();
        let is_there = |idx: usize| fields.get(idx).is_some_and(|cell| !is_missing(cell));
        let reading = self.columns.first().is_some_and(|idx| is_there(*idx));
        match (is_there(told), reading) {
            (true, true) => self.n_apart = 0,
            (told, reading) if told != reading && is_there(own) == reading => self.n_apart += 1,
            _ => {}
        }
    }

    fn check_side_by_side(&self, table: &Table) -> Result<(), Fault> {
        let (Some(own), Some(told)) = (self.sources.passed_time, self.sources.time.column()) else { return Ok(()) };
        let Some(reading) = self.columns.first().filter(|_| self.n_apart >= FEWEST_APART) else { return Ok(()) };
        let role = if self.sources.measured() == Measured::Rate { "rate" } else { "theta" };
        Err(Fault::SideBySide {
            time: table.column_name(told),
            reading: table.column_name(*reading),
            cure: format!("t={own},{role}={reading}"),
            n_rows: self.n_apart,
        })
    }

    fn take(&mut self, table: &Table, notes: &mut Vec<String>) -> Result<(), Fault> {
        let (sources, is_ours) = (self.sources, self.is_ours);
        self.look_side_by_side(table);
        self.look_beside(table);
        // Our own writer ends every line: in a row without an end, even what looks like a number may be the
        // beginning of one. The writers of others often leave out the last end.
        let may_be_whole = table.is_complete() || !is_ours;
        match may_be_whole.then(|| self.samples.take(table, sources, &self.columns, &mut self.numerals)) {
            // Words in place of a time are a summary only below the last row.
            Some(Ok(()) | Err(Skipped::Gap { .. })) if !self.below.is_empty() => return Err(self.below.swap_remove(0)),
            Some(Ok(())) => {
                self.held.iter_mut().zip(&self.latest).for_each(|(list, latest)| list.push(*latest));
                self.count_sample(table)?;
            }
            Some(Err(Skipped::Gap { column })) if table.is_complete() => self.missing.count(table, column),
            Some(Err(Skipped::Fault(_))) if !is_ours && has_no_number(table) => {
                self.count_words(table);
                return Ok(());
            }
            Some(Err(Skipped::Fault(fault)))
                if !is_ours && self.below.len() < MOST_BELOW && sources.has_words_as_time(table) =>
            {
                self.below.push(fault);
                return Ok(());
            }
            Some(Err(Skipped::Fault(_))) if is_ours && table.is_heading() => {
                return Err(Fault::Joined { line: table.line() });
            }
            Some(Err(Skipped::Fault(fault))) if table.is_complete() => return Err(fault),
            _ => {
                notes.push(format!("line {}: cut off while it was written, left out", table.line()));
                return Ok(());
            }
        }
        self.n_rows += 1;
        Ok(())
    }

    /// Time goes on, and there is an end to it.
    fn count_sample(&mut self, table: &Table) -> Result<(), Fault> {
        let samples = &mut self.samples;
        samples.rows.extend(self.sources.counts_rows().then_some(self.n_rows));
        if samples.is_doubled(samples.len() - 1) {
            samples.n_doubled += 1;
            return Ok(());
        }
        match samples.len() > MOST_SAMPLES {
            true => Err(Fault::TooManySamples),
            false => samples.check_last(table, self.sources, self.is_ours),
        }
    }

    fn count_words(&mut self, table: &Table) {
        if self.sources.counts_rows() && table.is_heading() {
            self.samples.headings.push(self.samples.len());
        }
        self.wordy.count(table, 0);
    }

    fn finish(mut self, notes: &mut Vec<String>) -> Samples {
        self.take_held();
        if self.sources.run.is_none() {
            self.samples.end_before_empty_rows(notes);
        }
        notes.extend(self.missing.in_words("rows without a value are gaps"));
        notes.extend(self.wordy.in_words("lines without any number left out"));
        if !self.below.is_empty() {
            let lines = if self.below.len() == 1 { "1 line".to_owned() } else { format!("{} lines", self.below.len()) };
            notes.push(format!("{lines} below the table left out, with words where the time would be"));
        }
        self.samples
    }
}

/// Rows without a value.
#[derive(Default)]
struct Missing {
    n_rows: usize,
    first: Option<String>,
}

impl Missing {
    fn count(&mut self, table: &Table, column: usize) {
        self.n_rows += 1;
        self.first.get_or_insert_with(|| {
            let text = table.fields().get(column).copied().unwrap_or_default().to_owned();
            format!("line {}, column {}: \"{text}\"", table.line(), table.column_name(column))
        });
    }

    fn in_words(self, what: &str) -> Option<String> {
        let first = self.first?;
        Some(format!("{} {what}, the first at {first}", self.n_rows))
    }
}

/// Words between the rows or behind them, such as a program's last message.
fn has_no_number(table: &Table) -> bool {
    let is_number = |field: &&str| !matches!(Numerals::new().read(field), Cell::Text | Cell::Missing);
    let fields = table.fields();
    !fields.iter().any(|field| is_number(field) || clock::read(field).is_some())
}
