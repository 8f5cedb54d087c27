//! Each effect of a model replaced by another one: is a different pair as good, or better?
//!
//! A search that adds one effect at a time may begin with a wrong one that imitates the sum of two; and an effect that
//! cannot be told from another stays unnoticed as long as its partner is missing.

use super::physical::is_sound;
use super::score::{Promise, promises};
use super::search::{fit_promise, worth_all_samples};
use super::trial::{Sketch, Trial};
use crate::fit::problem::Problem;
use rayon::prelude::*;
use shared::effect::Effect;

/// A replacement must promise this share of what the effect itself is worth; a linearised step promises too little.
const SHARE_OF_WORTH: f64 = 0.5;

/// Replacements fitted for each effect, at most.
const MAX_FITTED: usize = 3;

/// Models with one effect of `claimed` replaced that are not among the `known` ones, the lowest cost first; `without`
/// fits it without one effect on the sketches of `rough`.
pub fn replacements(
    problem: &Problem,
    rough: &Problem,
    claimed: &Trial,
    candidates: &[&'static Effect<f64>],
    known: &[Trial],
    without: impl Fn(u16) -> Trial,
) -> Vec<Trial> {
    let fresh: Vec<&'static Effect<f64>> =
        candidates.iter().copied().filter(|effect| !claimed.has(effect.name)).collect();
    let on_sketches = claimed.judged(rough);
    let mut others: Vec<Trial> = claimed
        .effects
        .iter()
        .flat_map(|effect| {
            let rest = without(effect.id);
            let is_new = |added: &&&'static Effect<f64>| {
                let is_it = |other: &Trial| other.has(added.name) && rest.effects.iter().all(|e| other.has(e.name));
                !known.iter().any(is_it)
            };
            let fresh: Vec<&'static Effect<f64>> = fresh.iter().filter(is_new).copied().collect();
            replaced(problem, rough, on_sketches.cost, &rest, &fresh)
        })
        .collect();
    others.retain(|other| is_sound(problem, other));
    others.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    others
}

fn replaced(
    problem: &Problem,
    rough: &Problem,
    claimed_cost: f64,
    rest: &Trial,
    fresh: &[&'static Effect<f64>],
) -> Vec<Trial> {
    let worth = rest.cost - claimed_cost;
    let mut best: Vec<Promise> = Vec::new();
    for promise in promises(rough, rest, fresh) {
        let is_new = best.iter().all(|other| other.effect.id != promise.effect.id);
        if is_new && promise.gain > SHARE_OF_WORTH * worth && best.len() < MAX_FITTED {
            best.push(promise);
        }
    }
    let fitted = |promise: &Promise| {
        // Another stop level may be what it lacks.
        let sketch = Sketch::of(rough, &fit_promise(rough, rest, promise)?);
        let is_near = sketch.trial.cost < worth_all_samples(rough, claimed_cost);
        Some(if is_near { sketch.on_all(problem) } else { sketch.trial.judged(problem) })
    };
    best.par_iter().filter_map(fitted).collect()
}
