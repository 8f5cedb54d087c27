//! Levenberg–Marquardt with bounds: lowers the squared error within one window.
//!
//! Source: D. W. Marquardt, J. SIAM 11 (1963) 431. Four dampings are tried at once, because four simulations cost
//! little more than one.

use super::arrow::ArrowFactor;
use super::linear::{Equations, Steps, equations};
use super::problem::{LANES, PER_SWING, Point, Problem};
use crate::swing::Window;
use nalgebra::DVector;

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// At most this many linearisations.
    pub max_iterations: usize,
    /// Stop when a step lowers the cost by less than this many noise variances.
    pub least_gain: f64,
    /// … or by less than this share of the cost …
    pub least_share: f64,
    /// … or by less than this share of what the cost has beyond the noise.
    pub least_share_of_excess: f64,
}

impl Tolerance {
    /// To see what a model is worth.
    pub const SCREEN: Self = Self { max_iterations: 5, least_gain: 3.0, least_share: 0.02, ..Self::FINE };
    /// To go on with a longer window.
    pub const ROUGH: Self = Self { max_iterations: 6, least_gain: 3.0, least_share: 1e-3, ..Self::FINE };
    /// Where the numbers of a law depend on each other.
    pub const LONG: Self = Self { max_iterations: 12, least_gain: 3.0, least_share: 1e-4, ..Self::FINE };
    /// For a model's last fit: to the last digit only where the noise is nearly reached.
    pub const JUDGE: Self = Self { max_iterations: 12, least_gain: 0.1, least_share_of_excess: 3e-3, ..Self::FINE };
    /// To the last digit.
    pub const FINE: Self = Self { max_iterations: 15, least_gain: 1e-2, least_share: 0.0, least_share_of_excess: 0.0 };
}

/// Why a descent ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Termination {
    /// The last step gained less than the tolerance.
    LittleGain,
    /// The last step gained just what the linear model predicted, which leaves nothing to the next one.
    AsPredicted,
    /// No step lowers the cost, however short.
    NoStepHelps,
    /// The iterations were used up first.
    LostPatience,
}

impl Termination {
    /// Is a minimum reached, as far as the tolerance goes?
    pub fn is_converged(self) -> bool {
        self != Self::LostPatience
    }
}

/// Where a descent ended.
#[derive(Clone, Debug)]
pub struct Descent {
    /// The best guess.
    pub point: Point,
    /// Sum of squared errors there, rad².
    pub cost: f64,
    /// Finite-difference steps, to go on with.
    pub steps: Steps,
    /// Why it ended.
    pub termination: Termination,
}

/// The dampings tried around the present one.
const DAMPING_FACTORS: [f64; LANES] = [1e-3, 1e-1, 1.0, 30.0];

/// Damping at the start: nearly Gauss–Newton.
const FIRST_DAMPING: f64 = 1e-3;

/// Share of a predicted gain by which the true one may differ where the error is a parabola.
const SMALL_SURPRISE: f64 = 0.03;

/// Beyond this no direction helps.
const LARGEST_DAMPING: f64 = 1e6;

/// Descends from a guess.
pub fn descend(problem: &Problem, from: &Point, window: Window, tolerance: Tolerance, steps: Steps) -> Descent {
    let mut steps = steps;
    let mut point = from.clone();
    let mut damping = FIRST_DAMPING;
    let unit = problem.least_variance();
    let noise = unit * problem.n_samples(window) as f64;
    let mut linear = equations(problem, &point, window, &mut steps);
    let mut cost = linear.cost;
    let mut termination = Termination::LostPatience;
    for iteration in 0..tolerance.max_iterations {
        if iteration > 0 {
            linear = equations(problem, &point, window, &mut steps);
        }
        let predicted = linear.gain(&bounded_step(problem, &point, &linear, 0.0));
        let gain = loop {
            let Some((better, lower, factor)) = best_trial(problem, &point, &linear, window, damping, cost) else {
                damping *= 1e4;
                if damping > LARGEST_DAMPING {
                    break 0.0;
                }
                continue;
            };
            damping = (damping * factor).clamp(1e-9, LARGEST_DAMPING);
            let gain = cost - lower;
            (point, cost) = (better, lower);
            break gain;
        };
        let least_of_excess = tolerance.least_share_of_excess * (cost - noise);
        let least = (tolerance.least_gain * unit).max(tolerance.least_share * cost).max(least_of_excess);
        let surprise = (predicted - gain).abs();
        let ended = if gain <= 0.0 {
            Some(Termination::NoStepHelps)
        } else if gain < least {
            Some(Termination::LittleGain)
        } else if surprise < least.min(SMALL_SURPRISE * predicted) {
            Some(Termination::AsPredicted)
        } else {
            None
        };
        if let Some(reason) = ended {
            termination = reason;
            break;
        }
    }
    Descent { point, cost, steps, termination }
}

/// The best of four damped steps, if it is better than staying.
fn best_trial(
    problem: &Problem,
    point: &Point,
    linear: &Equations,
    window: Window,
    damping: f64,
    cost: f64,
) -> Option<(Point, f64, f64)> {
    let trial = |factor: &f64| {
        let step = bounded_step(problem, point, linear, damping * factor);
        stepped(point, &step, problem.unknowns.len())
    };
    let trials: Vec<Point> = DAMPING_FACTORS.iter().map(trial).collect();
    let costs = problem.costs(window, &trials);
    let (best, lowest) =
        costs.iter().enumerate().filter(|(_, cost)| cost.is_finite()).min_by(|a, b| a.1.total_cmp(b.1))?;
    (*lowest < cost).then(|| (trials[best].clone(), *lowest, DAMPING_FACTORS[best]))
}

/// A damped step within the bounds: an unknown that would leave them is put on its bound, and the others are solved
/// for again.
pub fn bounded_step(problem: &Problem, point: &Point, linear: &Equations, damping: f64) -> DVector<f64> {
    let n_unknowns = problem.unknowns.len();
    let is_offset = |j: usize| j >= n_unknowns && (j - n_unknowns) % PER_SWING == PER_SWING - 1;
    let mut free: Vec<bool> = (0..linear.gradient.len()).map(|j| problem.offsets_are_free || !is_offset(j)).collect();
    let mut gradient = linear.gradient.clone();
    let mut fixed_step = DVector::zeros(gradient.len());
    loop {
        let factor = ArrowFactor::new(&linear.normal, damping, |j| free[j]);
        let step = factor.solve(&gradient) + &fixed_step;
        let leaving = (0..n_unknowns).filter(|j| free[*j]).find_map(|j| {
            let target = point.values[j] + step[j];
            let bounded = target.clamp(problem.unknowns[j].low, problem.unknowns[j].high);
            (bounded != target).then_some((j, bounded - point.values[j]))
        });
        match leaving {
            None => return step,
            Some((j, to_bound)) => {
                free[j] = false;
                fixed_step[j] = to_bound;
                gradient -= linear.normal.shared_column(j) * to_bound;
            }
        }
    }
}

/// The guess after a step.
pub fn stepped(point: &Point, step: &DVector<f64>, n_unknowns: usize) -> Point {
    let mut next = point.clone();
    next.values.iter_mut().zip(step.iter()).for_each(|(value, change)| *value += change);
    for (swing_idx, start) in next.starts.iter_mut().enumerate() {
        let first = n_unknowns + PER_SWING * swing_idx;
        start.angle_rad += step[first];
        start.velocity_rad_s += step[first + 1];
        start.offset_rad += step[first + 2];
    }
    next
}
