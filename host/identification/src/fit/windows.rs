//! Growing windows: each descent starts where a shorter one ended, so that the model never slips a cycle against the
//! measurement.

use super::descent::{Descent, Tolerance, descend};
use super::linear::Steps;
use super::problem::{Point, Problem};
use crate::swing::{Swing, Window, pace};

/// The first windows of the usual pace, s; then each is about twice the one before, up to all of the lively motion.
pub(super) const WINDOWS_S: [f64; 6] = [1.2, 2.5, 5.0, 10.0, 20.0, 40.0];

/// The first windows of these swings, s.
pub fn windows_s(swings: &[Swing]) -> impl Iterator<Item = f64> {
    let longest_s = swings.iter().map(Swing::duration_s).fold(0.0, f64::max);
    let pace = pace(swings);
    let longer = std::iter::successors(WINDOWS_S.last().map(|last| 2.0 * last), |seconds| Some(2.0 * seconds));
    let windows = WINDOWS_S.into_iter().chain(longer).map(move |seconds| pace * seconds);
    windows.take_while(move |seconds| *seconds < 0.8 * longest_s)
}

/// After the lively motion, these shares of the last swings: near rest, the angle depends on Ms and DV ever more
/// strongly, and in jumps from the wrong ones.
pub const CALMING: [f64; 4] = [0.5, 0.75, 0.9, 0.97];

/// Descends through all windows up to the last swings before rest, which [`super::stiction`] decides; on decimated swings.
pub fn grow(problem: &Problem, from: &Point) -> Descent {
    let decimated = problem.decimated();
    let problem = &problem.on(&decimated);
    let mut steps = Steps::new(problem);
    let mut point = from.clone();
    for seconds in windows_s(problem.swings) {
        let descent = descend(problem, &point, Window::First(seconds), Tolerance::ROUGH, steps);
        (point, steps) = (descent.point, descent.steps);
    }
    descend(problem, &point, Window::Lively, Tolerance::ROUGH, steps)
}
