//! Friction before anything was measured: what is usual for a pendulum of this size, so that a fresh file serves
//! every command.
//!
//! The shares are those of the paper's rig (Table 9), rounded: a damping ratio of 0.7 %, and dry friction of some
//! thousandths of m·g·l.

use shared::effect::Effect;
use shared::motion::Pendulum;
use shared::parameters::{ABSURD, Parameters, base};

/// Mw as a share of √(m·g·l·J), J the moment of inertia about the pivot; twice the damping ratio.
const VISCOUS_SHARE: f64 = 0.015;

/// Mc as a share of m·g·l.
const COULOMB_SHARE: f64 = 0.003;

/// Ms as a share of m·g·l.
const STICTION_SHARE: f64 = 0.005;

/// DV as a share of the angular frequency of small swings, per rad of amplitude.
const BAND_SHARE: f64 = 0.01;

/// So short that m·l² does not matter beside I, which then is the whole moment of inertia about the pivot.
const NORMALISED_LENGTH_M: f64 = 1e-3;

/// Period of small swings of a pendulum of which nothing is known, s.
const USUAL_PERIOD_S: f64 = 1.0;

/// A pendulum with friction as usual for its size, values rounded to two digits, within what is accepted.
pub(super) fn parameters(pendulum: Pendulum<f64>) -> Parameters<f64> {
    let (gravity_nm, inertia) = (pendulum.gravity_torque_nm(), pendulum.pivot_inertia_kg_m2());
    let frequency_rad_s = (gravity_nm / inertia).sqrt();
    let mut parameters = Parameters::frictionless(pendulum);
    let accepted = |id: u16, index: usize, value: f64| {
        let most = Effect::<f64>::by_id(id).map_or(value, |effect| effect.parameters[index].high * ABSURD);
        rounded(value).min(most)
    };
    parameters.set_friction(
        accepted(base::VISCOUS, 0, VISCOUS_SHARE * (gravity_nm * inertia).sqrt()),
        accepted(base::COULOMB, 0, COULOMB_SHARE * gravity_nm),
        accepted(base::STICTION, 0, STICTION_SHARE * gravity_nm),
        accepted(base::STICTION, 1, BAND_SHARE * frequency_rad_s),
    );
    parameters
}

/// m·g·l = 1 N·m, moment of inertia for the usual period.
pub(super) fn normalised_pendulum(gravity_m_s2: f64) -> Pendulum<f64> {
    let frequency_rad_s = 2.0 * std::f64::consts::PI / USUAL_PERIOD_S;
    Pendulum {
        mass_kg: 1.0 / (gravity_m_s2 * NORMALISED_LENGTH_M),
        length_m: NORMALISED_LENGTH_M,
        inertia_kg_m2: rounded(frequency_rad_s.powi(-2)),
        gravity_m_s2,
    }
}

fn rounded(value: f64) -> f64 {
    format!("{value:.1e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_guess_for_the_papers_pendulum_is_near_its_table_9() {
        let truth = Parameters::paper();
        let guess = parameters(truth.pendulum);
        for id in [1, 2, 3] {
            for (guess, truth) in guess.values(id).unwrap().iter().zip(truth.values(id).unwrap()) {
                assert!((0.4..2.5).contains(&(guess / truth)), "effect {id}: {guess} for {truth}");
            }
        }
    }

    #[test]
    fn the_normalised_pendulum_has_the_torque_one_and_its_inertia_in_i() {
        let pendulum = normalised_pendulum(9.81);
        assert!((pendulum.gravity_torque_nm() - 1.0).abs() < 1e-12);
        assert!((pendulum.pivot_inertia_kg_m2() / pendulum.inertia_kg_m2 - 1.0).abs() < 5e-3);
        assert_eq!(parameters(pendulum).check(), Ok(()));
    }
}
