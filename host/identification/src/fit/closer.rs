//! Starts between those of the list, for laws that repeat or act at one place along the way: notches and magnets.
//!
//! A fit finds such a law only from where it still keeps step with the truth, and the wider the swings are the sooner it is
//! lost: of 24 notches a turn, 20 are out of step after a quarter of a radian. The few starts of the list are those that a
//! board has room for. Here they lie as closely as the swings are wide, and what one linearised step promises from each
//! chooses among them.

use super::problem::Problem;
use shared::effect::{Effect, MAX_VALUES, Pattern};
use std::f64::consts::PI;

/// From one start to the next a pattern that repeats gains so many rad at the end of the widest swing: the nearest start is
/// half of that off at most, and keeps two thirds of what the right one promises.
const PERIODS_APART_RAD: f64 = 2.0;

/// Places lie so many half widths apart: the nearest start of a bell curve of the right width then covers three quarters of it.
const PLACES_APART: f64 = 1.5;

/// They are fitted where one promises so many times what the best of the list does. With 1, a small magnet near the middle began
/// at a start that promised a little more than that of the list, and ended at 1.7 noises. Half and twice were not tried.
pub(super) const WORTH_IT: f64 = 1.5;

/// Beside so many effects no start is sought.
pub(super) const MOST_BESIDE: usize = 2;

/// Starts one beside the other, in order.
pub(super) type Row = Vec<[f64; MAX_VALUES]>;

/// Starts of an effect as closely as the swings are wide: of one that repeats a row, of one at a place a row for each of its
/// half widths; none of all others.
pub(super) fn rows(effect: &Effect<f64>, on: &Problem) -> Vec<Row> {
    let reach_rad = reach_rad(on);
    match effect.rules.pattern {
        Some(Pattern::Periods(at)) => vec![periods(effect, usize::from(at), reach_rad)],
        Some(Pattern::Place(at, width)) => places(effect, [at, width].map(usize::from), reach_rad),
        None => Vec::new(),
    }
}

/// How far the widest swing goes, rad; no more than half a turn, beyond which all repeats.
pub(crate) fn reach_rad(on: &Problem) -> f64 {
    on.largest_rad().min(PI)
}

/// From the fewest periods that the list begins with to as many as there may be.
fn periods(effect: &Effect<f64>, at: usize, reach_rad: f64) -> Row {
    let fewest = effect.starts.iter().map(|start| start[at]).fold(f64::INFINITY, f64::min);
    spread(&effect.starts[0], at, fewest, effect.parameters[at].high, PERIODS_APART_RAD / reach_rad)
}

/// All along the way, for each half width that fits into it.
fn places(effect: &Effect<f64>, [at, width]: [usize; 2], reach_rad: f64) -> Vec<Row> {
    let mut widths: Vec<f64> = effect.starts.iter().map(|start| start[width]).collect();
    widths.sort_by(f64::total_cmp);
    widths.dedup();
    let row = |half: f64| {
        let mut start = effect.starts[0];
        start[width] = half;
        spread(&start, at, -reach_rad, reach_rad, PLACES_APART * half)
    };
    widths.into_iter().filter(|half| *half < reach_rad).map(row).collect()
}

/// Starts that differ in one number, from a lowest to a highest one, evenly.
fn spread(like: &[f64; MAX_VALUES], at: usize, low: f64, high: f64, step: f64) -> Row {
    let n = ((high - low) / step).ceil().max(1.0);
    let value = |k: usize| low + (high - low) * k as f64 / n;
    let start = |k: usize| {
        let mut start = *like;
        start[at] = value(k);
        start
    };
    if n.is_finite() { (0..=n as usize).map(start).collect() } else { Row::new() }
}

/// Which of a row promise more than both of their neighbours, and more than this.
pub(super) fn peaks(promised: &[f64], least: f64) -> impl Iterator<Item = usize> {
    let beside = |j: Option<usize>| j.and_then(|j| promised.get(j)).copied().unwrap_or(0.0);
    let is_peak = move |i: &usize| {
        promised[*i] > least && promised[*i] >= beside(i.checked_sub(1)) && promised[*i] > beside(Some(i + 1))
    };
    (0..promised.len()).filter(is_peak)
}

#[cfg(test)]
mod tests {
    use crate::diagnose::tests::{effect, fitted, rig};
    use crate::fit::added::begun;
    use crate::fit::identify::problem_of;
    use crate::fit::own_swing::swing;
    use crate::fit::tally::Tally;

    /// How many noises an effect leaves that is added.
    fn noises_left(name: &str, more: impl Fn(f64, f64) -> f64) -> f64 {
        let (swings, count) = ([swing(1.3, more)], Tally::default());
        let problem = problem_of(&swings, &rig(), &count);
        let best = begun(&problem, &fitted(&problem, &rig()), effect(name)).unwrap();
        problem.rmse_rad(best.cost) / problem.noise_rad()
    }

    #[test]
    fn notches_are_found_however_many_there_are() {
        for n in [24.0, 42.0] {
            let left = noises_left("detent", |angle, _| 6e-4 * (n * angle + 0.7).sin());
            assert!(left < 1.05, "{n} notches leave {left} noises");
        }
    }

    #[test]
    fn a_magnet_is_found_wherever_it_stands() {
        for (at, half) in [(0.47, 0.1), (-0.95, 0.09)] {
            let brake = |angle: f64, velocity: f64| -2e-3 * velocity * (-((angle - at) / half).powi(2)).exp();
            let left = noises_left("eddy-brake", brake);
            assert!(left < 1.05, "a magnet at {at} leaves {left} noises");
        }
    }
}
