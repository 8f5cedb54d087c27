//! What a set of recordings cannot tell, in words.

use super::measurement::Measurement;
use super::pictures::short_name;
use super::recording::Judged;
use crate::fit::LARGE_RELEASE_RAD;
use crate::number::angle;
use crate::recording::Measured;

/// Swings that a friction law needs to show.
const FEW_SWINGS: usize = 6;

/// What can't be judged with these recordings, and what to do about it.
pub fn limits(measurements: &[Measurement], recordings: &[Judged]) -> Vec<String> {
    let mut limits: Vec<String> = Vec::new();
    for (measurement, judged) in measurements.iter().zip(recordings) {
        limits.extend(of_recording(measurement, judged));
    }
    if recordings.iter().any(|judged| judged.kind == Measured::Rate) {
        limits.push(
            "Rates, not angles, were measured: energy and period against amplitude, the map of the missing torque and the \
             stop angle can't be drawn from them; host diagnose tells which effect is missing all the same."
                .to_owned(),
        );
    } else if recordings.iter().all(|judged| judged.stop_angles_rad.is_none()) {
        limits.push(
            "No recording comes to rest: stiction and the stop angle can't be judged; record until it hangs still."
                .to_owned(),
        );
    }
    let largest = measurements.iter().map(|m| m.swing.largest_rad()).fold(0.0, f64::max);
    if largest < LARGE_RELEASE_RAD {
        limits.push(format!(
            "No angle exceeds {} rad: effects that show at large amplitude (drag, gain, spring) can't be told apart; \
             release from 1.4 rad or more.",
            angle(largest)
        ));
    }
    limits
}

fn of_recording(measurement: &Measurement, judged: &Judged) -> Vec<String> {
    let name = short_name(&judged.name);
    let mut limits = Vec::new();
    if judged.swings.len() < FEW_SWINGS {
        let n_swings = judged.swings.len();
        limits.push(format!(
            "{name}: only {n_swings} swings: how the loss depends on amplitude can't be judged; record longer."
        ));
    }
    if measurement.is_told_by_model {
        limits.push(format!(
            "{name}: neighbouring readings are alike, and what the model leaves is forgotten within a tenth of a period, where a missing law is remembered for many: it counts as noise; a rest at the end would tell it for sure."
        ));
    } else if !measurement.has_lead_in && !measurement.has_rest {
        limits.push(format!(
            "{name}: no still stretch that is long enough before or after the swing: whether the sensor's noise is white \
             can't be judged; hold it still for a second before the release."
        ));
    } else if measurement.noise.colour.is_some() {
        limits.push(format!(
            "{name}: the sensor's own noise is coloured (neighbouring readings depend on each other while it hangs \
             still): a remainder below 1.3 times the noise can't be told from it."
        ));
    }
    limits
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::tests::{NOISE_RAD, judged, swing};

    fn measurement(has_lead_in: bool, has_rest: bool) -> Measurement {
        let mut measurement = Measurement::of_swing(swing("one.csv", NOISE_RAD, 1));
        (measurement.has_lead_in, measurement.has_rest) = (has_lead_in, has_rest);
        measurement
    }

    fn is_said(limits: &[String], what: &str) -> bool {
        limits.iter().any(|limit| limit.contains(what))
    }

    #[test]
    fn a_still_stretch_before_or_after_the_swing_tells_the_noise() {
        let judged = judged();
        let doubts =
            |before: bool, after: bool| is_said(&of_recording(&measurement(before, after), &judged), "is white");
        assert_eq!([doubts(false, false), doubts(true, false), doubts(false, true)], [true, false, false]);
    }

    #[test]
    fn one_recording_that_comes_to_rest_is_enough_for_stiction() {
        let moving = judged();
        let resting = Judged { stop_angles_rad: Some((0.01, 0.01)), ..moving.clone() };
        let measurements = [measurement(true, true), measurement(true, true)];
        let doubts = |recordings: &[Judged]| is_said(&limits(&measurements, recordings), "comes to rest");
        assert!(doubts(&[moving.clone(), moving.clone()]));
        assert!(!doubts(&[moving, resting]));
    }
}
