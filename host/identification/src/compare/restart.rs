//! The model started anew for every swing, so that errors of one swing do not carry over to the next.
//!
//! A swing goes from one crossing of the hanging position to the next but one. Its start is fitted to it; let run on
//! through the following swing, the model predicts that one: one swing ahead.

use super::follow::starts_only;
use super::slope::slopes;
use crate::cores::on_all_cores;
use crate::fit::descent::{Tolerance, descend};
use crate::fit::linear::Steps;
use crate::fit::problem::{Point, Start};
use crate::fit::tally::Tally;
use crate::recording::Measured;
use crate::recording::median;
use crate::recording::smooth::LocalFit;
use crate::recording::turning;
use crate::swing::{Swing, Window};
use shared::parameters::Parameters;
use std::ops::Range;

/// A stretch of about one swing with the model that was started anew for it.
#[derive(Clone, Debug)]
pub struct Restart {
    /// Samples of the whole swing that it covers.
    pub range: Range<usize>,
    /// Model's angle without the sensor's zero, rad.
    pub angles_rad: Vec<f64>,
    /// Model's velocity, rad/s.
    pub velocities_rad_s: Vec<f64>,
    /// Measured minus modelled, rad.
    pub residuals_rad: Vec<f64>,
    /// Errors on the following swing, which took no part, rad; empty behind the last.
    pub ahead_rad: Vec<f64>,
}

/// How a swing is cut into stretches.
#[derive(Clone, Debug)]
pub struct Cuts {
    /// Where the stretches meet: sample indices.
    pub at: Vec<usize>,
    /// A typical half swing, s.
    pub half_swing_s: f64,
}

/// Fewer samples than this tell nothing beyond a start.
const MIN_SAMPLES: usize = 8;

/// Nothing on a bench swings this slowly; the clock must be wrong, s.
const SLOWEST_S: f64 = 10.0;

/// Start angle and velocity are first read off a cubic of this half width, in half swings: with a parabola swings of 2.9 rad
/// go over the top.
const GUESS_WIDTH: f64 = 0.15;

/// Cuts a swing at every other crossing of its hanging position; `None` when it hardly swings.
pub fn cuts(swing: &Swing, offset_rad: f64) -> Option<Cuts> {
    let (times_s, angles_rad) = (&swing.times_s, &swing.angles_rad);
    let half_swing_s = turning::half_swing_s(times_s, angles_rad, swing.noise_rad).filter(|s| *s < SLOWEST_S)?;
    let crossings = turning::crossings(times_s, angles_rad, offset_rad, swing.noise_rad);
    let index = |time_s: f64| times_s.partition_point(|t| *t < time_s).min(swing.len() - 1);
    let mut at = vec![0];
    at.extend(crossings.iter().skip(1).step_by(2).map(|crossing| index(crossing.time_s)));
    at.dedup_by(|next, before| *next < *before + MIN_SAMPLES);
    (at.len() >= 2).then_some(Cuts { at, half_swing_s })
}

/// The sensor's zero (rad) as single swings see it: fitted to each, then the middle one of all. In a free run with
/// wrong physics the zero bends to hide some of the misfit, which would show up as a constant torque. A torque that is
/// constant in truth cannot be told from a zero that is off.
pub fn zero_of_swings(swing: &Swing, parameters: &Parameters<f64>, first_rad: f64, cuts: &Cuts) -> f64 {
    let one = |ends: &[usize]| {
        let piece = swing.part(ends[0]..ends[1] + 1);
        Some(fitted_start(&piece, parameters, guess(&piece, cuts.half_swing_s, first_rad)?, true).offset_rad)
    };
    // Swings close to rest hang on stiction.
    let lively = swing.samples_within(Window::Lively);
    let stretches = cuts.at.windows(2).filter(|ends| ends[1] < lively);
    let mut zeros: Vec<f64> = on_all_cores(stretches, one).into_iter().flatten().collect();
    if zeros.len() < FEWEST_ZEROS { first_rad } else { median(&mut zeros) }
}

/// With fewer swings the free run's zero is as good.
const FEWEST_ZEROS: usize = 3;

/// The start that follows a piece best; its zero is fitted too or stays.
fn fitted_start(piece: &Swing, parameters: &Parameters<f64>, guess: Start, zero_is_free: bool) -> Start {
    let count = Tally::default();
    let mut problem = starts_only(std::slice::from_ref(piece), parameters, &count);
    problem.offsets_are_free = zero_is_free;
    let first = Point { values: Vec::new(), starts: vec![guess] };
    descend(&problem, &first, Window::Whole, Tolerance::FINE, Steps::new(&problem)).point.starts[0]
}

/// Starts the model anew for every stretch, which reaches `overlap_s` beyond its cuts.
pub fn restarts(
    swing: &Swing,
    parameters: &Parameters<f64>,
    offset_rad: f64,
    cuts: &Cuts,
    overlap_s: f64,
) -> Vec<Restart> {
    let one = |pair: (usize, &[usize])| {
        let (k, ends) = pair;
        let next_end = cuts.at.get(k + 2).copied();
        restart(swing, parameters, offset_rad, cuts, &Stretch { from: ends[0], to: ends[1], next_end, overlap_s })
    };
    on_all_cores(cuts.at.windows(2).enumerate(), one).into_iter().flatten().collect()
}

struct Stretch {
    from: usize,
    to: usize,
    next_end: Option<usize>,
    overlap_s: f64,
}

fn restart(
    swing: &Swing,
    parameters: &Parameters<f64>,
    offset_rad: f64,
    cuts: &Cuts,
    stretch: &Stretch,
) -> Option<Restart> {
    let times_s = &swing.times_s;
    let (begin_s, end_s) = (times_s[stretch.from] - stretch.overlap_s, times_s[stretch.to] + stretch.overlap_s);
    let range = times_s.partition_point(|t| *t < begin_s)..times_s.partition_point(|t| *t <= end_s);
    // The stretch and the one behind it: simulated at once, fitted to the first only.
    let longest = stretch.next_end.unwrap_or(range.end).max(range.end);
    let both = swing.part(range.start..longest);
    let fitted = swing.part(range.clone());
    let start = fitted_start(&fitted, parameters, guess(&fitted, cuts.half_swing_s, offset_rad)?, false);

    let count = Tally::default();
    let problem = starts_only(std::slice::from_ref(&both), parameters, &count);
    let mut angles_rad = problem.predict(0, both.len(), &[(&[], start)]).remove(0);
    let error = |(measured, modelled): (&f64, &f64)| measured - offset_rad - modelled;
    let mut residuals_rad: Vec<f64> = both.angles_rad.iter().zip(&angles_rad).map(error).collect();
    let ahead_rad = residuals_rad.split_off(fitted.len());
    angles_rad.truncate(fitted.len());
    let velocities_rad_s = slopes(&fitted.times_s, &angles_rad);
    Some(Restart { range, angles_rad, velocities_rad_s, residuals_rad, ahead_rad })
}

fn guess(fitted: &Swing, half_swing_s: f64, offset_rad: f64) -> Option<Start> {
    if fitted.measured == Measured::Rate {
        let (angle_rad, rate_rad_s) = fitted.start_guess();
        return Some(Start { angle_rad, velocity_rad_s: rate_rad_s - offset_rad, offset_rad });
    }
    let step_s = fitted.duration_s() / (fitted.len() - 1) as f64;
    let width_s = (GUESS_WIDTH * half_swing_s).max(3.0 * step_s);
    let cubic = LocalFit::<4>::new(&fitted.times_s, &fitted.angles_rad, width_s, width_s)?;
    let velocity_rad_s = (cubic.angle_rad(0.02 * width_s) - cubic.angle_rad(0.0)) / (0.02 * width_s);
    Some(Start { angle_rad: cubic.angle_rad(0.0) - offset_rad, velocity_rad_s, offset_rad })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::tests::{OFFSET_RAD, VISCOUS, rig, swing};
    use shared::effect::Effect;
    use shared::model::Model;
    use std::f64::consts::PI;

    #[test]
    fn a_swing_is_cut_at_every_other_crossing() {
        let times_s: Vec<f64> = (0..1600).map(|i| f64::from(i) / 200.0).collect();
        let turning =
            |half_swing_s: f64| -> Vec<f64> { times_s.iter().map(|t| (PI * t / half_swing_s).cos()).collect() };
        let found = cuts(&Swing::new("sine", &times_s, &turning(0.5), 1e-5), 0.0).unwrap();
        assert!((found.half_swing_s - 0.5).abs() < 0.01, "{found:?}");
        // It crosses zero at 0.25 s, 0.75 s, 1.25 s …: the second, the fourth, and so on are cuts.
        let expected: Vec<usize> = [0].into_iter().chain((0..8).map(|k| 150 + 200 * k)).collect();
        assert_eq!(found.at.len(), expected.len(), "{found:?}");
        assert!(found.at.iter().zip(&expected).all(|(at, expected)| at.abs_diff(*expected) <= 1), "{found:?}");
        let slow: Vec<f64> = times_s.iter().map(|t| 5.0 * t).collect();
        assert!(cuts(&Swing::new("slow", &slow, &turning(0.5), 1e-5), 0.0).is_some());
        let slower: Vec<f64> = times_s.iter().map(|t| 25.0 * t).collect();
        assert!(cuts(&Swing::new("slower", &slower, &turning(0.5), 1e-5), 0.0).is_none());
    }

    #[test]
    fn the_true_model_started_anew_follows_each_swing_and_the_next_about_its_zero() {
        let swing = swing("small", 0.0, 1);
        let cuts = cuts(&swing, OFFSET_RAD).unwrap();
        let found = restarts(&swing, &rig(VISCOUS), OFFSET_RAD, &cuts, 0.05);
        assert_eq!(found.len(), cuts.at.len() - 1);
        // A small swing is a sine to 2e-5 of 0.02 rad, beside its phase.
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        for restart in &found {
            assert!(largest(&restart.residuals_rad) < 2e-6, "{}", largest(&restart.residuals_rad));
            assert!(largest(&restart.ahead_rad) < 4e-6, "{}", largest(&restart.ahead_rad));
        }
        assert!(found[..found.len() - 1].iter().all(|restart| restart.ahead_rad.len() > 150));
    }

    /// Near upright a start that is a little off ends somewhere else: it takes more steps to find.
    #[test]
    fn swings_from_nearly_upright_are_followed_too() {
        let truth = rig(VISCOUS);
        let model = Model::new(&truth);
        let mut state = model.release(2.9, 0.0);
        let times_s: Vec<f64> = (0..2400).map(|i| f64::from(i) / 200.0).collect();
        let mut angles_rad = Vec::new();
        for idx in 0..times_s.len() {
            angles_rad.push(state.angle_rad + 1e-3 * (2.1 * idx as f64).sin());
            (0..5).for_each(|_| model.step(&mut state, 1e-3));
        }
        let swing = Swing::new("upright", &times_s, &angles_rad, 1e-3);
        let found = restarts(&swing, &truth, 0.0, &cuts(&swing, 0.0).unwrap(), 0.05);
        let largest = |errors: &[f64]| errors.iter().fold(0.0_f64, |largest, error| largest.max(error.abs()));
        let ahead: Vec<f64> = found.iter().map(|restart| largest(&restart.ahead_rad)).collect();
        assert!(ahead.iter().all(|ahead| *ahead < 0.02), "{ahead:?}");
    }

    #[test]
    fn friction_that_fades_does_not_begin_anew_with_each_swing() {
        let mut truth = rig(5.0 * VISCOUS);
        let fades = [0.0, -4.0 * VISCOUS / 1.5, 1.5];
        truth.set(Effect::<f64>::by_name("drifting-friction").unwrap().id, &fades).unwrap();
        let model = Model::new(&truth);
        let mut state = model.release(0.3, 0.0);
        let times_s: Vec<f64> = (0..1600).map(|i| f64::from(i) / 200.0).collect();
        let mut angles_rad = Vec::new();
        for _ in &times_s {
            angles_rad.push(state.angle_rad);
            (0..5).for_each(|_| model.step(&mut state, 1e-3));
        }
        let swing = Swing::new("fading", &times_s, &angles_rad, 1e-6);
        let found = restarts(&swing, &truth, 0.0, &cuts(&swing, 0.0).unwrap(), 0.05);
        let largest = |errors: &[f64]| errors.iter().fold(0.0_f64, |largest, error| largest.max(error.abs()));
        assert!(found.len() > 5 && found.iter().all(|restart| largest(&restart.ahead_rad) < 1e-4));
        let zero_rad = zero_of_swings(&swing, &truth, 1e-3, &cuts(&swing, 0.0).unwrap());
        assert!(zero_rad.abs() < 1e-6, "{zero_rad}");
    }
}
