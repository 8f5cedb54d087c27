//! Load of a gear train: its teeth rub in proportion to the torque that they transmit.
//! Source: M. Duclusaud, G. Passault, V. Padois, O. Ly, Extended Friction Models for the Physics Simulation of Servo
//! Actuators, arXiv 2410.08650 (2024), model M3.
//!
//! What a train transmits to a motor without current is what gravity turns it with, so that friction is least in the
//! middle and grows to either side, and so does what holds a pendulum that rests there. The bearing's own load is
//! another one, which is largest in the middle: load-dependent Coulomb friction.
//!
//! Five stages of spur gears that take 7 % each take 30 %.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 26,
        name: "gear-load",
        summary: "Gears rub the harder, the more torque they transmit: least in the middle, most when it stands out.",
        formula: "torque = -mu*m*g*l*|sin(theta)|*sgn(omega)",
        source: "M. Duclusaud, G. Passault, V. Padois, O. Ly, arXiv 2410.08650 (2024), model M3",
        experiment: "Wide releases: like grease it takes a share of the amplitude, but at the ends of a swing, not in its middle.",
        parameters: &[Parameter {
            symbol: "mu",
            unit: "1",
            low: 0.0,
            high: 0.3,
            start: 0.0,
            meaning: prose!("share of the transmitted torque that the gears take"),
        }],
        starts: &[[0.0, 0.0, 0.0, 0.0]],
        family: Family::Angle,
        generalises: None,
        is_fine: false,
        rules: Rules { is_left_to_diagnosis: true, ..Rules::NONE },
        action: Action::Friction(torque),
    }
}

fn torque<R: Real>(motion: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
    -values[0] * motion.pendulum.gravity_torque_nm() * motion.angle_rad.sin().abs() * motion.direction
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::{motion_at, torque_at};
    use crate::model::Model;
    use crate::parameters::Parameters;

    #[test]
    fn it_opposes_the_motion_by_a_share_of_what_gravity_turns_with() {
        let weight_nm = motion_at(0.0, 0.0, 0.0).pendulum.gravity_torque_nm();
        let torque = |angle: f64, velocity: f64| torque_at(&super::effect(), angle, velocity, &[0.1]);
        assert_eq!((torque(0.0, 3.0), torque(0.5, 0.0)), (0.0, 0.0));
        for angle in [0.3_f64, -0.3, 1.5, -2.5] {
            let share = 0.1 * weight_nm * libm::sin(angle.abs());
            assert!((torque(angle, 2.0) + share).abs() < 1e-15 && (torque(angle, -0.1) - share).abs() < 1e-15);
        }
    }

    /// Where it is at rest, gears that take a share µ leave 1 − µ of gravity to what else holds it.
    #[test]
    fn what_holds_a_resting_pendulum_grows_with_the_load() {
        let rests = |angle: f64, share: f64| {
            let mut parameters = Parameters::<f64>::paper();
            parameters.set_friction(0.0, 2e-3, 2e-3, 0.0);
            parameters.set(super::effect::<f64>().id, &[share]).unwrap();
            Model::new(&parameters).release(angle, 0.0).contact.is_resting()
        };
        let alone = 2e-3 / Parameters::<f64>::paper().pendulum.gravity_torque_nm();
        let largest = |share: f64| libm::asin(alone / (1.0 - share));
        for share in [0.0, 0.1, 0.3] {
            assert!(rests(0.999 * largest(share), share) && !rests(1.001 * largest(share), share), "{share}");
        }
    }
}
