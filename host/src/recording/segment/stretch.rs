//! The stretch that is swung freely, and the rest at its end.

use super::super::median;
use super::super::turning::TurningPoint;
use super::{Cut, MIN_TURNING_POINTS, STILL_SPREADS, SegmentError, mean};
use std::f64::consts::PI;
use std::ops::Range;

/// Half swings at the end that may be too small to be seen.
const N_UNSEEN: f64 = 3.0;

/// Swings from turn to turn below this many noise rms are too uncertain to say that they grew.
const GROWTH_NOISE: f64 = 20.0;

/// A swing with so many turning points beside the free one is worth a word.
const WORTH_A_LOOK: usize = 2 * MIN_TURNING_POINTS;

/// Quality factor of the best clocks; with half of it a clock would be doubted, with twice of it a motor that holds its swing
/// to a thousandth in thirty periods would not.
const BEST_QUALITY: f64 = 2e4;

/// Half swings in each third, at least, before it is said that they don't become smaller.
const FADING_SWINGS: usize = 6;

impl Cut<'_> {
    /// The stretch between disturbances with the most turning points, cut again where the swings grow.
    pub(super) fn undisturbed(&self) -> Result<Range<usize>, SegmentError> {
        let stretches = self.stretches();
        let best = stretches.into_iter().max_by_key(|range| self.count_turns(range)).unwrap_or(0..0);
        let best = self.after_last_growth(best);
        match self.count_turns(&best) {
            n if n >= MIN_TURNING_POINTS => Ok(best),
            n_turning_points => {
                Err(SegmentError::TooFewSwings { n_turning_points, duration_s: self.duration_s(&best) })
            }
        }
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

    /// A free swing never grows: what comes before the last growth was pushed.
    fn after_last_growth(&self, range: Range<usize>) -> Range<usize> {
        self.fading_parts(range.clone()).pop().unwrap_or(range)
    }

    /// What lies between the growths, in order.
    fn fading_parts(&self, range: Range<usize>) -> Vec<Range<usize>> {
        let inside: Vec<&TurningPoint> =
            self.turns.iter().filter(|turn| range.contains(&self.recording.index_at(turn.time_s))).collect();
        let grows = |three: &[&TurningPoint]| {
            let spread_rad = three[0].spread_rad.hypot(three[2].spread_rad) + self.noise_rms_rad;
            let before = (three[0].angle_rad - three[1].angle_rad).abs();
            let after = (three[2].angle_rad - three[1].angle_rad).abs();
            let alternate = three[0].is_maximum != three[1].is_maximum && three[1].is_maximum != three[2].is_maximum;
            alternate && after > GROWTH_NOISE * self.noise_rms_rad && after > before * 1.02 + 6.0 * spread_rad
        };
        let index_of = |turn: &TurningPoint| self.recording.index_at(turn.time_s);
        let mut parts = Vec::new();
        let mut start = range.start;
        for three in inside.windows(3).filter(|three| grows(three)) {
            parts.push(start..index_of(three[1]).max(start));
            start = index_of(three[2]);
        }
        parts.push(start..range.end);
        parts
    }

    /// The largest swing that is left out beside the free one, if there is one worth a look.
    pub(super) fn other_swing(&self, free: &Range<usize>) -> Option<Range<usize>> {
        let is_apart = |range: &Range<usize>| range.end <= free.start || range.start >= free.end;
        let others = self.stretches().into_iter().flat_map(|range| self.fading_parts(range)).filter(is_apart);
        let longest = others.max_by_key(|range| self.count_turns(range))?;
        (self.count_turns(&longest) >= WORTH_A_LOOK).then_some(longest)
    }

    /// Do the swings become smaller, as without a motor they must? From the first and the last third of many.
    pub(super) fn fades(&self, free: &Range<usize>) -> bool {
        let inside: Vec<f64> = self
            .turns
            .iter()
            .filter(|turn| free.contains(&self.recording.index_at(turn.time_s)))
            .map(|turn| turn.angle_rad)
            .collect();
        let mut sizes: Vec<f64> = inside.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
        let third = sizes.len() / 3;
        if third < FADING_SWINGS {
            return true;
        }
        let n_between = (sizes.len() - third) as f64;
        let late = median(&mut sizes.split_off(sizes.len() - third));
        let early = median(&mut sizes[..third]);
        (early / late).ln() > n_between * PI / (2.0 * BEST_QUALITY)
    }

    /// Hanging still at the end: from some half swings after the last motion that can be seen, because the very last
    /// ones may be smaller than the noise, or hidden in the play of the sensor.
    pub(super) fn rest(&self, stretch: &Range<usize>) -> Option<Range<usize>> {
        let last_turn_s = self
            .turns
            .iter()
            .rev()
            .map(|turn| turn.time_s)
            .find(|time_s| stretch.contains(&self.recording.index_at(*time_s)))?;
        let after = self.recording.index_at(last_turn_s)..stretch.end;
        let angles_rad = &self.angles_rad()[after.clone()];
        let n_window = self.n_in(self.half_swing_s / 4.0);
        let n_final = (4 * n_window).max(angles_rad.len() / 4).min(angles_rad.len());
        let final_rad = mean(&angles_rad[angles_rad.len() - n_final..]);
        let limit_rad = STILL_SPREADS * self.noise_rms_rad / (n_window as f64).sqrt();
        let moves = |window: &[f64]| (mean(window) - final_rad).abs() > limit_rad;
        let last_motion = angles_rad.windows(n_window).rposition(moves).map_or(0, |idx| idx + n_window);
        let start_s = self.times_s()[(after.start + last_motion).min(stretch.end - 1)] + N_UNSEEN * self.half_swing_s;
        let rest = self.recording.index_at(start_s)..stretch.end;
        (rest.start < rest.end && rest.len() >= n_window).then_some(rest)
    }
}
