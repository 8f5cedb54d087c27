//! The core of the fit against closed forms: small swings of a pendulum with viscous or with dry friction.

use super::covariance::covariance;
use super::descent::{Termination, Tolerance, descend};
use super::fitted::{Fitted, Stiction};
use super::identify::{FitError, problem_of};
use super::linear::{Linear, Steps, SwingLinear, linearise};
use super::problem::{PER_SWING, Point, Problem, Start};
use super::stop_level;
use crate::fit::tally::Tally;
use crate::recording::Measured;
use crate::swing::{Swing, Window};
use shared::motion::Pendulum;
use shared::parameters::Parameters;
use std::f64::consts::PI;

pub(super) const PENDULUM: Pendulum<f64> =
    Pendulum { mass_kg: 0.15, length_m: 0.16, inertia_kg_m2: 2.7e-3, gravity_m_s2: 9.81 };

/// So small that sin θ = θ to 2e-5 of it, so large that a finite difference of 1e-5 rad is a thousandth of it.
pub(super) const RELEASE_RAD: f64 = 1e-2;

/// θ = A·e^(−λt)·(cos ω_d t + λ/ω_d·sin ω_d t), from rest; λ = Mw/2J.
pub(super) fn viscous_rad(viscous: f64, inertia_kg_m2: f64, time_s: f64) -> f64 {
    let pivot = Pendulum { inertia_kg_m2, ..PENDULUM }.pivot_inertia_kg_m2();
    let decay = viscous / (2.0 * pivot);
    let angular = (PENDULUM.gravity_torque_nm() / pivot - decay * decay).sqrt();
    RELEASE_RAD * (-decay * time_s).exp() * ((angular * time_s).cos() + decay / angular * (angular * time_s).sin())
}

pub(super) fn times_s(seconds: f64) -> Vec<f64> {
    (0..(200.0 * seconds) as usize).map(|i| i as f64 / 200.0).collect()
}

pub(super) fn viscous_swing(viscous: f64) -> [Swing; 1] {
    let times_s = times_s(10.0);
    let angles_rad: Vec<f64> = times_s.iter().map(|t| viscous_rad(viscous, PENDULUM.inertia_kg_m2, *t)).collect();
    [Swing::new("small", &times_s, &angles_rad, 1e-8)]
}

/// Viscous friction and inertia alone are unknown.
pub(super) fn viscous_problem<'a>(swings: &'a [Swing], viscous: f64, count: &'a Tally) -> Problem<'a> {
    let mut rig = Parameters::frictionless(PENDULUM);
    rig.set_friction(viscous, 0.0, 0.0, 0.0);
    let mut problem = problem_of(swings, &rig, count);
    problem.unknowns.retain(|unknown| ["Mw", "I"].contains(&unknown.symbol));
    problem
}

pub(super) fn at_rest(angle_rad: f64) -> Vec<Start> {
    vec![Start { angle_rad, velocity_rad_s: 0.0, offset_rad: 0.0 }]
}

#[test]
fn derivatives_are_those_of_the_closed_form() {
    let (viscous, count) = (4e-4, Tally::default());
    let swings = viscous_swing(viscous);
    let problem = viscous_problem(&swings, viscous, &count);
    let point = Point { values: problem.template_values(), starts: at_rest(RELEASE_RAD) };
    let mut steps = Steps::new(&problem);
    linearise(&problem, &point, Window::Whole, &mut steps);
    let linear = linearise(&problem, &point, Window::Whole, &mut steps);
    let inertia = PENDULUM.inertia_kg_m2;
    let slope = |of: &dyn Fn(f64) -> f64, step: f64| (of(step) - of(-step)) / (2.0 * step);
    let expected = |t: f64| {
        [
            slope(&|step| viscous_rad(viscous + step, inertia, t), 1e-8),
            slope(&|step| viscous_rad(viscous, inertia + step, t), 1e-8),
            viscous_rad(viscous, inertia, t) / RELEASE_RAD,
        ]
    };
    let columns = linear.each(|_, swing| swing.columns.clone()).remove(0);
    for k in 0..3 {
        let column = &columns[k];
        let wanted: Vec<f64> = swings[0].times_s.iter().map(|t| expected(*t)[k]).collect();
        let largest = wanted.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        let worst = column.iter().zip(&wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < 2e-3 * largest, "column {k}: {worst} of {largest}");
    }
}

#[test]
fn many_swings_are_linearised_as_each_of_them_alone() {
    let (viscous, count) = (4e-4, Tally::default());
    let swings = vec![viscous_swing(viscous)[0].clone(); 20];
    let problem = viscous_problem(&swings, viscous, &count);
    let point = Point { values: problem.template_values(), starts: at_rest(RELEASE_RAD).repeat(20) };
    let all = linearise(&problem, &point, Window::Whole, &mut Steps::new(&problem));
    let alone = problem.on(&swings[..1]);
    let point = Point { starts: at_rest(RELEASE_RAD), ..point };
    let one = linearise(&alone, &point, Window::Whole, &mut Steps::new(&problem));
    let columns = one.each(|_, swing| swing.columns.clone()).remove(0);
    assert!(all.each(|_, swing| swing.columns == columns).into_iter().all(|same| same));
    let (all, one) = (&all.equations, &one.equations);
    assert!((all.normal.square(0) / one.normal.square(0) - 20.0).abs() < 1e-9);
    assert_eq!(all.normal.square(all.normal.len() - 1), one.normal.square(one.normal.len() - 1));
    assert!((all.gradient[0] / one.gradient[0] - 20.0).abs() < 1e-9);
}

#[test]
fn a_descent_finds_the_numbers_of_the_closed_form_and_says_why_it_ended() {
    let (viscous, count) = (4e-4, Tally::default());
    let swings = viscous_swing(viscous);
    let problem = viscous_problem(&swings, 1.5 * viscous, &count);
    let mut from = Point { values: problem.template_values(), starts: at_rest(1.1 * RELEASE_RAD) };
    from.values[1] *= 1.05;
    let end = descend(&problem, &from, Window::Whole, Tolerance::FINE, Steps::new(&problem));
    assert!((end.point.values[0] / viscous - 1.0).abs() < 1e-4, "{:?}", end.point);
    assert!((end.point.values[1] / PENDULUM.inertia_kg_m2 - 1.0).abs() < 1e-4, "{:?}", end.point);
    assert!(end.termination.is_converged(), "{:?}", end.termination);
    let hasty = Tolerance { max_iterations: 1, ..Tolerance::FINE };
    let end = descend(&problem, &from, Window::Whole, hasty, Steps::new(&problem));
    assert_eq!(end.termination, Termination::LostPatience);
}

#[test]
fn a_descent_stays_within_the_bounds() {
    let count = Tally::default();
    // Friction would have to be negative: this swing grows.
    let times_s = times_s(10.0);
    let grown = |t: &f64| viscous_rad(-1e-4, PENDULUM.inertia_kg_m2, *t);
    let swings = [Swing::new("growing", &times_s, &times_s.iter().map(grown).collect::<Vec<f64>>(), 1e-8)];
    let problem = viscous_problem(&swings, 2e-4, &count);
    let from = Point { values: problem.template_values(), starts: at_rest(RELEASE_RAD) };
    let end = descend(&problem, &from, Window::Whole, Tolerance::FINE, Steps::new(&problem));
    assert_eq!(end.point.values[0], 0.0);
}

/// A linearisation of one swing by hand: residuals and columns, the last three of them the start's.
fn by_hand(residuals: Vec<f64>, columns: Vec<Vec<f64>>) -> Linear<'static> {
    Linear::of(columns.len() - PER_SWING, vec![SwingLinear { residuals, columns }])
}

/// Uniform noise of variance 1/12 from a linear congruence.
pub(super) fn noise(n: usize) -> Vec<f64> {
    let mut state = 7_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    (0..n).map(|_| next()).collect()
}

fn waves(n: usize) -> Vec<Vec<f64>> {
    let wave = |k: usize| (0..n).map(|i| (2.0 * PI * (k + 1) as f64 * i as f64 / n as f64).cos()).collect();
    let mut columns: Vec<Vec<f64>> = (0..3).map(wave).collect();
    columns.push(vec![1.0; n]);
    columns
}

#[test]
fn the_covariance_of_white_residuals_is_that_of_the_textbook() {
    // Cosines are orthogonal: each has the variance s²·2/n, the mean s²/n.
    let n = 4000;
    let covariance = covariance(&by_hand(noise(n), waves(n))).unwrap();
    let textbook = |share: f64| (share / 12.0 / n as f64).sqrt();
    assert!(!covariance.coloured);
    assert!((covariance.std(0).unwrap() / textbook(2.0) - 1.0).abs() < 0.05);
    assert!((covariance.std(3).unwrap() / textbook(1.0) - 1.0).abs() < 0.05);
    assert!(covariance.correlation(0, 3).unwrap().abs() < 0.05);
}

#[test]
fn residuals_with_a_memory_make_slow_columns_as_uncertain_as_they_are() {
    // A first-order process of correlation ρ: the mean's standard error is √((1+ρ)/(1−ρ)) times that of white residuals.
    let (n, rho) = (40_000, 0.6);
    let coloured: Vec<f64> = noise(n)
        .iter()
        .scan(0.0, |last, x| {
            *last = rho * *last + x;
            Some(*last)
        })
        .collect();
    let variance = coloured.iter().map(|x| x * x).sum::<f64>() / n as f64;
    let covariance = covariance(&by_hand(coloured, waves(n))).unwrap();
    let expected = (variance / n as f64 * (1.0 + rho) / (1.0 - rho)).sqrt();
    assert!(covariance.coloured);
    assert!((covariance.std(3).unwrap() / expected - 1.0).abs() < 0.2, "{:?} {expected}", covariance.std(3));
}

#[test]
fn a_column_without_effect_is_unknown_and_spoils_no_other() {
    let n = 4000;
    let mut columns = waves(n);
    columns[1] = vec![0.0; n];
    let covariance = covariance(&by_hand(noise(n), columns)).unwrap();
    assert_eq!(covariance.std(1), None);
    assert!((covariance.std(0).unwrap() / (2.0 / 12.0 / n as f64).sqrt() - 1.0).abs() < 0.05);
}

/// Dry friction alone: half a cosine about ±Mc/mgl after the other, each 2·Mc/mgl smaller, until one ends where Ms holds.
pub(super) fn dry_swing(coulomb_nm: f64, level_nm: f64) -> [Swing; 1] {
    let stiffness = PENDULUM.gravity_torque_nm();
    let half_s = PI * (PENDULUM.pivot_inertia_kg_m2() / stiffness).sqrt();
    let (release_rad, shift_rad) = (0.02, coulomb_nm / stiffness);
    let angle = |time_s: f64| {
        let (mut turn_rad, mut half) = (release_rad, 0.0);
        while stiffness * f64::abs(turn_rad) > level_nm {
            let centre_rad = shift_rad * f64::signum(turn_rad);
            if time_s < (half + 1.0) * half_s {
                return centre_rad + (turn_rad - centre_rad) * (PI * (time_s / half_s - half)).cos();
            }
            (turn_rad, half) = (2.0 * centre_rad - turn_rad, half + 1.0);
        }
        turn_rad
    };
    let times_s = times_s(9.0);
    [Swing::new("dry", &times_s, &times_s.iter().map(|t| angle(*t)).collect::<Vec<f64>>(), 1e-5)]
}

#[test]
fn the_stop_level_is_found_between_the_turning_points_that_frame_it() {
    // Turning points 2·Mc apart: 2.6e-4 N·m; the level lies within one of the gaps.
    let (coulomb_nm, level_nm, count) = (1.3e-4, 1.1e-3, Tally::default());
    let swings = dry_swing(coulomb_nm, level_nm);
    let mut rig = Parameters::frictionless(PENDULUM);
    rig.set_friction(0.0, coulomb_nm, 0.0, 0.0);
    let problem = problem_of(&swings, &rig, &count);
    let point = Point { values: problem.template_values(), starts: at_rest(0.02) };
    let model = Fitted::at(&problem, &point).with_stiction(Stiction::NONE);
    let (low, high) = stop_level::levels(&problem, &model)[0].level_range_nm;
    assert!(low < level_nm && level_nm < high, "{low} … {high}");
    assert!(high - low < 3.0 * coulomb_nm, "{low} … {high}");
}

#[test]
fn an_error_of_rates_is_told_in_their_unit() {
    let words = |measured| FitError::Hopeless { error: 0.0452, measured, follows_from_s: None }.to_string();
    assert!(words(Measured::Rate).contains("error 0.045 rad/s; is the rate in rad/s"), "{}", words(Measured::Rate));
    assert!(words(Measured::Angle).contains("error 0.045 rad; is the angle in rad,"), "{}", words(Measured::Angle));
}

#[test]
fn a_later_start_that_is_followed_is_named_before_anything_else() {
    let fault = FitError::Hopeless { error: 0.6, measured: Measured::Angle, follows_from_s: Some(2.9) };
    let words = fault.to_string();
    let [from, unit] = ["--from 2.90", "is the angle in rad"].map(|part| words.find(part));
    assert!(from.is_some() && from < unit, "{words}");
}
