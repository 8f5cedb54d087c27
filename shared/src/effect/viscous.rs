//! Viscous friction: torque proportional to speed.
//! Source: paper, Eq 14.

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules};
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 1,
        name: "viscous",
        summary: "The grease of the bearing shears: twice the speed, twice the torque.",
        formula: "torque = -Mw*omega",
        source: "paper, Eq 14",
        experiment: "Any swing: the amplitude decays exponentially while viscous friction rules.",
        parameters: &[Parameter {
            symbol: "Mw",
            unit: "N·m·s/rad",
            low: 0.0,
            high: 5e-3,
            start: 0.0,
            meaning: prose!("torque at 1 rad/s"),
        }],
        starts: &[[0.0; MAX_VALUES]],
        family: Family::Speed,
        generalises: None,
        is_fine: false,
        rules: Rules::NONE,
        action: Action::Base,
    }
}

/// Torque in N·m at a velocity in rad/s.
#[inline(always)]
pub fn torque_nm<R: Real>(velocity_rad_s: R, viscous: R) -> R {
    -viscous * velocity_rad_s
}
