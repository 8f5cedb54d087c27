//! Where another swing begins behind a hole in the rows: whoever logs on demand writes one release behind the other.
//!
//! In: a stretch in which nothing is seen to touch the pendulum. Out: its parts between such holes. A swing that goes on
//! behind a hole is no larger than before it, and a law of the turning points before tells where it is, as in
//! [`interrupted`](super::interrupted).

use super::Cut;
use super::interrupted::Across;
use std::ops::Range;

/// Behind a hole it is off what the law says by more than this share of its amplitude (rms): two sines of one size are off by 0.9 of
/// it on an average over their phases. Half and twice were not tried …
const OFF_SHARE: f64 = 0.35;

/// … and by more than so many times what the law is off at most over as long a time without a hole, where that can be told. Half and
/// twice were not tried.
const OFF_TIMES: f64 = 2.0;

impl Cut<'_> {
    /// What lies between the holes behind which another swing begins, in order.
    pub(super) fn releases_in(&self, range: Range<usize>) -> Vec<Range<usize>> {
        let mut parts = Vec::new();
        let mut start = range.start;
        for behind in self.holes_in(&range) {
            if self.begins_anew(&(start..behind), &(behind..range.end)) {
                parts.push(start..behind);
                start = behind;
            }
        }
        parts.push(start..range.end);
        parts
    }

    /// The first samples behind holes in which a turn may be hidden.
    fn holes_in(&self, range: &Range<usize>) -> Vec<usize> {
        let gaps = self.recording.gaps().iter().filter(|gap| gap.to_s - gap.from_s >= self.hole_s());
        gaps.map(|gap| gap.after_idx + 1).filter(|idx| range.start < *idx && *idx < range.end).collect()
    }

    fn begins_anew(&self, before: &Range<usize>, behind: &Range<usize>) -> bool {
        let (last, first) = (self.half_swings_in(before).pop(), self.half_swings_in(behind).into_iter().next());
        let has_grown = last.zip(first).is_some_and(|(last, first)| self.growth(&last, &first).is_some());
        has_grown || self.is_elsewhere(before, behind)
    }

    /// Is it somewhere else behind the hole than where either side's law says?
    fn is_elsewhere(&self, before: &Range<usize>, behind: &Range<usize>) -> bool {
        let turned = |range: &Range<usize>| -> Vec<usize> {
            self.turns_in(range).iter().map(|turn| self.recording.index_at(turn.time_s)).collect()
        };
        let (mut before, behind) = (turned(before), turned(behind));
        let hole = match (before.last(), behind.first()) {
            (Some(last), Some(first)) => last + 1..*first,
            _ => return false,
        };
        before.reverse();
        let off = [self.off_across(&before, &behind, &hole), self.off_across(&behind, &before, &hole)];
        let is_off = |off: &Across| {
            off.rms_rad > OFF_SHARE * off.amplitude_rad
                && off.usual_rad.is_none_or(|usual| off.rms_rad > OFF_TIMES * usual)
        };
        let mut told = off.iter().flatten().peekable();
        told.peek().is_some() && told.all(is_off)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{STEP_S, moved_swing, noisy};
    use super::super::{SegmentOptions, free_swings};
    use crate::Recording;

    const FIRST_S: f64 = 12.0;

    /// The free stretches (s) of angles, with nothing written for some time behind the first [`FIRST_S`].
    fn with_hole(angles_rad: &[f64], hole_s: f64) -> Vec<[f64; 2]> {
        let written = noisy(angles_rad);
        let later = |time_s: &f64| if *time_s < FIRST_S { *time_s } else { time_s + hole_s };
        let times_s = written.times_s().iter().map(later).collect();
        let recording = Recording::new(written.header().clone(), times_s, written.angles_rad().to_vec(), None).unwrap();
        let swings = free_swings(&recording, &SegmentOptions::default()).unwrap();
        let free = |swing: super::super::FreeSwing| {
            let times_s = &swing.recording.times_s()[swing.segments.free];
            [times_s[0], times_s[times_s.len() - 1]]
        };
        swings.into_iter().map(free).collect()
    }

    #[test]
    fn another_release_behind_a_hole_begins_there() {
        let first = moved_swing(0.9, FIRST_S, |_| 0.0);
        for second_rad in [-0.8, 0.5] {
            let angles_rad = [first.clone(), moved_swing(second_rad, FIRST_S, |_| 0.0)].concat();
            for hole_s in [0.4, 1.0, 3.3, 10.0, 60.0] {
                let swings = with_hole(&angles_rad, hole_s);
                let [one, two] = &swings[..] else { panic!("{hole_s} {second_rad} {swings:?}") };
                assert!(one[0] < 0.1 && (FIRST_S - 0.1..FIRST_S).contains(&one[1]), "{hole_s} {one:?}");
                let begins_s = FIRST_S + hole_s;
                assert!((begins_s - STEP_S..begins_s + 0.1).contains(&two[0]), "{hole_s} {second_rad} {two:?}");
            }
        }
    }

    #[test]
    fn what_goes_on_behind_a_hole_is_one_swing() {
        let angles_rad = moved_swing(0.9, 40.0, |_| 0.0);
        for hole_s in [0.3, 0.7, 2.0, 5.0, 10.0] {
            let [before, behind] = [FIRST_S, FIRST_S + hole_s].map(|time_s| (time_s / STEP_S).round() as usize);
            let seen = [&angles_rad[..before], &angles_rad[behind..]].concat();
            let swings = with_hole(&seen, hole_s);
            assert!(swings.len() == 1 && swings[0][0] < 0.1 && swings[0][1] > 20.0, "{hole_s} {swings:?}");
        }
    }
}
