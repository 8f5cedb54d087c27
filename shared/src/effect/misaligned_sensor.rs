//! Misaligned sensor: the magnet of an encoder turns beside the chip's centre, a joint between shaft and sensor is bent,
//! or a camera sees the plane of the swing askew.
//! Source: Texas Instruments, design guide TIDUF97 (2024), table 3-1: displacement of the sensor, second harmonic.
//!
//! R. Hooke's joint with an angle β between its shafts, and a camera that is turned by β about the plumb line, have
//! tan(reading) = cos β·tan θ, which is ms = −tan²(β/2) and mc = 0 to the order β⁴. To the second order in the angle it is
//! a gain and a bend: the smaller the swing, the less can be told, and no board tries it.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules, SENSOR_MEMORY, Sensor};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 38,
        name: "misaligned-sensor",
        summary: "A magnet beside its chip's centre, a bent joint or a camera that looks askew: it errs twice a turn.",
        formula: "reading = theta + ms*sin(2*theta) + mc*(cos(2*theta) - 1)",
        source: "Texas Instruments, design guide TIDUF97 (2024), table 3-1: sensor displacement",
        experiment: "Set chip, joint or camera straight and swing again: its numbers must become smaller.",
        parameters: &[
            Parameter {
                symbol: "ms",
                unit: "rad",
                low: -0.2,
                high: 0.2,
                start: 0.0,
                meaning: prose!("error at an eighth of a turn, unlike in sign on the two sides"),
            },
            Parameter {
                symbol: "mc",
                unit: "rad",
                low: -0.2,
                high: 0.2,
                start: 0.0,
                meaning: prose!("half the error from the bottom to a quarter of a turn, alike on the two sides"),
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
    let twice_rad = reading_rad + reading_rad;
    reading_rad + values[0] * twice_rad.sin() + values[1] * (twice_rad.cos() - R::one())
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::reading_at;

    /// The joint's other shaft, whose fork stands at this angle as the pendulum hangs, turns by so much.
    fn turned(angle: f64, fork: f64, bend: f64) -> f64 {
        let (sine, cosine) = (angle + fork).sin_cos();
        (bend.cos() * sine).atan2(cosine) - fork
    }

    #[test]
    fn a_bent_joint_errs_like_it() {
        let (bend, fork) = (0.12_f64, 0.4_f64);
        let size = (0.5 * bend).tan().powi(2);
        let values = [-size * (2.0 * fork).cos(), -size * (2.0 * fork).sin()];
        for angle in [-2.2, -1.0, 0.6, 2.0] {
            let seen = turned(angle, fork, bend) - turned(0.0, fork, bend);
            let reading = reading_at(&super::effect(), angle, 0.0, &values);
            assert!((reading - seen).abs() < 2e-5 && (reading - angle).abs() > 5e-4, "{angle}: {reading} {seen}");
        }
    }
}
