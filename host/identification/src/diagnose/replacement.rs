//! Each effect of a model replaced by another one: is a different pair as good, or better?
//!
//! A search that adds one effect at a time may begin with a wrong one that imitates the sum of two; and an effect that
//! cannot be told from another stays unnoticed as long as its partner is missing.

use super::models::{sort, worth_all_samples};
use super::physical::is_sound;
use crate::cores::on_all_cores;
use crate::fit::fitted::Fitted;
use crate::fit::prediction::{Prediction, predictions};
use crate::fit::problem::Problem;
use crate::fit::refine::{levels, on_all};
use shared::effect::Effect;

/// A replacement must promise this share of what the effect itself is worth; a linearised step promises too little.
const SHARE_OF_WORTH: f64 = 0.5;

/// Replacements fitted for each effect, at most.
const MAX_FITTED: usize = 3;

/// What replacements are made from, and how they are judged.
pub struct Replacements<'a, 'b> {
    /// The swings.
    pub problem: &'b Problem<'a>,
    /// The same with decimated swings.
    pub rough: &'b Problem<'b>,
    /// Effects that may stand in.
    pub candidates: &'b [&'static Effect<f64>],
    /// Models that were tried before.
    pub known: &'b [Fitted],
}

impl Replacements<'_, '_> {
    /// New models with one effect of `claimed` replaced, the lowest cost first; `without` fits it without one effect on
    /// decimated swings.
    pub fn of(&self, claimed: &Fitted, without: impl Fn(u16) -> Fitted) -> Vec<Fitted> {
        let claimed_cost = claimed.evaluated(self.rough).cost;
        let of_effect = |effect: &&'static Effect<f64>| self.replaced(claimed, claimed_cost, &without(effect.id));
        let mut others: Vec<Fitted> = claimed.effects.iter().flat_map(of_effect).collect();
        others.retain(|other| is_sound(self.problem, other));
        sort(&mut others);
        others
    }

    fn replaced(&self, claimed: &Fitted, claimed_cost: f64, rest: &Fitted) -> Vec<Fitted> {
        let is_new = |effect: &Effect<f64>| {
            let is_it = |other: &Fitted| other.has(effect.name) && rest.effects.iter().all(|kept| other.has(kept.name));
            !claimed.has(effect.name) && !self.known.iter().any(is_it)
        };
        let fresh: Vec<&'static Effect<f64>> =
            self.candidates.iter().copied().filter(|effect| is_new(effect)).collect();
        let worth = rest.cost - claimed_cost;
        let mut best: Vec<Prediction> = Vec::new();
        for prediction in predictions(self.rough, rest, &fresh) {
            let is_first = best.iter().all(|other| other.effect.id != prediction.effect.id);
            if is_first && prediction.reduction > SHARE_OF_WORTH * worth && best.len() < MAX_FITTED {
                best.push(prediction);
            }
        }
        let fitted = |prediction: &Prediction| {
            // Another stop level may be what it lacks.
            let levels = levels(self.rough, &prediction.fitted(self.rough));
            let is_near = levels[0].cost < worth_all_samples(self.rough, claimed_cost);
            if is_near { on_all(self.problem, &levels) } else { levels[0].evaluated(self.problem) }
        };
        on_all_cores(&best, fitted)
    }
}
