//! Each effect of a model replaced by another one: is a different pair as good, or better?
//!
//! A search that adds one effect at a time may begin with a wrong one that imitates the sum of two; and an effect that
//! cannot be told from another stays unnoticed as long as its partner is missing.

use super::extension::fit_promise;
use super::level::sort;
use super::physical::is_sound;
use super::score::{Promise, promises};
use super::search::worth_all_samples;
use super::trial::{Sketch, Trial};
use crate::fit::problem::Problem;
use rayon::prelude::*;
use shared::effect::Effect;

/// A replacement must promise this share of what the effect itself is worth; a linearised step promises too little.
const SHARE_OF_WORTH: f64 = 0.5;

/// Replacements fitted for each effect, at most.
const MAX_FITTED: usize = 3;

/// What replacements are made from, and how they are judged.
pub struct Replacements<'a, 'b> {
    /// The swings.
    pub problem: &'b Problem<'a>,
    /// The same with sketches of the swings.
    pub rough: &'b Problem<'b>,
    /// Effects that may stand in.
    pub candidates: &'b [&'static Effect<f64>],
    /// Models that were tried before.
    pub known: &'b [Trial],
}

impl Replacements<'_, '_> {
    /// New models with one effect of `claimed` replaced, the lowest cost first; `without` fits it without one effect on
    /// sketches.
    pub fn of(&self, claimed: &Trial, without: impl Fn(u16) -> Trial) -> Vec<Trial> {
        let claimed_cost = claimed.judged(self.rough).cost;
        let of_effect = |effect: &&'static Effect<f64>| self.replaced(claimed, claimed_cost, &without(effect.id));
        let mut others: Vec<Trial> = claimed.effects.iter().flat_map(of_effect).collect();
        others.retain(|other| is_sound(self.problem, other));
        sort(&mut others);
        others
    }

    fn replaced(&self, claimed: &Trial, claimed_cost: f64, rest: &Trial) -> Vec<Trial> {
        let is_new = |effect: &Effect<f64>| {
            let is_it = |other: &Trial| other.has(effect.name) && rest.effects.iter().all(|kept| other.has(kept.name));
            !claimed.has(effect.name) && !self.known.iter().any(is_it)
        };
        let fresh: Vec<&'static Effect<f64>> =
            self.candidates.iter().copied().filter(|effect| is_new(effect)).collect();
        let worth = rest.cost - claimed_cost;
        let mut best: Vec<Promise> = Vec::new();
        for promise in promises(self.rough, rest, &fresh) {
            let is_first = best.iter().all(|other| other.effect.id != promise.effect.id);
            if is_first && promise.gain > SHARE_OF_WORTH * worth && best.len() < MAX_FITTED {
                best.push(promise);
            }
        }
        let fitted = |promise: &Promise| {
            // Another stop level may be what it lacks.
            let sketch = Sketch::of(self.rough, &fit_promise(self.rough, rest, promise)?);
            let is_near = sketch.trial.cost < worth_all_samples(self.rough, claimed_cost);
            Some(if is_near { sketch.on_all(self.problem) } else { sketch.trial.judged(self.problem) })
        };
        best.par_iter().filter_map(fitted).collect()
    }
}
