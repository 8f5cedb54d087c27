//! What a model leaves beyond the noise.

use super::trial::Trial;
use crate::fit::problem::Problem;
use crate::verdict::Left;

/// A model that leaves more than this share of the noise variance is not the last word.
const WELL_EXPLAINED: f64 = 0.02;

/// Does a model that was fitted on sketches leave so little of all samples that no other view of it is needed?
pub fn is_well_explained(problem: &Problem, trial: &Trial) -> bool {
    excess(problem, trial.judged(problem).cost) <= WELL_EXPLAINED
}

/// Does a model leave no more than the noise?
pub fn is_explained(problem: &Problem, trial: &Trial) -> bool {
    problem.chi_square(trial.cost).left() == Left::Noise
}

/// Residual variance beyond the noise, as a share of the noise variance.
pub fn excess(problem: &Problem, cost: f64) -> f64 {
    problem.chi_square(cost).excess()
}
