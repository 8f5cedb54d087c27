//! Models with the same number of added effects, the lowest cost first; and what they leave.

use crate::fit::fitted::Fitted;
pub(super) use crate::fit::fitted::sort;
use crate::fit::problem::Problem;
use crate::verdict::Left;

/// An effect may leave this share of the excess that was there before it …
pub(super) const MOST_LEFT: f64 = 0.6;

/// … and less where the noise is not reached even so: then nobody knows what else is in the swings.
pub(super) const MOST_LEFT_UNEXPLAINED: f64 = 0.4;

/// Predictions that differ by less than this many noises are called alike.
pub(super) const ALIKE_NOISES: f64 = 0.05;

/// Costs within this factor of the best are worth a fit to the last digit on decimated swings.
pub(super) const NEAR: f64 = 1.3;

/// A model that leaves more than this share of the noise variance is not the last word.
const WELL_EXPLAINED: f64 = 0.02;

/// A second effect shall remove most of what the first one leaves, and one linearised step has promised at least 0.6 of
/// what a fit then kept (0.39 of 0.65, on real pendulums and the eight examples); a model for which none promises this
/// share of its excess is not gone on with. Half of it: long recordings take twice as long. Twice: pairs would be
/// missed.
pub(super) const PROMISING: f64 = 0.25;

/// Does a model that was fitted on decimated swings leave so little of all samples that no other view of it is needed?
pub(super) fn is_well_explained(problem: &Problem, model: &Fitted) -> bool {
    excess(problem, &model.evaluated(problem)) <= WELL_EXPLAINED
}

/// Does a model leave no more than the noise?
pub(super) fn is_explained(problem: &Problem, model: &Fitted) -> bool {
    problem.chi_square(model.cost).left() == Left::Noise
}

/// The reduced chi-square beyond 1.
pub(super) fn excess(problem: &Problem, model: &Fitted) -> f64 {
    problem.chi_square(model.cost).excess()
}

/// The models of a sorted level that nearly cost what the best one does.
pub(super) fn near_the_best(level: &[Fitted]) -> &[Fitted] {
    let n_near = level.iter().take_while(|model| model.cost < NEAR * level[0].cost).count();
    &level[..n_near]
}

/// A model whose cost on decimated swings is below this may be the best one of all samples, if the best on them costs
/// `lowest`.
pub(super) fn worth_all_samples(decimated: &Problem, lowest: f64) -> f64 {
    let chance = MOSTLY_CHANCE * decimated.noise_rad().powi(2);
    let missing = (lowest - decimated.noise_cost()).max(0.0);
    lowest + chance + SMALL_SHARE_OF_EXCESS * missing
}

/// On decimated swings, differences of so many noise variances may be chance, or another stop level …
const MOSTLY_CHANCE: f64 = 50.0;

/// … and so may this share of what is missing from the model.
const SMALL_SHARE_OF_EXCESS: f64 = 0.1;

/// Of models with the same effects only the first is kept.
pub(super) fn drop_doubles(level: &mut Vec<Fitted>) {
    let mut seen: Vec<Vec<u16>> = Vec::new();
    level.retain(|model| {
        let mut ids: Vec<u16> = model.effects.iter().map(|effect| effect.id).collect();
        ids.sort_unstable();
        let new = !seen.contains(&ids);
        seen.push(ids);
        new
    });
}
