//! What may be claimed: which effects are missing, which can't be told apart, what stays unexplained.

use super::excess::{excess, is_explained};
use super::replacement::Replacements;
use super::search::Found;
use super::summary::Candidate;
use super::trial::{Sketch, Trial, fit_from, values};
use crate::fit::problem::{Point, Problem, Unknown};
use crate::swing::Window;
use crate::verdict::Left;
use shared::effect::Effect;

/// An effect may leave this share of the excess that was there before it …
const MOST_LEFT: f64 = 0.6;

/// … and less where the noise is not reached even so: then nobody knows what else is in the swings.
const MOST_LEFT_UNEXPLAINED: f64 = 0.4;

/// Where the noise is not reached, a simpler model is taken that leaves no more than so many times the excess.
const SIMPLER_MAY_LEAVE: f64 = 3.0;

/// Sums of squares closer than this, in noise variances, are no reason to prefer one effect over another.
pub(super) const INDISTINGUISHABLE: f64 = 25.0;

/// So often a claimed model is exchanged for a better one with one effect replaced.
const MAX_ROUNDS: usize = 3;

/// A cost so many times higher than another one needs no closer look.
const CLEARLY_MORE: f64 = 1.3;

/// Predictions that differ by less than this many noises are called alike.
const ALIKE_NOISES: f64 = 0.05;

/// Decides from what the search found.
pub(super) struct Judge<'a, 'b> {
    pub(super) problem: &'b Problem<'a>,
    /// The same with sketches of the swings.
    pub(super) rough: &'b Problem<'b>,
    pub(super) found: &'b Found,
    pub(super) candidates: &'b [&'static Effect<f64>],
}

impl Judge<'_, '_> {
    fn noise_variance(&self) -> f64 {
        self.problem.noise_rad().powi(2)
    }

    /// Cost in noise variances, a unit that grows where even the best model leaves more than the noise.
    pub(super) fn unit(&self) -> f64 {
        let lowest = self.found.levels.iter().flatten().map(|trial| trial.cost).fold(self.found.base.cost, f64::min);
        self.noise_variance().max(lowest / self.problem.n_samples(Window::Whole) as f64)
    }

    pub(super) fn criterion(&self, trial: &Trial) -> f64 {
        let n_samples = self.problem.n_samples(Window::Whole) as f64;
        trial.cost / self.unit() + trial.n_added() as f64 * n_samples.ln()
    }

    /// The model to claim: level by level as long as each added effect removes a substantial part of what was left;
    /// at the last level the lowest criterion decides, a special case before its generalisation.
    pub(super) fn claimed(&self) -> Trial {
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
    fn is_worth_it(&self, before: &Trial, after: &Trial) -> bool {
        let left = self.excess(before);
        let removed = left - self.excess(after);
        let visible = removed * self.problem.n_samples(Window::Whole) as f64 > 2.0 * INDISTINGUISHABLE;
        let most_left = if self.is_unexplained(after) { MOST_LEFT_UNEXPLAINED } else { MOST_LEFT };
        let n_more = after.effects.len() - before.effects.len();
        !is_explained(self.problem, before) && visible && left - removed < most_left.powi(n_more as i32) * left
    }

    fn excess(&self, trial: &Trial) -> f64 {
        excess(self.problem, trial.cost)
    }

    fn is_unexplained(&self, trial: &Trial) -> bool {
        self.problem.chi_square(trial.cost).left() == Left::Missing
    }

    fn preferred<'t>(&self, level: &'t [Trial]) -> &'t Trial {
        let best = level.iter().min_by(|a, b| self.criterion(a).total_cmp(&self.criterion(b))).unwrap_or(&level[0]);
        if self.is_unexplained(best) {
            return self.simplest(level, best);
        }
        let simpler = |trial: &&Trial| {
            let close = trial.cost - best.cost < INDISTINGUISHABLE * self.unit();
            close && is_simpler_form(trial, best)
        };
        level.iter().find(simpler).unwrap_or(best)
    }

    /// Residuals that are no noise are correlated over many swings, so that sums of squares overrate what more numbers
    /// achieve; of models that leave about as much as the best one, the one with the fewest numbers is taken.
    fn simplest<'t>(&self, level: &'t [Trial], best: &'t Trial) -> &'t Trial {
        let near = |trial: &&Trial| self.excess(trial) < SIMPLER_MAY_LEAVE * self.excess(best);
        let order = |a: &&Trial, b: &&Trial| a.n_added().cmp(&b.n_added()).then(a.cost.total_cmp(&b.cost));
        level.iter().filter(near).min_by(order).unwrap_or(best)
    }

    /// The claimed model, after each of several effects had to stand against its replacements; and these.
    pub(super) fn refined(&self, claimed: Trial) -> (Trial, Vec<Trial>) {
        let mut claimed = claimed;
        let mut tried = Vec::new();
        for _ in 0..MAX_ROUNDS {
            let (better, others) = self.replaced(&claimed, &tried);
            tried.extend(others);
            let Some(better) = better else { break };
            tried.push(std::mem::replace(&mut claimed, better));
        }
        (claimed, tried)
    }

    /// A model with one effect replaced that is better than the claimed one, pruned; and the others.
    fn replaced(&self, claimed: &Trial, known: &[Trial]) -> (Option<Trial>, Vec<Trial>) {
        if claimed.effects.len() < 2 {
            return (None, Vec::new());
        }
        let without = |id: u16| self.without(claimed, id).trial;
        let Self { problem, rough, candidates, .. } = self;
        let others = Replacements { problem, rough, candidates, known }.of(claimed, without);
        let reach = INDISTINGUISHABLE * self.unit();
        let is_better = |other: &Trial| {
            let wins = claimed.cost - other.cost > reach || is_simpler_form(other, claimed);
            wins && self.criterion(other) < self.criterion(claimed)
        };
        let better = (!others.is_empty()).then(|| self.preferred(&others)).filter(|other| is_better(other));
        (better.map(|other| self.pruned(other.clone())), others)
    }

    /// Without effects that became unnecessary once others were in.
    pub(super) fn pruned(&self, trial: Trial) -> Trial {
        self.pruned_but(trial, None)
    }

    /// The same; one effect stays in any case, because its gain is not seen in the cost.
    pub(super) fn pruned_but(&self, trial: Trial, stays: Option<&str>) -> Trial {
        if trial.effects.len() < 2 {
            return trial;
        }
        let on_sketches = trial.judged(self.rough);
        let without = |effect: &&'static Effect<f64>| {
            let sketch = self.without(&trial, effect.id);
            self.may_be_dispensable(&sketch.trial, &on_sketches).then(|| sketch.on_all(self.problem))
        };
        let may_go = trial.effects.iter().filter(|effect| Some(effect.name) != stays);
        let dispensable = may_go.filter_map(without).filter(|smaller| {
            self.is_as_good(smaller, &trial) || is_explained(self.problem, smaller) || self.is_no_more(smaller, &trial)
        });
        match dispensable.min_by(|a, b| a.cost.total_cmp(&b.cost)) {
            Some(smaller) => self.pruned_but(smaller, stays),
            None => trial,
        }
    }

    /// Where the noise is not reached, does an effect remove too small a part of what is left without it?
    fn is_no_more(&self, smaller: &Trial, trial: &Trial) -> bool {
        self.is_unexplained(trial) && self.excess(trial) > MOST_LEFT_UNEXPLAINED * self.excess(smaller)
    }

    /// Judged on sketches, and generously: is it worth asking on all samples?
    fn may_be_dispensable(&self, smaller: &Trial, trial: &Trial) -> bool {
        let excess = |trial: &Trial| excess(self.rough, trial.cost);
        smaller.cost < CLEARLY_MORE * trial.cost || excess(trial) > 0.5 * MOST_LEFT_UNEXPLAINED * excess(smaller)
    }

    /// The model without an effect, on sketches: refitted from where it was, or from where the search had it if that is
    /// better.
    fn without(&self, trial: &Trial, id: u16) -> Sketch {
        let rest: Vec<&'static Effect<f64>> = trial.effects.iter().copied().filter(|effect| effect.id != id).collect();
        let is_rest = |other: &&Trial| other.effects.len() == rest.len() && rest.iter().all(|e| other.has(e.name));
        let known = self.found.levels.iter().flatten().find(is_rest).map(|known| known.judged(self.rough));
        let own = Sketch::of(self.rough, &self.refitted_without(trial, id, rest.clone()));
        match known {
            Some(known) if known.cost < own.trial.cost => Sketch::of(self.rough, &known),
            _ => own,
        }
    }

    fn is_as_good(&self, smaller: &Trial, trial: &Trial) -> bool {
        smaller.cost - trial.cost < INDISTINGUISHABLE * self.unit()
    }

    fn refitted_without(&self, trial: &Trial, id: u16, rest: Vec<&'static Effect<f64>>) -> Trial {
        let keep = |unknown: &&Unknown| !trial.unknowns_of(id).contains(&unknown.quantity);
        let kept: Vec<usize> = (0..trial.unknowns.len()).filter(|j| keep(&&trial.unknowns[*j])).collect();
        let mut template = trial.parameters.clone();
        template.remove(id);
        let problem = Problem {
            unknowns: kept.iter().map(|j| trial.unknowns[*j].clone()).collect(),
            template,
            ..self.rough.clone()
        };
        let point =
            Point { values: kept.iter().map(|j| trial.point.values[*j]).collect(), starts: trial.point.starts.clone() };
        fit_from(&problem, rest, &point, trial.stiction)
    }

    /// Effects that could stand for one of the claimed ones without any visible loss; `others` are models beside those
    /// of the search.
    pub(super) fn undecided(&self, claimed: &Trial, others: &[Trial]) -> Vec<&'static str> {
        let n_effects = claimed.effects.len();
        let Some(level) = n_effects.checked_sub(1) else { return Vec::new() };
        let n_samples = self.problem.n_samples(Window::Whole) as f64;
        let reach = (ALIKE_NOISES.powi(2) * n_samples).max(INDISTINGUISHABLE) * self.unit();
        let close = |trial: &&Trial| trial.effects.len() == n_effects && trial.cost - claimed.cost < reach;
        let of_search = self.found.levels.get(level).into_iter().flatten();
        let mut names: Vec<&'static str> = Vec::new();
        for name in of_search.chain(others).filter(close).flat_map(Trial::names) {
            if !claimed.has(name) && !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }

    pub(super) fn ranked(&self, claimed: &Trial) -> Vec<&'static str> {
        let mut ranked = claimed.names();
        if ranked.is_empty() {
            ranked.push("none");
        }
        let mut others: Vec<(&Trial, f64)> =
            self.found.levels.first().into_iter().flatten().map(|trial| (trial, self.criterion(trial))).collect();
        others.push((&self.found.base, self.criterion(&self.found.base)));
        others.sort_by(|a, b| a.1.total_cmp(&b.1));
        for (trial, _) in others {
            let name = trial.effects.first().map_or("none", |effect| effect.name);
            if !ranked.contains(&name) {
                ranked.push(name);
            }
        }
        ranked
    }

    pub(super) fn candidate(&self, trial: &Trial) -> Candidate {
        let n_samples = self.problem.n_samples(Window::Whole) as f64;
        Candidate {
            name: if trial.effects.is_empty() { "none".to_owned() } else { trial.names().join("+") },
            rmse: (trial.cost / n_samples).sqrt(),
            criterion: self.criterion(trial),
            parameters: values(self.problem, trial).into_iter().filter(|value| trial.has(value.effect)).collect(),
        }
    }
}

/// Does a model have the special case of an effect of another one?
fn is_simpler_form(trial: &Trial, of: &Trial) -> bool {
    of.effects.iter().any(|effect| effect.generalises.is_some_and(|special| trial.has(special) && !of.has(special)))
}

impl Trial {
    fn unknowns_of(&self, id: u16) -> Vec<crate::fit::problem::Quantity> {
        use crate::fit::problem::Quantity;
        let belongs = |quantity: &Quantity| matches!(quantity, Quantity::Effect { id: of, .. } if *of == id);
        self.unknowns.iter().map(|unknown| unknown.quantity).filter(belongs).collect()
    }
}
