//! Backlash: play between the shaft and the sensor; after each reversal the sensor stands still until it is taken up.
//! Source: M. A. Krasnosel'skii, A. V. Pokrovskii, Systems with Hysteresis (Springer, 1989): the play operator.
//!
//! Where in the play the sensor stood at the release is a number of its own, because the hand left it there.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules, SENSOR_MEMORY, Sensor};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 34,
        name: "backlash",
        summary: "Play between shaft and sensor: after each turn the reading waits until the play is taken up.",
        formula: "reading stays within theta +- b/2",
        source: "M. A. Krasnosel'skii, A. V. Pokrovskii, Systems with Hysteresis (Springer, 1989)",
        experiment: "Slow small swings: flat tops at the turning points.",
        parameters: &[
            Parameter {
                symbol: "b",
                unit: "rad",
                low: 0.0,
                high: 0.1,
                start: 0.0,
                meaning: prose!("width of the play"),
            },
            Parameter {
                symbol: "b0",
                unit: "1",
                low: -1.0,
                high: 1.0,
                start: 0.0,
                meaning: prose!("where in the play the sensor stood at the release, -1 to 1"),
            },
        ],
        starts: &[[0.0, 0.0, 0.0, 0.0], [4e-3, 0.0, 0.0, 0.0], [4e-3, 0.7, 0.0, 0.0], [4e-3, -0.7, 0.0, 0.0]],
        family: Family::Give,
        generalises: None,
        is_fine: false,
        rules: Rules { needs_angles: true, ..Rules::NONE },
        action: Action::Sensor(Sensor { start, read }),
    }
}

/// Memory: the sensor's own angle; velocity and time of the last sample.
fn start<R: Real>(angle_rad: R, motion: &Motion<R>, values: &[R; MAX_VALUES]) -> [R; SENSOR_MEMORY] {
    let sensor_rad = angle_rad + R::of(0.5) * values[0] * values[1];
    [sensor_rad, motion.velocity_rad_s, motion.time_s]
}

fn read<R: Real>(angle_rad: R, motion: &Motion<R>, memory: &mut [R; SENSOR_MEMORY], values: &[R; MAX_VALUES]) -> R {
    let half = R::of(0.5) * values[0];
    let taken_along = |sensor_rad: R, angle_rad: R| sensor_rad.max(angle_rad - half).min(angle_rad + half);
    let outermost_rad = angle_rad + beyond(motion, memory[1], memory[2]);
    let sensor_rad = taken_along(taken_along(memory[0], outermost_rad), angle_rad);
    *memory = [sensor_rad, motion.velocity_rad_s, motion.time_s];
    sensor_rad
}

/// How much further than to here the shaft went if it turned since the last sample, its velocity changing evenly, rad.
fn beyond<R: Real>(motion: &Motion<R>, velocity_before: R, time_before: R) -> R {
    let velocity = motion.velocity_rad_s;
    let turned = (velocity * velocity_before).lt(R::zero());
    // A divisor that is not zero in a lane whose result is not used.
    let change = R::select(turned, velocity_before - velocity, R::one());
    let further = R::of(0.5) * velocity * velocity * (motion.time_s - time_before) / change;
    R::select(turned, further, R::zero())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effect::tests_support::motion_at;

    #[test]
    fn the_sensor_waits_after_a_reversal() {
        let values = [0.02, 0.0, 0.0, 0.0];
        let mut memory = start(0.0, &motion_at(0.0, 0.0, 0.0), &values);
        let mut reading = |angle: f64| read(angle, &motion_at(angle, 0.0, 0.0), &mut memory, &values);
        for (angle, expected) in [(0.005, 0.0), (0.05, 0.04), (0.04, 0.04), (0.03, 0.04), (0.0, 0.01), (-0.1, -0.09)] {
            assert!((reading(angle) - expected).abs() < 1e-15, "{angle}");
        }
    }

    /// Samples may come long before and after the turn: how far it was out counts.
    #[test]
    fn a_turn_between_two_samples_takes_the_sensor_along() {
        let values = [0.02, 0.0, 0.0, 0.0];
        // Thrown up at 1 rad/s, it turns at 0.05 rad after 0.1 s.
        let motion = |t: f64| motion_at(t - 5.0 * t * t, 1.0 - 10.0 * t, t);
        let last = |times_s: &[f64]| {
            let mut memory = start(0.0, &motion(0.0), &values);
            times_s.iter().map(|t| read(motion(*t).angle_rad, &motion(*t), &mut memory, &values)).last().unwrap()
        };
        assert!((last(&[0.07, 0.12]) - 0.04).abs() < 1e-15);
        assert_eq!(last(&[0.07, 0.12]), last(&[0.05, 0.1, 0.12]));
    }

    #[test]
    fn the_hand_may_leave_it_at_an_edge() {
        let memory = start(0.5, &motion_at(0.5, 0.0, 0.0), &[0.02, -1.0, 0.0, 0.0]);
        assert!((memory[0] - 0.49).abs() < 1e-15);
    }
}
