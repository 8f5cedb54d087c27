//! Recordings that do not fit the model at all: what is the most likely reason?
//!
//! The first swings are tried again with other units, another zero, another inertia; what then follows the model is
//! the reason. A pendulum that gains energy is driven.

use super::follow::follow;
use super::halves::Halves;
use super::recording::{Judged, explained};
use crate::fit::descent::{Tolerance, descend};
use crate::fit::linear::Steps;
use crate::fit::problem::{Problem, Unknown};
use crate::fit::start;
use crate::fit::tally::Tally;
use crate::recording::turning::half_swing_s;
use crate::swing::zero::within_half_a_turn;
use crate::swing::{Swing, Window};
use serde::Serialize;
use shared::parameters::Parameters;
use std::f64::consts::{PI, TAU};

/// Below this share of the motion explained, the recording does not fit the model at all.
pub const HOPELESS: f64 = 0.7;

/// A reason explains at least this share of the first swings.
const EXPLAINS: f64 = 0.9;

/// The first swings: so many half swings.
const FIRST_HALF_SWINGS: f64 = 7.0;

/// Nothing on a bench swings so slowly that they take longer than this, s.
const SLOWEST_S: f64 = 60.0;

/// A zero beyond this lies nearer to the top than to the hanging position, rad.
const UPSIDE_DOWN_RAD: f64 = PI / 2.0;

/// A gain of energy counts from so many standard errors on …
const GAIN_SIGNIFICANT: f64 = 6.0;

/// … and swings that gained some make a driven pendulum from this share on.
const DRIVEN_SHARE: f64 = 0.2;

/// A recording that does not fit, and why.
#[derive(Clone, Debug, Serialize)]
pub struct Mismatch {
    /// The recording.
    pub recording: String,
    /// Share of the motion that the model explains.
    pub explained: f64,
    /// The most likely reason, in words.
    pub reason: String,
    /// Do the first swings follow the model? Then a fit may help.
    #[serde(skip)]
    pub begins_well: bool,
}

impl Mismatch {
    /// A swing that does not follow the model.
    pub fn of(swing: &Swing, parameters: &Parameters<f64>, judged: &Judged) -> Self {
        let begins_well = first_explained(swing, parameters) > EXPLAINS;
        let reason = reason(swing, parameters, judged, begins_well);
        Self { recording: judged.name.clone(), explained: judged.verdict.explained, reason, begins_well }
    }
}

/// Another way to read a recording.
struct Reading {
    scale: f64,
    shift_rad: f64,
    clock: f64,
    words: &'static str,
}

const READINGS: &[Reading] = &[
    Reading { scale: PI / 180.0, shift_rad: 0.0, clock: 1.0, words: "the angles seem to be in degrees (--degrees)" },
    Reading {
        scale: 180.0 / PI,
        shift_rad: 0.0,
        clock: 1.0,
        words: "the angles seem to have been converted from degrees twice: they are 57.3 times too small",
    },
    Reading {
        scale: TAU, shift_rad: 0.0, clock: 1.0, words: "the angles seem to be in turns: a factor 2π is missing"
    },
    Reading { scale: 1.0 / TAU, shift_rad: 0.0, clock: 1.0, words: "the angles seem to be 2π times too large" },
    Reading { scale: 1.0, shift_rad: 0.0, clock: 1e-3, words: "the times seem to be in milliseconds" },
    Reading { scale: 1.0, shift_rad: 0.0, clock: 1e3, words: "the times seem to be 1000 times too short" },
];

/// Is the sensor's zero so far off that the recording must stand on its head?
pub fn is_upside_down(offset_rad: f64) -> bool {
    within_half_a_turn(offset_rad).abs() > UPSIDE_DOWN_RAD
}

/// The most likely reason why a swing does not follow the model.
fn reason(swing: &Swing, parameters: &Parameters<f64>, judged: &Judged, begins_well: bool) -> String {
    let offset_rad = judged.start.offset_rad;
    if judged.verdict.explained > HOPELESS && is_upside_down(offset_rad) {
        let change = if within_half_a_turn(offset_rad) > 0.0 { "subtract π" } else { "add π" };
        return format!("the zero seems to be at the top: 0 must be the hanging pendulum ({change})");
    }
    if swing.is_driven || is_driven(&judged.measured) {
        return "the pendulum gets energy on the way: it is driven, or a hand is on it".to_owned();
    }
    if begins_well {
        return "the first swings follow the model, later ones do not: friction differs much from the model's; \
                fit these recordings first (host fit)"
            .to_owned();
    }
    let reads = |reading: &&Reading| first_explained(&read_as(swing, reading), parameters) > EXPLAINS;
    if let Some(reading) = READINGS.iter().find(reads) {
        return reading.words.to_owned();
    }
    match other_inertia(swing, parameters) {
        Some(ratio) => format!(
            "it swings like another pendulum: the moment of inertia about the pivot would have to be {ratio:.2} times \
             the model's; check mass, length and inertia"
        ),
        None => {
            "no other unit, zero or inertia helps: another pendulum, a driven one, or one that was touched".to_owned()
        }
    }
}

fn is_driven(measured: &Halves) -> bool {
    let losses = measured.losses();
    let gains = losses.iter().filter(|loss| loss.loss_nm < -GAIN_SIGNIFICANT * loss.spread_nm).count();
    losses.len() >= 3 && gains as f64 > DRIVEN_SHARE * losses.len() as f64
}

fn first_explained(swing: &Swing, parameters: &Parameters<f64>) -> f64 {
    let first = first_part(swing);
    if first.duration_s() > SLOWEST_S {
        return 0.0;
    }
    explained(&first.angles_rad, &follow(&first, parameters).residuals_rad)
}

/// The first swings.
fn first_part(swing: &Swing) -> Swing {
    read_as(swing, &AS_IT_IS)
}

const AS_IT_IS: Reading = Reading { scale: 1.0, shift_rad: 0.0, clock: 1.0, words: "" };

/// The first swings, read in another way.
fn read_as(swing: &Swing, reading: &Reading) -> Swing {
    let half_swing_s = half_swing_s(&swing.times_s, &swing.angles_rad, swing.noise_rad).unwrap_or(swing.duration_s());
    let first_s = FIRST_HALF_SWINGS * half_swing_s;
    let end = swing.times_s.partition_point(|t| *t <= first_s).clamp(3.min(swing.len()), swing.len());
    let times_s: Vec<f64> = swing.times_s[..end].iter().map(|t| t * reading.clock).collect();
    let angle = |angle: &f64| angle * reading.scale + reading.shift_rad;
    let angles_rad: Vec<f64> = swing.angles_rad[..end].iter().map(angle).collect();
    let mut read = swing.like(&times_s, &angles_rad);
    read.noise_rad *= reading.scale;
    read
}

/// Ratio of the moment about the pivot that follows the first swings to the model's, if one does.
fn other_inertia(swing: &Swing, parameters: &Parameters<f64>) -> Option<f64> {
    let first = first_part(swing);
    if first.duration_s() > SLOWEST_S {
        return None;
    }
    let count = Tally::default();
    let problem = Problem::new(std::slice::from_ref(&first), parameters, vec![Unknown::inertia(parameters)], &count);
    let guess = start::guess(&problem);
    let end = descend(&problem, &guess, Window::Whole, Tolerance::FINE, Steps::new(&problem));
    let changed = problem.parameters(&end.point.values);
    let ratio = changed.pendulum.pivot_inertia_kg_m2() / parameters.pendulum.pivot_inertia_kg_m2();
    (first_explained(&first, &changed) > EXPLAINS).then_some(ratio)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::halves::HalfSwing;

    /// So many swings there and back, a half swing loses so much.
    fn swings(n_swings: u32, lost_j: f64) -> Halves {
        let half = |k: u32| HalfSwing {
            from_s: f64::from(k),
            to_s: f64::from(k + 1),
            amplitude_rad: 0.5,
            is_rising: k.is_multiple_of(2),
            lost_j,
            loss_nm: lost_j,
            loss_spread_nm: 1e-5,
        };
        Halves { halves: (0..2 * n_swings).map(half).collect(), periods: Vec::new() }
    }

    #[test]
    fn a_pendulum_is_driven_if_some_of_at_least_three_swings_gained_energy() {
        let driven = |n_swings: u32, lost_j: f64| is_driven(&swings(n_swings, lost_j));
        assert!(driven(3, -1e-3) && driven(10, -1e-3));
        assert!(!driven(2, -1e-3) && !driven(10, 1e-3) && !driven(10, -1e-5));
        // One of five is not more than a fifth.
        let with_gains = |n_gains: usize| {
            let mut halves = swings(5, 1e-3);
            halves.halves[..2 * n_gains].iter_mut().for_each(|half| half.lost_j = -1e-3);
            is_driven(&halves)
        };
        assert_eq!([with_gains(1), with_gains(2)], [false, true]);
    }
}
