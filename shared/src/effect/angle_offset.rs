//! Angle offset: the sensor's zero is not where the pendulum hangs.
//! Source: JCGM 100:2008 (Guide to the expression of uncertainty in measurement), 3.2: systematic effects.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules, SENSOR_MEMORY, Sensor};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 31,
        name: "angle-offset",
        summary: "The sensor's zero is not where the pendulum hangs: every reading is off by the same angle.",
        formula: "reading = theta + off",
        source: "JCGM 100:2008, 3.2: systematic effects and their correction",
        experiment: "Where the pendulum hangs at rest, approached from both sides.",
        parameters: &[Parameter {
            symbol: "off",
            unit: "rad",
            low: -0.2,
            high: 0.2,
            start: 0.0,
            meaning: prose!("reading of the hanging pendulum"),
        }],
        starts: &[[0.0, 0.0, 0.0, 0.0]],
        family: Family::Reading,
        generalises: None,
        is_fine: false,
        rules: Rules { is_free_offset: true, ..Rules::NONE },
        action: Action::Sensor(Sensor { start, read }),
    }
}

fn start<R: Real>(_: R, _: &Motion<R>, _: &[R; MAX_VALUES]) -> [R; SENSOR_MEMORY] {
    [R::zero(); SENSOR_MEMORY]
}

fn read<R: Real>(reading_rad: R, _: &Motion<R>, _: &mut [R; SENSOR_MEMORY], values: &[R; MAX_VALUES]) -> R {
    reading_rad + values[0]
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::reading_at;

    #[test]
    fn it_adds_the_same_angle_everywhere() {
        assert_eq!(reading_at(&super::effect(), 0.5, 2.0, &[0.25]), 0.75);
        assert_eq!(reading_at(&super::effect(), -0.5, 0.0, &[0.25]), -0.25);
    }
}
