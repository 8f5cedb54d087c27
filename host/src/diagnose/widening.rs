//! Wider laws before second effects: a law that was found may have another shape than the usual one, and what that leaves
//! is easily taken for an effect that is not there.

use super::models::{is_explained, near_the_best};
use super::physical::is_sound;
use crate::fit::descent::Tolerance;
use crate::fit::fitted::Fitted;
use crate::fit::problem::Problem;
use crate::fit::refine::{Band, levels};
use rayon::prelude::*;
use shared::effect::{Effect, MAX_VALUES};

/// The models of a sorted level that come near the best, each of their laws in its wider form where there is one, fitted
/// on decimated swings; and in its usual form again, where the way through the wider one led to a better minimum. None
/// where the best leaves no more than the noise.
pub(super) fn widened(rough: &Problem, level: &[Fitted], candidates: &[&'static Effect<f64>]) -> Vec<Fitted> {
    if level.first().is_none_or(|best| is_explained(rough, best)) {
        return Vec::new();
    }
    let all: Vec<Widening> = near_the_best(level).iter().flat_map(|model| widenings(model, candidates)).collect();
    let fitted = all.par_iter().filter_map(|widening| widening.fitted(rough)).flatten_iter();
    fitted.filter(|model| is_sound(rough, model)).collect()
}

/// A law of a model, and its wider form.
struct Widening<'a> {
    model: &'a Fitted,
    usual: &'static Effect<f64>,
    wide: &'static Effect<f64>,
}

fn widenings<'a>(model: &'a Fitted, candidates: &[&'static Effect<f64>]) -> Vec<Widening<'a>> {
    let wider = candidates.iter().filter(|wide| wide.rules.follows_special_case);
    let pair = |wide: &&'static Effect<f64>| {
        let usual = model.effects.iter().find(|effect| wide.generalises == Some(effect.name))?;
        Some(Widening { model, usual, wide })
    };
    wider.filter_map(pair).collect()
}

impl Widening<'_> {
    /// From the numbers of the usual law and from each start of what the wider one has beyond them the best, and the
    /// usual law from there if that is better than it was.
    fn fitted(&self, rough: &Problem) -> Option<Vec<Fitted>> {
        let rest = self.model.without(self.usual.id);
        let own = self.model.parameters.values(self.usual.id)?;
        let fits = self.wide.starts.iter().filter_map(|start| {
            let mut values = *start;
            values.iter_mut().zip(own).for_each(|(value, own)| *value = *own);
            Some(rest.with(self.wide, &values)?.refined(rough, Band::Held, Tolerance::SCREEN))
        });
        let best = fits.min_by(|a, b| a.cost.total_cmp(&b.cost))?;
        let mut found = vec![levels(rough, &best).swap_remove(0)];
        let narrow = self.narrowed(&found[0])?.refined(rough, Band::Held, Tolerance::SCREEN);
        found.extend((narrow.cost < self.model.cost).then_some(narrow));
        Some(found)
    }

    /// The usual law with the first numbers of the wider one, not fitted yet.
    fn narrowed(&self, wide: &Fitted) -> Option<Fitted> {
        let mut values = [0.0; MAX_VALUES];
        values.iter_mut().zip(wide.parameters.values(self.wide.id)?).for_each(|(value, own)| *value = *own);
        wide.without(self.wide.id).with(self.usual, &values)
    }
}
