//! Coulomb friction: constant torque against the direction of sliding.
//! Source: paper, Eq 14.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules};
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 2,
        name: "coulomb",
        summary: "Dry rubbing of bearing and wiper: the same torque at every speed, against the motion.",
        formula: "torque = -Mc*sgn(omega)",
        source: "paper, Eq 14",
        experiment: "The last swings before rest: the amplitude falls by the same angle every half swing.",
        parameters: &[Parameter {
            symbol: "Mc",
            unit: "N·m",
            low: 0.0,
            high: 2e-2,
            start: 0.0,
            meaning: prose!("torque while sliding"),
        }],
        starts: &[[0.0; MAX_VALUES]],
        family: Family::Dry,
        generalises: None,
        is_fine: false,
        rules: Rules::NONE,
        action: Action::Base,
    }
}

/// Torque in N·m when sliding in a direction (−1, 0, +1).
#[inline(always)]
pub fn torque_nm<R: Real>(direction: R, coulomb: R) -> R {
    -coulomb * direction
}
