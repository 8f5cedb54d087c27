//! Adding and removing effects by hand, one step at a time, with the error before and after each.

use crate::diagnose::score::promises;
use crate::diagnose::trial::{Trial, Value, finish, finish_with_band, fit_from, values};
use crate::fit::descent::Patience;
use crate::fit::identify::{held_out_rmse, problem_of, smooth};
use crate::fit::problem::{Point, Problem, Quantity};
use crate::fit::stiction::{self, Stiction, with_stiction};
use crate::fit::{start, windows};
use crate::formula::effect_of;
use crate::swing::{Swing, Window};
use serde::Serialize;
use shared::effect::Effect;
use shared::parameters::{Parameters, base};
use std::sync::atomic::AtomicUsize;

/// What to do.
#[derive(Clone, Copy, Debug)]
pub enum Change {
    /// Add an effect.
    Add(&'static Effect<f64>),
    /// Take an effect out.
    Remove(&'static Effect<f64>),
}

/// The model after one change.
#[derive(Clone, Debug, Serialize)]
pub struct Step {
    /// What was done.
    pub words: String,
    /// Root mean square error, rad.
    pub rmse: f64,
    /// The same on held-out swings, rad.
    pub held_out: Option<f64>,
    /// Noise, rad.
    pub noise: f64,
    /// All numbers of the model but Ms and DV.
    pub values: Vec<Value>,
    /// The model, refitted.
    #[serde(skip)]
    pub parameters: Parameters<f64>,
}

/// Why a change can't be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ChangeError {
    /// It is in already.
    #[error(
        "{name} is part of the model already; change its value in the model file, or take it out with --remove {name}"
    )]
    Present {
        /// The effect.
        name: &'static str,
    },
    /// It is not in.
    #[error("{name} is not part of the model; there is nothing to remove")]
    Absent {
        /// The effect.
        name: &'static str,
    },
    /// No fit with it came to anything.
    #[error("no fit with {name} succeeded; a model has at most {} effects", shared::parameters::MAX_EFFECTS)]
    Failed {
        /// The effect.
        name: &'static str,
    },
}

/// Refits the model as it is, then makes each change and refits everything.
pub fn change(
    swings: &[Swing],
    held_out: &[Swing],
    rig: &Parameters<f64>,
    changes: &[Change],
) -> Result<Vec<Step>, ChangeError> {
    let bench = Bench { swings, held_out, count: &AtomicUsize::new(0) };
    let (mut trial, first) = bench.fitted(rig);
    let mut steps = vec![first];
    for change in changes {
        let (next, step) = bench.changed(&trial, *change)?;
        trial = next;
        steps.push(step);
    }
    Ok(steps)
}

/// What the changes of a model are judged by.
#[derive(Clone, Copy, Debug)]
pub struct Bench<'a> {
    /// Swings to fit.
    pub swings: &'a [Swing],
    /// Swings that take no part.
    pub held_out: &'a [Swing],
    /// Simulated swings so far.
    pub count: &'a AtomicUsize,
}

impl Bench<'_> {
    /// The model as it is, refitted; further changes go on from the trial.
    pub fn fitted(&self, rig: &Parameters<f64>) -> (Trial, Step) {
        let problem = smooth(&problem_of(self.swings, rig, self.count));
        let trial = fitted_as_it_is(&problem);
        let step = self.step("as it is".to_owned(), &problem, &trial);
        (trial, step)
    }

    /// The model after one more change, refitted from where it was.
    ///
    /// # Errors
    /// The effect is in already, is not in, or nothing with it could be fitted.
    pub fn changed(&self, trial: &Trial, change: Change) -> Result<(Trial, Step), ChangeError> {
        let problem = smooth(&problem_of(self.swings, &trial.parameters, self.count));
        let (words, trial) = match change {
            Change::Add(effect) => (format!("+ {}", effect.name), added(&problem, trial, effect)?),
            Change::Remove(effect) => (format!("- {}", effect.name), removed(&problem, trial, effect)?),
        };
        let step = self.step(words, &problem, &trial);
        Ok((trial, step))
    }

    fn step(&self, words: String, problem: &Problem, trial: &Trial) -> Step {
        let held_out = |parameters| held_out_rmse(self.held_out, parameters, self.count);
        Step {
            words,
            rmse: (trial.cost / problem.n_samples(Window::Whole) as f64).sqrt(),
            held_out: (!self.held_out.is_empty()).then(|| held_out(&trial.parameters)),
            noise: problem.noise_rad(),
            values: values(problem, trial),
            parameters: trial.parameters.clone(),
        }
    }
}

fn fitted_as_it_is(problem: &Problem) -> Trial {
    let effects = problem.template.effects.iter().filter(|effect| effect.id > base::STICTION);
    let effects: Vec<&'static Effect<f64>> =
        effects.filter_map(|effect| effect_of(&problem.template, effect.id)).collect();
    let free = with_stiction(problem, Stiction { level_nm: 0.0, velocity_band: 0.0 });
    let grown = windows::grow(&free, &start::guess(&free));
    Trial::settled(&free, effects, stiction::settle(&free, &grown.point, Patience::JUDGE))
}

fn added(problem: &Problem, trial: &Trial, effect: &'static Effect<f64>) -> Result<Trial, ChangeError> {
    let name = effect.name;
    if trial.parameters.values(effect.id).is_some() {
        return Err(ChangeError::Present { name });
    }
    let fits = promises(problem, trial, &[effect]).into_iter().take(STARTS).filter_map(|promise| {
        let n_before = trial.unknowns.len();
        let (unknowns, template) = trial.with(problem, effect, &promise.point.values[n_before..])?;
        let effects = [trial.effects.as_slice(), &[effect]].concat();
        Some(fit_from(&Problem { unknowns, template, ..problem.clone() }, effects, &promise.point, trial.stiction))
    });
    let best = fits.min_by(|a, b| a.cost.total_cmp(&b.cost)).ok_or(ChangeError::Failed { name })?;
    Ok(finished(problem, best))
}

/// Far above the noise the last swings tell nothing of a velocity band, whose search costs the most.
fn finished(problem: &Problem, trial: Trial) -> Trial {
    let trial = if is_near_noise(problem, &trial) { trial } else { finish(problem, &trial) };
    if is_near_noise(problem, &trial) { finish_with_band(problem, &trial) } else { trial }
}

fn is_near_noise(problem: &Problem, trial: &Trial) -> bool {
    trial.cost < (NEAR_NOISE * problem.noise_rad()).powi(2) * problem.n_samples(Window::Whole) as f64
}

/// An error of so many times the noise is near it.
const NEAR_NOISE: f64 = 5.0;

/// Starts of an effect that are fitted.
const STARTS: usize = 3;

fn removed(problem: &Problem, trial: &Trial, effect: &'static Effect<f64>) -> Result<Trial, ChangeError> {
    let belongs = |quantity: Quantity| matches!(quantity, Quantity::Effect { id, .. } if id == effect.id);
    if trial.parameters.values(effect.id).is_none() {
        return Err(ChangeError::Absent { name: effect.name });
    }
    let kept: Vec<usize> = (0..trial.unknowns.len()).filter(|j| !belongs(trial.unknowns[*j].quantity)).collect();
    let mut template = trial.parameters.clone();
    template.remove(effect.id);
    let unknowns = kept.iter().map(|j| trial.unknowns[*j].clone()).collect();
    let values = kept.iter().map(|j| trial.point.values[*j]).collect();
    let point = Point { values, starts: trial.point.starts.clone() };
    let effects = trial.effects.iter().copied().filter(|other| other.id != effect.id).collect();
    let stiction =
        if effect.id == base::STICTION { Stiction { level_nm: 0.0, velocity_band: 0.0 } } else { trial.stiction };
    let smaller = Problem { unknowns, template, ..problem.clone() };
    Ok(finish(problem, &fit_from(&smaller, effects, &point, stiction)))
}
