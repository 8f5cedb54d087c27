//! Eccentric sensor: the disc of an encoder, or the track of a potentiometer, is fixed off the axis of the shaft.
//! Source: Texas Instruments, design guide TIDUF97 (2024), table 3-1: displacement of the shaft, first harmonic.
//!
//! To the second order in the angle it is a gain and a bend: the smaller the swing, the less can be told, and no board
//! tries it.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules, SENSOR_MEMORY, Sensor};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 37,
        name: "eccentric-sensor",
        summary: "The sensor's scale does not turn about its own centre: it errs once a turn.",
        formula: "reading = theta + es*sin(theta) + ec*(cos(theta) - 1)",
        source: "Texas Instruments, design guide TIDUF97 (2024), table 3-1: shaft displacement",
        experiment: "Turn the sensor by half a turn on its shaft: the error changes its sign.",
        parameters: &[
            Parameter {
                symbol: "es",
                unit: "rad",
                low: -0.2,
                high: 0.2,
                start: 0.0,
                meaning: prose!("centre's shift towards the place of reading, over the scale's radius, as it hangs"),
            },
            Parameter {
                symbol: "ec",
                unit: "rad",
                low: -0.2,
                high: 0.2,
                start: 0.0,
                meaning: prose!("its shift across that direction"),
            },
        ],
        starts: &[[0.0, 0.0, 0.0, 0.0]],
        family: Family::Reading,
        generalises: None,
        is_fine: false,
        rules: Rules { needs_angles: true, is_left_to_diagnosis: true, ..Rules::NONE },
        action: Action::Sensor(Sensor { start, read }),
    }
}

fn start<R: Real>(_: R, _: &Motion<R>, _: &[R; MAX_VALUES]) -> [R; SENSOR_MEMORY] {
    [R::zero(); SENSOR_MEMORY]
}

fn read<R: Real>(reading_rad: R, _: &Motion<R>, _: &mut [R; SENSOR_MEMORY], values: &[R; MAX_VALUES]) -> R {
    reading_rad + values[0] * reading_rad.sin() + values[1] * (reading_rad.cos() - R::one())
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::reading_at;

    /// What a scale of radius 1 shows at a fixed place beside it, where its centre is off the axis and turns with it.
    fn shown(angle: f64, [towards, across]: [f64; 2]) -> f64 {
        let (sine, cosine) = angle.sin_cos();
        let centre = [towards * cosine - across * sine, towards * sine + across * cosine];
        angle - (-centre[1]).atan2(1.0 - centre[0])
    }

    #[test]
    fn it_is_a_scale_about_another_centre() {
        let shift = [1e-3, -2e-3];
        for angle in [-3.0, -1.5, 0.8, 2.0] {
            let seen = shown(angle, shift) - shown(0.0, shift);
            let reading = reading_at(&super::effect(), angle, 0.0, &shift);
            assert!((reading - seen).abs() < 1e-5 && (reading - angle).abs() > 3e-4, "{angle}: {reading} {seen}");
        }
    }
}
