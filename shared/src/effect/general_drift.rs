//! Drifting friction that settles earlier or later than an exponential: along a straight line, or as a hyperbola.
//! Source: B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, Automatica 30 (1994) 1083: friction depends on how long
//! the contact has run. Signs and times are those of drifting friction.

use super::{Action, Effect, Family, Former, MAX_VALUES, Parameter, Rules, q_exponential};
use crate::motion::Motion;
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 40,
        name: "general-drift",
        summary: "Friction that fades (or grows) while it swings, along a straight line, an exponential or a hyperbola.",
        formula: "torque = -(rcg*sgn(omega) + rwg*omega)*taug*(1 - max(1 + kappa*t/taug, 0)^(-1/kappa))",
        source: "B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, Automatica 30 (1994) 1083",
        experiment: "Releases of very different sizes: the same amplitude is then passed early in one and late in the other.",
        parameters: &[
            Parameter {
                symbol: "rcg",
                unit: "N·m/s",
                low: -1e-3,
                high: 1e-3,
                start: 0.0,
                meaning: prose!("by how much dry friction grows in a second, just after the release"),
            },
            Parameter {
                symbol: "rwg",
                unit: "N·m/rad",
                low: -2e-4,
                high: 2e-4,
                start: 0.0,
                meaning: prose!("by how much viscous friction grows in a second, just after the release"),
            },
            Parameter {
                symbol: "taug",
                unit: "s",
                low: 0.5,
                high: 300.0,
                start: 10.0,
                meaning: prose!("time in which it would be at its end at its first rate"),
            },
            Parameter {
                symbol: "kappa",
                unit: "1",
                low: -1.0,
                high: 4.0,
                start: 0.0,
                meaning: prose!("-1 a straight line that ends, 0 an exponential, 1 a hyperbola"),
            },
        ],
        starts: &[[0.0, 0.0, 10.0, 0.0], [0.0, 0.0, 10.0, -0.7], [0.0, 0.0, 10.0, 1.0]],
        family: Family::Time,
        generalises: Some("drifting-friction"),
        is_fine: false,
        rules: Rules {
            needs_several_releases: true,
            special_case_at: Some((3, 0.0)),
            follows_special_case: true,
            former: Some(FORMER),
            ..Rules::NONE
        },
        action: Action::Friction(torque),
    }
}

/// As of drifting friction.
const FORMER: Former = Former {
    symbols: &["Mcg", "Mwg"],
    meaning: prose!("added friction at the release, when Mc and Mw were those in the end"),
};

fn torque<R: Real>(motion: &Motion<R>, values: &[R; MAX_VALUES]) -> R {
    let rate = values[0] * motion.direction + values[1] * motion.velocity_rad_s;
    -rate * values[2] * (R::one() - q_exponential(motion.time_s / values[2], values[3]))
}

#[cfg(test)]
mod tests {
    use crate::effect::tests_support::torque_at_time;

    #[test]
    fn it_settles_as_an_exponential_a_straight_line_or_a_hyperbola() {
        let torque =
            |time: f64, kappa: f64| torque_at_time(&super::effect(), 0.1, 2.0, time, &[1e-4, 1e-5, 8.0, kappa]);
        for time in [0.0, 1.0, 7.0, 20.0] {
            let share = time / 8.0;
            assert!((torque(time, 0.0) + 9.6e-4 * (1.0 - libm::exp(-share))).abs() < 1e-15);
            assert!((torque(time, -1.0) + 9.6e-4 * share.min(1.0)).abs() < 1e-15);
            assert!((torque(time, 1.0) + 9.6e-4 * share / (1.0 + share)).abs() < 1e-15);
        }
    }

    #[test]
    fn of_an_exponential_it_is_drifting_friction() {
        let usual = crate::effect::drifting_friction::effect::<f64>();
        for time in [0.0, 0.4, 9.0, 200.0] {
            let ours = torque_at_time(&super::effect(), 0.1, -2.0, time, &[-1e-4, 2e-5, 30.0, 0.0]);
            let its = torque_at_time(&usual, 0.1, -2.0, time, &[-1e-4, 2e-5, 30.0]);
            assert!((ours - its).abs() < 1e-15, "{time}");
        }
    }
}
