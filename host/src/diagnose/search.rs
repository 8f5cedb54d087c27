//! The search through models: one effect at a time, the most promising few kept at each level.

use super::score::{Promise, promises};
use super::trial::{Trial, finish, fit_from};
use crate::fit::descent::{Patience, descend};
use crate::fit::linear::Steps;
use crate::fit::problem::Problem;
use crate::fit::stiction::{self, Settled};
use crate::swing::Window;
use rayon::prelude::*;
use shared::effect::Effect;

/// A residual this far above the noise variance is worth an explanation.
pub const EXCESS_WORTH_EXPLAINING: f64 = 0.02;

/// At most this many effects are added.
const MAX_ADDED: usize = 3;

/// Models kept from one level to the next.
const BEAM: usize = 3;

/// Effects whose promise is below this share of the best one are not fitted.
const SHARE_OF_BEST_PROMISE: f64 = 0.15;

/// Effects fitted at each level on top of one model, at most.
const MAX_FITTED: usize = 7;

/// Starts of one effect that are fitted, at most.
const MAX_STARTS: usize = 2;

/// Models of one level that are finished, at most.
const MAX_FINISHED: usize = 4;

/// What a search found.
#[derive(Clone, Debug)]
pub struct Found {
    /// The base model.
    pub base: Trial,
    /// Fitted models by the number of added effects (first: one), the lowest cost first; only the first few of each
    /// level are finished.
    pub levels: Vec<Vec<Trial>>,
}

impl Found {
    /// The model with the lowest cost at a level; level 0 is the base.
    pub fn best(&self, level: usize) -> &Trial {
        if level == 0 { &self.base } else { &self.levels[level - 1][0] }
    }
}

/// Fits the base model and, level by level, models with added effects, until one explains the swings.
pub fn search(problem: &Problem, base: &Settled, candidates: &[&'static Effect<f64>]) -> Found {
    let none = stiction_free_base(problem, base);
    let mut found = Found { base: Trial::settled(problem, Vec::new(), base.clone()), levels: Vec::new() };
    if is_explained(problem, &found.base) {
        return found;
    }
    let mut beam = vec![none];
    for _ in 0..MAX_ADDED {
        let level = next_level(problem, &beam, candidates);
        if level.is_empty() {
            break;
        }
        let explained = is_explained(problem, &level[0]);
        let lowers = level[0].cost < found.best(found.levels.len()).cost;
        beam = level.iter().take(BEAM).cloned().collect();
        if !lowers {
            break;
        }
        found.levels.push(level);
        if explained {
            break;
        }
    }
    found
}

/// The base without a velocity band: a band that only imitates the missing effect would hide it.
fn stiction_free_base(problem: &Problem, base: &Settled) -> Trial {
    if base.stiction.velocity_band == 0.0 {
        return Trial::settled(problem, Vec::new(), base.clone());
    }
    let free = stiction::with_stiction(problem, stiction::Stiction { level_nm: 0.0, velocity_band: 0.0 });
    let descent = descend(&free, &base.descent.point, Window::Lively, Patience::ROUGH, Steps::new(&free));
    Trial::settled(problem, Vec::new(), stiction::without_band(&free, &descent))
}

/// Does a model leave no more than the noise?
pub fn is_explained(problem: &Problem, trial: &Trial) -> bool {
    excess(problem, trial.cost) <= EXCESS_WORTH_EXPLAINING
}

/// Residual variance beyond the noise, as a share of the noise variance.
pub fn excess(problem: &Problem, cost: f64) -> f64 {
    cost / (problem.n_samples(Window::Whole) as f64 * problem.noise_rad().powi(2)) - 1.0
}

/// All models with one more effect than those of the beam that are worth fitting, the lowest cost first.
fn next_level(problem: &Problem, beam: &[Trial], candidates: &[&'static Effect<f64>]) -> Vec<Trial> {
    let mut level: Vec<Trial> = beam.iter().flat_map(|trial| extensions(problem, trial, candidates)).collect();
    sort(&mut level);
    drop_doubles(&mut level);
    let n_finished = if level.first().is_some_and(|best| is_explained(problem, best)) { 2 } else { MAX_FINISHED };
    let rest = level.split_off(n_finished.min(level.len()));
    level = level.par_iter().map(|trial| finish(problem, trial)).collect();
    level.extend(rest);
    sort(&mut level);
    level
}

/// A model with one more effect, each of the promising ones in turn.
fn extensions(problem: &Problem, trial: &Trial, candidates: &[&'static Effect<f64>]) -> Vec<Trial> {
    let fresh: Vec<&'static Effect<f64>> =
        candidates.iter().copied().filter(|effect| !trial.has(effect.name)).collect();
    let promises = worth_fitting(promises(problem, trial, &fresh));
    let fitted: Vec<Trial> = promises.par_iter().filter_map(|promise| fit_promise(problem, trial, promise)).collect();
    let mut level = fitted;
    sort(&mut level);
    drop_doubles(&mut level);
    level
}

fn worth_fitting(promises: Vec<Promise>) -> Vec<Promise> {
    let best = promises.first().map_or(0.0, |promise| promise.gain);
    let mut names: Vec<&'static str> = Vec::new();
    let mut kept: Vec<Promise> = Vec::new();
    for promise in promises.into_iter().filter(|promise| promise.gain > SHARE_OF_BEST_PROMISE * best) {
        let name = promise.effect.name;
        if !names.contains(&name) {
            if names.len() == MAX_FITTED {
                continue;
            }
            names.push(name);
        }
        if kept.iter().filter(|other| other.effect.name == name).count() < MAX_STARTS {
            kept.push(promise);
        }
    }
    kept
}

fn fit_promise(problem: &Problem, trial: &Trial, promise: &Promise) -> Option<Trial> {
    let n_before = trial.unknowns.len();
    let (unknowns, template) = trial.with(problem, promise.effect, &promise.point.values[n_before..])?;
    let enlarged = Problem { unknowns, template, ..problem.clone() };
    let mut effects = trial.effects.clone();
    effects.push(promise.effect);
    Some(fit_from(&enlarged, effects, &promise.point, trial.stiction))
}

fn sort(level: &mut [Trial]) {
    level.sort_by(|a, b| a.cost.total_cmp(&b.cost));
}

/// Of models with the same effects only the first is kept.
fn drop_doubles(level: &mut Vec<Trial>) {
    let mut seen: Vec<Vec<u16>> = Vec::new();
    level.retain(|trial| {
        let mut ids: Vec<u16> = trial.effects.iter().map(|effect| effect.id).collect();
        ids.sort_unstable();
        let new = !seen.contains(&ids);
        seen.push(ids);
        new
    });
}
