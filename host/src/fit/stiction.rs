//! Ms and DV: the two parameters in which the error is not smooth.
//!
//! Where the pendulum stops depends on them in jumps, so they are searched on a grid. Each pair is judged after the
//! smooth parameters have answered to it to first order (a frozen linearisation); the best few are then descended
//! from in earnest. With DV = 0 the error depends on Ms only through the turning point at which the pendulum stays,
//! so that only the torques between two turning points need be tried.

use super::descent::{Descent, Patience, descend};
use super::linear::{Linear, Steps, dot, linearise, solve_damped};
use super::problem::{PER_SWING, Point, Problem, Quantity, Start, Unknown};
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
const LEVELS: [f64; 8] = [0.002, 0.004, 0.008, 0.013, 0.02, 0.03, 0.045, 0.07];

/// At most this many turning points before the stop are considered.
const MAX_STOPS: usize = 10;

/// A band is only sought when the error without one exceeds the noise by this share of the variance.
const EXCESS_WORTH_A_BAND: f64 = 0.005;

/// A band is only kept when it lowers the cost by this many noise variances more than none.
pub const GAIN_WORTH_A_BAND: f64 = 12.0;

/// Rounds of search and descent.
const MAX_ROUNDS: usize = 3;

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

/// Searches Ms and DV, starting from a guess at everything else. `problem` must not have them among its unknowns.
pub fn settle(problem: &Problem, from: &Descent, patience: Patience) -> Settled {
    let none = without_band(problem, from, patience);
    let variance = problem.noise_rad().powi(2);
    let n_samples = problem.n_samples(Window::Whole) as f64;
    if none.descent.cost < (1.0 + EXCESS_WORTH_A_BAND) * variance * n_samples {
        return none;
    }
    let band = with_band(problem, &none, patience);
    if band.descent.cost < none.descent.cost - GAIN_WORTH_A_BAND * variance { band } else { none }
}

/// The problem with other fixed Ms and DV.
pub fn with_stiction<'a>(problem: &Problem<'a>, stiction: Stiction) -> Problem<'a> {
    let mut changed = problem.clone();
    // The base effects always have their place in the list.
    let _ = changed.template.set(base::STICTION, &[stiction.level_nm, stiction.velocity_band]);
    changed
}

/// Searches Ms alone, DV = 0.
pub fn without_band(problem: &Problem, from: &Descent, patience: Patience) -> Settled {
    let mut point = from.point.clone();
    let mut steps = from.steps.clone();
    let mut best: Option<Settled> = None;
    for _ in 0..MAX_ROUNDS {
        let free = with_stiction(problem, Stiction { level_nm: 0.0, velocity_band: 0.0 });
        let ranges = stop_ranges(&free, &point);
        let linear = linearise(&free, &point, Window::Whole, &mut steps);
        let tried: Vec<Stiction> =
            ranges.iter().map(|(low, high)| Stiction { level_nm: 0.5 * (low + high), velocity_band: 0.0 }).collect();
        let costs = answered_costs(&free, &linear, &point, &tried);
        let Some(chosen) = lowest(&costs) else { break };
        let chosen_problem = with_stiction(problem, tried[chosen]);
        let descent = descend(&chosen_problem, &point, Window::Whole, patience, steps.clone());
        let settled = Settled { stiction: tried[chosen], level_range_nm: ranges[chosen], descent };
        let gain = best.as_ref().map_or(f64::INFINITY, |before| before.descent.cost - settled.descent.cost);
        let point_cost = settled.descent.cost;
        point = settled.descent.point.clone();
        if gain > 0.0 {
            best = Some(settled);
        }
        if gain < little(problem, patience, point_cost) {
            break;
        }
    }
    best.unwrap_or_else(|| {
        let stiction = Stiction { level_nm: 0.0, velocity_band: 0.0 };
        let descent = descend(&with_stiction(problem, stiction), &point, Window::Whole, patience, steps);
        Settled { stiction, level_range_nm: (0.0, 0.0), descent }
    })
}

/// Ranges of Ms, each of which stops the pendulum at another turning point; DV = 0.
fn stop_ranges(problem: &Problem, point: &Point) -> Vec<(f64, f64)> {
    let parameters = problem.parameters(&point.values);
    let coulomb = parameters.values(base::COULOMB).map_or(0.0, |values| values[0]);
    let gravity = parameters.pendulum.gravity_torque_nm();
    let mut torques: Vec<f64> = (0..problem.swings.len())
        .flat_map(|swing_idx| {
            let column = &problem.predict(
                swing_idx,
                problem.swings[swing_idx].len(),
                &[(&point.values, point.starts[swing_idx])],
            )[0];
            last_turning_torques(column, gravity)
        })
        .filter(|torque| *torque > coulomb)
        .collect();
    torques.sort_by(f64::total_cmp);
    torques.dedup_by(|later, earlier| *later - *earlier < 1e-3 * *earlier);
    torques.truncate(MAX_STOPS);
    torques.insert(0, 0.0_f64.max(coulomb));
    torques.windows(2).map(|pair| (pair[0], pair[1])).collect()
}

/// |m·g·l·sin θ| at the last turning points of a simulated swing.
fn last_turning_torques(angles_rad: &[f64], gravity_nm: f64) -> Vec<f64> {
    let turns = |triple: &[f64]| (triple[1] - triple[0]) * (triple[2] - triple[1]) < 0.0;
    let turning = angles_rad.windows(3).filter(|triple| turns(triple)).map(|triple| triple[1]);
    let all: Vec<f64> = turning.chain(angles_rad.last().copied()).collect();
    all.iter().rev().take(MAX_STOPS).map(|angle| (gravity_nm * angle.sin()).abs()).collect()
}

/// Costs of pairs after the smooth parameters have answered to first order.
fn answered_costs(problem: &Problem, linear: &Linear, point: &Point, tried: &[Stiction]) -> Vec<f64> {
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

/// Searches Ms and a velocity band; `none` is the outcome without one.
pub fn with_band(problem: &Problem, none: &Settled, patience: Patience) -> Settled {
    let gravity = problem.template.pendulum.gravity_torque_nm();
    let mut best = none.clone();
    for tried in promising(problem, none, gravity) {
        best = better(best, descended(problem, &none.descent.point, tried, patience));
    }
    narrowed(problem, best, patience)
}

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
    let variance = problem.noise_rad().powi(2);
    let excess = cost - variance * problem.n_samples(Window::Whole) as f64;
    variance.max(patience.least_share_of_excess * excess)
}

/// The best level for each band, the most promising bands first.
fn promising(problem: &Problem, none: &Settled, gravity_nm: f64) -> Vec<Stiction> {
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

fn descended(problem: &Problem, point: &Point, stiction: Stiction, patience: Patience) -> Settled {
    let (descent, stiction) = descend_with_stiction(problem, point, stiction, patience);
    Settled { stiction, level_range_nm: (stiction.level_nm, stiction.level_nm), descent }
}

/// The best pair by first-order answers alone, without any descent: for response surfaces.
pub fn best_pair(problem: &Problem, point: &Point, around: Option<Stiction>) -> Stiction {
    let gravity = problem.template.pendulum.gravity_torque_nm();
    let free = with_stiction(problem, Stiction { level_nm: 0.0, velocity_band: 0.0 });
    let stops = stop_ranges(&free, point);
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

/// A grid of pairs around one.
fn finer(centre: &Stiction) -> Vec<Stiction> {
    let factors = [0.6, 0.8, 0.95, 1.0, 1.05, 1.25, 1.6];
    let pair = |level: f64, band: f64| Stiction {
        level_nm: level * centre.level_nm,
        velocity_band: band * centre.velocity_band,
    };
    factors.iter().flat_map(|level| factors.iter().map(move |band| pair(*level, *band))).collect()
}

/// Descends first with the pair fixed, then with it free, as long as that helps.
fn descend_with_stiction(
    problem: &Problem,
    point: &Point,
    stiction: Stiction,
    patience: Patience,
) -> (Descent, Stiction) {
    let fixed = with_stiction(problem, stiction);
    let first = descend(&fixed, point, Window::Whole, Patience::ROUGH, Steps::new(&fixed));
    let mut all = fixed.clone();
    all.unknowns.extend(stiction_unknowns(&fixed.template));
    let mut values = first.point.values.clone();
    values.extend([stiction.level_nm, stiction.velocity_band]);
    let together = Point { values, starts: first.point.starts.clone() };
    let second = descend(&all, &together, Window::Whole, patience, Steps::new(&all));
    let n_unknowns = problem.unknowns.len();
    let moved =
        Stiction { level_nm: second.point.values[n_unknowns], velocity_band: second.point.values[n_unknowns + 1] };
    let mut point = second.point;
    point.values.truncate(n_unknowns);
    let last = descend(&with_stiction(problem, moved), &point, Window::Whole, patience, first.steps.clone());
    if last.cost <= first.cost { (last, moved) } else { (first, stiction) }
}

/// The unknowns without Ms and DV, which are searched here.
pub fn smooth_unknowns(unknowns: &[Unknown]) -> Vec<Unknown> {
    let smooth = |unknown: &&Unknown| !matches!(unknown.quantity, Quantity::Effect { id: base::STICTION, .. });
    unknowns.iter().filter(smooth).cloned().collect()
}
