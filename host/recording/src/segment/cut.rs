//! Everything known about the asked part of a recording while it is cut.

use super::half_swing::sizes_rad;
use super::law::{Law, State, states};
use super::words::TINY_TAIL;
use super::{LONGEST_S, MIN_TURNING_POINTS, SegmentError};
use crate::limits::MIN_SAMPLES;
use crate::noise::{self, Noise, smallest_step};
use crate::number::significant;
use crate::turning::{self, TurningPoint};
use crate::{Measured, Recording};
use std::cmp::Reverse;
use std::ops::Range;

/// A noise found from n samples is known to about 1/√n of itself; beyond so many times this, it is another noise. Among
/// 10,000 samples a jump of 60 noises is noticed; with half of it one of 40, with twice of it one of 90, and with half of it
/// chance would now and then take the noise of the free swing, which is known less well.
const NOISE_SPREADS: f64 = 5.0;

/// A way of no more steps of the sensor from one turning point to the next is no swing: two to either side, where each end may be off
/// by one. A wander that a motor left behind goes by 2.3 to 3.4 of them, but for one way; half and twice were not tried.
const NO_SWING_STEPS: f64 = 4.0;

/// Everything known about the asked part of a recording while it is cut.
pub(super) struct Cut<'a> {
    pub(super) recording: &'a Recording,
    pub(super) asked: Range<usize>,
    pub(super) whole_noise: Noise,
    /// Of neighbours, or where it wanders the white noise that would scatter means over parts of a swing so.
    pub(super) noise_rms_rad: f64,
    pub(super) width_s: f64,
    pub(super) half_swing_s: f64,
    pub(super) turns: Vec<TurningPoint>,
    pub(super) states: Vec<State>,
    pub(super) law: Law,
    pub(super) disturbed: Vec<bool>,
    pub(super) interrupted: Vec<Range<usize>>,
}

impl<'a> Cut<'a> {
    pub(super) fn new(recording: &'a Recording, asked: Range<usize>) -> Result<Self, SegmentError> {
        let (times_s, angles_rad) = (&recording.times_s()[asked.clone()], &recording.angles_rad()[asked.clone()]);
        let noise = noise::estimate(recording);
        let white_rad = noise::of_most_samples(times_s, angles_rad, &noise);
        let rough_s = turning::half_swing_s(times_s, angles_rad, white_rad);
        let of_means = |half_swing_s| noise::noise_of_means(times_s, angles_rad, white_rad, half_swing_s);
        let noise_rms_rad = rough_s.map_or(white_rad, of_means);
        let turns = turning::turning_points(times_s, angles_rad, noise_rms_rad);
        let half_swing_s = turning::half_swing_s(times_s, angles_rad, noise_rms_rad);
        let duration_s = times_s[times_s.len() - 1] - times_s[0];
        let too_few = SegmentError::TooFewSwings { n_turning_points: turns.len(), duration_s };
        let (Some(half_swing_s), true) = (half_swing_s, turns.len() >= MIN_TURNING_POINTS) else { return Err(too_few) };
        let width_s = turning::quartic_width_s(half_swing_s, recording.step_s());
        // What its colour adds to accelerations shows in how far they are off the law anyway.
        let states = states(times_s, angles_rad, white_rad, width_s);
        let mut cut = Self {
            recording,
            asked,
            whole_noise: noise,
            noise_rms_rad,
            width_s,
            half_swing_s,
            turns,
            states,
            law: Law::zeros(),
            disturbed: Vec::new(),
            interrupted: Vec::new(),
        };
        cut.find_disturbances().ok_or(too_few)?;
        if recording.measured() == Measured::Angle {
            cut.interrupted = cut.forgive_interruptions();
        }
        Ok(cut)
    }

    /// The stretch that swings freely, and what tells of it, if that is less than all.
    pub(super) fn narrowed(&self, is_told: bool) -> Result<(Option<Self>, Range<usize>), SegmentError> {
        match self.narrowed_by_law(is_told) {
            // A hand that trembles while it holds is tiny beside what follows.
            Ok(found)
                if is_told || !self.times_as_large_later(&found.1).is_some_and(|times| times * TINY_TAIL > 1.0) =>
            {
                Ok(found)
            }
            Err(fault) if is_told || !matches!(fault, SegmentError::TooFewSwings { .. }) => Err(fault),
            found => self.behind_hold().map_or(found, Ok),
        }
    }

    /// How many times as large as those of a stretch the largest swing of all is, where that is behind it.
    pub(super) fn times_as_large_later(&self, stretch: &Range<usize>) -> Option<f64> {
        let later = self.largest_swing(&self.asked).filter(|largest| largest.end > stretch.end)?;
        Some(self.largest_rad(&(later.start..later.end + 1))? / self.largest_rad(stretch)?)
    }

    /// The same of what was held right before its largest swing, or of that swing where the hand trembles, and of all behind it: of few
    /// swings a hand that lifts and holds it for longer than it swings leaves no law.
    pub(super) fn behind_hold(&self) -> Option<(Option<Self>, Range<usize>)> {
        let largest = self.largest_swing(&self.asked).filter(|_| self.recording.measured() == Measured::Angle)?;
        let held = self.held_within(self.asked.start, &self.asked).filter(|held| largest.contains(&held.end));
        let start = held.map_or(largest.start, |held| held.start);
        let alone = (start > self.asked.start).then(|| Self::new(self.recording, start..self.asked.end).ok())??;
        let is_it = |again: &Range<usize>| {
            again.contains(&largest.end) && alone.may_fade(again) && alone.driven_in_words(again).is_empty()
        };
        let again = alone.undisturbed().ok().filter(is_it)?;
        Some((Some(alone), again))
    }

    fn narrowed_by_law(&self, is_told: bool) -> Result<(Option<Self>, Range<usize>), SegmentError> {
        let hanging = self.of_hanging();
        let cut = hanging.as_ref().unwrap_or(self);
        let stretch = cut.undisturbed()?;
        // What the user says stands, whatever lies in it.
        let alone = if is_told { None } else { cut.alone(&stretch) };
        match alone {
            Some((alone, again)) => Ok((Some(alone), again)),
            None => Ok((hanging, stretch)),
        }
    }

    /// How often it turns in its free swing, if that is often enough and no longer than any pendulum swings.
    pub(super) fn check_enough_swings(&self, free: &Range<usize>) -> Result<usize, SegmentError> {
        let (n_turning_points, duration_s) = (self.count_turns(free), self.duration_s(free));
        match n_turning_points {
            _ if duration_s > LONGEST_S => Err(SegmentError::TooLong { duration_s }),
            n if n < MIN_TURNING_POINTS => Err(SegmentError::TooFewSwings { n_turning_points, duration_s }),
            n => self.check_more_than_steps(free, n).map(|()| n),
        }
    }

    /// A sensor that stands between two of its steps goes to and fro by one or two of them to either side while nothing swings.
    fn check_more_than_steps(&self, free: &Range<usize>, n_turning_points: usize) -> Result<(), SegmentError> {
        let Some(step) = smallest_step(&self.angles_rad()[free.clone()]) else { return Ok(()) };
        let n_seen = sizes_rad(&self.turns_in(free)).iter().filter(|size| **size > NO_SWING_STEPS * step).count();
        if n_seen + 1 >= MIN_TURNING_POINTS {
            return Ok(());
        }
        Err(SegmentError::WithinSteps {
            n_turning_points,
            duration_s: self.duration_s(free),
            n_seen,
            step: significant(step, 3),
            unit: self.recording.measured().unit(),
        })
    }

    /// The same of the longest stretch that hangs, by its swings, where a motor holds it upright in others: how it moves there tells
    /// of no law.
    fn of_hanging(&self) -> Option<Self> {
        let parts = self.hanging_parts(self.asked.clone());
        let alone = |part: Range<usize>| {
            let alone = Self::new(self.recording, part).ok()?;
            let n_turns = alone.count_turns(&alone.undisturbed().ok()?);
            Some((n_turns, alone))
        };
        let is_part = |part: &Range<usize>| *part != self.asked && part.len() >= MIN_SAMPLES;
        let found = parts.into_iter().filter(is_part).filter_map(alone);
        found.max_by_key(|(n_turns, _)| *n_turns).map(|(_, alone)| alone)
    }

    /// The same without what lies behind a stretch, or before it as well, and the stretch anew, if it is not shorter by that: what
    /// a hand does, and other swings, tell of no law that this one follows.
    fn alone(&self, stretch: &Range<usize>) -> Option<(Self, Range<usize>)> {
        let is_before = |part: &Range<usize>| part.end <= stretch.start && self.count_turns(part) >= MIN_TURNING_POINTS;
        let before = self.parts_left_alone().filter(is_before).map(|part| part.end).max();
        let before = before.filter(|end| self.is_disturbed_within(&(*end..stretch.start)));
        let parts = [Some(self.asked.start), before].into_iter().flatten().map(|start| start..stretch.end);
        let again = |part: Range<usize>| {
            let alone = Self::new(self.recording, part).ok()?;
            let again = alone.undisturbed().ok()?;
            again.contains(&usize::midpoint(stretch.start, stretch.end)).then_some((alone, again))
        };
        let n_swings = |(alone, again): &(Self, Range<usize>)| alone.count_swings(again);
        let found =
            parts.filter(|part| *part != self.asked).filter_map(again).min_by_key(|it| Reverse(n_swings(it)))?;
        (n_swings(&found) >= self.count_swings(stretch)).then_some(found)
    }

    /// Of the whole recording, which tells it best, unless that is larger than chance makes it beside the free swing:
    /// where a pendulum is put down or let go, the angle may jump.
    pub(super) fn noise(&self, free: &Range<usize>) -> Noise {
        let of_free = noise::of_part(self.recording, free.clone());
        let chance = NOISE_SPREADS / (free.len() as f64).sqrt();
        if self.whole_noise.total_rms > of_free.total_rms * (1.0 + chance) { of_free } else { self.whole_noise.clone() }
    }

    pub(super) fn times_s(&self) -> &'a [f64] {
        &self.recording.times_s()[..self.asked.end]
    }

    pub(super) fn angles_rad(&self) -> &'a [f64] {
        &self.recording.angles_rad()[..self.asked.end]
    }

    pub(super) fn duration_s(&self, range: &Range<usize>) -> f64 {
        match range.len() {
            0 => 0.0,
            _ => self.times_s()[range.end - 1] - self.times_s()[range.start],
        }
    }

    pub(super) fn count_turns(&self, range: &Range<usize>) -> usize {
        let in_range = |time_s: f64| range.contains(&self.recording.index_at(time_s));
        self.turns.iter().filter(|turn| in_range(turn.time_s)).count()
    }

    pub(super) fn n_in(&self, duration_s: f64) -> usize {
        ((duration_s / self.recording.step_s()).round() as usize).min(self.asked.len()).max(3)
    }
}
