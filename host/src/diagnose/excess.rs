//! What a model leaves beyond the noise.

use super::trial::Trial;
use crate::fit::problem::Problem;

/// A residual this far above the noise variance is worth an explanation; the noise itself is known to about 2 %.
pub const EXCESS_WORTH_EXPLAINING: f64 = 0.03;

/// What a model with an added effect may leave: the law of the list is never quite the law of the rig.
const EXCESS_LEFT: f64 = 0.045;

/// A model that leaves more than this share of the noise variance is not the last word.
const WELL_EXPLAINED: f64 = 0.02;

/// Does a model that was fitted on sketches leave so little of all samples that no other view of it is needed?
pub fn is_well_explained(problem: &Problem, trial: &Trial) -> bool {
    excess(problem, trial.judged(problem).cost) <= WELL_EXPLAINED
}

/// Does a model leave no more than the noise?
pub fn is_explained(problem: &Problem, trial: &Trial) -> bool {
    let allowed = if trial.effects.is_empty() { EXCESS_WORTH_EXPLAINING } else { EXCESS_LEFT };
    excess(problem, trial.cost) <= allowed
}

/// Residual variance beyond the noise, as a share of the noise variance.
pub fn excess(problem: &Problem, cost: f64) -> f64 {
    cost / problem.noise_cost() - 1.0
}
