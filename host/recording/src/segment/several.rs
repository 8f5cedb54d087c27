//! Several free swings in one recording: it was released again and again, pushed meanwhile, or a tracker lost it and found it
//! somewhere else.
//!
//! In: a recording. Out: a recording of its own for each free swing in it, with what lies before it. Each then has a beginning
//! and a zero of its own, and what happened between them is not asked. The longest one is taken in any case; another one
//! where it falls as freely, is as long as several swings, and takes as long to and fro.

use super::super::{Measured, Recording};
use super::stretch::WORTH_A_LOOK;
use super::{SegmentError, SegmentOptions, Segments, segment};
use crate::plausible::Swings;
use std::borrow::Cow;
use std::ops::Range;

/// Swings to and fro that differ by no more than this share are of one pendulum. Those beside the longest one of six recordings
/// differ by 0.02 to 0.9 %, and of one by 1.3 % whose unit is said wrongly, which half of it would leave out; another one by 280 %,
/// so that twice of it tells the same.
const SAME_PERIOD: f64 = 0.02;

/// A part is the one that was looked for where so much of that is in it. Half and twice were not tried.
const SAME_PART: f64 = 0.8;

/// A free swing, what lies about it, and what it is cut from.
#[derive(Debug)]
pub struct FreeSwing<'a> {
    /// The recording, or its part.
    pub recording: Cow<'a, Recording>,
    /// What is what in it.
    pub segments: Segments,
}

impl FreeSwing<'_> {
    /// Does it swing freely then?
    fn is_at(&self, time_s: f64) -> bool {
        self.segments.free.contains(&self.recording.index_at(time_s)) && time_s >= self.recording.times_s()[0]
    }
}

/// Finds the free swings, in order of time; one alone where the user says where it lies.
///
/// # Errors
/// As [`segment`].
pub fn free_swings<'a>(recording: &'a Recording, options: &SegmentOptions) -> Result<Vec<FreeSwing<'a>>, SegmentError> {
    let whole = segment(recording, options)?;
    let found = several(recording, &whole).filter(|found| found.len() > 1);
    Ok(found.unwrap_or_else(|| vec![FreeSwing { recording: Cow::Borrowed(recording), segments: whole }]))
}

fn several<'a>(recording: &'a Recording, whole: &Segments) -> Option<Vec<FreeSwing<'a>>> {
    if whole.others.is_empty() || !whole.fades {
        return None;
    }
    let period_s = period_s(recording, &whole.free)?;
    let mut ranges = [&whole.others[..], std::slice::from_ref(&whole.free)].concat();
    ranges.sort_by_key(|range| range.start);
    // What is behind a swing, a rest perhaps, belongs to it, and what is before the next one to that, but for what lies behind a
    // hole in the rows that the next one begins with.
    let is_behind_hole = |idx: usize| recording.gaps().iter().any(|gap| gap.after_idx + 1 == idx);
    let parted = ranges.windows(2).map(|pair| if is_behind_hole(pair[1].start) { pair[1].start } else { pair[0].end });
    let ends = parted.clone().chain([recording.len()]);
    let begins = std::iter::once(0).chain(parted);
    let swing = |(begin, end): (usize, usize), wanted: &Range<usize>| {
        free_swing(recording, &(begin..end), wanted).filter(|swing| is_alike(swing, period_s))
    };
    let mut found: Vec<FreeSwing> =
        begins.zip(ends).zip(&ranges).filter_map(|(part, wanted)| swing(part, wanted)).collect();
    let middle_s = recording.times_s()[usize::midpoint(whole.free.start, whole.free.end)];
    let has_longest = found.iter().any(|swing| swing.is_at(middle_s));
    let n_samples: usize = found.iter().map(|swing| swing.segments.free.len()).sum();
    let note = in_words(&found, ranges.len() - found.len());
    for swing in &mut found {
        swing.recording.to_mut().notes.clear();
    }
    // Both what was known before and what is told of all stand with the first one.
    found.first_mut()?.recording.to_mut().notes = [&recording.notes[..], &[note]].concat();
    (has_longest && n_samples > whole.free.len()).then_some(found)
}

/// The free swing of a part, if it is the wanted one.
fn free_swing<'a>(recording: &Recording, part: &Range<usize>, wanted: &Range<usize>) -> Option<FreeSwing<'a>> {
    let part_of = recording.part(part.clone()).ok()?;
    let segments = segment(&part_of, &SegmentOptions::default()).ok()?;
    let end = segments.rest.as_ref().map_or(segments.free.end, |rest| rest.end) + part.start;
    let shared = end.min(wanted.end).saturating_sub(wanted.start.max(segments.free.start + part.start));
    let is_wanted = shared as f64 > SAME_PART * wanted.len() as f64;
    (is_wanted && segments.n_turning_points > WORTH_A_LOOK)
        .then_some(FreeSwing { recording: Cow::Owned(part_of), segments })
}

fn is_alike(swing: &FreeSwing, period_s: f64) -> bool {
    let other_s = self::period_s(&swing.recording, &swing.segments.free);
    log::debug!("another swing takes {other_s:?} s to and fro, the longest one {period_s} s");
    swing.segments.fades && other_s.is_some_and(|other_s| (other_s / period_s - 1.0).abs() < SAME_PERIOD)
}

/// The period that small swings have there, s.
fn period_s(recording: &Recording, free: &Range<usize>) -> Option<f64> {
    let swings = Swings::of(&recording.times_s()[free.clone()], &recording.angles_rad()[free.clone()])?;
    let swings = if recording.measured() == Measured::Rate { swings.in_angles() } else { swings };
    Some(swings.small_period_s())
}

fn in_words(found: &[FreeSwing], n_left: usize) -> String {
    let at = |FreeSwing { recording, segments }: &FreeSwing| {
        let [from_s, to_s] = [segments.free.start, segments.free.end - 1].map(|idx| recording.times_s()[idx]);
        format!("{from_s:.2} to {to_s:.2} s")
    };
    let listed: Vec<String> = found.iter().map(at).collect();
    let left = match n_left {
        0 => String::new(),
        n => format!("; {n} more that last longer to and fro, or shorter, or do not die away, are left out"),
    };
    format!(
        "{} free swings are in it, from {}: each is taken as a recording of its own; --from and --to choose one{left}",
        found.len(),
        listed.join(", from ")
    )
}

#[cfg(test)]
mod tests {
    use super::super::tests::{STEP_S, moved_swing, noisy};
    use super::*;

    fn found(angles_rad: &[f64]) -> Vec<(Range<f64>, Vec<String>)> {
        let recording = noisy(angles_rad);
        let swings = free_swings(&recording, &SegmentOptions::default()).unwrap();
        let told = |FreeSwing { recording, segments }: FreeSwing| {
            let times_s = recording.times_s();
            let notes = recording.notes().iter().chain(&segments.notes).cloned().collect();
            (times_s[segments.free.start]..times_s[segments.free.end - 1], notes)
        };
        swings.into_iter().map(told).collect()
    }

    /// A hand lifts it from where it hangs, and holds it.
    fn lift(angle_rad: f64) -> Vec<f64> {
        (0..400).map(|idx| angle_rad * f64::from(idx.min(300)) / 300.0).collect()
    }

    fn released(angle_rad: f64) -> Vec<f64> {
        [lift(angle_rad), moved_swing(angle_rad, 25.0, |_| 0.0)].concat()
    }

    #[test]
    fn each_release_of_a_recording_is_a_swing_of_its_own() {
        let swings = found(&[released(0.9), released(0.5), released(0.7)].concat());
        let each_s = 400.0 * STEP_S + 25.0;
        assert_eq!(swings.len(), 3, "{swings:?}");
        for (idx, (free_s, _)) in swings.iter().enumerate() {
            let release_s = idx as f64 * each_s + 400.0 * STEP_S;
            assert!((-0.05..0.5).contains(&(free_s.start - release_s)), "{free_s:?} {release_s}");
            assert!(free_s.end > release_s + 5.0 && free_s.end < release_s + 25.1, "{free_s:?}");
        }
        assert!(swings[0].1.iter().any(|note| note.starts_with("3 free swings are in it, from 2.")), "{swings:?}");
        assert!(swings.iter().all(|(_, notes)| notes.iter().all(|note| !note.contains("left out"))), "{swings:?}");
    }

    /// A tracker that slips, and a pendulum that is pushed.
    #[test]
    fn what_goes_on_behind_a_jump_of_the_zero_or_a_push_begins_anew() {
        let slipped: Vec<f64> = moved_swing(1.0, 30.0, |_| 0.0)
            .iter()
            .enumerate()
            .map(|(idx, angle)| angle + if idx < 2000 { 0.0 } else { 0.3 })
            .collect();
        let pushed = moved_swing(1.0, 30.0, |time_s| if (10.0..10.2).contains(&time_s) { 30.0 } else { 0.0 });
        for angles_rad in [slipped, pushed] {
            let swings = found(&angles_rad);
            let [(first, _), (second, _)] = &swings[..] else { panic!("{swings:?}") };
            assert!(first.start < 0.1 && (9.0..10.1).contains(&first.end), "{first:?}");
            assert!((9.9..11.0).contains(&second.start) && second.end > 20.0, "{second:?}");
        }
    }

    /// As where a weight was moved, and as where there is only one.
    #[test]
    fn another_pendulum_is_left_out_and_said() {
        let shorter: Vec<f64> =
            released(0.7).into_iter().enumerate().filter(|(idx, _)| idx % 20 != 0).map(|a| a.1).collect();
        let swings = found(&[released(0.9), shorter.clone()].concat());
        let [(free_s, notes)] = &swings[..] else { panic!("{swings:?}") };
        assert!(free_s.end < 27.1 && notes.iter().any(|note| note.contains("is left out")), "{notes:?}");
        assert_eq!(found(&released(0.9)).len(), 1);
        let swings = found(&[released(0.9), shorter, released(0.6)].concat());
        assert_eq!(swings.len(), 2, "{swings:?}");
        assert!(swings[0].1.iter().any(|note| note.contains("; 1 more that last longer")), "{swings:?}");
    }

    /// It has the same period, but too few turns to be taken.
    #[test]
    fn without_the_longest_one_nothing_is_parted() {
        let recording = noisy(&[released(0.9), released(0.5), released(0.7)].concat());
        let whole = segment(&recording, &SegmentOptions::default()).unwrap();
        assert_eq!(several(&recording, &whole).unwrap().len(), 3);
        let short = whole.free.start..whole.free.start + 500;
        let lost = Segments { free: short, ..whole };
        assert!(several(&recording, &lost).is_none());
    }

    #[test]
    fn who_says_where_the_swing_lies_gets_that_one() {
        let recording = noisy(&[released(0.9), released(0.5)].concat());
        let options = SegmentOptions { from_s: Some(3.0), to_s: None };
        let swings = free_swings(&recording, &options).unwrap();
        assert_eq!((swings.len(), swings[0].segments.free.start), (1, 600));
    }
}
