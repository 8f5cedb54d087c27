//! Growing windows: each descent starts where a shorter one ended, so that the model never slips a cycle against the
//! measurement.

use super::descent::{Descent, Tolerance, descend};
use super::linear::Steps;
use super::problem::{Point, Problem};
use crate::swing::Window;

/// The first windows, s; then follows all of the lively motion.
pub const WINDOWS_S: [f64; 6] = [1.2, 2.5, 5.0, 10.0, 20.0, 40.0];

/// After the lively motion, these shares of the last swings: near rest, the angle depends on Ms and DV ever more
/// strongly, and in jumps from the wrong ones.
pub const CALMING: [f64; 4] = [0.5, 0.75, 0.9, 0.97];

/// Descends through all windows up to the last swings before rest, which [`super::stiction`] decides; on decimated swings.
pub fn grow(problem: &Problem, from: &Point) -> Descent {
    let decimated = problem.decimated();
    let problem = &problem.on(&decimated);
    let longest_s = problem.longest_s();
    let mut steps = Steps::new(problem);
    let mut point = from.clone();
    for seconds in WINDOWS_S.into_iter().filter(|seconds| *seconds < 0.8 * longest_s) {
        let descent = descend(problem, &point, Window::First(seconds), Tolerance::ROUGH, steps);
        (point, steps) = (descent.point, descent.steps);
    }
    descend(problem, &point, Window::Lively, Tolerance::ROUGH, steps)
}
