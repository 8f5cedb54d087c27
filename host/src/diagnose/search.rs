//! The search through models: one effect at a time, the most promising few kept at each level.

use super::excess::{excess, is_explained, is_well_explained};
use super::extension::extensions;
use super::level::{NEAR, drop_doubles, near_the_best, sort};
use super::physical::is_sound;
use super::trial::{Sketch, Trial, better, finish, fitted_on, refined};
use crate::fit::descent::{Patience, descend};
use crate::fit::linear::Steps;
use crate::fit::problem::Problem;
use crate::fit::stiction::{self, Settled, Stiction};
use crate::fit::stop_level;
use crate::swing::Window;
use rayon::prelude::*;
use shared::effect::{CUSTOM_FORMULA_NAME, Effect};

/// At most this many effects are added.
const MAX_ADDED: usize = 3;

/// From the second effect on, one that leaves more than this share of the excess is the last.
const WORTH_ANOTHER: f64 = 0.4;

/// Models kept from one level to the next.
const BEAM: usize = 2;

/// Models that cost this much more than the best are not gone on with.
const BEAM_REACH: f64 = 2.0;

/// Models of one level that are looked at again, at most, …
const MAX_LOOKED_AT: usize = 8;

/// … if they cost less than so many times the best one.
const WORTH_A_LOOK: f64 = 3.0;

/// Where the best model leaves more than the noise, so many are looked at from other sides too.
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

/// All models with one more effect than those of the beam that are worth fitting, the lowest cost first.
fn next_level(problem: &Problem, rough: &Problem, beam: &[Trial], candidates: &[&'static Effect<f64>]) -> Vec<Trial> {
    let found = found_roughly(rough, beam, candidates);
    let Some(lowest) = found.first().map(|best| best.cost) else { return found };
    let (mut level, mut rest) = best_on_all(problem, rough, found);
    let best = level[0].clone();
    let has_another = |trial: &Trial| best.stiction.velocity_band > 0.0 || trial.stiction.velocity_band > 0.0;
    rest.extend(level.extract_if(1.., |trial| has_another(trial)));
    let others = rest.par_iter_mut().filter(|trial| has_another(trial) && trial.cost < BEAM_REACH * lowest);
    others.for_each(|trial| *trial = with_the_stiction_of(rough, best.stiction, trial));
    // Models far above the best one stay as they are: nothing that follows depends on their last digit.
    let reach = NEAR * best.judged(rough).cost.min(lowest);
    let left = |trial: &Trial| {
        if trial.cost < reach { fitted_on(problem, trial, Patience::ROUGH) } else { trial.judged(problem) }
    };
    level.par_extend(rest.par_iter().map(left));
    level.retain(|trial| is_sound(problem, trial));
    sort(&mut level);
    level
}

/// Those of a sorted level that may be the best, fitted to all samples until nothing moves, the lowest cost first; and
/// the others as they are on sketches. The level must not be empty.
fn best_on_all(problem: &Problem, rough: &Problem, mut level: Vec<Trial>) -> (Vec<Trial>, Vec<Trial>) {
    let n_near = near_the_best(&level).len().clamp(1, MAX_FINISHED);
    let mut rest = level.split_off(n_near);
    let mut near: Vec<Sketch> = level.par_iter().map(|trial| Sketch::of(rough, trial)).collect();
    sort_sketches(&mut near);
    if !is_well_explained(problem, &near[0].trial) {
        near.par_iter_mut().take(RIVALS).for_each(|sketch| sketch.seen_from_other_sides(problem, rough));
        sort_sketches(&mut near);
    }
    let limit = worth_all_samples(rough, near[0].trial.cost);
    let n_worth_it = near.iter().take_while(|sketch| sketch.trial.cost <= limit).count().max(1);
    rest.extend(near.split_off(n_worth_it).into_iter().map(|sketch| sketch.trial));
    // What somebody typed deserves its last digit anyway.
    let typed: Vec<Trial> = rest.extract_if(.., |trial| trial.has(CUSTOM_FORMULA_NAME)).collect();
    let mut best: Vec<Trial> = near.par_iter().map(|sketch| sketch.on_all(problem)).collect();
    best.par_extend(typed.par_iter().map(|trial| finish(problem, trial)));
    sort(&mut best);
    (best, rest)
}

fn sort_sketches(sketches: &mut [Sketch]) {
    sketches.sort_by(|a, b| a.trial.cost.total_cmp(&b.trial.cost));
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

/// A model with the stiction of another one, which may be a property of the bearing and no merit of its effect; what a
/// model was begun with may have imitated the effect.
fn with_the_stiction_of(rough: &Problem, stiction: Stiction, trial: &Trial) -> Trial {
    let moved = Trial { stiction, ..trial.clone() };
    better(trial.judged(rough), refined(rough, &moved, Patience::LONG))
}

/// A few steps more for models that came within reach of the best, in their new order: the first fits end early.
fn looked_at_again(problem: &Problem, mut level: Vec<Trial>) -> Vec<Trial> {
    let lowest = level.first().map_or(0.0, |best| best.cost);
    let n_near = level.iter().take(MAX_LOOKED_AT).take_while(|trial| trial.cost < WORTH_A_LOOK * lowest).count();
    level[..n_near].par_iter_mut().for_each(|trial| *trial = refined(problem, trial, Patience::ROUGH));
    sort(&mut level);
    level
}
