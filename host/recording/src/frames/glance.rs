//! A glance at a recording: may a frame be missing in it, or stand there twice?
//!
//! In: times (s) and readings. Out: no, where each reading moves on from the last one about as its neighbours do wherever
//! it is fast. A slip that is told is one that two readings show by five standard deviations, and their move is then a
//! frame's worth off; so that a look at windows of some periods, which takes a hundred times as long, would find none.

use super::{FAST, SEEN};
use std::f64::consts::SQRT_2;

/// Neighbours on either side reach so far, in periods: a sine is 4 % slower there.
const REACH: f64 = 1.0 / 12.0;

/// A move is even that differs from its neighbours' by less than this share of it: a slip is 1. Half of it is what a swing
/// of a dozen samples a period has by itself; twice of it is what noise of a fifth of a move makes of a slip once in a
/// hundred.
const EVEN: f64 = 0.3;

/// So much of what counts as fast is fast here, where fewer readings say so.
const NEARLY: f64 = 0.7;

/// `noise` is the rms of a reading's noise, `period` in samples.
pub(super) fn may_slip(times_s: &[f64], readings: &[f64], noise: f64, step_s: f64, period: f64) -> bool {
    let n_beside = ((period * REACH) as usize).max(1);
    let n_steps = |from: usize, to: usize| ((times_s[to] - times_s[from]) / step_s).round();
    let seen = |idx: usize| {
        let (first, last) = (idx - 1 - n_beside, idx + n_beside);
        let beside = readings[last] - readings[idx] + readings[idx - 1] - readings[first];
        Seen {
            is_next: n_steps(idx - 1, idx) == 1.0,
            moved: readings[idx] - readings[idx - 1],
            beside: beside / (n_steps(idx, last) + n_steps(first, idx - 1)),
        }
    };
    let seen: Vec<Seen> = (n_beside + 1..readings.len().saturating_sub(n_beside)).map(seen).collect();
    // What noise makes of the neighbours' moves, three times.
    let beyond_noise = (SEEN * SQRT_2 - 3.0 / n_beside as f64) * noise;
    let half_swing = (period / 2.0).ceil() as usize;
    seen.chunks(half_swing).any(|half| {
        let fastest = half.iter().map(|seen| seen.beside.abs()).fold(0.0, f64::max);
        // A slip moves a reading by one of these; in the rest of hours chance does so too.
        let shows = 2.0 * fastest > beyond_noise;
        shows && half.iter().any(|seen| seen.is_next && seen.is_fast(fastest) && seen.is_off(beyond_noise))
    })
}

/// A move from one reading to the next, and what the readings before and after it move in a step.
struct Seen {
    is_next: bool,
    moved: f64,
    beside: f64,
}

impl Seen {
    fn is_fast(&self, fastest: f64) -> bool {
        self.beside.abs() >= NEARLY * FAST * fastest
    }

    fn is_off(&self, beyond_noise: f64) -> bool {
        (self.moved - self.beside).abs() > beyond_noise.max(EVEN * self.beside.abs())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A decaying swing of 60 readings a period, which hangs still in the end, with noise of 1.
    fn swing() -> (Vec<f64>, Vec<f64>) {
        swing_of(3000)
    }

    fn swing_of(n_readings: u32) -> (Vec<f64>, Vec<f64>) {
        let mut state = 1_u64;
        let mut white = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let mut noise = || (0..12).map(|_| white()).sum::<f64>();
        let angle = |idx: f64| 400.0 * (-idx / 600.0).exp() * (idx * std::f64::consts::TAU / 60.0).cos();
        let angle = |idx: f64| if idx < 1995.0 { angle(idx) } else { 0.0 };
        let times_s: Vec<f64> = (0..n_readings).map(f64::from).collect();
        let readings = times_s.iter().map(|idx| angle(*idx) + noise()).collect();
        (times_s, readings)
    }

    #[test]
    fn chance_in_a_long_rest_is_no_slip() {
        let (times_s, readings) = swing_of(500_000);
        assert!(!is_seen(&times_s, &readings));
    }

    fn is_seen(times_s: &[f64], readings: &[f64]) -> bool {
        may_slip(times_s, readings, 1.0, 1.0, 60.0)
    }

    #[test]
    fn a_swing_in_noise_has_nothing_to_look_for_and_one_that_lacks_a_frame_has() {
        let (times_s, readings) = swing();
        assert!(!is_seen(&times_s, &readings));
        // It hangs every 30 readings, and moves by 27 a reading there.
        let missing: Vec<f64> = readings[..255].iter().chain(&readings[256..]).copied().collect();
        assert!(is_seen(&times_s[..2999], &missing));
        let mut doubled = readings;
        doubled.insert(255, doubled[254]);
        assert!(is_seen(&times_s, &doubled[..3000]));
    }

    #[test]
    fn a_frame_that_the_times_show_to_be_missing_is_none() {
        let (mut times_s, mut readings) = swing();
        times_s.remove(255);
        readings.remove(255);
        assert!(!is_seen(&times_s, &readings));
    }

    #[test]
    fn a_small_swing_is_measured_by_its_own_speed_and_a_push_where_it_turns_is_no_slip() {
        let (times_s, readings) = swing();
        // Late it moves by 10 a reading, a quarter of what it did in the beginning.
        let missing: Vec<f64> = readings[..855].iter().chain(&readings[856..]).copied().collect();
        assert!(is_seen(&times_s[..2999], &missing));
        let mut pushed = readings;
        pushed[270] += 20.0;
        assert!(!is_seen(&times_s, &pushed));
    }

    #[test]
    fn of_a_dozen_readings_a_period_one_that_is_missing_is_seen_beside_its_neighbours() {
        let times_s: Vec<f64> = (0..300).map(f64::from).collect();
        let readings: Vec<f64> = times_s.iter().map(|idx| 100.0 * (idx * std::f64::consts::TAU / 13.0).cos()).collect();
        assert!(!may_slip(&times_s, &readings, 0.1, 1.0, 13.0));
        // It hangs at 3.25 + 6.5·k: 101 lies a quarter of a reading beside it.
        let missing: Vec<f64> = readings[..101].iter().chain(&readings[102..]).copied().collect();
        assert!(may_slip(&times_s[..299], &missing, 0.1, 1.0, 13.0));
    }
}
