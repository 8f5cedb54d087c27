//! Levenberg–Marquardt with bounds: lowers the squared error within one window.
//!
//! Source: D. W. Marquardt, J. SIAM 11 (1963) 431. Four dampings are tried at once, because four simulations cost
//! little more than one. Where a straight step leaves a curved valley, it is bent (`bend.rs`).

use super::arrow::ArrowFactor;
use super::bend::bent;
use super::linear::{Equations, Linear, Steps, linearise};
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
    /// Are steps bent that would leave a curved valley? That takes three more simulations a step, where they do.
    pub follows_valleys: bool,
}

impl Tolerance {
    /// To see what a model is worth.
    pub const SCREEN: Self = Self { max_iterations: 5, least_gain: 3.0, least_share: 0.02, ..Self::FINE };
    /// To go on with a longer window.
    pub const ROUGH: Self = Self { max_iterations: 6, least_gain: 3.0, least_share: 1e-3, ..Self::FINE };
    /// Where the numbers of a law depend on each other.
    pub const LONG: Self = Self { max_iterations: 12, least_gain: 3.0, least_share: 1e-4, ..Self::FINE };
    /// For what may be the best model: to the last digit only where the noise is nearly reached.
    pub const JUDGE: Self = Self { max_iterations: 12, least_gain: 0.1, least_share_of_excess: 3e-3, ..Self::FINE };
    /// To the last digit.
    pub const FINE: Self = Self {
        max_iterations: 15,
        least_gain: 1e-2,
        least_share: 0.0,
        least_share_of_excess: 0.0,
        follows_valleys: false,
    };
    /// For the model that is told: as to judge it, along curved valleys too. Rigs with a free exponent take up to eight
    /// steps, four in the mean; half of these would leave some on the way, twice is never reached.
    pub const LAST: Self = Self { max_iterations: 30, least_gain: 1e-2, follows_valleys: true, ..Self::JUDGE };
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

/// A step that brings less than this share of what the linear model promises has left a curved valley.
const KEPT_SHARE: f64 = 0.5;

/// Beyond this no direction helps.
const LARGEST_DAMPING: f64 = 1e6;

/// Descends from a guess.
pub fn descend(problem: &Problem, from: &Point, window: Window, tolerance: Tolerance, steps: Steps) -> Descent {
    let mut steps = steps;
    let mut point = from.clone();
    let mut damping = FIRST_DAMPING;
    let unit = problem.least_variance();
    let noise = unit * problem.n_samples(window) as f64;
    let mut linear = linearise(problem, &point, window, &mut steps);
    let mut cost = linear.equations.cost;
    let mut termination = Termination::LostPatience;
    for iteration in 0..tolerance.max_iterations {
        if iteration > 0 {
            linear = linearise(problem, &point, window, &mut steps);
        }
        let equations = &linear.equations;
        let predicted = equations.gain(&bounded_step(problem, &point, equations, 0.0));
        let gain = loop {
            let wanted = tolerance.follows_valleys.then_some(KEPT_SHARE * predicted);
            let here = Here { problem, point: &point, window, cost };
            let Some((better, lower, factor)) = here.best_trial(&linear, damping, wanted) else {
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

/// Where a descent stands.
struct Here<'a, 'b> {
    problem: &'a Problem<'b>,
    point: &'a Point,
    window: Window,
    cost: f64,
}

impl Here<'_, '_> {
    /// The best of four damped steps, if it is better than staying: straight ones, and bent ones where these bring less than is
    /// wanted. Where it leads, what that costs, and its factor of the damping.
    fn best_trial(&self, linear: &Linear, damping: f64, wanted: Option<f64>) -> Option<(Point, f64, f64)> {
        let steps =
            DAMPING_FACTORS.map(|factor| Step::bounded(self.problem, self.point, &linear.equations, damping * factor));
        let n_unknowns = self.problem.unknowns.len();
        let straight = self.best(steps.iter().map(|step| stepped(self.point, &step.change, n_unknowns)).collect());
        let gain = straight.as_ref().map_or(0.0, |(_, cost, _)| self.cost - cost);
        if wanted.is_none_or(|wanted| gain >= wanted) {
            return straight;
        }
        let bent = bent(self.problem, self.point, linear, &steps);
        let bent = self.best(bent.iter().map(|change| self.bounded(change)).collect());
        [straight, bent].into_iter().flatten().min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The guess after a change that knows no bounds.
    fn bounded(&self, change: &DVector<f64>) -> Point {
        let mut point = stepped(self.point, change, self.problem.unknowns.len());
        let all = point.values.iter_mut().zip(&self.problem.unknowns);
        all.for_each(|(value, unknown)| *value = value.clamp(unknown.low, unknown.high));
        point
    }

    /// The best of some guesses, if it is better than staying.
    fn best(&self, trials: Vec<Point>) -> Option<(Point, f64, f64)> {
        let costs = self.problem.costs(self.window, &trials);
        let (best, lowest) =
            costs.iter().enumerate().filter(|(_, cost)| cost.is_finite()).min_by(|a, b| a.1.total_cmp(b.1))?;
        (*lowest < self.cost).then(|| (trials[best].clone(), *lowest, DAMPING_FACTORS[best]))
    }
}

/// A damped step within the bounds.
pub(super) struct Step {
    /// What it adds to the unknowns, then to angle, velocity and offset of each swing.
    pub(super) change: DVector<f64>,
    damping: f64,
    /// Numbers that are not on their bounds.
    free: Vec<bool>,
}

impl Step {
    /// An unknown that would leave its bounds is put on its bound, and the others are solved for again.
    fn bounded(problem: &Problem, point: &Point, linear: &Equations, damping: f64) -> Self {
        let n_unknowns = problem.unknowns.len();
        let is_offset = |j: usize| j >= n_unknowns && (j - n_unknowns) % PER_SWING == PER_SWING - 1;
        let mut free: Vec<bool> =
            (0..linear.gradient.len()).map(|j| problem.offsets_are_free || !is_offset(j)).collect();
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
                None => return Self { change: step, damping, free },
                Some((j, to_bound)) => {
                    free[j] = false;
                    fixed_step[j] = to_bound;
                    gradient -= linear.normal.shared_column(j) * to_bound;
                }
            }
        }
    }

    /// What the free numbers answer to another right-hand side, damped as the step is.
    pub(super) fn answer(&self, linear: &Equations, gradient: &DVector<f64>) -> DVector<f64> {
        ArrowFactor::new(&linear.normal, self.damping, |j| self.free[j]).solve(gradient)
    }
}

/// A damped step within the bounds.
pub fn bounded_step(problem: &Problem, point: &Point, linear: &Equations, damping: f64) -> DVector<f64> {
    Step::bounded(problem, point, linear, damping).change
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
