//! An effect put into a model: where it may begin, and what the swings make of it.

use super::descent::Tolerance;
use super::fitted::Fitted;
use super::other_turn::or_of_another_turn;
use super::prediction::{Prediction, predictions, predictions_between};
use super::problem::{Problem, Quantity, Unknown};
use super::refine::Band;
use crate::verdict::Left;
use shared::effect::Effect;

/// A model with one more effect, fitted from the effect's most promising starts; `None` if there is no room for it.
pub(crate) fn fitted(problem: &Problem, model: &Fitted, effect: &'static Effect<f64>) -> Option<Fitted> {
    let best = begun(problem, model, effect)?;
    // Far above the noise the last swings tell nothing of a velocity band, whose search costs the most.
    let finished =
        if is_near_noise(problem, &best) { best } else { best.refined(problem, Band::Level, Tolerance::JUDGE) };
    Some(match is_near_noise(problem, &finished) {
        true => or_of_another_turn(problem, finished.refined(problem, Band::Searched, Tolerance::JUDGE)),
        false => finished,
    })
}

/// The same, Ms and DV not searched to the end.
pub(crate) fn begun(problem: &Problem, model: &Fitted, effect: &'static Effect<f64>) -> Option<Fitted> {
    let predictions = predictions(problem, &model.evaluated(problem), &[effect]);
    let fits = predictions.iter().take(STARTS).map(|prediction| from_start(problem, prediction));
    let best = fits.min_by(|a, b| a.cost.total_cmp(&b.cost))?;
    if problem.chi_square(best.cost).left() == Left::Noise {
        return Some(best);
    }
    let between = predictions_between(problem, &model.evaluated(problem), &[effect], &predictions);
    Some(between.iter().map(|prediction| from_start(problem, prediction)).fold(best, Fitted::better))
}

fn from_start(problem: &Problem, prediction: &Prediction) -> Fitted {
    let fitted = prediction.fitted(problem);
    if problem.chi_square(fitted.cost).left() == Left::Noise {
        return fitted;
    }
    // The numbers of a model that lacks it may hold an effect near nothing: so it is begun with the first swings too.
    let anew = prediction.model.regrown(problem).refined(problem, Band::Held, Tolerance::SCREEN);
    // And the law may decide at which turn it stops.
    let stopped = prediction.model.calmed(problem).refined(problem, Band::Level, Tolerance::JUDGE);
    anew.better(fitted).better(stopped)
}

fn is_near_noise(problem: &Problem, model: &Fitted) -> bool {
    problem.rmse_rad(model.cost) < NEAR_NOISE * problem.noise_rad()
}

/// An error of so many times the noise is near it.
const NEAR_NOISE: f64 = 5.0;

/// Starts of an effect that are fitted.
const STARTS: usize = 3;

/// Effects of a model that came to the end of what they may be are put into it anew, one after the other: begun with far too
/// little strength, a law may lose all of it before the other numbers are right.
pub(super) fn or_added_anew(problem: &Problem, found: Fitted) -> Fitted {
    let anew = |model: Fitted, effect: &&'static Effect<f64>| {
        if problem.chi_square(model.cost).left() == Left::Noise || !is_at_an_end(&model, effect) {
            return model;
        }
        let again = fitted(problem, &model.without(effect.id), effect);
        again.into_iter().fold(model, Fitted::better)
    };
    let effects = found.effects.clone();
    effects.iter().fold(found, anew)
}

/// Did a number of an effect end at the end of its range?
pub(crate) fn is_at_an_end(model: &Fitted, effect: &Effect<f64>) -> bool {
    let is_its = |unknown: &&Unknown| matches!(unknown.quantity, Quantity::Effect { id, .. } if id == effect.id);
    model.unknowns.iter().filter(is_its).any(|unknown| {
        let value = unknown.get(&model.parameters);
        value <= unknown.low || value >= unknown.high
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{effect, fitted as fitted_base, rig, simulated};
    use crate::fit::identify::problem_of;
    use crate::fit::tally::Tally;

    #[test]
    fn a_brake_that_lost_all_its_strength_is_put_in_anew() {
        let (brake, base, count) = (effect("eddy-brake"), rig(), Tally::default());
        let mut truth = rig();
        truth.set(brake.id, &[3e-3, -0.13, 0.12]).unwrap();
        let swings = [simulated("brake", &truth, 14.0, 3)];
        let problem = problem_of(&swings, &base, &count);
        let with = |values: &[f64]| fitted_base(&problem, &base).with(brake, values).unwrap().evaluated(&problem);
        let lost = with(&[0.0, 1.2, 0.02]);
        let again = or_added_anew(&problem, lost.clone());
        let noises = |model: &Fitted| problem.rmse_rad(model.cost) / problem.noise_rad();
        assert!(noises(&lost) > 3.0 && noises(&again) < 1.05, "{} {}", noises(&lost), noises(&again));
        // One that is within its range is left as it is.
        let within = with(&[1e-5, 1.2, 0.1]);
        assert_eq!(or_added_anew(&problem, within.clone()).parameters, within.parameters);
    }
}
