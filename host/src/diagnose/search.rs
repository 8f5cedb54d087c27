//! The search through models: one effect at a time, the most promising few kept at each level.

use super::physical::is_sound;
use super::score::{Promise, promises};
use super::trial::{Sketch, Trial, better, finish, finish_with_band, fit_from, fitted_on, refined, regrown};
use crate::fit::descent::{Patience, descend};
use crate::fit::linear::Steps;
use crate::fit::problem::Problem;
use crate::fit::stiction::{self, Settled, Stiction};
use crate::fit::stop_level;
use crate::swing::Window;
use rayon::prelude::*;
use shared::effect::{CUSTOM_FORMULA_ID, CUSTOM_FORMULA_NAME, Effect};

/// A residual this far above the noise variance is worth an explanation; the noise itself is known to about 2 %.
pub const EXCESS_WORTH_EXPLAINING: f64 = 0.03;

/// What a model with an added effect may leave: the law of the list is never quite the law of the rig.
const EXCESS_LEFT: f64 = 0.045;

/// At most this many effects are added.
const MAX_ADDED: usize = 3;

/// From the second effect on, one that leaves more than this share of the excess is the last.
const WORTH_ANOTHER: f64 = 0.4;

/// Models kept from one level to the next.
const BEAM: usize = 2;

/// Models that cost this much more than the best are not gone on with.
const BEAM_REACH: f64 = 2.0;

/// Effects whose promise is below this share of the best one are not fitted.
const SHARE_OF_BEST_PROMISE: f64 = 0.1;

/// Effects fitted at each level on top of one model, at most.
const MAX_FITTED: usize = 12;

/// Costs within this factor of the best are worth a fit to the last digit on sketches.
const NEAR: f64 = 1.3;

/// A model that leaves more than this share of the noise variance is not the last word: the best …
const WELL_EXPLAINED: f64 = 0.02;

/// … so many are then looked at from other sides too.
const RIVALS: usize = 2;

/// A base with a velocity band is gone on with, beside the one without, if its cost is below this share.
const WORTH_KEEPING_THE_BAND: f64 = 0.8;

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

/// Fits the base model and, level by level, models with added effects, until one explains the swings; `rough` has
/// sketches of the swings, on which models are found.
pub fn search(problem: &Problem, rough: &Problem, base: &Settled, candidates: &[&'static Effect<f64>]) -> Found {
    let none = stiction_free_base(problem, base);
    let mut found = Found { base: Trial::settled(problem, Vec::new(), base.clone()), levels: Vec::new() };
    if is_explained(problem, &found.base) {
        return found;
    }
    let mut beam = vec![none];
    let with_band = found.base.clone();
    if with_band.cost < WORTH_KEEPING_THE_BAND * beam[0].cost {
        beam.push(with_band);
    }
    for _ in 0..MAX_ADDED {
        let level = next_level(problem, rough, &beam, candidates);
        if level.is_empty() {
            break;
        }
        let explained = is_explained(problem, &level[0]);
        let n_added = found.levels.len();
        let before = found.best(n_added).cost;
        let share_left = excess(problem, level[0].cost) / excess(problem, before);
        let lowers = level[0].cost < before;
        beam = kept(&level);
        if !lowers {
            break;
        }
        found.levels.push(level);
        if explained || (n_added > 0 && share_left > WORTH_ANOTHER) {
            break;
        }
    }
    found
}

/// The models to go on with: the best few, and the best of those with the fewest numbers.
fn kept(level: &[Trial]) -> Vec<Trial> {
    let near = || level.iter().filter(|trial| trial.cost < BEAM_REACH * level[0].cost);
    let mut beam: Vec<Trial> = near().take(BEAM).cloned().collect();
    let simplest = near().min_by_key(|trial| trial.n_added());
    beam.extend(simplest.filter(|simple| beam.iter().all(|other| other.n_added() > simple.n_added())).cloned());
    beam
}

/// The base without a velocity band: a band that only imitates the missing effect would hide it.
fn stiction_free_base(problem: &Problem, base: &Settled) -> Trial {
    if base.stiction.velocity_band == 0.0 {
        return Trial::settled(problem, Vec::new(), base.clone());
    }
    let free = stiction::with_stiction(problem, Stiction { level_nm: 0.0, velocity_band: 0.0 });
    let descent = descend(&free, &base.descent.point, Window::Lively, Patience::ROUGH, Steps::new(&free));
    Trial::settled(problem, Vec::new(), stop_level::without_band(&free, &descent.point, Patience::JUDGE))
}

/// Does a model leave no more than the noise?
pub fn is_explained(problem: &Problem, trial: &Trial) -> bool {
    let allowed = if trial.effects.is_empty() { EXCESS_WORTH_EXPLAINING } else { EXCESS_LEFT };
    excess(problem, trial.cost) <= allowed
}

/// Residual variance beyond the noise, as a share of the noise variance.
pub fn excess(problem: &Problem, cost: f64) -> f64 {
    cost / problem.noise_cost() - 1.0
}

/// All models with one more effect than those of the beam that are worth fitting, the lowest cost first.
fn next_level(problem: &Problem, rough: &Problem, beam: &[Trial], candidates: &[&'static Effect<f64>]) -> Vec<Trial> {
    let mut level = found_roughly(rough, beam, candidates);
    let Some(lowest) = level.first().map(|best| best.cost) else { return level };
    let n_near = near_the_best(&level).len().clamp(1, MAX_FINISHED);
    let mut rest = level.split_off(n_near);
    let mut near: Vec<Sketch> = level.par_iter().map(|trial| Sketch::of(rough, trial)).collect();
    near.sort_by(|a, b| a.trial.cost.total_cmp(&b.trial.cost));
    let limit = worth_all_samples(rough, near[0].trial.cost);
    let n_worth_it = near.iter().take_while(|sketch| sketch.trial.cost <= limit).count().max(1);
    rest.extend(near.split_off(n_worth_it).into_iter().map(|sketch| sketch.trial));
    let lowest = lowest.min(near[0].trial.cost);
    // What somebody typed deserves its last digit anyway.
    let typed: Vec<Trial> = rest.extract_if(.., |trial| trial.has(CUSTOM_FORMULA_NAME)).collect();
    level = near.par_iter().map(|sketch| sketch.on_all(problem)).collect();
    level.par_extend(typed.par_iter().map(|trial| finish(problem, trial)));
    sort(&mut level);
    if excess(problem, level[0].cost) > WELL_EXPLAINED {
        level.par_iter_mut().take(RIVALS).for_each(|trial| *trial = from_other_sides(problem, rough, trial));
        sort(&mut level);
    }
    let best = level[0].stiction;
    let has_another = |trial: &Trial| best.velocity_band > 0.0 || trial.stiction.velocity_band > 0.0;
    rest.extend(level.extract_if(1.., |trial| has_another(trial)));
    let others = rest.par_iter_mut().filter(|trial| has_another(trial) && trial.cost < BEAM_REACH * lowest);
    others.for_each(|trial| *trial = with_the_stiction_of(rough, best, trial));
    // Models far above the best one stay as they are: nothing that follows depends on their last digit.
    let reach = NEAR * level[0].judged(rough).cost.min(lowest);
    let left = |trial: &Trial| {
        if trial.cost < reach { fitted_on(problem, trial, Patience::ROUGH) } else { trial.judged(problem) }
    };
    level.par_extend(rest.par_iter().map(left));
    level.retain(|trial| is_sound(problem, trial));
    sort(&mut level);
    level
}

/// A model whose cost on sketches is below this may be the best one of all samples, if the best on sketches costs
/// `lowest`.
pub(super) fn worth_all_samples(rough: &Problem, lowest: f64) -> f64 {
    let chance = MOSTLY_CHANCE * rough.noise_rad().powi(2);
    let missing = (lowest - rough.noise_cost()).max(0.0);
    lowest + chance + SMALL_SHARE_OF_EXCESS * missing
}

/// On sketches, differences of so many noise variances may be chance, or another stop level …
const MOSTLY_CHANCE: f64 = 50.0;

/// … and so may this share of what is missing from the model.
const SMALL_SHARE_OF_EXCESS: f64 = 0.1;

/// The same on sketches alone, not finished.
fn found_roughly(rough: &Problem, beam: &[Trial], candidates: &[&'static Effect<f64>]) -> Vec<Trial> {
    let extended = |trial: &Trial| extensions(rough, &trial.judged(rough), candidates);
    let mut level: Vec<Trial> = beam.iter().flat_map(extended).collect();
    level.retain(|trial| is_sound(rough, trial));
    sort(&mut level);
    drop_doubles(&mut level);
    looked_at_again(rough, level)
}

/// A model fitted anew from the first swings, and with a velocity band, if one of them is better.
fn from_other_sides(problem: &Problem, rough: &Problem, trial: &Trial) -> Trial {
    let here = trial.judged(rough);
    let anew = better(here.clone(), regrown(rough, trial));
    let explains = excess(rough, anew.cost) <= WELL_EXPLAINED;
    let anew = if explains { anew } else { better(anew.clone(), finish_with_band(rough, &anew)) };
    let gain = here.cost - anew.cost;
    if gain < stiction::GAIN_WORTH_A_BAND * problem.noise_rad().powi(2) {
        return trial.clone();
    }
    let has_band = anew.stiction.velocity_band > 0.0;
    let anew = if has_band { fitted_on(problem, &anew, Patience::JUDGE) } else { finish(problem, &anew) };
    better(trial.clone(), anew)
}

/// A model with the stiction of another one, which may be a property of the bearing and no merit of its effect; what a
/// model was begun with may have imitated the effect.
fn with_the_stiction_of(rough: &Problem, stiction: Stiction, trial: &Trial) -> Trial {
    let moved = Trial { stiction, ..trial.clone() };
    better(trial.judged(rough), refined(rough, &moved, Patience::LONG))
}

/// A few steps more for models that came within reach of the best, in their new order: the first fits end early.
fn looked_at_again(problem: &Problem, mut level: Vec<Trial>) -> Vec<Trial> {
    let lowest = level.first().map_or(0.0, |best| best.cost);
    let n_near = level.iter().take(MAX_FITTED).take_while(|trial| trial.cost < BEAM_REACH * lowest).count();
    level[..n_near].par_iter_mut().for_each(|trial| *trial = refined(problem, trial, Patience::ROUGH));
    sort(&mut level);
    level
}

/// A model with one more effect, each of the promising ones in turn: first the best start of each, then the next best
/// and the wider forms; where one explains the swings, only of those that come near it, but then all their starts.
fn extensions(problem: &Problem, trial: &Trial, candidates: &[&'static Effect<f64>]) -> Vec<Trial> {
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

/// A generalisation is fitted at once if it promises so many times the gain of its special case.
const GENERALISATION_GAIN: f64 = 1.05;

/// Fits what a promise leads to; where little of a large one comes true, another stop level may be what is lacking.
fn fit_or_sketch(problem: &Problem, trial: &Trial, promise: &Promise, best_gain: f64) -> Option<Trial> {
    let fitted = fit_promise(problem, trial, promise)?;
    let is_large = promise.gain > LARGE_PROMISE * best_gain;
    let came_true = trial.cost - fitted.cost > KEPT_PROMISE * promise.gain;
    Some(if is_large && !came_true { Sketch::of(problem, &fitted).trial } else { fitted })
}

/// A promise is large from this share of the best one on …
const LARGE_PROMISE: f64 = 0.7;

/// … and comes true if the fit gains this share of it.
const KEPT_PROMISE: f64 = 0.7;

/// Fits what a promise leads to.
pub(super) fn fit_promise(problem: &Problem, trial: &Trial, promise: &Promise) -> Option<Trial> {
    let n_before = trial.unknowns.len();
    let (unknowns, template) = trial.with(problem, promise.effect, &promise.point.values[n_before..])?;
    let enlarged = Problem { unknowns, template, ..problem.clone() };
    let mut effects = trial.effects.clone();
    effects.push(promise.effect);
    Some(fit_from(&enlarged, effects, &promise.point, trial.stiction))
}

/// The models of a sorted level that nearly cost what the best one does.
fn near_the_best(level: &[Trial]) -> &[Trial] {
    let n_near = level.iter().take_while(|trial| trial.cost < NEAR * level[0].cost).count();
    &level[..n_near]
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
