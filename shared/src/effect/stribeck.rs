//! Stribeck effect: lubricated contacts rub more at very low speed, before the film carries.
//! Source: B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, Automatica 30 (1994) 1083.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 12,
        name: "stribeck",
        summary: "Before the grease film carries, the bearing rubs harder: extra friction that fades with speed.",
        formula: "torque = -dM*exp(-(omega/ws)^2)*sgn(omega)",
        source: "B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, Automatica 30 (1994) 1083",
        experiment: "Small swings, and the last ones of every release: the amplitude falls faster the smaller it is.",
        parameters: &[
            Parameter {
                symbol: "dM",
                unit: "N·m",
                low: 0.0,
                high: 2e-2,
                start: 0.0,
                meaning: prose!("extra friction at very low speed"),
            },
            Parameter {
                symbol: "ws",
                unit: "rad/s",
                low: 0.02,
                high: 10.0,
                start: 0.5,
                meaning: prose!("speed at which it has fallen to 37 %"),
            },
        ],
        starts: &[[0.0, 0.5, 0.0, 0.0], [0.0, 0.12, 0.0, 0.0], [0.0, 1.5, 0.0, 0.0], [0.0, 4.0, 0.0, 0.0]],
        family: Family::Dry,
        generalises: None,
        is_fine: false,
        rules: Rules::NONE,
        action: Action::Friction(torque),
    }
}

fn torque<R: Real>(motion: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
    let ratio = motion.velocity_rad_s / values[1];
    -values[0] * (-ratio * ratio).exp() * motion.direction
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::torque_at;

    #[test]
    fn it_opposes_slow_motion_and_fades_with_speed() {
        let torque = |velocity: f64| torque_at(&super::effect(), 0.0, velocity, &[1e-3, 0.5]);
        assert!((torque(1e-9) + 1e-3).abs() < 1e-12 && (torque(-1e-9) - 1e-3).abs() < 1e-12);
        assert!((torque(0.5) + 1e-3 * libm::exp(-1.0)).abs() < 1e-15);
        assert!(torque(5.0).abs() < 1e-15);
    }
}
