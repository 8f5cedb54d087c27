//! The model let run beside a swing: only the swing's own start is fitted, the parameters stay as they are.

use crate::fit::descent::{Patience, descend};
use crate::fit::linear::Steps;
use crate::fit::problem::{Point, Problem, Start};
use crate::fit::start;
use crate::swing::{Swing, Window};
use shared::parameters::Parameters;
use std::sync::atomic::AtomicUsize;

/// The window grows in these steps, s. With the parameters fixed only a start can be wrong, so few steps suffice.
const WINDOWS_S: [f64; 3] = [1.5, 6.0, 20.0];

/// A free swing that lasts longer has a wrong clock; its start is not worth the time, s.
const LONGEST_S: f64 = 7200.0;

/// A start is known far better than its effect on the residual.
const PATIENCE: Patience = Patience { max_iterations: 10, least_gain: 0.1, ..Patience::FINE };

/// A free run of the model beside a swing.
#[derive(Clone, Debug)]
pub struct Followed {
    /// How it began, and the sensor's zero.
    pub start: Start,
    /// Model's readings at the swing's times, offset included, rad.
    pub angles_rad: Vec<f64>,
    /// Measured minus modelled, rad.
    pub residuals_rad: Vec<f64>,
}

/// A problem in which nothing but starts is unknown.
pub fn starts_only<'a>(swings: &'a [Swing], parameters: &Parameters<f64>, count: &'a AtomicUsize) -> Problem<'a> {
    Problem { swings, template: parameters.clone(), unknowns: Vec::new(), offsets_are_free: true, n_simulations: count }
}

/// Fits the start of one swing, with the window growing, and lets the model run to its end.
pub fn follow(swing: &Swing, parameters: &Parameters<f64>) -> Followed {
    let count = AtomicUsize::new(0);
    let swings = std::slice::from_ref(swing);
    let problem = starts_only(swings, parameters, &count);
    let first = Point { values: Vec::new(), starts: start::starts(swings) };
    if swing.duration_s() > LONGEST_S {
        return run(&problem, first.starts[0]);
    }
    let windows = WINDOWS_S.into_iter().filter(|seconds| *seconds < 0.8 * swing.duration_s()).map(Window::First);
    let point = windows.fold(first, |point, window| descended(&problem, &point, window));
    run(&problem, descended(&problem, &point, Window::Whole).starts[0])
}

fn descended(problem: &Problem, from: &Point, window: Window) -> Point {
    descend(problem, from, window, PATIENCE, Steps::new(problem)).point
}

/// Lets the model of a problem run from a start along its first swing.
pub fn run(problem: &Problem, start: Start) -> Followed {
    let swing = &problem.swings[0];
    let mut angles_rad = problem.predict(0, swing.len(), &[(&[], start)]).remove(0);
    angles_rad.iter_mut().for_each(|angle| *angle += start.offset_rad);
    let residuals_rad = swing.angles_rad.iter().zip(&angles_rad).map(|(m, p)| m - p).collect();
    Followed { start, angles_rad, residuals_rad }
}
