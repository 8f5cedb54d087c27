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
        rules: Rules::NONE,
        action: Action::Sensor(Sensor { start, read }),
    }
}

/// Memory: the sensor's own angle.
fn start<R: Real>(angle_rad: R, _: &Motion<R>, values: &[R; MAX_VALUES]) -> [R; SENSOR_MEMORY] {
    let sensor_rad = angle_rad + R::of(0.5) * values[0] * values[1];
    [sensor_rad, R::zero(), R::zero()]
}

fn read<R: Real>(angle_rad: R, _: &Motion<R>, memory: &mut [R; SENSOR_MEMORY], values: &[R; MAX_VALUES]) -> R {
    let half = R::of(0.5) * values[0];
    memory[0] = memory[0].max(angle_rad - half).min(angle_rad + half);
    memory[0]
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

    #[test]
    fn the_hand_may_leave_it_at_an_edge() {
        let memory = start(0.5, &motion_at(0.5, 0.0, 0.0), &[0.02, -1.0, 0.0, 0.0]);
        assert!((memory[0] - 0.49).abs() < 1e-15);
    }
}
