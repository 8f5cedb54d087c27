//! Asymmetric Coulomb friction: dry friction that differs between the two directions.
//! Source: C. Canudas de Wit, K. J. Åström, K. Braun, IEEE J. Robotics and Automation 3 (1987) 681.
//!
//! It adds to Coulomb friction, which must be the larger for friction to oppose both directions. While it slides it is a
//! constant torque: from small swings it can hardly be told from a wrong zero of the sensor.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 17,
        name: "asymmetric-coulomb",
        summary: "Dry friction is larger one way than the other, as when a wiper is pushed or pulled along.",
        formula: "torque = -dM: friction Mc + dM when omega > 0, Mc - dM when omega < 0",
        source: "C. Canudas de Wit, K. J. Åström, K. Braun, IEEE J. Robotics and Automation 3 (1987) 681",
        experiment: "Releases from both sides to rest: the swings lie off centre and stop on different sides of it.",
        parameters: &[Parameter {
            symbol: "dM",
            unit: "N·m",
            low: -1e-2,
            high: 1e-2,
            start: 0.0,
            meaning: prose!("half the difference between the directions"),
        }],
        starts: &[[0.0, 0.0, 0.0, 0.0]],
        family: Family::Dry,
        generalises: None,
        is_fine: false,
        rules: Rules { resembles_offset: true, ..Rules::NONE },
        action: Action::Friction(torque),
    }
}

fn torque<R: Real>(motion: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
    -values[0] * motion.direction.abs()
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::torque_at;

    #[test]
    fn it_hinders_one_way_and_helps_the_other() {
        let torque = |velocity: f64| torque_at(&super::effect(), 0.1, velocity, &[2e-4]);
        assert_eq!((torque(1.0), torque(-1.0), torque(0.0)), (-2e-4, -2e-4, 0.0));
    }
}
