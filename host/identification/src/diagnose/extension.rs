//! One more effect on top of a model: which effects are fitted, and from which starts.

use super::budget::Budget;
use super::models::{drop_doubles, is_explained, near_the_best, sort};
use crate::cores::on_all_cores;
use crate::fit::descent::Tolerance;
use crate::fit::fitted::Fitted;
use crate::fit::prediction::{Prediction, predictions, predictions_between};
use crate::fit::problem::Problem;
use crate::fit::refine::{Band, levels};
use shared::effect::{Action, CUSTOM_FORMULA_ID, Effect};

/// Effects whose predicted reduction is below this share of the best one are not fitted.
const SHARE_OF_BEST_PREDICTION: f64 = 0.1;

/// One that swings by itself takes several times as long to simulate and can imitate much, so that less than this share of
/// the best one is not fitted. Of 12 rigs on stands that swing 11 promise most by that, and one 0.96 of the best; four
/// searches on the arm on ball bearings promise 0.12, 0.43, 0.95 and 0.96. Half of it: the same two are fitted there, more
/// elsewhere; no share is twice as large.
const SHARE_OF_SUPPORTS: f64 = 0.9;

/// At most so many effects are fitted on top of one model.
const MAX_FITTED: usize = 12;

/// A generalisation is fitted at once if it promises so many times the gain of its special case.
const GENERALISATION_GAIN: f64 = 1.05;

/// A prediction is large from this share of the best one on …
const LARGE_PREDICTION: f64 = 0.7;

/// … and comes true if the fit gains this share of it. With 0.7 the drag of a light pendulum that hangs at rest for 20 s
/// in the end is lost: its fit keeps 0.73 at the stop level of the base model, and all at its own. Half of it: no stop
/// level is sought again; nearer to 1: it is sought for most predictions, since a linear one is seldom kept whole.
const KEPT_PREDICTION: f64 = 0.9;

/// A model with one more effect, each of the promising ones in turn: first the best start of each, then the next best
/// and the wider forms; where one explains the swings, only of those that come near it, but then all their starts. None
/// if no prediction is to remove at least this share of the excess.
pub(super) fn extensions(
    problem: &Problem,
    model: &Fitted,
    candidates: &[&'static Effect<f64>],
    least_share: f64,
    budget: &Budget,
) -> Vec<Fitted> {
    // Of a law in its wider form the usual one is a part.
    let is_part = |effect: &Effect<f64>| effect.wider_form().is_some_and(|wide| model.has(wide.name));
    let fresh: Vec<&'static Effect<f64>> =
        candidates.iter().copied().filter(|effect| !model.has(effect.name) && !is_part(effect)).collect();
    let promised = predictions(problem, model, &fresh);
    let supports: Vec<Prediction> = promised.iter().filter(|promise| is_support(promise.effect)).cloned().collect();
    let (first, mut others) = worth_fitting(promised.clone());
    let best_reduction = first.first().map_or(0.0, |prediction| prediction.reduction);
    if best_reduction < least_share * (model.cost - problem.noise_cost()) {
        return Vec::new();
    }
    let mut level = on_all_cores(&first, |prediction| fitted(problem, model, prediction, best_reduction));
    sort(&mut level);
    let is_explained = |level: &[Fitted]| level.first().is_some_and(|best| is_explained(problem, best));
    if model.effects.is_empty() && !is_explained(&level) && budget.allows_more() {
        // What swings by itself would take the time of all others together.
        let others = level.iter_mut().filter(|model| !swings(model));
        on_all_cores(others, |fitted| *fitted = grown(problem, fitted));
        sort(&mut level);
    }
    if !budget.allows_more() {
        return level;
    }
    if !is_explained(&level) {
        let mut between = predictions_between(problem, model, &fresh, &promised);
        between.retain(|prediction| prediction.reduction > SHARE_OF_BEST_PREDICTION * best_reduction);
        level.extend(on_all_cores(&between, |prediction| prediction.fitted(problem)));
        sort(&mut level);
    }
    if is_explained(&level) {
        let rivals: Vec<&str> = near_the_best(&level).iter().filter_map(|rival| rival.names().pop()).collect();
        others.retain(|prediction| rivals.contains(&prediction.effect.name) || prediction.effect.generalises.is_some());
    } else {
        let leading: Vec<&str> = near_the_best(&level).iter().filter_map(|leader| leader.names().pop()).collect();
        keep_first_of_each_but(&mut others, &leading);
    }
    level.extend(on_all_cores(&others, |prediction| prediction.fitted(problem)));
    sort(&mut level);
    if model.effects.is_empty() && !is_explained(&level) && budget.allows_more() {
        level.extend(supports_from_first_swings(problem, &first, &supports));
        sort(&mut level);
    }
    drop_doubles(&mut level);
    level
}

/// What swings by itself, if it was fitted at all, begun with the first swings from each of its starts, whatever that promised:
/// over the whole swings another resonance lies at every few oscillations of a support, and a fit ends in one beside the true one.
fn supports_from_first_swings(problem: &Problem, first: &[Prediction], supports: &[Prediction]) -> Vec<Fitted> {
    let is_tried = |promise: &&Prediction| first.iter().any(|tried| tried.effect.id == promise.effect.id);
    let tried: Vec<&Prediction> = supports.iter().filter(is_tried).collect();
    on_all_cores(tried, |promise| promise.grown(problem))
}

/// The best start of each effect that predicts enough; and the others, with the generalisations that predict hardly
/// more than their special case: if those do not suffice, they may still do after some steps.
fn worth_fitting(predictions: Vec<Prediction>) -> (Vec<Prediction>, Vec<Prediction>) {
    let best = predictions.first().map_or(0.0, |prediction| prediction.reduction);
    let needless = needless_generalisations(&predictions);
    let (mut first, mut others): (Vec<Prediction>, Vec<Prediction>) = (Vec::new(), Vec::new());
    let is_promising = |prediction: &Prediction| {
        let least = if is_support(prediction.effect) { SHARE_OF_SUPPORTS } else { SHARE_OF_BEST_PREDICTION };
        prediction.reduction > least * best
    };
    let is_typed = |prediction: &Prediction| prediction.effect.id == CUSTOM_FORMULA_ID;
    for prediction in predictions.into_iter().filter(|prediction| is_promising(prediction) || is_typed(prediction)) {
        let is_known = first.iter().any(|other| other.effect.id == prediction.effect.id);
        let waits = needless.contains(&prediction.effect.id);
        if is_typed(&prediction) {
            // Nobody chose its starts with care, so all of them are tried.
            first.push(prediction);
        } else if is_known || waits {
            others.push(prediction);
        } else if first.len() < MAX_FITTED {
            first.push(prediction);
        }
    }
    (first, others)
}

/// Does something swing beside the pendulum in a model?
pub(super) fn swings(model: &Fitted) -> bool {
    model.effects.iter().any(|effect| is_support(effect))
}

fn is_support(effect: &Effect<f64>) -> bool {
    matches!(effect.action, Action::Support(_))
}

/// All starts of the effects that lead, and the best of each other one.
fn keep_first_of_each_but(predictions: &mut Vec<Prediction>, leading: &[&str]) {
    let mut seen = Vec::new();
    predictions.retain(|prediction| {
        let new = !seen.contains(&prediction.effect.id);
        seen.push(prediction.effect.id);
        new || leading.contains(&prediction.effect.name)
    });
}

/// A wider form of an effect is at first only worth its numbers if it promises visibly more.
fn needless_generalisations(predictions: &[Prediction]) -> Vec<u16> {
    let gain_of = |name: &str| {
        predictions
            .iter()
            .filter(|prediction| prediction.effect.name == name)
            .map(|prediction| prediction.reduction)
            .fold(0.0, f64::max)
    };
    let is_needless = |prediction: &&Prediction| {
        prediction
            .effect
            .generalises
            .is_some_and(|special| gain_of(prediction.effect.name) <= GENERALISATION_GAIN * gain_of(special))
    };
    predictions.iter().filter(is_needless).map(|prediction| prediction.effect.id).collect()
}

/// Begun anew with the first swings, if that is better: over many periods a step that changes the period leads into a
/// side valley, or into one so narrow that a fit ends on the way. Swings that rest are led to their stop.
pub(super) fn grown(on: &Problem, fitted: &Fitted) -> Fitted {
    let begun = if on.comes_to_rest() { fitted.calmed(on) } else { fitted.regrown(on) };
    let anew = begun.refined(on, Band::Held, Tolerance::ROUGH);
    fitted.clone().better(anew)
}

/// Fits what a prediction leads to; where little of a large one comes true, another stop level may be what is lacking, from
/// there or from the swings before the last ones, which lead astray where the law decides at which turn it stops. Not of what
/// swings by itself, which would take the time of all others together; and of the best start of an effect alone: from four
/// starts of a detent beside presliding the levels took 12 of the 15 s of a search, and led to the same model.
fn fitted(on: &Problem, model: &Fitted, prediction: &Prediction, best_reduction: f64) -> Fitted {
    let fitted = prediction.fitted(on);
    let is_large = prediction.reduction > LARGE_PREDICTION * best_reduction;
    let came_true = model.cost - fitted.cost > KEPT_PREDICTION * prediction.reduction;
    if !is_large || came_true || swings(&fitted) {
        return fitted;
    }
    levels(on, &fitted).swap_remove(0).better(prediction.stopped_anew(on))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{effect, fitted as fitted_from, rig, simulated};
    use crate::fit::identify::problem_of;
    use crate::fit::problem::Point;
    use crate::fit::tally::Tally;
    use crate::verdict::Left;

    #[test]
    fn all_starts_of_a_leading_effect_are_fitted_and_one_more_of_each_other() {
        let count = Tally::default();
        let problem = problem_of(&[], &rig(), &count);
        let model = Fitted::at(&problem, &Point { values: problem.template_values(), starts: Vec::new() });
        let of = |name: &str| {
            let effect = effect(name);
            let prediction =
                |start| Prediction { effect, start, reduction: 1.0, at_start: model.clone(), model: model.clone() };
            effect.starts.iter().copied().map(prediction).collect::<Vec<_>>()
        };
        let mut all = [of("stribeck"), of("detent")].concat();
        keep_first_of_each_but(&mut all, &["detent"]);
        let starts = |name: &str| all.iter().filter(|prediction| prediction.effect.name == name).count();
        assert!(effect("stribeck").starts.len() > 1);
        assert_eq!((starts("stribeck"), starts("detent")), (1, effect("detent").starts.len()));
    }

    /// A fit to the whole swing ends at 1.3 times the noise's squares.
    #[test]
    fn a_stand_is_found_from_the_first_swings() {
        let (mut truth, count) = (rig(), Tally::default());
        let [support, law] = ["resonant-support", "power-law-drag"].map(effect);
        truth.set(support.id, &[0.04, 4.2, 0.04, 1.0]).unwrap();
        let swings = [simulated("stand", &truth, 40.0, 1)];
        let problem = problem_of(&swings, &rig(), &count);
        let (decimated, budget) = (problem.decimated(), Budget::new(&count));
        let rough = problem.on(&decimated);
        let base = fitted_from(&problem, &rig()).evaluated(&rough);
        let level = extensions(&rough, &base, &[support, law], 0.0, &budget);
        assert!(level[0].has(support.name) && rough.chi_square(level[0].cost).left() != Left::Missing, "{level:?}");
    }
}
