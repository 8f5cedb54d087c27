//! The stretch that is swung freely.

use super::{Cut, MIN_TURNING_POINTS, SegmentError};
use crate::Measured;
use crate::turning::TurningPoint;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::ops::Range;

/// So many swings beside the free ones are worth a word.
pub(super) const WORTH_A_LOOK: usize = 2 * MIN_TURNING_POINTS;

/// Does a half swing lie beyond a right angle, with no lowest point on its way? Whole turns apart it hangs as well.
fn is_about_upright(from: &TurningPoint, to: &TurningPoint) -> bool {
    let is_high = |turn: &TurningPoint| (turn.angle_rad - TAU * (turn.angle_rad / TAU).round()).abs() > FRAC_PI_2;
    let [low, high] = if from.is_maximum { [to, from] } else { [from, to] }.map(|turn| turn.angle_rad / TAU);
    from.is_maximum != to.is_maximum && is_high(from) && is_high(to) && low.ceil() > high
}

impl Cut<'_> {
    /// What is swung freely: of what was left alone long enough to tell, what becomes smaller and has the most swings.
    pub(super) fn undisturbed(&self) -> Result<Range<usize>, SegmentError> {
        let worth = |part: &Range<usize>| {
            (self.count_turns(part) >= MIN_TURNING_POINTS, self.may_fade(part), self.count_swings(part))
        };
        let best = |stretches: Vec<Range<usize>>| self.parts_of(stretches).max_by_key(worth).unwrap_or(0..0);
        let mut part = best(self.undriven_stretches());
        if self.count_turns(&part) < MIN_TURNING_POINTS {
            part = best(self.stretches());
        }
        match self.count_turns(&part) {
            n if n >= MIN_TURNING_POINTS => Ok(part),
            n_turning_points => Err(self.grows().unwrap_or_else(|| SegmentError::TooFewSwings {
                n_turning_points,
                duration_s: self.duration_s(&part),
            })),
        }
    }

    /// Between disturbances, between growths, and behind a motor.
    pub(super) fn parts_left_alone(&self) -> impl Iterator<Item = Range<usize>> {
        self.parts_of(self.undriven_stretches())
    }

    /// Of these stretches what lies between growths and behind a motor.
    fn parts_of(&self, stretches: Vec<Range<usize>>) -> impl Iterator<Item = Range<usize>> {
        let hanging = stretches.into_iter().flat_map(|range| self.hanging_parts(range));
        let parts = hanging.flat_map(|range| self.releases_in(range)).flat_map(|range| self.fading_parts(range));
        parts.map(|part| self.left_alone(&part)).map(|part| part.start..self.taken_from_rest(&part).unwrap_or(part.end))
    }

    /// Index ranges between the disturbances.
    pub(super) fn stretches(&self) -> Vec<Range<usize>> {
        if self.states.is_empty() {
            return vec![self.asked.clone()];
        }
        let n_states = self.states.len();
        let mut stretches = Vec::new();
        let mut start = None;
        for state_idx in 0..=n_states {
            let is_free = self.disturbed.get(state_idx).is_some_and(|disturbed| !disturbed);
            match (start, is_free) {
                (None, true) => start = Some(state_idx),
                (Some(from), false) => {
                    stretches.push(self.index_range(from, state_idx - 1));
                    start = None;
                }
                _ => {}
            }
        }
        stretches
    }

    /// Samples between two states; the ends of the recording belong to the first and the last.
    fn index_range(&self, first: usize, last: usize) -> Range<usize> {
        let start = match first {
            0 => self.asked.start,
            _ => self.recording.index_at(self.states[first].time_s),
        };
        let end = match last + 1 {
            n if n == self.states.len() => self.asked.end,
            _ => self.recording.index_at(self.states[last].time_s),
        };
        start..end.max(start)
    }

    /// What lies between the stretches about upright, in order: a pendulum that is left alone falls from there and passes its lowest
    /// point before it turns again, so that a motor holds what turns without.
    pub(super) fn hanging_parts(&self, range: Range<usize>) -> Vec<Range<usize>> {
        let mut parts = Vec::new();
        let mut start = range.start;
        let is_angle = self.recording.measured() == Measured::Angle;
        for pair in self.turns_in(&range).windows(2).filter(|pair| is_angle && is_about_upright(pair[0], pair[1])) {
            let [from, to] = [pair[0], pair[1]].map(|turn| self.recording.index_at(turn.time_s));
            parts.push(start..from.max(start));
            start = to;
        }
        parts.push(start..range.end);
        parts
    }

    /// What swings beside the free part, where it is worth a look.
    pub(super) fn other_swings(&self, free: &Range<usize>) -> Vec<Range<usize>> {
        let is_apart = |range: &Range<usize>| range.end <= free.start || range.start >= free.end;
        let is_worth = |range: &Range<usize>| is_apart(range) && self.count_swings(range) >= WORTH_A_LOOK;
        self.parts_left_alone().filter(is_worth).collect()
    }

    /// The one with the most swings.
    pub(super) fn longest_of(&self, ranges: Vec<Range<usize>>) -> Option<Range<usize>> {
        ranges.into_iter().max_by_key(|range| self.count_swings(range))
    }
}
