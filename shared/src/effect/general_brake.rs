//! Eddy-current brake whose field reaches further than a bell curve: near and wide poles, or a magnet some way off.
//! Source: H. D. Wiederick, N. Gauthier, D. A. Campbell, P. Rochon, Am. J. Phys. 55 (1987) 500: the torque follows the
//! square of the field, and that of a dipole falls with a power of the distance.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules, q_exponential};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 22,
        name: "general-brake",
        summary: "A magnet beside the path whose field ends more gradually than a bell curve: it brakes from further off.",
        formula: "torque = -Cbg*omega*(1 + nu*((theta - thbg)/wg)^2)^(-1/nu)",
        source: "H. D. Wiederick, N. Gauthier, D. A. Campbell, P. Rochon, Am. J. Phys. 55 (1987) 500",
        experiment: "Releases of many sizes, some too small to reach the magnet: only those that pass it lose the extra energy.",
        parameters: &[
            Parameter {
                symbol: "Cbg",
                unit: "N·m·s/rad",
                low: 0.0,
                high: 2e-2,
                start: 0.0,
                meaning: prose!("braking torque at 1 rad/s in front of the magnet"),
            },
            Parameter {
                symbol: "thbg",
                unit: "rad",
                low: -3.2,
                high: 3.2,
                start: 0.0,
                meaning: prose!("angle of the magnet"),
            },
            Parameter {
                symbol: "wg",
                unit: "rad",
                low: 0.02,
                high: 2.0,
                start: 0.2,
                meaning: prose!("half width of its field"),
            },
            Parameter {
                symbol: "nu",
                unit: "1",
                low: 0.0,
                high: 4.0,
                start: 0.0,
                meaning: prose!("how gradually the field ends: 0 a bell curve, 1 Lorentz's"),
            },
        ],
        starts: &[[0.0, 0.0, 0.2, 0.0], [0.0, 0.3, 0.2, 1.0]],
        family: Family::Angle,
        generalises: Some("eddy-brake"),
        is_fine: false,
        rules: Rules { special_case_at: Some((3, 0.0)), follows_special_case: true, ..Rules::NONE },
        action: Action::Friction(torque),
    }
}

fn torque<R: Real>(motion: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
    let away = (motion.angle_rad - values[1]) / values[2];
    -values[0] * motion.velocity_rad_s * q_exponential(away * away, values[3])
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::torque_at;

    #[test]
    fn with_nothing_it_is_the_bell_curve_and_with_one_lorentzs() {
        let bell = crate::effect::eddy_brake::effect::<f64>();
        for angle in [-0.5, 0.4, 0.5, 0.9] {
            let ours = |nu: f64| torque_at(&super::effect(), angle, 2.0, &[1e-3, 0.5, 0.1, nu]);
            assert!((ours(0.0) - torque_at(&bell, angle, 2.0, &[1e-3, 0.5, 0.1])).abs() < 1e-15);
            assert!((ours(1.0) + 2e-3 / (1.0 + (angle - 0.5) * (angle - 0.5) / 0.01)).abs() < 1e-15);
        }
    }
}
