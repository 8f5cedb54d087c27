//! The times of the rows: clocks that show the time of day, and those that do not go on as they must.

use super::Samples;
use super::row::Row;
use crate::cell::is_missing;
use crate::chosen::{Sources, TimeSource};
use crate::error::{Fault, check_step};
use crate::limits::LONGEST_STEP_S;
use crate::table::Table;
use crate::{clock, grid, median_step_s, ticks};

/// A time has digits enough where the last one is worth less than this share of a step: times that were rounded so finely
/// would hardly be the same. With half of it, or twice, whole ms at 100 Hz are too few and µs enough.
const FINE: f64 = 0.01;

/// A clock that goes back by more than this passed midnight, s.
const MIDNIGHT_S: f64 = 43_200.0;

impl Samples {
    /// Seconds since midnight of the first day.
    pub(super) fn clock_s(&mut self, row: &Row, idx: usize) -> Result<Option<f64>, Fault> {
        let text = row.field(idx)?;
        if is_missing(text) {
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

    /// Time goes on.
    pub(super) fn check_last(&mut self, table: &Table, sources: &Sources, is_ours: bool) -> Result<(), Fault> {
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

    /// Steps instead of times, counters that began anew, and clocks coarser than the samples; true where rows of the same
    /// time are several.
    pub(super) fn set_clock_right(&mut self, notes: &mut Vec<String>) -> Result<bool, Fault> {
        let Some(fault) = self.standstill.take() else { return Ok(false) };
        let mut times = self.times.clone();
        let anew = ticks::unwind(&mut times);
        if let (Some(times), None) = (ticks::of_steps(&self.times, self.says_steps), anew) {
            notes.push("the column of the time holds the time since the row before: added up".to_owned());
            self.times = times;
            return Ok(true);
        }
        let of_digits = || grid::of_few_digits(&times).map(|(even, n_digits)| (even, n_digits, 0));
        let even = of_digits().or_else(|| grid::of_few_digits_past_losses(&times));
        let rounded = even.as_ref().map(|(_, n_digits, n_places)| (*n_digits, *n_places));
        let even = even.map(|(even, ..)| even).or_else(|| grid::of_slow_clock(&times));
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
            notes.push(rounded.map_or(
                "the clock is coarser than the samples: rows with the same time are spread evenly over it".to_owned(),
                |(n_digits, n_places)| grid::in_words(n_digits, n_places),
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
}

/// Have the times finer digits than rows that share one would need?
fn has_digits(times: &[f64]) -> bool {
    let digit = 10f64.powf((FINE * median_step_s(times)).log10().ceil());
    times.iter().map(|time| time / digit).any(|digits| (digits - digits.round()).abs() > 1e-3)
}
