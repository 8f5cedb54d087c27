//! Sensor nonlinearity: the potentiometer's track is not even; gain, bend and curvature of its characteristic.
//! Source: Vishay Spectrol 157 data sheet, linearity ±2 %.
//!
//! The gain belongs to it: a bent characteristic that is right at both ends has another slope in the middle.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules, SENSOR_MEMORY, Sensor};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 32,
        name: "sensor-nonlinearity",
        summary: "The sensor's scale is not even: it stretches some angles and squeezes others.",
        formula: "reading = (1 + eg)*theta + q2*theta^2 + q3*theta^3",
        source: "Vishay Spectrol 157 data sheet: linearity ±2 %",
        experiment: "Turning points of large releases from both sides: each follows from the last by gravity and friction alone.",
        parameters: &[
            Parameter {
                symbol: "eg",
                unit: "1",
                low: -0.2,
                high: 0.2,
                start: 0.0,
                meaning: prose!("relative error of the gain at zero"),
            },
            Parameter {
                symbol: "q2",
                unit: "1/rad",
                low: -0.2,
                high: 0.2,
                start: 0.0,
                meaning: prose!("bend: unlike on the two sides"),
            },
            Parameter {
                symbol: "q3",
                unit: "1/rad²",
                low: -0.2,
                high: 0.2,
                start: 0.0,
                meaning: prose!("curvature: alike on the two sides"),
            },
        ],
        starts: &[[0.0, 0.0, 0.0, 0.0]],
        family: Family::Reading,
        generalises: Some("sensor-gain"),
        is_fine: false,
        rules: Rules::NONE,
        action: Action::Sensor(Sensor { start, read }),
    }
}

fn start<R: Real>(_: R, _: &Motion<R>, _: &[R; MAX_VALUES]) -> [R; SENSOR_MEMORY] {
    [R::zero(); SENSOR_MEMORY]
}

fn read<R: Real>(reading_rad: R, _: &Motion<R>, _: &mut [R; SENSOR_MEMORY], values: &[R; MAX_VALUES]) -> R {
    reading_rad * (R::one() + values[0] + reading_rad * (values[1] + reading_rad * values[2]))
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::reading_at;

    #[test]
    fn it_is_a_cubic_of_the_angle() {
        assert_eq!(reading_at(&super::effect(), 0.5, 0.0, &[0.25, 0.5, -1.0]), 0.625);
        assert_eq!(reading_at(&super::effect(), -0.5, 0.0, &[0.25, 0.5, -1.0]), -0.375);
    }
}
