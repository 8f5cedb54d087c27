//! The model let run beside a swing: only the swing's own start is fitted, the parameters stay as they are.
//!
//! A model whose numbers were fitted to the swing starts where all its samples say: that is how it was fitted. A model
//! with the numbers of another pendulum starts where its first samples say, or it would begin elsewhere because that
//! lowers its error later.

use crate::fit::descent::{Tolerance, descend};
use crate::fit::linear::Steps;
use crate::fit::problem::{Point, Problem, Start};
use crate::fit::start;
use crate::fit::tally::Tally;
use crate::swing::{Swing, Window};
use shared::parameters::Parameters;
use std::f64::consts::TAU;

/// The window grows in these steps of the usual pace, s. With the parameters fixed only a start can be wrong, so few
/// steps suffice.
const WINDOWS_S: [f64; 3] = [1.5, 6.0, 20.0];

/// A free swing that lasts longer has a wrong clock; its start is not worth the time, s.
const LONGEST_S: f64 = 7200.0;

/// A start is known far better than its effect on the residual.
const TOLERANCE: Tolerance = Tolerance { max_iterations: 10, least_gain: 0.1, ..Tolerance::FINE };

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
pub fn starts_only<'a>(swings: &'a [Swing], parameters: &Parameters<f64>, count: &'a Tally) -> Problem<'a> {
    Problem::new(swings, parameters, Vec::new(), count)
}

/// Fits the start of one swing, with the window growing, and lets the model run to its end.
pub fn follow(swing: &Swing, parameters: &Parameters<f64>) -> Followed {
    let count = Tally::default();
    let swings = std::slice::from_ref(swing);
    let problem = starts_only(swings, parameters, &count);
    let first = Point { values: Vec::new(), starts: start::starts(swings) };
    if swing.duration_s() > LONGEST_S {
        return run(&problem, first.starts[0]);
    }
    let windows = WINDOWS_S
        .into_iter()
        .map(|seconds| seconds * swing.pace)
        .filter(|seconds| *seconds < 0.8 * swing.duration_s())
        .map(Window::First);
    let point = windows.fold(first, |point, window| descended(&problem, &point, window));
    run(&problem, descended(&problem, &point, Window::Whole).starts[0])
}

/// The first samples: so much of the period of small swings.
const BEGINNING_PERIODS: f64 = 0.25;

/// Takes angle and velocity of the start from the first samples alone, the sensor's zero from all.
pub fn follow_from_the_beginning(swing: &Swing, parameters: &Parameters<f64>) -> Followed {
    let count = Tally::default();
    let swings = std::slice::from_ref(swing);
    let problem = Problem { offsets_are_free: false, ..starts_only(swings, parameters, &count) };
    let offset_rad = follow(swing, parameters).start.offset_rad;
    let measured = start::starts(swings)[0];
    let first = Start { angle_rad: measured.angle_rad - offset_rad, offset_rad, ..measured };
    let pendulum = &parameters.pendulum;
    let frequency_rad_s = (pendulum.gravity_torque_nm() / pendulum.pivot_inertia_kg_m2()).sqrt();
    let beginning = Window::First(BEGINNING_PERIODS * TAU / frequency_rad_s);
    run(&problem, descended(&problem, &Point { values: Vec::new(), starts: vec![first] }, beginning).starts[0])
}

fn descended(problem: &Problem, from: &Point, window: Window) -> Point {
    descend(problem, from, window, TOLERANCE, Steps::new(problem)).point
}

/// Lets the model of a problem run from a start along its first swing.
pub fn run(problem: &Problem, start: Start) -> Followed {
    let swing = &problem.swings[0];
    let mut angles_rad = problem.predict(0, swing.len(), &[(&[], start)]).remove(0);
    angles_rad.iter_mut().for_each(|angle| *angle += start.offset_rad);
    let residuals_rad = swing.angles_rad.iter().zip(&angles_rad).map(|(m, p)| m - p).collect();
    Followed { start, angles_rad, residuals_rad }
}
