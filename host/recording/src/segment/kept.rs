//! Whether what swings before and behind the free swing goes on as it does, from one half swing to the next.

use super::Cut;
use super::growth::FADING_SWINGS;
use super::half_swing::{HalfSwing, size_rad};
use std::ops::Range;

/// A half swing is like the one before it where it goes as far and takes as long to this share. Of 479 recordings of strangers, with
/// those whose file tells of a motor, four that motors drive were said to go on so; with half of it two of these, with twice of it a
/// fifth and one of a phone.
const ALIKE: f64 = 0.3;

impl Cut<'_> {
    /// What goes on like the free swing on both of its sides together, where that is longer than it. A release, a stop and a rest break
    /// it off.
    pub(super) fn swings_alike(&self, free: &Range<usize>) -> Option<Range<usize>> {
        let half_swings = self.half_swings_in(&self.asked);
        let start = |[from, _]: &HalfSwing| self.recording.index_at(from.time_s);
        let is_inside = |half_swing: &HalfSwing| free.contains(&start(half_swing));
        let (first, last) = (half_swings.iter().position(is_inside)?, half_swings.iter().rposition(is_inside)?);
        let n_before = half_swings[..=first].windows(2).rev().take_while(|pair| is_like(pair)).count();
        let n_behind = half_swings[last..].windows(2).take_while(|pair| is_like(pair)).count();
        let end = self.recording.index_at(half_swings[last + n_behind][1].time_s);
        let run = start(&half_swings[first - n_before])..end + 1;
        let is_longer = n_before + n_behind >= (last + 1 - first).max(2 * FADING_SWINGS);
        (is_longer && !self.is_switched_off_in(&run, free)).then_some(run)
    }

    /// Does the file tell what drives it there, or what it loses that a motor was switched off where the free swing begins?
    fn is_switched_off_in(&self, run: &Range<usize>, free: &Range<usize>) -> bool {
        let off = self.left_alone(run).start;
        let is_there = off > run.start && off.abs_diff(free.start) <= self.n_in(2.0 * self.half_swing_s);
        is_there || !self.driven_in_words(run).is_empty()
    }
}

/// Does the second follow the first at once, as far and in the same time?
fn is_like(pair: &[HalfSwing]) -> bool {
    let [before, after] = [&pair[0], &pair[1]];
    let duration_s = |[from, to]: &HalfSwing| to.time_s - from.time_s;
    let is_alike = |a: f64, b: f64| (b / a - 1.0).abs() < ALIKE;
    before[1].time_s == after[0].time_s
        && is_alike(size_rad(before), size_rad(after))
        && is_alike(duration_s(before), duration_s(after))
}

#[cfg(test)]
mod tests {
    use crate::Recording;
    use crate::segment::{SegmentOptions, segment};
    use std::f64::consts::TAU;

    fn doubts(seconds: u32, angle: impl Fn(f64) -> f64) -> Vec<String> {
        let readings = (0..seconds * 50).map(|idx| angle(f64::from(idx) / 50.0)).collect();
        let recording = Recording::uniform(50.0, readings).unwrap();
        let notes = segment(&recording, &SegmentOptions::default()).unwrap().notes;
        notes.into_iter().filter(|note| note.contains("it swings on")).collect()
    }

    /// A motor a little faster than the pendulum: it beats with what is left of its own swing, and one fall of that seems free.
    #[test]
    fn a_part_of_a_swing_that_a_motor_keeps_going_is_doubted() {
        let beating = |time_s: f64| (TAU * time_s / 1.5).sin() * (0.5 + 0.12 * (TAU * time_s / 20.0).cos());
        let said = doubts(300, beating);
        assert!(said.len() == 1 && said[0].contains("without dying away"), "{said:?}");
    }

    /// A stand that swings along takes a few per cent of each swing and gives them back.
    #[test]
    fn a_part_of_a_swing_that_something_swings_along_with_is_doubted_with_the_rest_of_it() {
        let shared = |time_s: f64| {
            let size = 0.5 * (-0.003 * time_s).exp() * (1.0 + 0.08 * (TAU * time_s / 16.0).cos());
            size * (TAU * time_s / 1.5).sin()
        };
        let said = doubts(180, shared);
        assert!(said.len() == 1 && said[0].contains("swings along") && said[0].contains("--from 0."), "{said:?}");
    }

    #[test]
    fn one_of_several_releases_is_not() {
        let released = |time_s: f64| {
            let since_s = time_s % 75.0;
            let swings_s = (since_s - 5.0).max(0.0);
            0.5 * (-0.02 * swings_s).exp() * (TAU * swings_s / 1.5).cos()
        };
        assert_eq!(doubts(300, released), Vec::<String>::new());
        let switched_off = |time_s: f64| 0.5 * (-0.03 * (time_s - 120.0).max(0.0)).exp() * (TAU * time_s / 1.5).cos();
        assert_eq!(doubts(180, switched_off), Vec::<String>::new());
        let free = |time_s: f64| 0.5 * (-0.01 * time_s).exp() * (TAU * time_s / 1.5).cos();
        assert_eq!(doubts(300, free), Vec::<String>::new());
    }
}
