//! The rows of a table, one after the other: numbers of the chosen columns, gaps, what was cut off.

mod left_out;

use super::cell::{Cell, Numerals};
use super::chosen::{Sources, TimeSource};
use super::clock;
use super::error::{Fault, check_step};
use super::frozen;
use super::grid;
use super::labels::Labels;
use super::limits::{LONGEST_STEP_S, MOST_SAMPLES};
use super::median_step_s;
use super::rails;
use super::spikes;
use super::straight;
use super::stuck::{self, What};
use super::table::Table;
use super::ticks;
use super::trail;
use super::words;
use std::borrow::Cow;

/// A file names at most so many columns that are needed at once: three axes, and what else is called a rate.
pub(super) const MOST_COLUMNS: usize = 8;

/// A summary below a table has no more lines.
const MOST_BELOW: usize = 20;

/// A time has digits enough where the last one is worth less than this share of a step: times that were rounded so finely
/// would hardly be the same. With half of it, or twice, whole ms at 100 Hz are too few and µs enough.
const FINE: f64 = 0.01;

/// A clock that goes back by more than this passed midnight, s.
const MIDNIGHT_S: f64 = 43_200.0;

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

/// Rows without a value.
#[derive(Default)]
struct Missing {
    n_rows: usize,
    first: Option<String>,
}

/// What became of a row.
enum Taken {
    Sample,
    Gap { column: usize },
}

impl Samples {
    /// Reads all rows, of however many runs; what is dropped is noted.
    pub(super) fn collect(
        table: &mut Table,
        sources: &Sources,
        is_ours: bool,
        notes: &mut Vec<String>,
    ) -> Result<Self, Fault> {
        let columns = sources.reading.columns();
        let lists = |n: usize| vec![Vec::new(); n];
        let mut samples = Self {
            readings: lists(columns.len()),
            others: lists(sources.others.len()),
            headings: vec![0],
            ..Self::default()
        };
        samples.says_steps = sources.time.column().is_some_and(|idx| table.says(idx, words::is_step));
        let mut numerals = table.numerals.clone();
        let mut missing = Missing::default();
        let mut wordy = Missing::default();
        let mut below: Vec<Fault> = Vec::new();
        let mut row_idx = 0_u32;
        while table.advance()? {
            // Our own writer ends every line: in a row without an end, even what looks like a number may be the
            // beginning of one. The writers of others often leave out the last end.
            let may_be_whole = table.is_complete() || !is_ours;
            match may_be_whole.then(|| samples.take(table, sources, &columns, &mut numerals)) {
                // Words in place of a time are a summary only below the last row.
                Some(Ok(_)) if !below.is_empty() => return Err(below.swap_remove(0)),
                Some(Ok(Taken::Sample)) => {
                    samples.rows.extend(sources.counts_rows().then_some(row_idx));
                    match samples.is_doubled(samples.len() - 1) {
                        true => samples.n_doubled += 1,
                        false => samples.check_last(table, sources, is_ours)?,
                    }
                }
                Some(Ok(Taken::Gap { column })) if table.is_complete() => missing.count(table, column),
                Some(Err(_)) if !is_ours && has_no_number(table) => {
                    if sources.counts_rows() && table.is_heading() {
                        samples.headings.push(samples.len());
                    }
                    wordy.count(table, 0);
                    continue;
                }
                Some(Err(fault)) if !is_ours && below.len() < MOST_BELOW && sources.has_words_as_time(table) => {
                    below.push(fault);
                    continue;
                }
                Some(Err(_)) if is_ours && table.is_heading() => return Err(Fault::Joined { line: table.line() }),
                Some(Err(fault)) if table.is_complete() => return Err(fault),
                _ => {
                    notes.push(format!("line {}: cut off while it was written, left out", table.line()));
                    continue;
                }
            }
            row_idx += 1;
        }
        if sources.run.is_none() {
            samples.end_before_empty_rows(notes);
        }
        notes.extend(missing.in_words("rows without a value are gaps"));
        notes.extend(wordy.in_words("lines without any number left out"));
        if !below.is_empty() {
            let lines = if below.len() == 1 { "1 line".to_owned() } else { format!("{} lines", below.len()) };
            notes.push(format!("{lines} below the table left out, with words where the time would be"));
        }
        Ok(samples)
    }

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

    /// Reads one row as a whole or not at all.
    fn take(
        &mut self,
        table: &Table,
        sources: &Sources,
        columns: &[usize],
        numerals: &mut Numerals,
    ) -> Result<Taken, Fault> {
        let row = Row { table, fields: table.fields() };
        let mut readings = [0.0; MOST_COLUMNS];
        for (reading, column) in readings.iter_mut().zip(columns) {
            let Some(number) = row.number(*column, numerals)? else { return Ok(Taken::Gap { column: *column }) };
            *reading = number;
        }
        let mut code = None;
        if let Some(column) = sources.code {
            let Some(number) = row.number(column, numerals)? else { return Ok(Taken::Gap { column }) };
            code = Some(as_code(table.line(), number)?);
        }
        let time = match sources.time {
            TimeSource::Rate(_) => None,
            TimeSource::Column { idx, .. } | TimeSource::Counter { idx, .. } => match row.number(idx, numerals)? {
                None => return Ok(Taken::Gap { column: idx }),
                found => found,
            },
            TimeSource::Clock { idx } => match self.clock_s(&row, idx)? {
                None => return Ok(Taken::Gap { column: idx }),
                found => found,
            },
        };
        let mut rest_s = 0.0;
        if let Some(parted) = sources.parted {
            let Some(rest) = row.number(parted.rest, numerals)? else {
                return Ok(Taken::Gap { column: parted.rest });
            };
            rest_s = rest * parted.unit.seconds();
        }
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
        Ok(Taken::Sample)
    }

    /// Seconds since midnight of the first day.
    fn clock_s(&mut self, row: &Row, idx: usize) -> Result<Option<f64>, Fault> {
        let text = row.field(idx)?;
        if super::cell::is_missing(text) {
            return Ok(None);
        }
        let moment = clock::read(text).ok_or_else(|| row.not_a_number(idx, text))?;
        let day = match moment.day {
            Some(day) => day - *self.first_day.get_or_insert(day),
            None => {
                let before_s = self.times.last().copied().unwrap_or(0.0);
                let now_s = f64::from(self.n_midnights) * clock::DAY_S + moment.second;
                self.n_midnights += u32::from(now_s < before_s - MIDNIGHT_S);
                i64::from(self.n_midnights)
            }
        };
        Ok(Some(day as f64 * clock::DAY_S + moment.second))
    }

    /// Steps instead of times, counters that began anew, and clocks coarser than the samples; true where rows of the same
    /// time are several.
    fn set_clock_right(&mut self, notes: &mut Vec<String>) -> Result<bool, Fault> {
        let Some(fault) = self.standstill.take() else { return Ok(false) };
        let mut times = self.times.clone();
        let anew = ticks::unwind(&mut times);
        if let (Some(times), None) = (ticks::of_steps(&self.times, self.says_steps), anew) {
            notes.push("the column of the time holds the time since the row before: added up".to_owned());
            self.times = times;
            return Ok(true);
        }
        let even = grid::of_few_digits(&times);
        let n_digits = even.as_ref().map(|(_, n_digits)| *n_digits);
        let even = even.map(|(even, _)| even).or_else(|| grid::of_slow_clock(&times));
        let spread = even.or_else(|| ticks::spread(&times));
        let is_coarse = spread.is_some();
        let times = spread.unwrap_or(times);
        let is_wrong = |idx: usize| times[idx] <= times[idx - 1] && (is_coarse || !self.is_doubled(idx));
        if (1..times.len()).any(is_wrong) {
            return match self.leave_out_strays(notes) || self.leave_out_twins(notes) || self.end_with_the_clock(notes) {
                true => Ok(false),
                false => Err(self.with_its_rows(fault)),
            };
        }
        if let Some((n, bits)) = anew {
            notes.push(format!("the times are counts of {bits} bits that begin anew {n} times: they go on there"));
        }
        if is_coarse {
            notes.push(n_digits.map_or(
                "the clock is coarser than the samples: rows with the same time are spread evenly over it".to_owned(),
                |n| format!("the times are rounded to {n} digits and fit even ones: these are taken"),
            ));
        }
        self.times = times;
        Ok(is_coarse)
    }

    /// Of a time that stands there again, how often it does in a row, and whether more digits would help: a clock that stopped
    /// wants another cure than one of too few.
    fn with_its_rows(&self, fault: Fault) -> Fault {
        let Fault::TimeRepeats { place, time, unit, .. } = fault else { return fault };
        let first = self.times.windows(2).position(|pair| pair[0] == pair[1]).unwrap_or(0);
        let n_rows = self.times[first..].iter().take_while(|time| **time == self.times[first]).count();
        Fault::TimeRepeats { place, time, unit, n_rows: n_rows.max(2), has_digits: has_digits(&self.times) }
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

    /// Readings that nobody took and those that jump out of the swing and back become gaps; of several axes none is looked at
    /// before one is chosen.
    pub(super) fn leave_out_losses(&mut self, times_s: &mut Vec<f64>, notes: &mut Vec<String>) {
        if self.readings.len() > 2 || times_s.len() != self.len() {
            return;
        }
        let lists: Vec<&[f64]> = self.readings.iter().map(Vec::as_slice).collect();
        if let Some(first) = trail::trail(times_s, &lists) {
            notes.push(trail::note(first, times_s));
            let is_behind = (0..times_s.len()).map(|idx| idx >= first).collect::<Vec<bool>>();
            self.leave_out(times_s, &is_behind);
        }
        let lists: Vec<&[f64]> = self.readings.iter().map(Vec::as_slice).collect();
        let is_drawn = straight::drawn(times_s, &lists);
        if let Some(note) = straight::note(&is_drawn, times_s) {
            notes.push(note);
            self.leave_out(times_s, &is_drawn);
        }
        let is_rail = rails::rails(times_s, &self.first());
        if let Some(note) = rails::note(&is_rail, &self.first(), times_s) {
            notes.push(note);
            self.leave_out(times_s, &is_rail);
        }
        if let Some(found) = stuck::standstill(times_s, &self.first()) {
            notes.push(stuck::note(&found, times_s));
            let is_stuck = |idx| found.what == What::Stuck && idx > found.first;
            self.leave_out(times_s, &(0..times_s.len()).map(is_stuck).collect::<Vec<bool>>());
        }
        let is_frozen = frozen::frozen(times_s, &self.first());
        if let Some(note) = frozen::note(&is_frozen, times_s) {
            notes.push(note);
            self.leave_out(times_s, &is_frozen);
        }
        // Of a point x tells: y is level where the pendulum hangs, and stands there in steps.
        let is_spike = spikes::spikes(times_s, &self.first());
        if let Some(note) = spikes::note(&is_spike, times_s) {
            notes.push(note);
            self.leave_out(times_s, &is_spike);
        }
    }

    /// The first list of readings, or else the codes of a converter.
    fn first(&self) -> Cow<'_, [f64]> {
        match self.readings.first() {
            Some(readings) => Cow::Borrowed(readings),
            None => self.codes.iter().map(|code| f64::from(*code)).collect(),
        }
    }

    fn leave_out(&mut self, times_s: &mut Vec<f64>, which: &[bool]) {
        let kept: Vec<bool> = which.iter().map(|is_out| !is_out).collect();
        keep(times_s, &kept);
        self.keep(&kept);
    }

    /// Time goes on, and there is an end to it.
    fn check_last(&mut self, table: &Table, sources: &Sources, is_ours: bool) -> Result<(), Fault> {
        if self.len() > MOST_SAMPLES {
            return Err(Fault::TooManySamples);
        }
        let [.., before, last] = self.times[..] else { return Ok(()) };
        if last > before || (self.standstill.is_some() && !is_ours) {
            return Ok(());
        }
        // Times whose unit is not stated, and that can't be seconds, are shown as they stand in the file.
        let is_stated = !matches!(sources.time, TimeSource::Column { unit: None, .. });
        let unit = if is_stated || median_step_s(&self.times) < LONGEST_STEP_S { " s" } else { "" };
        let scale = sources.time.scale();
        match check_step(|| format!("line {}", table.line()), unit, before * scale, last * scale) {
            Err(fault) if is_ours => Err(fault),
            Err(fault) => {
                self.standstill = Some(fault);
                Ok(())
            }
            Ok(()) => Ok(()),
        }
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

/// Have the times finer digits than rows that share one would need?
fn has_digits(times: &[f64]) -> bool {
    let digit = 10f64.powf((FINE * median_step_s(times)).log10().ceil());
    times.iter().map(|time| time / digit).any(|digits| (digits - digits.round()).abs() > 1e-3)
}

/// Words between the rows or behind them, such as a program's last message.
fn has_no_number(table: &Table) -> bool {
    let is_number = |field: &&str| !matches!(Numerals::new().read(field), Cell::Text | Cell::Missing);
    let fields = table.fields();
    !fields.iter().any(|field| is_number(field) || clock::read(field).is_some())
}

/// A row of the table while its cells are read.
struct Row<'a> {
    table: &'a Table<'a>,
    fields: Vec<&'a str>,
}

impl<'a> Row<'a> {
    fn field(&self, idx: usize) -> Result<&'a str, Fault> {
        let (line, n_found) = (self.table.line(), self.fields.len());
        let short = || Fault::ShortRow { line, n_found, column: self.table.column_name(idx) };
        // Between spaces nobody can write an empty cell: a row of the time alone has no value.
        let is_alone = self.table.is_parted_by_spaces() && n_found == 1 && idx > 0;
        self.fields.get(idx).copied().or(is_alone.then_some("")).ok_or_else(short)
    }

    /// A finite number; `None` where nothing was measured.
    fn number(&self, idx: usize, numerals: &mut Numerals) -> Result<Option<f64>, Fault> {
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

    fn not_a_number(&self, idx: usize, text: &str) -> Fault {
        Fault::NotANumber {
            place: format!("line {}", self.table.line()),
            column: self.table.column_name(idx),
            value: text.chars().take(40).collect(),
        }
    }
}

fn as_code(line: usize, number: f64) -> Result<u16, Fault> {
    if number.fract() != 0.0 || !(0.0..=f64::from(u16::MAX)).contains(&number) {
        return Err(Fault::BadCode { line, value: number.to_string() });
    }
    Ok(number as u16)
}
