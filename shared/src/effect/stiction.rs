//! Stiction with a velocity band: what holds the pendulum when it has (almost) stopped.
//! Source: D. Karnopp, J. Dyn. Sys. Meas. Control 107 (1985) 100; paper, Eq 14. The rule itself is in
//! [`crate::karnopp`].

use super::{Action, Effect, Family, MAX_VALUES, Parameter, Rules};
use crate::real::Real;

/// The effect's entry in the list.
pub const fn effect<R: Real>() -> Effect<R> {
    Effect {
        id: 3,
        name: "stiction",
        summary: "A pendulum at rest needs a push of its own to start: up to Ms the bearing holds it.",
        formula: "|omega| < DV: friction holds up to Ms",
        source: "D. Karnopp, J. Dyn. Sys. Meas. Control 107 (1985) 100; paper, Eq 14",
        experiment: "The angle at which the pendulum stops, over several releases.",
        parameters: &[
            Parameter {
                symbol: "Ms",
                unit: "N·m",
                low: 0.0,
                high: 5e-2,
                start: 0.0,
                meaning: prose!("largest torque it can hold"),
            },
            Parameter {
                symbol: "DV",
                unit: "rad/s",
                low: 0.0,
                high: 0.3,
                start: 0.0,
                meaning: prose!("speeds below count as standing"),
            },
        ],
        starts: &[[0.0; MAX_VALUES]],
        family: Family::Dry,
        generalises: None,
        is_fine: false,
        rules: Rules::NONE,
        action: Action::Base,
    }
}
