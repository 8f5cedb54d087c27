//! Whole turns between releases of one recording: somebody turned the pendulum round while nothing was logged.
//!
//! In: times and angles in rad. Out: the same with each run of rows, from one hole to the next, hanging where the first one
//! hangs. Gravity knows no turns, so that nothing else changes by it.

use super::plausible::Swings;
use super::{GAP_STEPS, median_step_s};
use std::f64::consts::{PI, TAU};
use std::ops::Range;

/// A run that swings further than this to either side of where it hangs goes round, and where it hangs is not known, rad.
const LARGEST_RAD: f64 = PI;

/// So near to whole turns, rad: zeros of two releases of one encoder were seen to differ by 0.04. Half and twice were not tried.
const NEAR_RAD: f64 = 0.2;

/// A hole as long as this part of a period hides where it went.
const HIDING_PERIODS: f64 = 0.5;

/// Takes whole turns off and says behind how many holes.
pub(super) fn take_off(times_s: &[f64], angles_rad: &mut [f64]) -> usize {
    let Some(swings) = Swings::of(times_s, angles_rad) else { return 0 };
    let runs = runs(times_s, HIDING_PERIODS * swings.period_s);
    let told: Vec<Option<Swings>> =
        runs.iter().map(|run| Swings::of(&times_s[run.clone()], &angles_rad[run.clone()])).collect();
    let Some(first_rad) = told.iter().flatten().next().map(|swings| swings.middle_rad) else { return 0 };
    let told_rad: Vec<Option<f64>> =
        told.iter().map(|swings| swings.as_ref().map(|swings| turns_off(swings, first_rad))).collect();
    let turns_rad: Vec<f64> = (0..runs.len()).map(|idx| nearest(times_s, &runs, &told_rad, idx)).collect();
    for (run, turns_rad) in runs.into_iter().zip(&turns_rad) {
        angles_rad[run].iter_mut().for_each(|angle| *angle -= turns_rad);
    }
    turns_rad.windows(2).filter(|pair| pair[0] != pair[1]).count()
}

/// Rows between holes.
fn runs(times_s: &[f64], hole_s: f64) -> Vec<Range<usize>> {
    let hole_s = hole_s.max(GAP_STEPS * median_step_s(times_s));
    let holes = (1..times_s.len()).filter(|idx| times_s[*idx] - times_s[*idx - 1] > hole_s);
    let ends: Vec<usize> = holes.chain([times_s.len()]).collect();
    std::iter::once(0).chain(ends.iter().copied()).zip(&ends).map(|(begin, end)| begin..*end).collect()
}

/// The turns of a run, or where it is too short to tell, of the nearest one in time that does.
fn nearest(times_s: &[f64], runs: &[Range<usize>], told_rad: &[Option<f64>], idx: usize) -> f64 {
    let away_s = |other: usize| match other < idx {
        true => times_s[runs[idx].start] - times_s[runs[other].end - 1],
        false if other == idx => 0.0,
        false => times_s[runs[other].start] - times_s[runs[idx].end - 1],
    };
    let others = (0..runs.len()).filter_map(|other| told_rad[other].map(|turns_rad| (away_s(other), turns_rad)));
    others.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0.0, |(_, turns_rad)| turns_rad)
}

/// Whole turns between where it hangs and where it hung at first, rad; none where it is no such number.
fn turns_off(swings: &Swings, first_rad: f64) -> f64 {
    let off_rad = swings.middle_rad - first_rad;
    let turns_rad = (off_rad / TAU).round() * TAU;
    let is_whole = (off_rad - turns_rad).abs() < NEAR_RAD && swings.largest_rad < LARGEST_RAD;
    if is_whole { turns_rad } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two runs of 10 s, with a hole between them, about these angles (rad).
    fn hanging_at(rad: [f64; 2], amplitude_rad: f64) -> (Vec<f64>, Vec<f64>) {
        let run = |(begins_s, middle_rad): (f64, f64)| {
            (0..1000).map(move |idx| {
                let time_s = 0.01 * f64::from(idx);
                let swing = amplitude_rad * (-0.05 * time_s).exp() * (5.0 * time_s).cos();
                (begins_s + time_s, middle_rad + swing)
            })
        };
        [0.0, 15.0].into_iter().zip(rad).flat_map(run).unzip()
    }

    #[test]
    fn a_release_that_hangs_whole_turns_away_hangs_where_the_first_one_does() {
        let (times_s, mut angles_rad) = hanging_at([0.01, 0.02 - 2.0 * TAU], 1.5);
        assert_eq!(take_off(&times_s, &mut angles_rad), 1);
        let (_, truth) = hanging_at([0.01, 0.02], 1.5);
        assert!(angles_rad.iter().zip(&truth).all(|(found, truth)| (found - truth).abs() < 1e-12));
    }

    #[test]
    fn what_is_no_whole_turn_away_or_goes_round_stays() {
        for (rad, amplitude_rad) in [([0.0, 1.0], 1.5), ([0.0, 0.3], 1.5), ([0.0, TAU], 4.0)] {
            let (times_s, mut angles_rad) = hanging_at(rad, amplitude_rad);
            let before = angles_rad.clone();
            assert_eq!((take_off(&times_s, &mut angles_rad), angles_rad == before), (0, true), "{rad:?}");
        }
    }
}
