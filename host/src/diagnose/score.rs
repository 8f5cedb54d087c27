//! The score test: what could an effect gain, judged from one Gauss–Newton step over all parameters?
//!
//! Friction and inertia must be allowed to answer at once, or effects that resemble them are never found.

use super::trial::Trial;
use crate::fit::descent::{bounded_step, stepped};
use crate::fit::linear::{Linear, Steps, linearise, linearise_added};
use crate::fit::problem::{Point, Problem};
use crate::swing::Window;
use rayon::prelude::*;
use shared::effect::Effect;

/// What a start point of an effect promises.
#[derive(Clone, Debug)]
pub struct Promise {
    /// The effect.
    pub effect: &'static Effect<f64>,
    /// By how much the cost would fall, rad².
    pub gain: f64,
    /// The guess after the step; the effect's numbers stand last among the values.
    pub point: Point,
}

/// Damping of the step: enough to keep numbers without any effect in place.
const DAMPING: f64 = 1e-6;

/// Promises of all start points of all given effects on top of a fitted model, the best first.
pub fn promises(of: &Problem, trial: &Trial, effects: &[&'static Effect<f64>]) -> Vec<Promise> {
    let starts: Vec<(&'static Effect<f64>, &[f64])> = effects
        .iter()
        .flat_map(|effect| effect.starts.iter().map(|start| (*effect, &start[..effect.parameters.len()])))
        .collect();
    let problem = trial.problem(of);
    let known = linearise(&problem, &trial.point, Window::Whole, &mut Steps::found(&problem, &trial.point));
    let mut promises: Vec<Promise> =
        starts.into_par_iter().filter_map(|(effect, start)| promise(of, trial, &known, effect, start)).collect();
    promises.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    promises
}

fn promise(
    of: &Problem,
    trial: &Trial,
    known: &Linear,
    effect: &'static Effect<f64>,
    start: &[f64],
) -> Option<Promise> {
    let (unknowns, template) = trial.with(of, effect, start)?;
    let problem = Problem { unknowns, template, ..of.clone() };
    let mut values = trial.point.values.clone();
    values.extend(start);
    let point = Point { values, starts: trial.point.starts.clone() };
    let linear = linearise_added(&problem, &point, Window::Whole, known);
    let step = bounded_step(&problem, &point, &linear, DAMPING);
    let cost = linear.cost - linear.gain(&step);
    let point = stepped(&point, &step, problem.unknowns.len());
    cost.is_finite().then_some(Promise { effect, gain: trial.cost - cost, point })
}
