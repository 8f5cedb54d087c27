//! Levenberg–Marquardt with bounds: lowers the squared error within one window.
//!
//! Source: D. W. Marquardt, J. SIAM 11 (1963) 431. Four dampings are tried at once, because four simulations cost
//! little more than one. Where a straight step leaves a curved valley, it is bent (`bend.rs`).

use super::bend::bent;
use super::linear::{Linear, Steps, linearise};
use super::problem::{Point, Problem};
use super::step::{Step, bounded_step, bounded_zero, stepped};
use crate::swing::Window;
use nalgebra::DVector;
use simulation::LANES;

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
    /// For the model that is told: as to judge it, along curved valleys too. Of 161 such descents of rigs with laws of
    /// another shape 127 end after one iteration and 28 after two to nineteen; six, of springs that harden, use all.
    /// Half of it would cut three more short; with twice those six go on.
    pub const LAST: Self = Self { max_iterations: 30, least_gain: 1e-2, follows_valleys: true, ..Self::JUDGE };
    /// The same for one that explains the swings: what is left beyond the noise that neighbouring readings tell is noise too,
    /// and no reason to end.
    pub const EXPLAINED: Self = Self { least_share_of_excess: 0.0, ..Self::LAST };
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
    /// The last step gained less than the tolerance, and far less than the linear model predicted: it left a curved valley.
    LeftValley,
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
        } else if gain < least.min(KEPT_SHARE * predicted) && predicted > least {
            Some(Termination::LeftValley)
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
    /// The best of four damped steps, if it is better than staying: straight ones, and bent ones where these bring less
    /// than is wanted. Where it leads, what that costs, and its factor of the damping.
    fn best_trial(&self, linear: &Linear, damping: f64, wanted: Option<f64>) -> Option<(Point, f64, f64)> {
        let steps =
            DAMPING_FACTORS.map(|factor| Step::bounded(self.problem, self.point, &linear.equations, damping * factor));
        let after = |step: &Step| stepped(self.problem, self.point, &step.change);
        let straight = self.best(steps.iter().map(after).collect());
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
        let mut point = stepped(self.problem, self.point, change);
        let all = point.values.iter_mut().zip(&self.problem.unknowns);
        all.for_each(|(value, unknown)| *value = value.clamp(unknown.low, unknown.high));
        for (swing_idx, start) in point.starts.iter_mut().enumerate() {
            let (_, low, high) = bounded_zero(self.problem, self.point, swing_idx);
            start.offset_rad = start.offset_rad.clamp(low, high);
        }
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
