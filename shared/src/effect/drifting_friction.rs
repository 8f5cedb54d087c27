//! Drifting friction: dry and viscous friction that change after the release, as grease warms or settles.
//! Source: B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, Automatica 30 (1994) 1083: friction depends on how long
//! the contact has run.
//!
//! It adds to Coulomb and viscous friction; negative values are friction that grows, and must be smaller than those.
//! Time counts from the release. A drift slower than the swing is a straight line: then only strength/tau is known.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 19,
        name: "drifting-friction",
        summary: "Friction that fades (or grows) while the pendulum swings, as grease warms up or settles.",
        formula: "torque = -(Mc1*sgn(omega) + Mw1*omega)*exp(-t/tau)",
        source: "B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, Automatica 30 (1994) 1083",
        experiment: "Releases of very different sizes: the same amplitude is then passed early in one and late in the other.",
        parameters: &[
            Parameter {
                symbol: "Mc1",
                unit: "N·m",
                low: -1e-2,
                high: 1e-2,
                start: 0.0,
                meaning: prose!("added dry friction at the release"),
            },
            Parameter {
                symbol: "Mw1",
                unit: "N·m·s/rad",
                low: -2e-3,
                high: 2e-3,
                start: 0.0,
                meaning: prose!("added viscous friction at the release"),
            },
            Parameter {
                symbol: "tau",
                unit: "s",
                low: 0.5,
                high: 300.0,
                start: 10.0,
                meaning: prose!("time after which 37 % of it is left"),
            },
        ],
        starts: &[[0.0, 0.0, 10.0, 0.0], [0.0, 0.0, 3.0, 0.0], [0.0, 0.0, 35.0, 0.0], [0.0, 0.0, 120.0, 0.0]],
        family: Family::Time,
        generalises: None,
        is_fine: false,
        rules: Rules { needs_several_releases: true, ..Rules::NONE },
        action: Action::Friction(torque),
    }
}

fn torque<R: Real>(motion: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
    let friction = values[0] * motion.direction + values[1] * motion.velocity_rad_s;
    -friction * (-motion.time_s / values[2]).exp()
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::torque_at_time;

    #[test]
    fn it_opposes_the_motion_and_fades_with_time() {
        let torque =
            |velocity: f64, time: f64| torque_at_time(&super::effect(), 0.1, velocity, time, &[1e-3, 1e-4, 8.0]);
        assert!((torque(2.0, 0.0) + 1.2e-3).abs() < 1e-15 && (torque(-2.0, 0.0) - 1.2e-3).abs() < 1e-15);
        assert!((torque(1.0, 8.0) + 1.1e-3 * libm::exp(-1.0)).abs() < 1e-15);
    }
}
