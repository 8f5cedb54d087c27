//! How slowly a pendulum swings.
//!
//! Windows, rates and steps of a fit, and the ranges of numbers with seconds in their unit, are meant for a pendulum
//! whose small swings last a second. One that swings more slowly has its motion stretched in time and nothing else, so
//! that all of them are stretched with it. A pace is a power of two: it must not depend on how far a pendulum was let
//! go.

use shared::effect::{Effect, MAX_VALUES, Parameter};
use shared::motion::Pendulum;
use std::f64::consts::TAU;

/// The period for which seconds are given, s.
const USUAL_PERIOD_S: f64 = 1.0;

/// Paces beyond 2 to the power of ± this are none of a pendulum: a fortieth of a second, or more than half a minute.
const MOST_DOUBLINGS: f64 = 5.0;

/// How many times slower than the usual pendulum one with this period is, to a power of two; 1 of what is no period.
pub fn of_period(period_s: f64) -> f64 {
    let doublings = (period_s / USUAL_PERIOD_S).log2().round();
    if doublings.is_finite() { doublings.clamp(-MOST_DOUBLINGS, MOST_DOUBLINGS).exp2() } else { 1.0 }
}

/// The same by the small swings of a pendulum.
pub fn of_pendulum(pendulum: &Pendulum<f64>) -> f64 {
    of_period(small_period_s(pendulum))
}

/// The period of its small swings, s.
pub fn small_period_s(pendulum: &Pendulum<f64>) -> f64 {
    TAU * (pendulum.pivot_inertia_kg_m2() / pendulum.gravity_torque_nm()).sqrt()
}

/// By how much a number in this unit grows with the pace: the power of the seconds in it. Torques are none of it,
/// because they are compared with that of gravity.
pub fn scale(unit: &str, pace: f64) -> f64 {
    let seconds = match unit {
        "s" | "s/rad" | "N·m·s/rad" => 1.0,
        "N·m·s²/rad²" => 2.0,
        // Between the two, as its exponent is.
        "N·m·(s/rad)^p" => 1.5,
        "rad/s" | "N·m/s" => -1.0,
        _ => 0.0,
    };
    pace.powf(seconds)
}

/// Where fits of an effect begin, at this pace.
pub fn starts(effect: &Effect<f64>, pace: f64) -> impl Iterator<Item = [f64; MAX_VALUES]> {
    let scaled = move |(value, parameter): (&mut f64, &Parameter)| *value *= scale(parameter.unit, pace);
    effect.starts.iter().map(move |start| {
        let mut start = *start;
        start.iter_mut().zip(effect.parameters).for_each(scaled);
        start
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paces_are_powers_of_two_and_never_absurd() {
        assert_eq!([0.8, 1.06, 1.3, 1.9, 9.0, 17.0].map(of_period), [1.0, 1.0, 1.0, 2.0, 8.0, 16.0]);
        assert_eq!([f64::NAN, f64::INFINITY, 0.0, -1.0].map(of_period), [1.0; 4]);
        assert_eq!([1e-9, 1e9].map(of_period), [1.0 / 32.0, 32.0]);
    }

    #[test]
    fn every_unit_with_seconds_is_known() {
        for parameter in Effect::<f64>::ALL.iter().flat_map(|effect| effect.parameters) {
            let has_seconds = parameter.unit.split(|c: char| !c.is_alphabetic()).any(|part| part == "s");
            assert_eq!(has_seconds, scale(parameter.unit, 2.0) != 1.0, "{}", parameter.unit);
        }
    }
}
