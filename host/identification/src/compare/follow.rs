//! The model let run beside a swing: only the swing's own start is fitted, the parameters stay as they are.
//!
//! A model whose numbers were fitted to the swing starts where all its samples say: that is how it was fitted. A model
//! with the numbers of another pendulum starts where its first samples say, if it would begin elsewhere because that
//! lowers its error later.

use super::rms;
use crate::fit::descent::{Tolerance, descend};
use crate::fit::linear::Steps;
use crate::fit::problem::{Point, Problem, Start};
use crate::fit::start;
use crate::fit::tally::Tally;
use crate::pace;
use crate::swing::{Swing, Window};
use shared::parameters::Parameters;

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

/// The same from a start that is known, without growing windows.
pub fn follow_from(swing: &Swing, parameters: &Parameters<f64>, start: Start) -> Followed {
    let count = Tally::default();
    let problem = starts_only(std::slice::from_ref(swing), parameters, &count);
    let known = Point { values: Vec::new(), starts: vec![start] };
    run(&problem, descended(&problem, &known, Window::Whole).starts[0])
}

/// Where all samples let it begin, unless it would begin elsewhere than the recording does to lower its error later: then where the
/// first ones say.
pub fn follow_of_another_pendulum(swing: &Swing, parameters: &Parameters<f64>) -> Followed {
    let followed = follow(swing, parameters);
    let beginning = swing.samples_within(beginning_of(parameters)).max(1);
    let is_elsewhere = rms(&followed.residuals_rad[..beginning]) > ELSEWHERE * swing.largest_rad();
    if is_elsewhere { follow_from_the_beginning(swing, parameters, followed.start.offset_rad) } else { followed }
}

/// A run that is off by more than this share of the swing in the first samples begins elsewhere. Of 40 simulated recordings that
/// were held out of a fit one is begun anew by it, three by half of it, none by twice of it.
const ELSEWHERE: f64 = 0.02;

/// The first samples: so much of the period of small swings.
const BEGINNING_PERIODS: f64 = 0.25;

fn beginning_of(parameters: &Parameters<f64>) -> Window {
    Window::First(BEGINNING_PERIODS * pace::small_period_s(&parameters.pendulum))
}

/// Takes angle and velocity of the start from the first samples alone, about this zero of the sensor.
fn follow_from_the_beginning(swing: &Swing, parameters: &Parameters<f64>, offset_rad: f64) -> Followed {
    let count = Tally::default();
    let swings = std::slice::from_ref(swing);
    let problem = Problem { offsets_are_free: false, ..starts_only(swings, parameters, &count) };
    let measured = start::starts(swings)[0];
    let first = Start { angle_rad: measured.angle_rad - offset_rad, offset_rad, ..measured };
    let first = Point { values: Vec::new(), starts: vec![first] };
    run(&problem, descended(&problem, &first, beginning_of(parameters)).starts[0])
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{rig, simulated};

    #[test]
    fn numbers_that_are_off_begin_where_the_recording_does() {
        let swing = simulated("plain", &rig(), 20.0, 1);
        let begins_rad = |inertia_share: f64| {
            let mut other = rig();
            other.pendulum.inertia_kg_m2 *= inertia_share;
            let first_rad = |followed: &Followed| (followed.angles_rad[0] - swing.angles_rad[0]).abs();
            [follow(&swing, &other), follow_of_another_pendulum(&swing, &other)].map(|run| first_rad(&run))
        };
        // A little off, all samples and the first ones agree about the beginning, and all know it better …
        let [of_all, taken] = begins_rad(1.0005);
        assert!(of_all < 0.01 && taken == of_all, "{of_all} {taken}");
        // … far off, all samples would rather have another swing.
        let [of_all, taken] = begins_rad(1.3);
        assert!(of_all > 0.1 && taken < 0.03, "{of_all} {taken}");
    }
}
