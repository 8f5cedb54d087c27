//! One more effect on top of a model: which effects are fitted, and from which starts.

use super::excess::is_explained;
use super::level::{drop_doubles, near_the_best, sort};
use super::score::{Promise, promises};
use super::trial::{Sketch, Trial, fit_from};
use crate::fit::problem::Problem;
use rayon::prelude::*;
use shared::effect::{CUSTOM_FORMULA_ID, Effect};

/// Effects whose promise is below this share of the best one are not fitted.
const SHARE_OF_BEST_PROMISE: f64 = 0.1;

/// At most so many effects are fitted on top of one model.
const MAX_FITTED: usize = 12;

/// A generalisation is fitted at once if it promises so many times the gain of its special case.
const GENERALISATION_GAIN: f64 = 1.05;

/// A promise is large from this share of the best one on …
const LARGE_PROMISE: f64 = 0.7;

/// … and comes true if the fit gains this share of it.
const KEPT_PROMISE: f64 = 0.7;

/// A model with one more effect, each of the promising ones in turn: first the best start of each, then the next best
/// and the wider forms; where one explains the swings, only of those that come near it, but then all their starts.
pub(super) fn extensions(problem: &Problem, trial: &Trial, candidates: &[&'static Effect<f64>]) -> Vec<Trial> {
    let fresh: Vec<&'static Effect<f64>> =
        candidates.iter().copied().filter(|effect| !trial.has(effect.name)).collect();
    let (first, mut others) = worth_fitting(promises(problem, trial, &fresh));
    let best_gain = first.first().map_or(0.0, |promise| promise.gain);
    let fit = |promises: Vec<Promise>| -> Vec<Trial> {
        promises.par_iter().filter_map(|promise| fit_or_sketch(problem, trial, promise, best_gain)).collect()
    };
    let mut level = fit(first);
    sort(&mut level);
    if level.first().is_some_and(|best| is_explained(problem, best)) {
        let rivals: Vec<&str> = near_the_best(&level).iter().filter_map(|rival| rival.names().pop()).collect();
        others.retain(|promise| rivals.contains(&promise.effect.name) || promise.effect.generalises.is_some());
    } else {
        keep_first_of_each(&mut others);
    }
    level.extend(fit(others));
    sort(&mut level);
    drop_doubles(&mut level);
    level
}

/// The best start of each effect that promises enough; and the others, with the generalisations that promise hardly
/// more than their special case: if those do not suffice, they may still do after some steps.
fn worth_fitting(promises: Vec<Promise>) -> (Vec<Promise>, Vec<Promise>) {
    let best = promises.first().map_or(0.0, |promise| promise.gain);
    let needless = needless_generalisations(&promises);
    let (mut first, mut others): (Vec<Promise>, Vec<Promise>) = (Vec::new(), Vec::new());
    let is_promising = |promise: &Promise| promise.gain > SHARE_OF_BEST_PROMISE * best;
    let is_typed = |promise: &Promise| promise.effect.id == CUSTOM_FORMULA_ID;
    for promise in promises.into_iter().filter(|promise| is_promising(promise) || is_typed(promise)) {
        let is_known = first.iter().any(|other| other.effect.id == promise.effect.id);
        let waits = needless.contains(&promise.effect.id);
        if is_typed(&promise) {
            // Nobody chose its starts with care, so all of them are tried.
            first.push(promise);
        } else if is_known || waits {
            others.push(promise);
        } else if first.len() < MAX_FITTED {
            first.push(promise);
        }
    }
    (first, others)
}

fn keep_first_of_each(promises: &mut Vec<Promise>) {
    let mut seen = Vec::new();
    promises.retain(|promise| {
        let new = !seen.contains(&promise.effect.id);
        seen.push(promise.effect.id);
        new
    });
}

/// A wider form of an effect is at first only worth its numbers if it promises visibly more.
fn needless_generalisations(promises: &[Promise]) -> Vec<u16> {
    let gain_of = |name: &str| {
        promises.iter().filter(|promise| promise.effect.name == name).map(|promise| promise.gain).fold(0.0, f64::max)
    };
    let is_needless = |promise: &&Promise| {
        promise
            .effect
            .generalises
            .is_some_and(|special| gain_of(promise.effect.name) <= GENERALISATION_GAIN * gain_of(special))
    };
    promises.iter().filter(is_needless).map(|promise| promise.effect.id).collect()
}

/// Fits what a promise leads to; where little of a large one comes true, another stop level may be what is lacking.
fn fit_or_sketch(problem: &Problem, trial: &Trial, promise: &Promise, best_gain: f64) -> Option<Trial> {
    let fitted = fit_promise(problem, trial, promise)?;
    let is_large = promise.gain > LARGE_PROMISE * best_gain;
    let came_true = trial.cost - fitted.cost > KEPT_PROMISE * promise.gain;
    Some(if is_large && !came_true { Sketch::of(problem, &fitted).trial } else { fitted })
}

/// Fits what a promise leads to.
pub(super) fn fit_promise(problem: &Problem, trial: &Trial, promise: &Promise) -> Option<Trial> {
    let n_before = trial.unknowns.len();
    let (unknowns, template) = trial.with(problem, promise.effect, &promise.point.values[n_before..])?;
    let enlarged = Problem { unknowns, template, ..problem.clone() };
    let mut effects = trial.effects.clone();
    effects.push(promise.effect);
    Some(fit_from(&enlarged, effects, &promise.point, trial.stiction))
}
