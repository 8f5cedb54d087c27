//! Load of a gear train whose friction grows faster or more slowly than the torque that it transmits, and falls as it
//! turns faster.
//! Source: ISO/TR 14179-2 (2001): a mesh has a coefficient of friction of (load/speed)^0.2, so that its friction grows
//! as load^1.2 and falls as speed^0.2. Load and signs are those of the usual law.
//!
//! Where the surfaces only touch elastically, friction grows as load^(2/3) (F. P. Bowden, D. Tabor, The Friction and
//! Lubrication of Solids, 1950), so that both exponents are free.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules};
use crate::motion::Motion;
use crate::real::Real;

/// Below this speed no film of oil is drawn in, and friction is what it is here, rad/s.
const SLOWEST_RAD_S: f64 = 0.1;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 27,
        name: "general-gear-load",
        summary: "Gears whose friction grows faster, or more slowly, than what they transmit, and less the faster they turn.",
        formula: "torque = -mug*m*g*l*|sin(theta)|^ag*max(|omega|, 0.1)^(-bg)*sgn(omega)",
        source: "ISO/TR 14179-2 (2001): ag = 1.2, bg = 0.2",
        experiment: "Wide releases, and some of a tenth of their amplitude: the share that the gears take differs.",
        parameters: &[
            Parameter {
                symbol: "mug",
                unit: "1",
                low: 0.0,
                high: 0.3,
                start: 0.0,
                meaning: prose!("share that the gears take standing out level at 1 rad/s"),
            },
            Parameter {
                symbol: "ag",
                unit: "1",
                low: 0.3,
                high: 3.0,
                start: 1.0,
                meaning: prose!("exponent of the load"),
            },
            Parameter {
                symbol: "bg",
                unit: "1",
                low: -0.5,
                high: 1.0,
                start: 0.0,
                meaning: prose!("exponent of the speed by which it falls"),
            },
        ],
        starts: &[[0.0, 1.0, 0.0, 0.0], [0.0, 1.2, 0.2, 0.0]],
        family: Family::Angle,
        generalises: Some("gear-load"),
        // Its powers have corners at rest and in the middle.
        is_fine: true,
        // With bg at 0, too; but it is asked only where the usual law explains as much.
        rules: Rules { special_case_at: Some((1, 1.0)), follows_special_case: true, ..Rules::NONE },
        action: Action::Friction(torque),
    }
}

fn torque<R: Real>(motion: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
    let load = motion.angle_rad.sin().abs().powf(values[1]);
    let faster = motion.velocity_rad_s.abs().max(R::of(SLOWEST_RAD_S)).powf(-values[2]);
    -values[0] * motion.pendulum.gravity_torque_nm() * load * faster * motion.direction
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::{motion_at, torque_at};

    #[test]
    fn it_is_the_usual_law_in_proportion_to_the_load_and_that_of_teeth_with_a_fifth() {
        let weight_nm = motion_at(0.0, 0.0, 0.0).pendulum.gravity_torque_nm();
        let usual = crate::effect::gear_load::effect::<f64>();
        for (angle, velocity) in [(0.5_f64, 3.0_f64), (-1.2, -0.4), (0.0, 2.0), (2.5, -7.0)] {
            let ours = |values: &[f64]| torque_at(&super::effect(), angle, velocity, values);
            assert!((ours(&[0.1, 1.0, 0.0]) - torque_at(&usual, angle, velocity, &[0.1])).abs() < 1e-15);
            let load = weight_nm * libm::sin(angle.abs());
            let friction = 0.1 * load * libm::pow(load / weight_nm / velocity.abs(), 0.2);
            assert!((ours(&[0.1, 1.2, 0.2]) + friction * velocity.signum()).abs() < 1e-12);
        }
    }

    #[test]
    fn slow_teeth_rub_no_more_than_at_the_speed_that_still_draws_in_oil() {
        let torque = |velocity: f64| torque_at(&super::effect(), 0.7, velocity, &[0.1, 1.0, 0.5]);
        assert_eq!(torque(0.02), torque(0.1));
        assert!(torque(0.1) < torque(0.2));
    }
}
