//! A reading that is written on and on at the end, while the pendulum still swung: the sensor, its wire or the program that
//! asked it stood still. Whoever takes that for a rest finds friction that holds the pendulum far from where it hangs.
//!
//! In: times and readings in any unit. Out: from which one on all are the same, and whether it was on its way there. What comes to
//! rest by friction has lost its speed by then; a hand takes it within a few samples, which bend the curve. Where it may have
//! turned, only that noise ends with it tells; of a tracker, which follows nothing that rests, it does so too.

use super::noise::{self, robust_spread, smallest_step};
use super::smooth::LocalFit;
use super::spikes::LEAST_SHARE;
use super::turning;
use super::{GAP_STEPS, median_step_s};
use std::f64::consts::PI;

/// It would have gone on by so many steps of the sensor: within them a small swing may come to rest unseen. Half and twice were not
/// tried.
const STEPS: f64 = 4.0;

/// … by so many standard deviations of that. Half and twice were not tried.
const SURE: f64 = 8.0;

/// … and by this share of its last half swing: a parabola through the end of one that stops is off by a tenth of it. A reading that
/// stood still within 14° of the phase where it turned can't be told from a rest; with twice of it 30°, with half of it 7°.
const OF_THE_SWING: f64 = 0.25;

/// Noise of so many steps that ends is worth a word: less may lie between two steps. Of 960 files of strangers six get it. Half and
/// twice were not tried.
const NOISE_STEPS: f64 = 2.0;

/// Noise of this share of the range, or what differences leave of a swing without any. Half and twice were not tried.
const SIMULATED: f64 = 1e-4;

/// The speed is that at the end of so much of a half swing. Half and twice were not tried.
const BEFORE: f64 = 0.25;

/// Fewer readings are no standstill.
const FEWEST: usize = 3;

/// It stays the same for so much of one, or it would be a turning point. Half and twice were not tried.
const LEAST: f64 = 0.5;

/// Equal readings at the end.
#[derive(Debug, PartialEq)]
pub(super) struct Standstill {
    /// The first of them.
    pub(super) first: usize,
    pub(super) what: What,
}

#[derive(Debug, PartialEq)]
pub(super) enum What {
    /// It still moved.
    Stuck,
    /// It may rest, though its noise ends too.
    Silent,
}

/// What the equal readings at the end are; `None` where there are none, or where they may well be a rest.
pub(super) fn standstill(times: &[f64], readings: &[f64]) -> Option<Standstill> {
    let last = *readings.last()?;
    let first = readings.iter().rposition(|reading| *reading != last)? + 1;
    if readings.len() - first < FEWEST {
        return None;
    }
    let (times_before, before) = (&times[..=first], &readings[..=first]);
    let noise = usual_noise(before);
    let half_swing = turning::half_swing_s(times_before, before, noise)?;
    if times[readings.len() - 1] - times[first] < LEAST * half_swing {
        return None;
    }
    let end = LocalFit::<3>::new(times_before, before, times[first], BEFORE * half_swing)?;
    // How far it would have gone, if nothing but gravity had been there.
    let of_speed = |speed: f64| speed * half_swing / PI;
    let last_swing = &before[times_before.partition_point(|time| *time < times[first] - half_swing)..];
    // Where the angle begins anew it goes far in no time.
    if last_swing.windows(2).any(|pair| (pair[1] - pair[0]).abs() > range(before) / 2.0) {
        return None;
    }
    let step = smallest_step(readings).unwrap_or(0.0);
    let of_the_swing = OF_THE_SWING * range(last_swing) / 2.0;
    // What rests may be shaken a little.
    let least = (STEPS * step).max(LEAST_SHARE * range(before));
    let limit = least.max(SURE * of_speed(end.velocity_spread()) * noise).max(of_the_swing);
    let is_whole = times[first] - times[first - 1] < GAP_STEPS * median_step_s(times);
    match of_speed(end.velocity_rad_s()).abs() > limit && is_whole {
        true => Some(Standstill { first, what: What::Stuck }),
        false => {
            let noise = noise::of_samples(times_before, before, None).total_rms;
            let is_there = noise > (NOISE_STEPS * step).max(SIMULATED * range(before));
            is_there.then_some(Standstill { first, what: What::Silent })
        }
    }
}

fn range(readings: &[f64]) -> f64 {
    let (low, high) = readings.iter().fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
    high - low
}

/// Of neighbours, by second differences, rounding among it.
fn usual_noise(readings: &[f64]) -> f64 {
    let bends: Vec<f64> = readings.windows(3).map(|window| window[0] - 2.0 * window[1] + window[2]).collect();
    let rounded = smallest_step(readings).unwrap_or(0.0) / 12_f64.sqrt();
    (robust_spread(&bends) / 6_f64.sqrt()).max(rounded)
}

/// What is said of it.
pub(super) fn note(found: &Standstill, times_s: &[f64]) -> String {
    let (from_s, last_s) = (times_s[found.first], times_s[times_s.len() - 1]);
    let same = format!("the last {:.2} s repeat one reading to the last digit", last_s - from_s);
    match found.what {
        What::Stuck => format!(
            "{same}, from {from_s:.3} s on, where it still moved: the sensor or the program that asked it stood still; left out"
        ),
        What::Silent => format!(
            "{same}, without the noise that is there before: if the sensor stood still, and not the pendulum, Ms is too large, and \
             --to {from_s:.2} leaves it out"
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::super::spikes::tests::swing;
    use super::*;

    #[test]
    fn a_reading_that_stands_still_on_its_way_is_no_rest() {
        let found = |from: usize| {
            let (times, mut readings) = swing();
            let last = readings[from];
            readings[from..].fill(last);
            standstill(&times, &readings).filter(|found| found.what == What::Stuck).map(|found| found.first)
        };
        assert_eq!([705, 919, 1010].map(found), [Some(705), Some(919), Some(1010)]);
        // Where it turns nobody knows, and a few readings are none.
        assert_eq!([1197, 1199].map(found), [None; 2]);
        let turns = (700..760).filter(|from| found(*from).is_none()).count();
        assert!((4..20).contains(&turns), "{turns}");
        let (times, mut readings) = swing();
        readings[721..].fill(0.44);
        assert_eq!(standstill(&times, &readings), Some(Standstill { first: 721, what: What::Silent }));
    }

    /// Angles at 100 Hz of a pendulum of 1 s that dry friction stops, which slows it by so many rad/s².
    fn stopped(dry_rad_s2: f64) -> Vec<f64> {
        let (mut angle, mut speed, step_s) = (1.2_f64, 0.0_f64, 1e-4);
        let mut moved = |_| {
            for _ in 0..100 {
                let gravity = -39.5 * angle.sin();
                let is_held = speed == 0.0 && gravity.abs() < dry_rad_s2;
                let drive = if speed == 0.0 { gravity } else { speed };
                let next = if is_held { 0.0 } else { speed + step_s * (gravity - dry_rad_s2 * drive.signum()) };
                speed = if next * speed < 0.0 { 0.0 } else { next };
                angle += step_s * speed;
            }
            angle
        };
        (0..6000).map(&mut moved).collect()
    }

    #[test]
    fn what_friction_stops_is_at_rest_however_coarse_the_sensor() {
        let times: Vec<f64> = (1..=6000_u32).map(|idx| f64::from(idx) / 100.0).collect();
        for dry_rad_s2 in [0.2, 1.0, 3.0, 8.0, 15.0] {
            for step in [0.0, 1e-3, 6e-3, 0.03] {
                let rounded = |angle: f64| if step > 0.0 { (angle / step).round() * step } else { angle };
                let readings: Vec<f64> = stopped(dry_rad_s2).into_iter().map(rounded).collect();
                let n_same = readings.iter().rev().take_while(|reading| **reading == readings[5999]).count();
                assert!(n_same > 300 && standstill(&times, &readings).is_none(), "{dry_rad_s2} {step} {n_same}");
            }
        }
    }
}
