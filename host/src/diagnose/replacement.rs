//! Each effect of a model replaced by another one: is a different pair as good, or better?
//!
//! A search that adds one effect at a time may begin with a wrong one that imitates the sum of two; and an effect that
//! cannot be told from another stays unnoticed as long as its partner is missing.

use super::physical::is_sound;
use super::score::{Promise, promises};
use super::search::fit_promise;
use super::trial::{Trial, finish};
use crate::fit::problem::Problem;
use rayon::prelude::*;
use shared::effect::Effect;

/// A replacement must promise this share of what the effect itself is worth; a linearised step promises too little.
const SHARE_OF_WORTH: f64 = 0.5;

/// Replacements fitted for each effect, at most.
const MAX_FITTED: usize = 3;

/// Costs within this factor of the model's are worth a fit to the last digit.
const NEAR: f64 = 1.1;

/// Models with one effect of `claimed` replaced, the lowest cost first; `without` fits it without one effect.
pub fn replacements(
    problem: &Problem,
    claimed: &Trial,
    candidates: &[&'static Effect<f64>],
    without: impl Fn(u16) -> Trial,
) -> Vec<Trial> {
    let fresh: Vec<&'static Effect<f64>> =
        candidates.iter().copied().filter(|effect| !claimed.has(effect.name)).collect();
    let mut others: Vec<Trial> =
        claimed.effects.iter().flat_map(|effect| replaced(problem, claimed, &without(effect.id), &fresh)).collect();
    others.retain(|other| is_sound(problem, other));
    others.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    others
}

fn replaced(problem: &Problem, claimed: &Trial, rest: &Trial, fresh: &[&'static Effect<f64>]) -> Vec<Trial> {
    let sketches = problem.sketches();
    let rough = problem.on(&sketches);
    let (rest, claimed_cost) = (rest.judged(&rough), claimed.judged(&rough).cost);
    let worth = rest.cost - claimed_cost;
    let mut best: Vec<Promise> = Vec::new();
    for promise in promises(&rough, &rest, fresh) {
        let is_new = best.iter().all(|other| other.effect.id != promise.effect.id);
        if is_new && promise.gain > SHARE_OF_WORTH * worth && best.len() < MAX_FITTED {
            best.push(promise);
        }
    }
    let fitted = |promise: &Promise| {
        let is_near = |trial: &Trial| trial.cost < NEAR * claimed_cost;
        let trial = fit_promise(&rough, &rest, promise)?;
        // Another stop level may be what it lacks.
        let trial = if is_near(&trial) { trial } else { finish(&rough, &trial) };
        Some(if is_near(&trial) { finish(problem, &trial) } else { trial.judged(problem) })
    };
    best.par_iter().filter_map(fitted).collect()
}
