//! The rows of a table as numbers of the chosen columns, gaps, what was cut off.

mod clock;
mod collect;
mod left_out;
mod losses;
mod row;

use super::error::{Fault, check_step};
use super::labels::Labels;

/// A file names at most so many columns that are needed at once: three axes, and what else is called a rate.
pub(super) const MOST_COLUMNS: usize = 8;

/// The needed columns as read, in the file's units.
#[derive(Default)]
pub(super) struct Samples {
    pub(super) times: Vec<f64>,
    /// One list a column: angles, x and y of a point, or the rates about several axes.
    pub(super) readings: Vec<Vec<f64>>,
    pub(super) codes: Vec<u16>,
    /// One list for each column that drives or carries the pendulum, NaN where it has no number.
    pub(super) others: Vec<Vec<f64>>,
    /// Which rows they are, where the rate tells the time and rows are missing.
    pub(super) rows: Vec<u32>,
    /// Which run each row belongs to, where a column says so.
    pub(super) labels: Labels,
    /// Rows above which the names of the columns stand again, where the rate tells the time; the first one with them.
    pub(super) headings: Vec<usize>,
    /// Is the column of the time called after steps (`dt`)?
    says_steps: bool,
    /// Day of the first clock time.
    first_day: Option<i64>,
    n_midnights: u32,
    /// Rows that repeat the one before.
    n_doubled: usize,
    /// The first time that does not increase, where it may be cured once all are known.
    standstill: Option<Fault>,
}

impl Samples {
    /// What only all rows of a run tell: clocks are set right, and rows that stand there twice left out.
    pub(super) fn finish(&mut self, notes: &mut Vec<String>) -> Result<(), Fault> {
        self.turn_round(notes);
        if self.set_clock_right(notes)? {
            self.n_doubled = 0;
        }
        self.drop_doubled();
        if self.n_doubled > 0 {
            notes
                .push(format!("{} rows stood there twice (same time, same angle), left out once each", self.n_doubled));
        }
        if self.n_midnights > 0 {
            notes.push("the clock passed midnight: a day added".to_owned());
        }
        self.shrink();
        Ok(())
    }

    /// The rows of each run as samples of their own.
    pub(super) fn by_runs(self, of_rows: &[u32], n_runs: usize) -> impl Iterator<Item = Self> {
        let lists = |of: &[Vec<f64>]| vec![Vec::new(); of.len()];
        let (readings, others) = (lists(&self.readings), lists(&self.others));
        let empty = || Self {
            readings: readings.clone(),
            others: others.clone(),
            says_steps: self.says_steps,
            ..Self::default()
        };
        let mut runs: Vec<Self> = (0..n_runs).map(|_| empty()).collect();
        let mut first_rows = vec![None; n_runs];
        for (row, place) in of_rows.iter().enumerate() {
            let run = &mut runs[*place as usize];
            run.times.extend(self.times.get(row));
            run.codes.extend(self.codes.get(row));
            run.rows.extend(self.rows.get(row).map(|idx| idx - *first_rows[*place as usize].get_or_insert(*idx)));
            run.readings.iter_mut().zip(&self.readings).for_each(|(list, all)| list.push(all[row]));
            run.others.iter_mut().zip(&self.others).for_each(|(list, all)| list.push(all[row]));
        }
        runs.into_iter().map(Self::looked_over)
    }

    /// With what is seen of a run while a file of its own is read.
    fn looked_over(mut self) -> Self {
        self.count_doubled();
        let wrong = self.first_standstill();
        self.standstill = wrong.and_then(|idx| {
            check_step(|| format!("row {} of the run", idx + 1), "", self.times[idx - 1], self.times[idx]).err()
        });
        self
    }

    /// The largest reading, in the file's unit.
    pub(super) fn largest_reading(&self) -> f64 {
        self.readings.iter().flatten().fold(0.0, |largest, reading| f64::max(largest, reading.abs()))
    }

    /// Does the time go back or stand anywhere?
    pub(super) fn goes_back(&self) -> bool {
        self.standstill.is_some()
    }

    fn count_doubled(&mut self) {
        self.n_doubled = (0..self.len()).filter(|idx| self.is_doubled(*idx)).count();
    }

    /// The first sample whose time does not increase, unless it repeats the one before.
    fn first_standstill(&self) -> Option<usize> {
        (1..self.times.len()).find(|idx| self.times[*idx] <= self.times[*idx - 1] && !self.is_doubled(*idx))
    }

    /// Does a sample repeat time and readings of the one before?
    fn is_doubled(&self, idx: usize) -> bool {
        let repeats = |values: &Vec<f64>| idx > 0 && values.get(idx).is_some_and(|value| *value == values[idx - 1]);
        repeats(&self.times) && self.readings.iter().all(repeats)
    }

    fn drop_doubled(&mut self) {
        if self.n_doubled > 0 {
            let kept: Vec<bool> = (0..self.len()).map(|idx| !self.is_doubled(idx)).collect();
            self.keep(&kept);
        }
    }

    fn keep(&mut self, kept: &[bool]) {
        keep(&mut self.times, kept);
        self.readings.iter_mut().chain(&mut self.others).for_each(|list| keep(list, kept));
        keep(&mut self.codes, kept);
        keep(&mut self.rows, kept);
    }

    pub(super) fn len(&self) -> usize {
        self.readings.first().map_or(self.codes.len(), Vec::len)
    }

    fn shrink(&mut self) {
        self.times.shrink_to_fit();
        self.readings.iter_mut().chain(&mut self.others).for_each(Vec::shrink_to_fit);
        self.codes.shrink_to_fit();
    }
}

/// Keeps what is marked, of a list that has something for each mark.
pub(super) fn keep<T>(list: &mut Vec<T>, kept: &[bool]) {
    let mut marks = kept.iter();
    list.retain(|_| *marks.next().unwrap_or(&true));
}
