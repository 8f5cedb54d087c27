//! What may be claimed: which effects are missing, which can't be told apart, what stays unexplained.

use super::evidence::{Evidence, evidence};
use super::formulas::{Found as FoundFormula, formulas};
use super::replacement::replacements;
use super::search::{EXCESS_WORTH_EXPLAINING, Found, excess, is_explained, search};
use super::trial::{Trial, Value, finish, fit_from, values};
use super::zero::{self, ANGLE_OFFSET, Zero};
use crate::fit::identify::{held_out_rmse, problem_of, smooth};
use crate::fit::problem::{Point, Problem, Unknown};
use crate::fit::stiction::{self, Settled, Stiction, with_stiction};
use crate::fit::{start, windows};
use crate::formula::effect_of;
use crate::swing::{Swing, Window};
use serde::Serialize;
use shared::effect::{CUSTOM_FORMULA_ID, CUSTOM_FORMULA_NAME, Effect};
use shared::parameters::{Parameters, base};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// An effect may leave this share of the excess that was there before it …
const MOST_LEFT: f64 = 0.6;

/// … and less where the noise is not reached even so: then nobody knows what else is in the swings.
const MOST_LEFT_UNEXPLAINED: f64 = 0.4;

/// Where the noise is not reached, a simpler model is taken that leaves no more than so many times the excess.
const SIMPLER_MAY_LEAVE: f64 = 3.0;

/// Sums of squares closer than this, in noise variances, are no reason to prefer one effect over another.
const INDISTINGUISHABLE: f64 = 25.0;

/// Predictions that differ by less than this many noises are called alike.
const ALIKE_NOISES: f64 = 0.05;

/// A residual above this many noises is called unexplained.
const UNEXPLAINED_NOISES: f64 = 1.10;

/// A model that was fitted.
#[derive(Clone, Debug, Serialize)]
pub struct Candidate {
    /// The effects added, joined by `+`; `none` for the base model.
    pub name: String,
    /// Root mean square error, rad.
    pub rmse: f64,
    /// Bayesian information criterion in units of the noise; lower is better.
    pub criterion: f64,
    /// The added effects' numbers.
    pub parameters: Vec<Value>,
}

/// A formula for what no candidate explains.
#[derive(Clone, Debug, Serialize)]
pub struct Suggestion {
    /// The torque with its numbers, N·m: `-3.1e-5·|ω|^2.3·sgn ω`.
    pub words: String,
    /// The law as `--effect` takes it.
    pub formula: String,
    /// Root mean square error with it, rad.
    pub rmse: f64,
    /// On held-out swings, rad.
    pub held_out: Option<f64>,
    /// Share of the excess over the noise (as a variance) that it removes.
    pub removed: f64,
    /// As of a candidate, with a penalty for length.
    pub criterion: f64,
    /// Its numbers.
    pub parameters: Vec<Value>,
    /// Effects of the verdict that it stands beside; it may explain more without them.
    pub beside: Vec<&'static str>,
    /// Largest angle it was seen at, rad.
    pub within_rad: f64,
}

/// What is missing.
#[derive(Clone, Debug, Serialize)]
pub struct Diagnosis {
    /// Version of this record.
    pub version: u32,
    /// Effects claimed to be missing from the base model; empty: nothing is missing, or nothing could be named.
    pub verdict: Vec<&'static str>,
    /// Effects that the data can't tell from one of the verdict.
    pub undecided: Vec<&'static str>,
    /// Effects by how well each explains the swings, `none` where it belongs.
    pub ranked: Vec<&'static str>,
    /// Root mean square error of the base model without any offset, rad.
    pub rmse_before: f64,
    /// The same with all of the verdict, rad.
    pub rmse_after: f64,
    /// On held-out swings before, rad.
    pub held_out_before: Option<f64>,
    /// On held-out swings after, rad.
    pub held_out_after: Option<f64>,
    /// Noise of the measurement, rad.
    pub noise: f64,
    /// True if more than 1.10 times the noise remains.
    pub unexplained: bool,
    /// Time taken.
    pub seconds: f64,
    /// Simulated swings.
    pub simulations: usize,
    /// Everything that was fitted, best first.
    pub candidates: Vec<Candidate>,
    /// Where more than the noise remains: small formulas that explain some of it, the best first.
    pub formulas: Vec<Suggestion>,
    /// What each claimed effect does to a swing.
    pub evidence: Vec<Evidence>,
    /// All numbers of the enlarged model but Ms and DV.
    pub values: Vec<Value>,
    /// The enlarged model.
    #[serde(skip)]
    pub parameters: Parameters<f64>,
    /// The claimed model and those that come closest to it, as fitted.
    #[serde(skip)]
    pub leading: Vec<Trial>,
    /// The base model alone.
    #[serde(skip)]
    pub base_parameters: Parameters<f64>,
    /// Error after each added effect, base first: the staircase.
    pub staircase: Vec<Step>,
}

/// One step of the staircase of errors.
#[derive(Clone, Debug, Serialize)]
pub struct Step {
    /// The effect that was added; `base` first.
    pub added: &'static str,
    /// Root mean square error on the fitted swings, rad.
    pub rmse: f64,
    /// The same on the held-out swings, rad.
    pub held_out: Option<f64>,
}

/// Finds what is missing from the base model of a rig.
pub fn diagnose(swings: &[Swing], held_out: &[Swing], rig: &Parameters<f64>) -> Diagnosis {
    diagnose_with(swings, held_out, rig, Wishes::default())
}

/// What a diagnosis does beside trying the effects of the list.
#[derive(Clone, Copy, Default)]
pub struct Wishes {
    /// An effect that somebody typed, tried as well.
    pub typed: Option<&'static Effect<f64>>,
    /// Small formulas are searched for what no effect explains; that takes up to a minute.
    pub formulas: bool,
}

/// The same with more than the effects of the list; a typed one that the rig has already is tried in any case.
pub fn diagnose_with(swings: &[Swing], held_out: &[Swing], rig: &Parameters<f64>, wishes: Wishes) -> Diagnosis {
    diagnose_counted(swings, held_out, rig, wishes, &AtomicUsize::new(0))
}

/// The same for somebody who wants to see the count of simulated swings grow.
pub fn diagnose_counted(
    swings: &[Swing],
    held_out: &[Swing],
    rig: &Parameters<f64>,
    wishes: Wishes,
    count: &AtomicUsize,
) -> Diagnosis {
    let began = Instant::now();
    let problem = base_problem(swings, rig, count);
    let base = fit_base(&problem);
    let mut candidates = candidates(swings);
    candidates.extend(wishes.typed.or(effect_of(rig, CUSTOM_FORMULA_ID)));
    let found = search(&problem, &base, &candidates);
    let judge = Judge { problem: &problem, found: &found, candidates: &candidates };
    let (claimed, others) = judge.refined(judge.claimed());
    let mut undecided = judge.undecided(&claimed, &others);
    let Zero { model: claimed, offset_is_missing, alike } =
        zero::decide(&problem, claimed, INDISTINGUISHABLE * judge.unit());
    undecided.extend(alike);
    Summary { judge, claimed, undecided, offset_is_missing, held_out, began, count }.build(wishes.formulas)
}

/// The effects that may be found missing: all but the base effects and the offset, which is fitted anyway. In a single
/// swing the amplitude falls as time goes by, so that no drift can be told from a law of speed or angle.
fn candidates(swings: &[Swing]) -> Vec<&'static Effect<f64>> {
    let is_candidate = |effect: &&Effect<f64>| {
        let needs_more = effect.name == DRIFTING && swings.len() < 2;
        !effect.is_base() && effect.name != ANGLE_OFFSET && !needs_more
    };
    Effect::ALL.iter().filter(is_candidate).collect()
}

/// Only several releases tell it from the rest.
const DRIFTING: &str = "drifting-friction";

fn base_problem<'a>(swings: &'a [Swing], rig: &Parameters<f64>, count: &'a AtomicUsize) -> Problem<'a> {
    let mut bare = rig.clone();
    bare.effects.retain(|effect| effect.id <= base::STICTION);
    bare.formula = None;
    let mut problem = smooth(&problem_of(swings, &bare, count));
    for (unknown, start) in problem.unknowns.clone().iter().zip(problem.template_values()) {
        if unknown.name != "inertia" && start <= unknown.low {
            unknown.set(&mut problem.template, unknown.scale);
        }
    }
    with_stiction(&problem, Stiction { level_nm: 0.0, velocity_band: 0.0 })
}

fn fit_base(problem: &Problem) -> Settled {
    let grown = windows::grow(problem, &start::guess(problem));
    stiction::settle(problem, &grown)
}

/// Decides from what the search found.
struct Judge<'a, 'b> {
    problem: &'b Problem<'a>,
    found: &'b Found,
    candidates: &'b [&'static Effect<f64>],
}

impl Judge<'_, '_> {
    fn noise_variance(&self) -> f64 {
        self.problem.noise_rad().powi(2)
    }

    /// Cost in noise variances, a unit that grows where even the best model leaves more than the noise.
    fn unit(&self) -> f64 {
        let lowest = self.found.levels.iter().flatten().map(|trial| trial.cost).fold(self.found.base.cost, f64::min);
        self.noise_variance().max(lowest / self.problem.n_samples(Window::Whole) as f64)
    }

    fn criterion(&self, trial: &Trial) -> f64 {
        let n_samples = self.problem.n_samples(Window::Whole) as f64;
        trial.cost / self.unit() + trial.n_added() as f64 * n_samples.ln()
    }

    /// The model to claim: level by level as long as each added effect removes a substantial part of what was left;
    /// at the last level the lowest criterion decides, a special case before its generalisation.
    fn claimed(&self) -> Trial {
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
        left > EXCESS_WORTH_EXPLAINING && visible && left - removed < most_left.powi(n_more as i32) * left
    }

    fn excess(&self, trial: &Trial) -> f64 {
        excess(self.problem, trial.cost)
    }

    fn is_unexplained(&self, trial: &Trial) -> bool {
        self.excess(trial) > UNEXPLAINED_NOISES.powi(2) - 1.0
    }

    fn preferred<'t>(&self, level: &'t [Trial]) -> &'t Trial {
        let best = level.iter().min_by(|a, b| self.criterion(a).total_cmp(&self.criterion(b))).unwrap_or(&level[0]);
        if self.is_unexplained(best) {
            return self.simplest(level, best);
        }
        let simpler = |trial: &&Trial| {
            let close = trial.cost - best.cost < INDISTINGUISHABLE * self.unit();
            close && best.effects.iter().any(|effect| effect.generalises.is_some_and(|special| trial.has(special)))
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
    fn refined(&self, claimed: Trial) -> (Trial, Vec<Trial>) {
        if claimed.effects.len() < 2 {
            return (claimed, Vec::new());
        }
        let without = |id: u16| self.without(&claimed, id);
        let mut others = replacements(self.problem, &claimed, self.candidates, without);
        let better = others.iter().position(|other| {
            claimed.cost - other.cost > INDISTINGUISHABLE * self.unit()
                && self.criterion(other) < self.criterion(&claimed)
        });
        match better {
            Some(best) => {
                let best = others.remove(best);
                others.push(claimed);
                (self.pruned(best), others)
            }
            None => (claimed, others),
        }
    }

    /// Without effects that became unnecessary once others were in.
    fn pruned(&self, trial: Trial) -> Trial {
        if trial.effects.len() < 2 {
            return trial;
        }
        let without: Vec<Trial> = trial.effects.iter().map(|effect| self.without(&trial, effect.id)).collect();
        let dispensable = without.into_iter().filter(|smaller| {
            smaller.cost - trial.cost < INDISTINGUISHABLE * self.unit() || is_explained(self.problem, smaller)
        });
        match dispensable.min_by(|a, b| a.cost.total_cmp(&b.cost)) {
            Some(smaller) => self.pruned(smaller),
            None => trial,
        }
    }

    fn without(&self, trial: &Trial, id: u16) -> Trial {
        let effects: Vec<&'static Effect<f64>> =
            trial.effects.iter().copied().filter(|effect| effect.id != id).collect();
        let known =
            self.found.levels.iter().flatten().find(|other| {
                other.effects.len() == effects.len() && effects.iter().all(|effect| other.has(effect.name))
            });
        if let Some(known) = known {
            return finish(self.problem, known);
        }
        let keep = |unknown: &&Unknown| !trial.unknowns_of(id).contains(&unknown.quantity);
        let kept: Vec<usize> = (0..trial.unknowns.len()).filter(|j| keep(&&trial.unknowns[*j])).collect();
        let mut template = trial.parameters.clone();
        template.remove(id);
        let problem = Problem {
            unknowns: kept.iter().map(|j| trial.unknowns[*j].clone()).collect(),
            template,
            ..self.problem.clone()
        };
        let point =
            Point { values: kept.iter().map(|j| trial.point.values[*j]).collect(), starts: trial.point.starts.clone() };
        finish(self.problem, &fit_from(&problem, effects, &point, trial.stiction))
    }

    /// Effects that could stand for one of the claimed ones without any visible loss; `others` are models beside those
    /// of the search.
    fn undecided(&self, claimed: &Trial, others: &[Trial]) -> Vec<&'static str> {
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

    fn ranked(&self, claimed: &Trial) -> Vec<&'static str> {
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

    fn candidate(&self, trial: &Trial) -> Candidate {
        let n_samples = self.problem.n_samples(Window::Whole) as f64;
        Candidate {
            name: if trial.effects.is_empty() { "none".to_owned() } else { trial.names().join("+") },
            rmse: (trial.cost / n_samples).sqrt(),
            criterion: self.criterion(trial),
            parameters: values(self.problem, trial).into_iter().filter(|value| trial.has(value.effect)).collect(),
        }
    }
}

impl Trial {
    fn unknowns_of(&self, id: u16) -> Vec<crate::fit::problem::Quantity> {
        use crate::fit::problem::Quantity;
        let belongs = |quantity: &Quantity| matches!(quantity, Quantity::Effect { id: of, .. } if *of == id);
        self.unknowns.iter().map(|unknown| unknown.quantity).filter(belongs).collect()
    }
}

/// Puts the result together.
struct Summary<'a, 'b, 'c> {
    judge: Judge<'a, 'b>,
    claimed: Trial,
    undecided: Vec<&'static str>,
    offset_is_missing: bool,
    held_out: &'c [Swing],
    began: Instant,
    count: &'c AtomicUsize,
}

impl Summary<'_, '_, '_> {
    fn build(self, with_formulas: bool) -> Diagnosis {
        let problem = self.judge.problem;
        let n_samples = problem.n_samples(Window::Whole) as f64;
        let base = &self.judge.found.base;
        let rmse = |cost: f64| (cost / n_samples).sqrt();
        let noise = problem.noise_rad();
        let rmse_before = rmse(zero::cost_with_offsets_within(problem, base, 0.0));
        let rmse_after = rmse(self.claimed.cost);
        let held_out = |parameters: &Parameters<f64>| {
            (!self.held_out.is_empty()).then(|| held_out_rmse(self.held_out, parameters, self.count))
        };
        let mut verdict = self.claimed.names();
        let mut ranked = self.judge.ranked(&self.claimed);
        if self.offset_is_missing {
            verdict.push(ANGLE_OFFSET);
            let place = if self.claimed.effects.is_empty() { 0 } else { 1 };
            ranked.insert(place, ANGLE_OFFSET);
        }
        let mut trials: Vec<&Trial> = vec![&self.claimed];
        let is_claimed = |trial: &Trial| trial.names() == self.claimed.names();
        trials.extend(self.judge.found.levels.iter().flatten().chain([base]).filter(|trial| !is_claimed(trial)));
        trials.sort_by(|a, b| self.judge.criterion(a).total_cmp(&self.judge.criterion(b)));
        let rivals = trials.iter().copied().filter(|trial| !is_claimed(trial)).take(MAX_RIVALS);
        let leading = std::iter::once(&self.claimed).chain(rivals).cloned().collect();
        trials.truncate(MAX_LISTED);
        let staircase = self.staircase(rmse_before, &held_out);
        let unexplained = rmse_after > UNEXPLAINED_NOISES * noise;
        let formulas = if unexplained && with_formulas { self.formulas(&held_out) } else { Vec::new() };
        Diagnosis {
            version: 1,
            undecided: self.undecided,
            rmse_before,
            rmse_after,
            held_out_before: held_out(&base.parameters),
            held_out_after: held_out(&self.claimed.parameters),
            noise,
            unexplained,
            formulas,
            evidence: evidence(problem, &self.claimed.parameters),
            values: values(problem, &self.claimed),
            candidates: trials.into_iter().map(|trial| self.judge.candidate(trial)).collect(),
            parameters: self.claimed.parameters,
            leading,
            base_parameters: base.parameters.clone(),
            staircase,
            seconds: self.began.elapsed().as_secs_f64(),
            simulations: self.count.load(Ordering::Relaxed),
            verdict,
            ranked,
        }
    }

    fn formulas(&self, held_out: &dyn Fn(&Parameters<f64>) -> Option<f64>) -> Vec<Suggestion> {
        let problem = self.judge.problem;
        let weight = (problem.n_samples(Window::Whole) as f64).ln();
        let angles = problem.swings.iter().flat_map(|swing| &swing.angles_rad);
        let within_rad = angles.fold(0.0_f64, |largest, angle| largest.max(angle.abs()));
        let before = excess(problem, self.claimed.cost);
        let suggestion = |found: FoundFormula| {
            let candidate = self.judge.candidate(&found.trial);
            let parameters = candidate.parameters.into_iter().filter(|value| value.effect == CUSTOM_FORMULA_NAME);
            Suggestion {
                words: found.words,
                formula: found.typed,
                rmse: candidate.rmse,
                held_out: held_out(&found.trial.parameters),
                removed: 1.0 - excess(problem, found.trial.cost) / before,
                criterion: candidate.criterion + weight * found.length as f64,
                parameters: parameters.collect(),
                beside: found.trial.names().into_iter().filter(|name| *name != CUSTOM_FORMULA_NAME).collect(),
                within_rad,
            }
        };
        if self.claimed.has(CUSTOM_FORMULA_NAME) {
            return Vec::new();
        }
        let on_top_of = |trial: &Trial| formulas(problem, trial, |trial| self.judge.criterion(trial), weight);
        let mut found: Vec<Suggestion> = on_top_of(&self.claimed).into_iter().map(suggestion).collect();
        if !self.claimed.effects.is_empty() {
            // An effect that was claimed for want of a better one may be in the way.
            found.extend(on_top_of(&self.judge.found.base).into_iter().map(suggestion));
        }
        found.sort_by(|a, b| a.criterion.total_cmp(&b.criterion));
        found.retain(|found| found.removed > 0.0);
        found.truncate(MAX_FORMULAS);
        found
    }

    fn staircase(&self, rmse_before: f64, held_out: &dyn Fn(&Parameters<f64>) -> Option<f64>) -> Vec<Step> {
        let found = self.judge.found;
        let n_samples = self.judge.problem.n_samples(Window::Whole) as f64;
        let mut steps = vec![Step { added: "base", rmse: rmse_before, held_out: held_out(&found.base.parameters) }];
        for n_added in 1..=self.claimed.effects.len() {
            let part = &self.claimed.effects[..n_added];
            let is_part =
                |trial: &&Trial| trial.effects.len() == n_added && part.iter().all(|effect| trial.has(effect.name));
            let trial = if n_added == self.claimed.effects.len() {
                Some(&self.claimed)
            } else {
                found.levels.iter().flatten().find(is_part)
            };
            if let Some(trial) = trial {
                let rmse = (trial.cost / n_samples).sqrt();
                steps.push(Step { added: part[n_added - 1].name, rmse, held_out: held_out(&trial.parameters) });
            }
        }
        steps
    }
}

/// At most this many formulas are offered.
const MAX_FORMULAS: usize = 3;

/// At most this many models are set against the claimed one.
const MAX_RIVALS: usize = 2;

/// At most this many models are listed.
const MAX_LISTED: usize = 12;
