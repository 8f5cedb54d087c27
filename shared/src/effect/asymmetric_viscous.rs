//! Asymmetric viscous friction: viscous friction that differs between the two directions, as behind a one-way damper or
//! on a bob that is open on one side. A draught does the same: the air's drag k·|ω − u|·(ω − u), less what it is in still
//! air, is −2·k·u·|ω| for a wind that is slower than the bob.
//! Source: C. Canudas de Wit, K. J. Åström, K. Braun, IEEE J. Robotics and Automation 3 (1987) 681.
//!
//! It adds to viscous friction or drag, which must be the larger for friction to oppose both directions.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 52,
        name: "asymmetric-viscous",
        summary: "Friction grows with speed more one way than the other: a draught, a one-way damper, a cup.",
        formula: "torque = -dB*|omega|: friction B + dB when omega > 0, B - dB when omega < 0",
        source: "C. Canudas de Wit, K. J. Åström, K. Braun, IEEE J. Robotics and Automation 3 (1987) 681",
        experiment: "Large releases from both sides: swings lie off centre, the more the wider they are. Turn the rig around: a draught changes sides.",
        parameters: &[Parameter {
            symbol: "dB",
            unit: "N·m·s/rad",
            low: -2.5e-3,
            high: 2.5e-3,
            start: 0.0,
            meaning: prose!("half the difference between the directions"),
        }],
        starts: &[[0.0; MAX_VALUES]],
        family: Family::Speed,
        generalises: None,
        is_fine: false,
        rules: Rules { is_left_to_diagnosis: true, ..Rules::NONE },
        action: Action::Friction(torque),
    }
}

fn torque<R: Real>(motion: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
    -values[0] * motion.velocity_rad_s.abs()
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::torque_at;

    #[test]
    fn it_hinders_one_way_and_helps_the_other_the_more_the_faster() {
        let torque = |velocity: f64| torque_at(&super::effect(), 0.1, velocity, &[2e-4]);
        assert_eq!((torque(2.0), torque(-2.0), torque(0.5), torque(0.0)), (-4e-4, -4e-4, -1e-4, 0.0));
    }
}
