//! Torsional spring: a cable or a seal that twists with the shaft.
//! Source: R. Hooke, De Potentia Restitutiva (London, 1678).
//!
//! From small swings it can hardly be told from a wrong gain of the sensor: both change the period alone.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 14,
        name: "torsional-spring",
        summary: "A cable that twists along pulls the pendulum towards the angle at which it is relaxed.",
        formula: "torque = -ks*(theta - ths)",
        source: "R. Hooke, De Potentia Restitutiva (London, 1678)",
        experiment: "Small and large releases on both sides: a spring shortens the period of small swings more.",
        parameters: &[
            Parameter { symbol: "ks", unit: "N·m/rad", low: 0.0, high: 0.2, start: 0.0, meaning: prose!("stiffness") },
            Parameter {
                symbol: "ths",
                unit: "rad",
                low: -3.2,
                high: 3.2,
                start: 0.0,
                meaning: prose!("angle at which it is relaxed"),
            },
        ],
        starts: &[[0.0, 0.0, 0.0, 0.0], [0.0, 0.3, 0.0, 0.0], [0.0, -0.3, 0.0, 0.0]],
        family: Family::Spring,
        generalises: None,
        is_fine: false,
        rules: Rules { relaxes_at: Some(1), ..Rules::NONE },
        action: Action::Drive(torque),
    }
}

fn torque<R: Real>(motion: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
    -values[0] * (motion.angle_rad - values[1])
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::torque_at;

    #[test]
    fn it_pulls_towards_its_relaxed_angle() {
        let torque = |angle: f64| torque_at(&super::effect(), angle, 0.0, &[0.01, 0.2]);
        assert!((torque(0.7) + 0.005).abs() < 1e-15 && torque(-0.3) > 0.0 && torque(0.2) == 0.0);
    }
}
