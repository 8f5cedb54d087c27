//! What the times tell of the rows: those that are no samples (room that was never filled, strays, twins, what a stopped
//! clock leaves), and those that stand there last one first.

use super::super::limits::MIN_SAMPLES;
use super::super::{order, ticks};
use super::Samples;

impl Samples {
    /// Rows of nothing but zeros, behind the last one with a time, are room that a program made beforehand and never filled.
    pub(super) fn end_before_empty_rows(&mut self, notes: &mut Vec<String>) {
        let is_empty = |idx: &usize| self.times[*idx] == 0.0 && self.readings.iter().all(|list| list[*idx] == 0.0);
        let Some(last) = (0..self.times.len()).rfind(|idx| !is_empty(idx)) else { return };
        let n_empty = self.times.len() - last - 1;
        if n_empty == 0 || self.times[last] <= 0.0 {
            return;
        }
        notes.push(format!("{n_empty} rows of nothing but zeros behind the last time, {}: left out", self.times[last]));
        let kept: Vec<bool> = (0..self.len()).map(|idx| idx <= last).collect();
        self.keep(&kept);
        self.count_anew();
    }

    /// A program that writes the newest row first: each time is before that of the row above. Counts of few bits that run
    /// down, and the same time in two rows, are another matter.
    pub(super) fn turn_round(&mut self, notes: &mut Vec<String>) {
        let runs_back = self.times.len() >= MIN_SAMPLES && self.times.windows(2).all(|pair| pair[1] < pair[0]);
        if !runs_back {
            return;
        }
        notes.push("the last row was the first in time: read from below".to_owned());
        self.times.reverse();
        self.readings.iter_mut().chain(&mut self.others).for_each(|list| list.reverse());
        self.codes.reverse();
        self.count_anew();
    }

    /// What was counted while the rows were read, of rows that were put in order since.
    fn count_anew(&mut self) {
        self.count_doubled();
        let still_goes_back = self.first_standstill().is_some();
        self.standstill = self.standstill.take().filter(|_| still_goes_back);
    }

    /// Rows out of the order of time, where they are few and the clock goes on around them.
    pub(super) fn leave_out_strays(&mut self, notes: &mut Vec<String>) -> bool {
        let Some(kept) = order::kept(&self.times, |idx| self.is_doubled(idx)) else { return false };
        let n = kept.iter().filter(|kept| !**kept).count();
        if let Some(first) = kept.iter().position(|kept| !kept) {
            let (stray, before) = (self.times[first], self.times[first - 1]);
            notes.push(match n {
                1 => format!("1 row is out of the order of time, {stray} after {before}, and the clock goes on: left out"),
                n => format!(
                    "{n} rows are out of the order of time, the first of them {stray} after {before}, and the clock goes \
                     on: left out"
                ),
            });
        }
        self.keep(&kept);
        true
    }

    /// Keeps the first of two rows of the same time, where they are few and the clock goes on around them.
    pub(super) fn leave_out_twins(&mut self, notes: &mut Vec<String>) -> bool {
        let Some(kept) = order::first_of_twins(&self.times) else { return false };
        let n = kept.iter().filter(|kept| !**kept).count();
        let first = kept.iter().position(|kept| !kept).map_or(0.0, |idx| self.times[idx]);
        notes.push(format!(
            "{n} rows have the time of the row before, {first} first, as when a sensor writes whenever it moves: left out"
        ));
        self.keep(&kept);
        true
    }

    /// Rows behind the moment at which the clock stopped for good have no time; those before it are a recording.
    pub(super) fn end_with_the_clock(&mut self, notes: &mut Vec<String>) -> bool {
        let Some(n_kept) = ticks::before_stop(&self.times, |idx| self.is_doubled(idx)) else { return false };
        notes.push(format!(
            "the clock stops at {}: the {} rows behind have no time and are left out; --rate, the samples a second, takes all",
            self.times[n_kept - 1],
            self.len() - n_kept
        ));
        let kept: Vec<bool> = (0..self.len()).map(|idx| idx < n_kept).collect();
        self.keep(&kept);
        true
    }
}
