//! Load-dependent Coulomb friction: the bearing rubs in proportion to the force of the rod on it.
//! Source: F. P. Bowden, D. Tabor, The Friction and Lubrication of Solids (Oxford, 1950).

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 13,
        name: "load-dependent-coulomb",
        summary: "The harder the rod pulls on the bearing, the more it rubs: most at the bottom of a fast swing.",
        formula: "torque = -kap*|m*(g*cos(theta) + l*omega^2)|*sgn(omega)",
        source: "F. P. Bowden, D. Tabor, The Friction and Lubrication of Solids (Oxford, 1950)",
        experiment: "Releases above 1.4 rad beside small ones: the load swings between nothing and three times the weight.",
        parameters: &[Parameter {
            symbol: "kap",
            unit: "m",
            low: 0.0,
            high: 2e-2,
            start: 0.0,
            meaning: prose!("friction torque per newton of load: coefficient times bearing radius"),
        }],
        starts: &[[0.0, 0.0, 0.0, 0.0]],
        family: Family::Angle,
        generalises: None,
        is_fine: false,
        rules: Rules { needs_geometry: true, ..Rules::NONE },
        action: Action::Friction(torque),
    }
}

fn torque<R: Real>(motion: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
    -values[0] * motion.load_n() * motion.direction
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::torque_at;

    #[test]
    fn the_load_is_the_weight_at_rest_and_grows_with_speed() {
        let weight_n = 0.15 * 9.81;
        let torque = |angle: f64, velocity: f64| torque_at(&super::effect(), angle, velocity, &[1e-3]);
        assert!((torque(0.0, 1e-9) + 1e-3 * weight_n).abs() < 1e-12);
        assert!((torque(0.0, -2.0) - 1e-3 * (weight_n + 0.15 * 0.16 * 4.0)).abs() < 1e-12);
        assert!(torque(core::f64::consts::FRAC_PI_2, 1e-9).abs() < 1e-12);
        // Upright the rod pushes instead of pulling; friction does not change its sign.
        assert!(torque(core::f64::consts::PI, 1e-9) < 0.0);
    }
}
