//! What may be claimed: which effects are missing, which can't be told apart, what stays unexplained.

use super::budget::Budget;
use super::models::{ALIKE_NOISES, MOST_LEFT, MOST_LEFT_UNEXPLAINED, NEAR, excess, is_explained};
use super::physical::is_sound;
use super::replacement::Replacements;
use super::rests::Rests;
use super::search::Found;
use super::value::{Candidate, values};
use super::widening::in_usual_form;
use crate::fit::descent::Tolerance;
use crate::fit::fitted::Fitted;
use crate::fit::problem::Problem;
use crate::fit::refine::{Band, levels, on_all};
use crate::swing::Window;
use crate::verdict::Left;
use shared::effect::Effect;

/// Where the noise is not reached, a simpler model is taken that leaves no more than so many times the excess.
const SIMPLER_MAY_LEAVE: f64 = 3.0;

/// Sums of squares closer than this, in noise variances, are no reason to prefer one effect over another.
pub const INDISTINGUISHABLE: f64 = 25.0;

/// So often a claimed model is exchanged for a better one with one effect replaced.
const MAX_ROUNDS: usize = 3;

/// Decides from what the search found.
pub(super) struct Judge<'a, 'b> {
    pub(super) problem: &'b Problem<'a>,
    /// The same with decimated swings.
    pub(super) rough: &'b Problem<'b>,
    pub(super) found: &'b Found,
    pub(super) candidates: &'b [&'static Effect<f64>],
    pub(super) budget: &'b Budget<'b>,
    /// What it asked for already.
    pub(super) rests: Rests,
}

impl Judge<'_, '_> {
    fn noise_variance(&self) -> f64 {
        self.problem.noise_rad().powi(2)
    }

    /// Cost in noise variances, a unit that grows where even the best model leaves more than the noise, and where neighbouring
    /// readings are alike: then fewer of them tell what a number gains.
    pub(super) fn unit(&self) -> f64 {
        let lowest = self.found.levels.iter().flatten().map(|model| model.cost).fold(self.found.base.cost, f64::min);
        let variance = self.noise_variance().max(lowest / self.problem.n_samples(Window::Whole) as f64);
        let colour = self.problem.chi_square(lowest).colour;
        variance / colour.map_or(1.0, |colour| colour.independent_share)
    }

    pub(super) fn criterion(&self, model: &Fitted) -> f64 {
        let n_samples = self.problem.n_samples(Window::Whole) as f64;
        model.cost / self.unit() + model.n_added() as f64 * n_samples.ln()
    }

    /// The model to claim: level by level as long as each added effect removes a substantial part of what was left;
    /// at the last level the lowest criterion decides, a special case before its generalisation.
    pub(super) fn claimed(&self) -> Fitted {
        let mut claimed = self.found.base.clone();
        for level in &self.found.levels {
            let chosen = self.preferred(level);
            if self.is_worth_it(&claimed, chosen) {
                claimed = chosen.clone();
            }
        }
        self.pruned(claimed)
    }

    /// Does each effect that a model has more than another remove a substantial part of what that one leaves?
    pub(super) fn is_worth_it(&self, before: &Fitted, after: &Fitted) -> bool {
        let left = self.excess(before);
        let removed = left - self.excess(after);
        let visible = removed * self.problem.n_samples(Window::Whole) as f64 > 2.0 * INDISTINGUISHABLE;
        let most_left = if self.is_unexplained(after) { MOST_LEFT_UNEXPLAINED } else { MOST_LEFT };
        let n_more = after.effects.len().saturating_sub(before.effects.len());
        !is_explained(self.problem, before) && visible && left - removed < most_left.powi(n_more as i32) * left
    }

    fn excess(&self, model: &Fitted) -> f64 {
        excess(self.problem, model)
    }

    fn is_unexplained(&self, model: &Fitted) -> bool {
        self.problem.chi_square(model.cost).left() == Left::Missing
    }

    pub(super) fn preferred<'t>(&self, level: &'t [Fitted]) -> &'t Fitted {
        let best = level.iter().min_by(|a, b| self.criterion(a).total_cmp(&self.criterion(b))).unwrap_or(&level[0]);
        if self.is_unexplained(best) {
            return self.simplest(level, best);
        }
        let simpler = |model: &&Fitted| {
            let close = model.cost - best.cost < INDISTINGUISHABLE * self.unit();
            close && is_simpler_form(model, best)
        };
        level.iter().find(simpler).unwrap_or(best)
    }

    /// Residuals that are no noise are correlated over many swings, so that sums of squares overrate what more numbers
    /// achieve; of models that leave about as much as the best one, the one with the fewest numbers is taken.
    fn simplest<'t>(&self, level: &'t [Fitted], best: &'t Fitted) -> &'t Fitted {
        let near = |model: &&Fitted| self.leaves_about_as_much(model, best);
        let order = |a: &&Fitted, b: &&Fitted| a.n_added().cmp(&b.n_added()).then(a.cost.total_cmp(&b.cost));
        level.iter().filter(near).min_by(order).unwrap_or(best)
    }

    /// Is what a model leaves no more than a few times what the best one does?
    pub(super) fn leaves_about_as_much(&self, model: &Fitted, best: &Fitted) -> bool {
        self.excess(model) < SIMPLER_MAY_LEAVE * self.excess(best)
    }

    /// The claimed model, after each of several effects had to stand against its replacements; and these.
    pub(super) fn refined(&self, claimed: Fitted) -> (Fitted, Vec<Fitted>) {
        let mut claimed = claimed;
        let mut tried = Vec::new();
        for round in 0..MAX_ROUNDS {
            // The first time tells a pair from one that imitates it, and is never left out.
            if claimed.effects.len() < 2 || round > 0 && !self.budget.allows_more() {
                break;
            }
            let (better, others) = self.replaced(&claimed, &tried);
            tried.extend(others);
            let Some(better) = better else { break };
            tried.push(std::mem::replace(&mut claimed, better));
        }
        (claimed, tried)
    }

    /// The claimed model with each law in its usual form, where that is as good begun from its numbers on all samples: the
    /// search may have it in a side valley, which decimated swings lead to. And those in whose place they are.
    pub(super) fn in_usual_forms(&self, mut claimed: Fitted) -> (Fitted, Vec<Fitted>) {
        let mut wider = Vec::new();
        for wide in claimed.effects.clone() {
            let Some(usual) = in_usual_form(self.problem, &claimed, wide) else { continue };
            let usual = usual.refined(self.problem, Band::Free, Tolerance::JUDGE);
            if is_sound(self.problem, &usual) && self.is_as_good(&usual, &claimed) {
                wider.push(std::mem::replace(&mut claimed, usual));
            }
        }
        (claimed, wider)
    }

    /// A model with one effect replaced that is better than the claimed one, pruned; and the others.
    fn replaced(&self, claimed: &Fitted, known: &[Fitted]) -> (Option<Fitted>, Vec<Fitted>) {
        let without = |id: u16| self.without(claimed, id).swap_remove(0);
        let Self { problem, rough, candidates, .. } = self;
        let others = Replacements { problem, rough, candidates, known }.of(claimed, without);
        let reach = INDISTINGUISHABLE * self.unit();
        let is_better = |other: &Fitted| {
            let wins = claimed.cost - other.cost > reach || is_simpler_form(other, claimed);
            wins && self.criterion(other) < self.criterion(claimed)
        };
        let better = (!others.is_empty()).then(|| self.preferred(&others)).filter(|other| is_better(other));
        (better.map(|other| self.pruned(other.clone())), others)
    }

    /// Without effects that became unnecessary once others were in.
    pub(super) fn pruned(&self, model: Fitted) -> Fitted {
        self.pruned_but(model, None)
    }

    /// The same; one effect stays in any case, because its gain is not seen in the cost.
    pub(super) fn pruned_but(&self, model: Fitted, stays: Option<&str>) -> Fitted {
        if model.effects.len() < 2 {
            return model;
        }
        let decimated = model.evaluated(self.rough);
        let without = |effect: &&'static Effect<f64>| {
            let levels = self.without(&model, effect.id);
            self.may_be_dispensable(&levels[0], &decimated).then(|| self.without_on_all(&model, effect.id))
        };
        let may_go = model.effects.iter().filter(|effect| Some(effect.name) != stays);
        let dispensable = may_go.filter_map(without).filter(|smaller| {
            self.is_as_good(smaller, &model) || is_explained(self.problem, smaller) || self.is_no_more(smaller, &model)
        });
        match dispensable.min_by(|a, b| a.cost.total_cmp(&b.cost)) {
            Some(smaller) => self.pruned_but(smaller, stays),
            None => model,
        }
    }

    /// Where the noise is not reached, does an effect remove too small a part of what is left without it?
    fn is_no_more(&self, smaller: &Fitted, model: &Fitted) -> bool {
        self.is_unexplained(model) && self.excess(model) > MOST_LEFT_UNEXPLAINED * self.excess(smaller)
    }

    /// Judged on decimated swings, and generously: is it worth asking on all samples?
    fn may_be_dispensable(&self, smaller: &Fitted, model: &Fitted) -> bool {
        let excess = |model: &Fitted| excess(self.rough, model);
        smaller.cost < NEAR * model.cost || excess(model) > 0.5 * MOST_LEFT_UNEXPLAINED * excess(smaller)
    }

    /// The model without an effect, on decimated swings with the stop levels that may suit it: refitted from where it was,
    /// or from where the search had it if that is better.
    pub(super) fn without(&self, model: &Fitted, id: u16) -> Vec<Fitted> {
        self.rests.levels(model, id, || self.fitted_without(model, id))
    }

    /// The same on all samples.
    pub(super) fn without_on_all(&self, model: &Fitted, id: u16) -> Fitted {
        let levels = self.without(model, id);
        self.rests.on_all(model, id, || on_all(self.problem, &levels))
    }

    fn fitted_without(&self, model: &Fitted, id: u16) -> Vec<Fitted> {
        let smaller = model.without(id);
        let is_it = |other: &&Fitted| {
            other.effects.len() == smaller.effects.len() && smaller.effects.iter().all(|e| other.has(e.name))
        };
        let known = self.found.levels.iter().flatten().find(is_it).map(|known| known.evaluated(self.rough));
        let own = levels(self.rough, &smaller.refined(self.rough, Band::Held, Tolerance::SCREEN));
        match known {
            Some(known) if known.cost < own[0].cost => levels(self.rough, &known),
            _ => own,
        }
    }

    fn is_as_good(&self, smaller: &Fitted, model: &Fitted) -> bool {
        smaller.cost - model.cost < INDISTINGUISHABLE * self.unit()
    }

    /// Effects that could stand for one of the claimed ones without any visible loss; `others` are models beside those
    /// of the search.
    pub(super) fn undecided(&self, claimed: &Fitted, others: &[Fitted]) -> Vec<&'static str> {
        let n_effects = claimed.effects.len();
        let Some(level) = n_effects.checked_sub(1) else { return Vec::new() };
        let n_samples = self.problem.n_samples(Window::Whole) as f64;
        let reach = (ALIKE_NOISES.powi(2) * n_samples).max(INDISTINGUISHABLE) * self.unit();
        let close = |model: &&Fitted| model.effects.len() == n_effects && model.cost - claimed.cost < reach;
        let of_search = self.found.levels.get(level).into_iter().flatten();
        let mut names: Vec<&'static str> = Vec::new();
        for name in of_search.chain(others).filter(close).flat_map(Fitted::names) {
            if !claimed.has(name) && !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }

    pub(super) fn ranked(&self, claimed: &Fitted) -> Vec<&'static str> {
        let mut ranked = claimed.names();
        if ranked.is_empty() {
            ranked.push("none");
        }
        let mut others: Vec<(&Fitted, f64)> =
            self.found.levels.first().into_iter().flatten().map(|model| (model, self.criterion(model))).collect();
        others.push((&self.found.base, self.criterion(&self.found.base)));
        others.sort_by(|a, b| a.1.total_cmp(&b.1));
        for (model, _) in others {
            let name = model.effects.first().map_or("none", |effect| effect.name);
            if !ranked.contains(&name) {
                ranked.push(name);
            }
        }
        ranked
    }

    pub(super) fn candidate(&self, model: &Fitted) -> Candidate {
        Candidate {
            name: model.name(),
            rmse: self.problem.rmse_rad(model.cost),
            criterion: self.criterion(model),
            parameters: match model.effects.is_empty() {
                true => Vec::new(),
                false => values(self.problem, model).into_iter().filter(|value| model.has(value.effect)).collect(),
            },
        }
    }
}

/// Does a model have the special case of an effect of another one?
fn is_simpler_form(model: &Fitted, of: &Fitted) -> bool {
    of.effects.iter().any(|effect| effect.generalises.is_some_and(|special| model.has(special) && !of.has(special)))
}
