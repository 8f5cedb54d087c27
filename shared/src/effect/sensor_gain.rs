//! Sensor gain: the potentiometer's electrical travel differs from the data sheet's 340°.
//! Source: Vishay Spectrol 157 data sheet, electrical angle 340° ± 4°.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules, SENSOR_MEMORY, Sensor};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 30,
        name: "sensor-gain",
        summary: "The sensor reads every angle too large or too small by the same factor.",
        formula: "reading = (1 + eg)*theta",
        source: "Vishay Spectrol 157 data sheet: electrical angle 340° ± 4°",
        experiment: "Period against amplitude: a wrong gain bends the curve that gravity prescribes.",
        parameters: &[Parameter {
            symbol: "eg",
            unit: "1",
            low: -0.2,
            high: 0.2,
            start: 0.0,
            meaning: prose!("relative error of the gain"),
        }],
        starts: &[[0.0; MAX_VALUES]],
        family: Family::Reading,
        generalises: None,
        is_fine: false,
        rules: Rules { is_calibrated: true, ..Rules::NONE },
        action: Action::Sensor(Sensor { start, read }),
    }
}

fn start<R: Real>(_: R, _: &Motion<R>, _: &[R; MAX_VALUES]) -> [R; SENSOR_MEMORY] {
    [R::zero(); SENSOR_MEMORY]
}

fn read<R: Real>(angle_rad: R, _: &Motion<R>, _: &mut [R; SENSOR_MEMORY], values: &[R; MAX_VALUES]) -> R {
    angle_rad * (R::one() + values[0])
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::reading_at;

    #[test]
    fn it_scales_the_reading_about_zero() {
        let effect = super::effect::<f64>();
        assert_eq!(reading_at(&effect, 0.5, 0.0, &[0.25]), 0.625);
        assert_eq!(reading_at(&effect, 0.0, 3.0, &[0.25]), 0.0);
    }
}
