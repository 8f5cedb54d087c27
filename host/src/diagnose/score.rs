//! The score test: what could an effect gain, judged from one Gauss–Newton step over all parameters?
//!
//! Friction and inertia must be allowed to answer at once, or effects that resemble them are never found.

use super::trial::Trial;
use crate::fit::descent::stepped;
use crate::fit::linear::{Linear, Steps, linearise, linearise_added, solve_damped};
use crate::fit::problem::{PER_SWING, Point, Problem};
use crate::swing::Window;
use nalgebra::DVector;
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
    let (step, cost) = bounded_step(&problem, &point, &linear);
    let point = stepped(&point, &step, problem.unknowns.len());
    cost.is_finite().then_some(Promise { effect, gain: trial.cost - cost, point })
}

/// The step and the cost it promises; numbers that would leave their bounds are held on them.
fn bounded_step(problem: &Problem, point: &Point, linear: &Linear) -> (DVector<f64>, f64) {
    let n_unknowns = problem.unknowns.len();
    let size = linear.gradient.len();
    debug_assert_eq!(size, n_unknowns + PER_SWING * problem.swings.len());
    let mut free = vec![true; size];
    let mut gradient = linear.gradient.clone();
    let mut held = DVector::zeros(size);
    loop {
        let step = solve_damped(&linear.normal, &gradient, DAMPING, &free) + &held;
        let leaving = (0..n_unknowns).filter(|j| free[*j]).find_map(|j| {
            let target = point.values[j] + step[j];
            let bounded = target.clamp(problem.unknowns[j].low, problem.unknowns[j].high);
            (bounded != target).then_some((j, bounded - point.values[j]))
        });
        let Some((j, to_bound)) = leaving else {
            let cost = linear.cost - 2.0 * linear.gradient.dot(&step) + step.dot(&(&linear.normal * &step));
            return (step, cost);
        };
        free[j] = false;
        held[j] = to_bound;
        gradient -= linear.normal.column(j) * to_bound;
    }
}
