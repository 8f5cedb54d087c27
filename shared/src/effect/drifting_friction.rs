//! Drifting friction: dry and viscous friction that change after the release, as grease warms or settles.
//! Source: B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, Automatica 30 (1994) 1083: friction depends on how long
//! the contact has run.
//!
//! Coulomb and viscous friction are those at the release, from which time counts; this is what has come to them since.
//! Its numbers are rates: of a drift slower than the swing, which is a straight line, nobody knows where it would end.

use super::{Action, Effect, Family, Former, MAX_VALUES, Parameter, Rules};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 39,
        name: "drifting-friction",
        summary: "Friction that fades (or grows) while the pendulum swings, as grease warms up or settles.",
        formula: "torque = -(rc*sgn(omega) + rw*omega)*tau*(1 - exp(-t/tau))",
        source: "B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, Automatica 30 (1994) 1083",
        experiment: "Releases of very different sizes: the same amplitude is then passed early in one and late in the other.",
        parameters: &[
            Parameter {
                symbol: "rc",
                unit: "N·m/s",
                low: -1e-3,
                high: 1e-3,
                start: 0.0,
                meaning: prose!("by how much dry friction grows in a second, just after the release"),
            },
            Parameter {
                symbol: "rw",
                unit: "N·m/rad",
                low: -2e-4,
                high: 2e-4,
                start: 0.0,
                meaning: prose!("by how much viscous friction grows in a second, just after the release"),
            },
            Parameter {
                symbol: "tau",
                unit: "s",
                low: 0.5,
                high: 300.0,
                start: 10.0,
                meaning: prose!("time after which it changes 37 % as fast"),
            },
        ],
        starts: &[[0.0, 0.0, 10.0, 0.0], [0.0, 0.0, 3.0, 0.0], [0.0, 0.0, 35.0, 0.0], [0.0, 0.0, 120.0, 0.0]],
        family: Family::Time,
        generalises: None,
        is_fine: false,
        rules: Rules { needs_several_releases: true, former: Some(FORMER), ..Rules::NONE },
        action: Action::Friction(torque),
    }
}

/// What grew to nothing in the end was added at the release, so that Mc was the friction in the end.
const FORMER: Former = Former {
    symbols: &["Mc1", "Mw1"],
    meaning: prose!("added friction at the release, when Mc and Mw were those in the end"),
};

fn torque<R: Real>(motion: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
    let rate = values[0] * motion.direction + values[1] * motion.velocity_rad_s;
    -rate * values[2] * (R::one() - (-motion.time_s / values[2]).exp())
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::torque_at_time;

    #[test]
    fn it_is_nothing_at_the_release_and_grows_against_the_motion_until_it_settles() {
        let torque =
            |velocity: f64, time: f64| torque_at_time(&super::effect(), 0.1, velocity, time, &[1e-4, 1e-5, 8.0]);
        assert_eq!([torque(2.0, 0.0), torque(-2.0, 0.0)], [0.0, 0.0]);
        assert!((torque(2.0, 1e-3) / -1.2e-7 - 1.0).abs() < 1e-3 && torque(-2.0, 1e-3) > 0.0);
        assert!((torque(1.0, 8.0) + 8.8e-4 * (1.0 - libm::exp(-1.0))).abs() < 1e-15);
        assert!((torque(2.0, 800.0) + 9.6e-4).abs() < 1e-15);
    }
}
