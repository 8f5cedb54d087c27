//! Where readings leave the swing for a while and the same swing goes on behind: a tracker that lost its marker, somebody who
//! walked through the picture, a sensor that was disturbed. What moved the pendulum itself would have changed its swing.
//!
//! In: the disturbances of a cut. Out: those that are none of the pendulum, as ranges of samples to leave out. As in
//! [`backwards`](super::backwards) a law is fitted to two swings on the one side and followed through the disturbance into the half
//! swing on its other side; how far off it may be there, the same law says of as long a time where nothing is disturbed.

use super::Cut;
use super::backwards::{FEWEST_USUAL, FITTED, MOST_USUAL};
use std::ops::Range;

// What half and twice of a constant would do was seen on 80 simulated swings with readings of something else for 0.1 to 0.7 s, of
// which 68 are gaps with these numbers, and on 100 more that were pushed meanwhile by 0.08 to 1.2 rad/s, of which none is.

/// A disturbance is no longer than so many half swings. With half of it 53 are gaps, twice of it
/// changes nothing.
const LONGEST_HALF_SWINGS: f64 = 4.0;

/// Those that come again within so many half swings are of the pendulum, or of one that is held. With half of it 4 of 80 are told as
/// two, twice of it changes nothing.
const APART_HALF_SWINGS: f64 = 3.0;

/// Behind it the swing is off no more than so many times what it is off elsewhere at most: with half of it about half as many are
/// gaps, with twice of it 2 of 20 are that were pushed by 0.08 rad/s …
const OFF_TIMES: f64 = 1.5;

/// … nor by more than this share of its amplitude (rms). With half of it 58 are gaps, with twice of it
/// 76, and 3 of 20 that were pushed by 0.08 rad/s.
const OFF_SHARE: f64 = 0.04;

/// How a law of one side does on the other one.
pub(super) struct Across {
    /// How far the half swing there is off it, rms, rad.
    pub(super) rms_rad: f64,
    /// How far it is off at most over as long a time where nothing is lost, rad, if that can be told.
    pub(super) usual_rad: Option<f64>,
    /// Of that half swing.
    pub(super) amplitude_rad: f64,
}

impl Cut<'_> {
    /// Those that lie in a part, with what of them may lie beside it.
    pub(super) fn interrupted_within(&self, free: &Range<usize>) -> Vec<Range<usize>> {
        let touches = |lost: &&Range<usize>| lost.start < free.end && free.start < lost.end;
        self.interrupted.iter().filter(touches).cloned().collect()
    }

    /// Takes back the disturbances behind which the same swing goes on, and says which samples they spoil.
    pub(super) fn forgive_interruptions(&mut self) -> Vec<Range<usize>> {
        let runs = self.disturbed_runs();
        let found: Vec<_> = runs.into_iter().filter(|run| self.is_interruption(&self.spoilt(run))).collect();
        let lost: Vec<Range<usize>> = found.iter().map(|run| self.spoilt(run)).collect();
        found.into_iter().for_each(|run| self.disturbed[run].fill(false));
        let recording = self.recording;
        self.turns.retain(|turn| !lost.iter().any(|lost| lost.contains(&recording.index_at(turn.time_s))));
        lost
    }

    /// Ranges of disturbed states, together with what is between two that are near each other.
    fn disturbed_runs(&self) -> Vec<Range<usize>> {
        let near_s = APART_HALF_SWINGS * self.half_swing_s;
        let mut runs: Vec<Range<usize>> = Vec::new();
        for idx in (0..self.disturbed.len()).filter(|idx| self.disturbed[*idx]) {
            match runs.last_mut() {
                Some(last) if self.states[idx].time_s - self.states[last.end - 1].time_s < near_s => last.end = idx + 1,
                _ => runs.push(idx..idx + 1),
            }
        }
        runs
    }

    /// The samples that a range of states is about.
    fn spoilt(&self, run: &Range<usize>) -> Range<usize> {
        let beside_s = self.width_s / 2.0;
        let at = |state_idx: usize, more_s: f64| self.recording.index_at(self.states[state_idx].time_s + more_s);
        at(run.start, -beside_s)..at(run.end - 1, beside_s).min(self.asked.end)
    }

    /// Does the same swing go on behind? As far as each side can tell.
    fn is_interruption(&self, lost: &Range<usize>) -> bool {
        let indices: Vec<usize> = self.turns.iter().map(|turn| self.recording.index_at(turn.time_s)).collect();
        let before: Vec<usize> = indices.iter().copied().filter(|idx| *idx < lost.start).rev().collect();
        let behind: Vec<usize> = indices.into_iter().filter(|idx| *idx >= lost.end).collect();
        if self.duration_s(lost) > LONGEST_HALF_SWINGS * self.half_swing_s {
            return false;
        }
        let told = [self.goes_on(&before, &behind, lost), self.goes_on(&behind, &before, lost)];
        told.contains(&Some(true)) && !told.contains(&Some(false))
    }

    /// Whether a law of the turning points on the one side tells the nearest half swing on the other one; `None` where there is
    /// too little to tell.
    fn goes_on(&self, known: &[usize], asked: &[usize], lost: &Range<usize>) -> Option<bool> {
        let across = self.off_across(known, asked, lost)?;
        let most_rad = OFF_TIMES * across.usual_rad?;
        Some(across.rms_rad < most_rad && across.rms_rad < OFF_SHARE * across.amplitude_rad)
    }

    /// How far the nearest half swing on one side is off a law of the turning points on the other one, both as they follow from
    /// what is lost on; `None` where there is too little to tell.
    pub(super) fn off_across(&self, known: &[usize], asked: &[usize], lost: &Range<usize>) -> Option<Across> {
        let [near, far] = *asked.get(..2)? else { return None };
        let first = *known.first()?;
        let between = |a: usize, b: usize| a.min(b)..a.max(b);
        let off_s = |idx: usize| self.times_s()[idx] - self.times_s()[first];
        let is_apart = |range: &Range<usize>| range.end < lost.start || range.start >= lost.end;
        let off_of = |look: usize| {
            let fitted = between(*known.get(look)?, *known.get(look + FITTED)?);
            let from_s = self.times_s()[known[look]];
            let looked = between(self.index_within(from_s + off_s(near))?, self.index_within(from_s + off_s(far))?);
            (look == 0 || is_apart(&looked)).then(|| self.off_beside(looked, fitted))
        };
        let rms_rad = off_of(0).filter(|off| off.is_finite())?;
        let usual: Vec<f64> =
            (1..known.len()).filter_map(off_of).filter(|off| off.is_finite()).take(MOST_USUAL).collect();
        let is_known = usual.len() >= FEWEST_USUAL;
        Some(Across {
            rms_rad,
            usual_rad: is_known.then(|| usual.into_iter().fold(0.0, f64::max)),
            amplitude_rad: (self.angles_rad()[far] - self.angles_rad()[near]).abs() / 2.0,
        })
    }

    pub(super) fn index_within(&self, time_s: f64) -> Option<usize> {
        let idx = self.recording.index_at(time_s);
        self.asked.contains(&idx).then_some(idx)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{STEP_S, find, moved_swing};
    use std::ops::Range;

    /// With readings of something else for some time (s).
    fn seen(angles_rad: &[f64], elsewhere_s: &Range<f64>, reading: impl Fn(f64) -> f64) -> Vec<f64> {
        let seen = |(idx, angle): (usize, &f64)| match idx as f64 * STEP_S {
            time_s if elsewhere_s.contains(&time_s) => reading(time_s),
            _ => *angle,
        };
        angles_rad.iter().enumerate().map(seen).collect()
    }

    #[test]
    fn what_leaves_the_swing_that_goes_on_behind_is_a_gap() {
        let free = moved_swing(0.8, 20.0, |_| 0.0);
        for (from_s, length_s) in [(3.0, 0.1), (4.1, 0.25), (7.07, 0.4), (12.0, 0.6)] {
            for reading in [|_: f64| 0.5, |time_s: f64| 0.3 * time_s - 3.0, |time_s: f64| 0.2 * (20.0 * time_s).sin()] {
                let elsewhere_s = from_s..from_s + length_s;
                let segments = find(&seen(&free, &elsewhere_s, reading));
                assert!(segments.free == (0..free.len()) || segments.rest.is_some(), "{elsewhere_s:?} {segments:?}");
                let [lost] = &segments.interrupted[..] else { panic!("{elsewhere_s:?} {segments:?}") };
                let lost_s = lost.start as f64 * STEP_S..lost.end as f64 * STEP_S;
                let beside_s = 0.12;
                assert!(
                    lost_s.start < from_s + STEP_S && lost_s.start > from_s - beside_s,
                    "{elsewhere_s:?} {lost_s:?}"
                );
                assert!(
                    lost_s.end > elsewhere_s.end - STEP_S && lost_s.end < elsewhere_s.end + beside_s,
                    "{elsewhere_s:?} {lost_s:?}"
                );
            }
        }
    }

    #[test]
    fn what_changes_the_swing_while_it_is_not_seen_is_no_gap() {
        for push_rad_s2 in [-3.0, -1.0, 1.0, 3.0] {
            let pushed = moved_swing(0.8, 20.0, |time_s| if (8.0..8.4).contains(&time_s) { push_rad_s2 } else { 0.0 });
            let segments = find(&seen(&pushed, &(8.0..8.4), |_| 0.5));
            assert!(
                segments.interrupted.is_empty() && segments.free.len() < pushed.len() * 2 / 3,
                "{push_rad_s2} {segments:?}"
            );
        }
    }
}
