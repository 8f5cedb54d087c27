//! Where it hangs still behind its swings, and where a hand takes it from there.

use super::start::BEGINS_TO_MOVE;
use super::{Cut, STILL_SPREADS, SURE, mean};
use crate::chance;
use crate::noise::rms_about_line;
use crate::turning::TurningPoint;
use std::ops::Range;

/// Half swings at the end that may be too small to be seen.
const N_UNSEEN: f64 = 3.0;

/// A hand that takes it from rest is seen by its acceleration within so many half swings of where it begins: with half and with
/// twice of it the same are cut of 264 simulated recordings, in 53 of which a hand takes it again.
const TAKEN_HALF_SWINGS: f64 = 2.0;

/// A swing that goes on turns again within one half swing; with twice of it the rest after a swing would often be lost.
const HUNG_HALF_SWINGS: f64 = 2.0;

/// And scatters by less than so many times the noise; with half of it chance would deny it, with twice of it a slow hand
/// would pass for it.
const HUNG_NOISES: f64 = 1.5;

impl Cut<'_> {
    /// Hanging still at the end: from some half swings after the last motion that can be seen, because the very last
    /// ones may be smaller than the noise, or hidden in the play of the sensor.
    pub(super) fn rest(&self, stretch: &Range<usize>) -> Option<Range<usize>> {
        self.still_after(self.last_motion(stretch)?.idx, N_UNSEEN, stretch.end)
    }

    /// The part at the end that tells of the noise: fewer may be unseen where each swing is so much smaller than the one before.
    pub(super) fn quiet_end(&self, stretch: &Range<usize>) -> Option<Range<usize>> {
        let last = self.last_motion(stretch)?;
        let n_unseen = self.lost_each_half_swing_rad(stretch).map_or(N_UNSEEN, |lost_rad| last.limit_rad / lost_rad);
        self.still_after(last.idx, n_unseen.min(N_UNSEEN), stretch.end)
    }

    fn still_after(&self, last_motion: usize, n_unseen: f64, end: usize) -> Option<Range<usize>> {
        let start_s = self.times_s()[last_motion] + n_unseen * self.half_swing_s;
        let still = self.recording.index_at(start_s)..end;
        (still.start < still.end && still.len() >= self.n_in(self.half_swing_s / 4.0)).then_some(still)
    }

    /// The last motion of a stretch that can be seen.
    fn last_motion(&self, stretch: &Range<usize>) -> Option<LastMotion> {
        let after = self.last_turn(stretch)?..stretch.end;
        let angles_rad = &self.angles_rad()[after.clone()];
        let n_window = self.n_in(self.half_swing_s / 4.0);
        let n_final = (4 * n_window).max(angles_rad.len() / 4).min(angles_rad.len());
        let final_rad = mean(&angles_rad[angles_rad.len() - n_final..]);
        // Among the windows of an hour some are further off by chance.
        let spreads = STILL_SPREADS.max(chance::reach((angles_rad.len() / n_window).max(1) as f64));
        let limit_rad = spreads * self.noise_rms_rad / (n_window as f64).sqrt();
        let moves = |window: &[f64]| (mean(window) - final_rad).abs() > limit_rad;
        let last_motion = angles_rad.windows(n_window).rposition(moves).map_or(0, |idx| idx + n_window);
        Some(LastMotion { idx: (after.start + last_motion).min(stretch.end - 1), limit_rad })
    }

    /// By how much the amplitude falls from one half swing to the next in the last ones of a stretch, if it does.
    fn lost_each_half_swing_rad(&self, stretch: &Range<usize>) -> Option<f64> {
        let turns = self.turns_in(stretch);
        let [.., a, b, c] = turns[..] else { return None };
        let ranges =
            [a, b, c].windows(2).map(|pair| (pair[1].angle_rad - pair[0].angle_rad).abs()).collect::<Vec<f64>>();
        // From one way to the next both ends come nearer.
        Some((ranges[0] - ranges[1]) / 2.0).filter(|lost_rad| *lost_rad > 0.0)
    }

    /// The sample at the last turning point of a stretch.
    fn last_turn(&self, stretch: &Range<usize>) -> Option<usize> {
        self.turns.iter().rev().map(|turn| self.recording.index_at(turn.time_s)).find(|idx| stretch.contains(idx))
    }

    /// Where a hand takes it that hung still: behind a last turn it is still for longer than a swing turns, and leaves that
    /// place just before something is seen to move it. A hand begins so gently that its acceleration shows late.
    pub(super) fn taken_from_rest(&self, stretch: &Range<usize>) -> Option<usize> {
        if stretch.end == self.asked.end {
            return None;
        }
        let is_further = |left_rad: f64, later_rad: Option<f64>| later_rad.is_none_or(|later| later / left_rad > 1.0);
        let still_behind = |turn: &&TurningPoint| {
            let hangs = self.recording.index_at(turn.time_s + N_UNSEEN * self.half_swing_s)..stretch.end;
            (hangs.len() > self.n_still_window()).then(|| self.still_from(hangs, is_further))
        };
        let is_near = |still: &Range<usize>| {
            let more_s = self.duration_s(&(still.end..stretch.end));
            still.end < stretch.end && more_s < TAKEN_HALF_SWINGS * self.half_swing_s
        };
        let is_long = |still: &Range<usize>| self.duration_s(still) > HUNG_HALF_SWINGS * self.half_swing_s;
        // Noise turns too: of what hangs still the last turn may be one of it.
        let turned = self.turns_in(stretch).into_iter().rev();
        let still = turned.filter_map(|turn| still_behind(&turn)).take_while(is_near).find(is_long)?;
        Some(still.end - self.n_in(BEGINS_TO_MOVE * self.half_swing_s).min(still.len()))
    }

    /// Did it hang still between its last turn and where it was pushed? That tells where it stopped.
    pub(super) fn hung(&self, between: &Range<usize>) -> bool {
        let third = between.len() / 3;
        let middle = &self.angles_rad()[between.start + third..between.end - third];
        self.duration_s(between) > HUNG_HALF_SWINGS * self.half_swing_s
            && rms_about_line(middle) < HUNG_NOISES * self.noise_rms_rad
            && (middle[0] - middle[middle.len() - 1]).abs() < SURE * self.noise_rms_rad
    }
}

/// Where motion is last seen.
struct LastMotion {
    idx: usize,
    /// How far means over a quarter of a half swing may be off where it hangs still, rad.
    limit_rad: f64,
}
