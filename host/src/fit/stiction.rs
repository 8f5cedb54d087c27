//! Ms and DV: the two parameters in which the error is not smooth.
//!
//! Where the pendulum stops depends on them in jumps, so they are searched on a grid. Each pair is judged after the
//! smooth parameters have answered to it to first order (a frozen linearisation); the best few are then descended
//! from in earnest. Ms alone, DV = 0, is the matter of [`super::stop_level`].

use super::descent::{Descent, Patience, descend};
use super::linear::{Linear, Steps, dot, linearise, solve_damped};
use super::problem::{PER_SWING, Point, Problem, Quantity, Start, Unknown};
use super::stop_level;
use crate::swing::Window;
use nalgebra::DVector;
use rayon::prelude::*;
use shared::effect::Effect;
use shared::parameters::{Parameters, base};

/// A pair to be tried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stiction {
    /// Ms, N·m.
    pub level_nm: f64,
    /// DV, rad/s.
    pub velocity_band: f64,
}

/// Velocity bands that are tried, rad/s.
const BANDS: [f64; 6] = [0.005, 0.012, 0.025, 0.04, 0.06, 0.09];

/// Levels that are tried with them, as shares of m·g·l.
const LEVELS: [f64; 12] = [0.002, 0.0028, 0.004, 0.0055, 0.0075, 0.0105, 0.0145, 0.02, 0.027, 0.036, 0.05, 0.07];

/// A band is only sought when the error without one exceeds the noise by this share of the variance.
const EXCESS_WORTH_A_BAND: f64 = 0.005;

/// A band is only kept when it lowers the cost by this many noise variances more than none.
pub const GAIN_WORTH_A_BAND: f64 = 12.0;

/// Rounds of search and descent.
pub(super) const MAX_ROUNDS: usize = 3;

/// What the search ends with.
#[derive(Clone, Debug)]
pub struct Settled {
    /// Ms and DV.
    pub stiction: Stiction,
    /// Other levels between these give the same swing, N·m.
    pub level_range_nm: (f64, f64),
    /// The descent with them.
    pub descent: Descent,
}

/// Searches Ms and DV, starting from a guess at everything else: first on sketches, then on all samples. `problem` must
/// not have them among its unknowns.
pub fn settle(problem: &Problem, from: &Point, patience: Patience) -> Settled {
    let sketches = problem.sketches();
    let rough = problem.on(&sketches);
    let levels = stop_level::levels(&rough, from);
    let near = &levels[0];
    let none = || stop_level::best_of(&levels, problem, patience);
    let band = |found: &Settled| freed(problem, &found.descent.point, found.stiction, patience);
    let least_gain = GAIN_WORTH_A_BAND * problem.noise_rad().powi(2);
    if near.descent.cost > FAR_FROM_NOISE * rough.noise_cost() {
        let found = with_band(&rough, near, patience);
        return found.filter(|found| gain_of(found, near) > least_gain).map_or_else(none, |found| band(&found));
    }
    let none = none();
    if none.descent.cost < (1.0 + EXCESS_WORTH_A_BAND) * problem.noise_cost() {
        return none;
    }
    let band = with_band(&rough, near, patience).map(|found| band(&found));
    band.filter(|band| gain_of(band, &none) > least_gain).unwrap_or(none)
}

fn gain_of(settled: &Settled, before: &Settled) -> f64 {
    before.descent.cost - settled.descent.cost
}

/// So many times the noise variance is far enough from it to decide for or against a band on sketches.
const FAR_FROM_NOISE: f64 = 2.0;

/// The problem with other fixed Ms and DV.
pub fn with_stiction<'a>(problem: &Problem<'a>, stiction: Stiction) -> Problem<'a> {
    let mut changed = problem.clone();
    // The base effects always have their place in the list.
    let _ = changed.template.set(base::STICTION, &[stiction.level_nm, stiction.velocity_band]);
    changed
}

/// Costs of pairs after the smooth parameters have answered to first order.
pub(super) fn answered_costs(problem: &Problem, linear: &Linear, point: &Point, tried: &[Stiction]) -> Vec<f64> {
    let pair_problem = Problem {
        unknowns: stiction_unknowns(&problem.template),
        template: problem.parameters(&point.values),
        ..problem.clone()
    };
    let pairs: Vec<[f64; 2]> = tried.iter().map(|pair| [pair.level_nm, pair.velocity_band]).collect();
    let n_unknowns = problem.unknowns.len();
    let per_swing: Vec<Vec<(f64, Vec<f64>)>> = (0..problem.swings.len())
        .into_par_iter()
        .map(|swing_idx| {
            let swing = &problem.swings[swing_idx];
            let start = point.starts[swing_idx];
            let guesses: Vec<(&[f64], Start)> = pairs.iter().map(|pair| (pair.as_slice(), start)).collect();
            let predicted = pair_problem.predict(swing_idx, swing.len(), &guesses);
            let judge = |column: &Vec<f64>| {
                let residuals: Vec<f64> =
                    swing.angles_rad.iter().zip(column).map(|(m, p)| m - p - start.offset_rad).collect();
                let slopes = linear.swings[swing_idx].columns.iter().map(|column| dot(column, &residuals)).collect();
                (dot(&residuals, &residuals), slopes)
            };
            predicted.iter().map(judge).collect()
        })
        .collect();
    (0..tried.len())
        .map(|pair_idx| {
            let mut gradient = DVector::zeros(linear.gradient.len());
            let mut cost = 0.0;
            for (swing_idx, judged) in per_swing.iter().enumerate() {
                let (square, slopes) = &judged[pair_idx];
                cost += square;
                for (j, slope) in slopes.iter().enumerate() {
                    gradient[if j < n_unknowns { j } else { j + PER_SWING * swing_idx }] += slope;
                }
            }
            let answer = solve_damped(&linear.normal, &gradient, 1e-6, &vec![true; gradient.len()]);
            cost - gradient.dot(&answer)
        })
        .collect()
}

/// Ms and DV as unknowns.
pub fn stiction_unknowns(parameters: &Parameters<f64>) -> Vec<Unknown> {
    Effect::by_id(base::STICTION).map_or(Vec::new(), |effect| Unknown::all_of_effect(effect, parameters))
}

fn lowest(costs: &[f64]) -> Option<usize> {
    let finite = costs.iter().enumerate().filter(|(_, cost)| cost.is_finite());
    finite.min_by(|a, b| a.1.total_cmp(b.1)).map(|(index, _)| index)
}

/// Searches Ms and a velocity band; `None` if nothing is better than `none`, the outcome without one.
fn with_band(problem: &Problem, none: &Settled, patience: Patience) -> Option<Settled> {
    let mut best = around(problem, none, patience).filter(|found| gain_of(found, none) > 0.0)?;
    let mut before = none.descent.cost;
    // Far from the truth, first-order answers mislead: where so much was gained, they are asked again.
    for _ in 1..MAX_ROUNDS {
        if best.descent.cost > WORTH_ANOTHER_ROUND * before {
            break;
        }
        before = best.descent.cost;
        best = around(problem, &best, patience).map_or(best.clone(), |next| better(best, next));
    }
    Some(best)
}

/// The best that the most promising bands lead to, judged from one outcome.
fn around(problem: &Problem, from: &Settled, patience: Patience) -> Option<Settled> {
    let tried = promising(problem, from);
    let fitted = tried.into_iter().map(|pair| descended(problem, &from.descent.point, pair, patience));
    let best = fitted.min_by(|a, b| a.descent.cost.total_cmp(&b.descent.cost))?;
    Some(narrowed(problem, best, patience))
}

/// The search goes on from where it ended if the cost fell below this share.
const WORTH_ANOTHER_ROUND: f64 = 0.5;

/// Goes on from a guess at everything, Ms and DV included.
pub fn refine(problem: &Problem, point: &Point, stiction: Stiction, patience: Patience) -> Settled {
    narrowed(problem, descended(problem, point, stiction, patience), patience)
}

/// Searches ever finer around the best pair.
fn narrowed(problem: &Problem, best: Settled, patience: Patience) -> Settled {
    let mut best = best;
    for _ in 0..MAX_ROUNDS {
        if best.stiction.velocity_band == 0.0 {
            break;
        }
        let before = best.descent.cost;
        let here = with_stiction(problem, best.stiction);
        let point = best.descent.point.clone();
        let linear = linearise(&here, &point, Window::Whole, &mut best.descent.steps.clone());
        let grid = finer(&best.stiction);
        let costs = answered_costs(&here, &linear, &point, &grid);
        let least = little(problem, patience, before);
        let Some(chosen) = lowest(&costs).filter(|chosen| before - costs[*chosen] > least) else { break };
        best = better(best, descended(problem, &point, grid[chosen], patience));
        if before - best.descent.cost < least {
            break;
        }
    }
    best
}

/// A gain that is not worth another round: one noise variance, or a small share of what the cost has beyond the noise.
fn little(problem: &Problem, patience: Patience, cost: f64) -> f64 {
    let excess = cost - problem.noise_cost();
    problem.noise_rad().powi(2).max(patience.least_share_of_excess * excess)
}

/// The best level for each band, the most promising bands first.
fn promising(problem: &Problem, none: &Settled) -> Vec<Stiction> {
    let gravity_nm = problem.template.pendulum.gravity_torque_nm();
    let here = with_stiction(problem, none.stiction);
    let point = &none.descent.point;
    let linear = linearise(&here, point, Window::Whole, &mut none.descent.steps.clone());
    let grid: Vec<Stiction> = BANDS.into_iter().flat_map(|band| levels(band, gravity_nm)).collect();
    let costs = answered_costs(&here, &linear, point, &grid);
    let of_band = |row: usize| lowest(&costs[row * LEVELS.len()..][..LEVELS.len()]).map(|k| row * LEVELS.len() + k);
    let mut rows: Vec<usize> = (0..BANDS.len()).filter_map(of_band).collect();
    rows.sort_by(|a, b| costs[*a].total_cmp(&costs[*b]));
    rows.truncate(PROMISING);
    rows.into_iter().map(|k| grid[k]).collect()
}

fn levels(band: f64, gravity_nm: f64) -> impl Iterator<Item = Stiction> {
    LEVELS.iter().map(move |level| Stiction { level_nm: level * gravity_nm, velocity_band: band })
}

/// So many bands are descended from.
const PROMISING: usize = 3;

fn better(a: Settled, b: Settled) -> Settled {
    if b.descent.cost < a.descent.cost { b } else { a }
}

/// Descends first with the pair fixed, then with it free.
fn descended(problem: &Problem, point: &Point, stiction: Stiction, patience: Patience) -> Settled {
    let fixed = with_stiction(problem, stiction);
    let descent = descend(&fixed, point, Window::Whole, Patience::ROUGH, Steps::new(&fixed));
    freed(problem, &descent.point, stiction, patience)
}

/// Descends with the pair free, then with the one found.
pub fn freed(problem: &Problem, point: &Point, stiction: Stiction, patience: Patience) -> Settled {
    let mut all = with_stiction(problem, stiction);
    all.unknowns.extend(stiction_unknowns(&all.template));
    let mut together = point.clone();
    together.values.extend([stiction.level_nm, stiction.velocity_band]);
    let mut point = descend(&all, &together, Window::Whole, patience, Steps::new(&all)).point;
    let pair = point.values.split_off(problem.unknowns.len());
    let stiction = Stiction { level_nm: pair[0], velocity_band: pair[1] };
    let fixed = with_stiction(problem, stiction);
    let descent = descend(&fixed, &point, Window::Whole, patience, Steps::new(&fixed));
    Settled { stiction, level_range_nm: (stiction.level_nm, stiction.level_nm), descent }
}

/// The best pair by first-order answers alone, without any descent: for response surfaces.
pub fn best_pair(problem: &Problem, point: &Point, around: Option<Stiction>) -> Stiction {
    let gravity = problem.template.pendulum.gravity_torque_nm();
    let free = with_stiction(problem, Stiction { level_nm: 0.0, velocity_band: 0.0 });
    let stops = stop_level::ranges(&free, point);
    let without = stops.iter().map(|(low, high)| Stiction { level_nm: 0.5 * (low + high), velocity_band: 0.0 });
    let mut tried: Vec<Stiction> = without.chain(BANDS.into_iter().flat_map(|band| levels(band, gravity))).collect();
    tried.extend(around);
    let here = with_stiction(problem, around.unwrap_or(Stiction { level_nm: 0.0, velocity_band: 0.0 }));
    let mut best = tried[0];
    for _ in 0..MAX_ROUNDS {
        let whole = linearise(&here, point, Window::Whole, &mut Steps::new(&here));
        let costs = answered_costs(&here, &whole, point, &tried);
        if let Some(chosen) = lowest(&costs) {
            best = tried[chosen];
        }
        if best.velocity_band == 0.0 {
            break;
        }
        tried = finer(&best);
    }
    best
}

/// A grid of pairs around one; finer along Ms, because the valley is narrow there.
fn finer(centre: &Stiction) -> Vec<Stiction> {
    let levels = [0.6, 0.7, 0.8, 0.88, 0.95, 1.0, 1.05, 1.12, 1.25, 1.4, 1.6];
    let bands = [0.6, 0.8, 0.95, 1.0, 1.05, 1.25, 1.6];
    let pair = |level: f64, band: f64| Stiction {
        level_nm: level * centre.level_nm,
        velocity_band: band * centre.velocity_band,
    };
    levels.iter().flat_map(|level| bands.iter().map(move |band| pair(*level, *band))).collect()
}

/// The unknowns without Ms and DV, which are searched here.
pub fn smooth_unknowns(unknowns: &[Unknown]) -> Vec<Unknown> {
    let smooth = |unknown: &&Unknown| !matches!(unknown.quantity, Quantity::Effect { id: base::STICTION, .. });
    unknowns.iter().filter(smooth).cloned().collect()
}
