//! Ms alone: with DV = 0 the error depends on it only through the turning points at which the pendulum stays, so that
//! only the torques between two of them need be tried.

use super::descent::{Descent, Patience, descend};
use super::linear::{Linear, Steps, linearise};
use super::problem::{Point, Problem};
use super::stiction::{MAX_ROUNDS, Settled, Stiction, answered_costs, with_stiction};
use crate::swing::Window;
use rayon::prelude::*;
use shared::parameters::base;

/// At most this many turning points before the stop are considered.
const MAX_STOPS: usize = 10;

/// First-order answers can't tell neighbouring levels apart: so many are tried in earnest beside the best.
const NEIGHBOURS: usize = 2;

/// Levels whose costs on sketches are closer than this, in noise variances, are decided on all samples.
const DOUBT: f64 = 40.0;

/// A range of Ms, N·m: all levels within it stop the pendulum alike.
type Range = (f64, f64);

/// A level, N·m, and the range it stands for.
#[derive(Clone, Copy, Debug)]
struct Level {
    level_nm: f64,
    range: Range,
}

impl Level {
    fn in_the_middle(range: Range) -> Self {
        Self { level_nm: 0.5 * (range.0 + range.1), range }
    }
}

/// The level that a model has, so that the search never ends with a worse one; without any, the lowest range.
fn own_level(own_nm: f64, ranges: &[Range]) -> Level {
    let lowest = ranges.iter().copied().min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((own_nm, own_nm));
    if own_nm == 0.0 {
        return Level::in_the_middle(lowest);
    }
    let range = ranges.iter().copied().find(|range| holds(range, own_nm));
    Level { level_nm: own_nm, range: range.unwrap_or(if own_nm < lowest.0 { lowest } else { (own_nm, own_nm) }) }
}

/// Searches Ms, DV = 0: first on sketches, then on all samples.
pub fn without_band(problem: &Problem, from: &Point, patience: Patience) -> Settled {
    let sketches = problem.sketches();
    best_of(&levels(&problem.on(&sketches), from), problem, patience)
}

/// The best of some levels on all samples. There must be one.
pub fn best_of(levels: &[Settled], problem: &Problem, patience: Patience) -> Settled {
    let on_all = |near: &Settled| descended(problem, near, patience);
    let first = on_all(&levels[0]);
    let better = |a: Settled, b: Settled| if b.descent.cost < a.descent.cost { b } else { a };
    levels[1..].iter().map(on_all).fold(first, better)
}

fn descended(problem: &Problem, near: &Settled, patience: Patience) -> Settled {
    let Settled { stiction, level_range_nm, descent } = near.clone();
    let fixed = with_stiction(problem, stiction);
    let descent = descend(&fixed, &descent.point, Window::Whole, patience, descent.steps);
    Settled { stiction, level_range_nm, descent }
}

/// The best level for sketches, and the next best if that may be better on all samples. The problem's own level is one
/// of those that are tried.
pub fn levels(rough: &Problem, from: &Point) -> Vec<Settled> {
    let own_nm = rough.template.values(base::STICTION).map_or(0.0, |values| values[0]);
    let free = with_stiction(rough, Stiction { level_nm: 0.0, velocity_band: 0.0 });
    let mut steps = Steps::new(&free);
    let linear = linearise(&free, from, Window::Whole, &mut steps);
    let ranges = promising(&free, from, &linear);
    let own = own_level(own_nm, &ranges);
    let first = ranges.first().copied().filter(|first| *first != own.range).map(Level::in_the_middle);
    let tried = [Some(own), first].into_iter().flatten().collect();
    let mut tried = in_earnest(rough, from, tried, &steps);
    for _ in 1..MAX_ROUNDS {
        tried[0] = descended(rough, &tried[0], Patience::JUDGE);
        let Descent { point, linear, steps, cost, .. } = &tried[0].descent;
        let lowest = *cost;
        let fresh = |range: &Range| tried.iter().all(|settled| !holds(range, settled.stiction.level_nm));
        let next = promising(&free, point, linear).into_iter().filter(fresh).take(NEIGHBOURS);
        tried.extend(in_earnest(rough, point, next.map(Level::in_the_middle).collect(), steps));
        tried.sort_by(|a, b| a.descent.cost.total_cmp(&b.descent.cost));
        if tried[0].descent.cost >= lowest {
            break;
        }
    }
    let doubt = tried[0].descent.cost + DOUBT * rough.noise_rad().powi(2);
    tried.truncate(if tried.len() > 1 && tried[1].descent.cost < doubt { 2 } else { 1 });
    tried
}

/// Descends with each of some levels; the lowest cost first.
fn in_earnest(rough: &Problem, from: &Point, levels: Vec<Level>, steps: &Steps) -> Vec<Settled> {
    let mut settled: Vec<Settled> = levels.into_par_iter().map(|level| at_level(rough, from, level, steps)).collect();
    settled.sort_by(|a, b| a.descent.cost.total_cmp(&b.descent.cost));
    settled
}

fn at_level(problem: &Problem, point: &Point, level: Level, steps: &Steps) -> Settled {
    let stiction = Stiction { level_nm: level.level_nm, velocity_band: 0.0 };
    let fixed = with_stiction(problem, stiction);
    let descent = descend(&fixed, point, Window::Whole, Patience::ROUGH, steps.clone());
    Settled { stiction, level_range_nm: level.range, descent }
}

fn holds(range: &Range, level_nm: f64) -> bool {
    (range.0..=range.1).contains(&level_nm)
}

/// Ranges of Ms, the one that suits a guess best first, judged by first-order answers; DV = 0.
fn promising(free: &Problem, point: &Point, linear: &Linear) -> Vec<Range> {
    let ranges = ranges(free, point);
    let middle = |(low, high): &Range| Stiction { level_nm: 0.5 * (low + high), velocity_band: 0.0 };
    let tried: Vec<Stiction> = ranges.iter().map(middle).collect();
    let costs = answered_costs(free, linear, point, &tried);
    let mut order: Vec<usize> = (0..ranges.len()).filter(|i| costs[*i].is_finite()).collect();
    order.sort_by(|a, b| costs[*a].total_cmp(&costs[*b]));
    order.into_iter().map(|i| ranges[i]).collect()
}

/// Ranges of Ms, each of which stops the pendulum at another turning point; DV = 0.
pub(super) fn ranges(problem: &Problem, point: &Point) -> Vec<Range> {
    let parameters = problem.parameters(&point.values);
    let coulomb = parameters.values(base::COULOMB).map_or(0.0, |values| values[0]);
    let gravity = parameters.pendulum.gravity_torque_nm();
    let torques_of = |swing_idx: usize| {
        let guess = (point.values.as_slice(), point.starts[swing_idx]);
        let column = &problem.predict(swing_idx, problem.swings[swing_idx].len(), &[guess])[0];
        last_turning_torques(column, gravity)
    };
    let mut torques: Vec<f64> = (0..problem.swings.len()).into_par_iter().flat_map(torques_of).collect();
    torques.retain(|torque| *torque > coulomb);
    torques.sort_by(f64::total_cmp);
    torques.dedup_by(|later, earlier| *later - *earlier < 1e-3 * *earlier);
    torques.truncate(MAX_STOPS);
    torques.insert(0, 0.0_f64.max(coulomb));
    torques.windows(2).map(|pair| (pair[0], pair[1])).collect()
}

/// |m·g·l·sin θ| at the last turning points of a simulated swing.
fn last_turning_torques(angles_rad: &[f64], gravity_nm: f64) -> Vec<f64> {
    let turns = |triple: &[f64]| (triple[1] - triple[0]) * (triple[2] - triple[1]) < 0.0;
    // A sensor with backlash stays where it is for a while.
    let mut moving = angles_rad.to_vec();
    moving.dedup();
    let turning = moving.windows(3).filter(|triple| turns(triple)).map(|triple| triple[1]);
    let all: Vec<f64> = turning.chain(angles_rad.last().copied()).collect();
    all.iter().rev().take(MAX_STOPS).map(|angle| (gravity_nm * angle.sin()).abs()).collect()
}
