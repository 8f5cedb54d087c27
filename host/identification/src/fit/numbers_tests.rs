//! What a fit says of its numbers, and the steps it is made of, against closed forms: small swings with viscous or with
//! dry friction.

use super::answered::answered_costs;
use super::blocks::{Begin, choice};
use super::by_least_squares::{fitted_as_it_is, start_in_the_middle};
use super::curve::placed;
use super::descent::{Termination, Tolerance, descend};
use super::fitted::{Fitted, Stiction};
use super::free_torque::free_torque;
use super::identify::{FitError, problem_of};
use super::linear::{Steps, linearise};
use super::number::{Number, Status, Uncertainty};
use super::problem::{Point, Problem, Quantity};
use super::quality::Responses;
use super::ranges::{from_recording, largest_coulomb_nm};
use super::report::Report;
use super::ridge::Ridge;
use super::runs::responses_at;
use super::scouts::scouts;
use super::stop_level::{self, likely};
use super::tests::{
    PENDULUM, RELEASE_RAD, at_rest, dry_swing, noise, times_s, viscous_problem, viscous_rad, viscous_swing,
};
use super::tolerance::{Known, Tolerances};
use super::tolerated::tolerated;
use super::uncertainty::uncertainty;
use super::windows::windows_s;
use crate::fit::tally::Tally;
use crate::swing::{Swing, Window};
use nalgebra::DMatrix;
use shared::curve::{Curve, MAX_KNOTS};
use shared::model::Model;
use shared::parameters::{Parameters, base};
use std::f64::consts::PI;
use std::time::Instant;

const VISCOUS: f64 = 4e-4;

/// A small swing with viscous friction about a zero that is off, with even noise.
fn noisy_swing(zero_rad: f64, noise_rad: f64) -> [Swing; 1] {
    let times_s = times_s(10.0);
    let angle = |t: &f64| viscous_rad(VISCOUS, PENDULUM.inertia_kg_m2, *t) + zero_rad;
    let white = noise(times_s.len());
    // Even noise from −½ to ½ has the rms 1/√12.
    let angles_rad = times_s.iter().map(angle).zip(white).map(|(angle, x)| angle + 12f64.sqrt() * noise_rad * x);
    [Swing::new("noisy", &times_s, &angles_rad.collect::<Vec<f64>>(), noise_rad.max(1e-8))]
}

fn fitted(problem: &Problem) -> Fitted {
    let point = Point { values: problem.template_values(), starts: at_rest(RELEASE_RAD) };
    Fitted::at(problem, &point).with_stiction(Stiction::NONE).descended(problem, Window::Whole, Tolerance::FINE)
}

#[test]
fn numbers_are_as_uncertain_as_the_closed_form_says() {
    let (noise_rad, count) = (1e-5, Tally::default());
    let swings = noisy_swing(0.0, noise_rad);
    let problem = viscous_problem(&swings, VISCOUS, &count);
    let found = uncertainty(&problem, &fitted(&problem));
    // Columns of Mw, I, start angle, start velocity and zero; the velocity's is a sine over the frequency.
    let inertia = PENDULUM.inertia_kg_m2;
    let angular = (PENDULUM.gravity_torque_nm() / PENDULUM.pivot_inertia_kg_m2()).sqrt();
    let decay = VISCOUS / (2.0 * PENDULUM.pivot_inertia_kg_m2());
    let row = |t: f64| {
        [
            (viscous_rad(VISCOUS + 1e-8, inertia, t) - viscous_rad(VISCOUS - 1e-8, inertia, t)) / 2e-8,
            (viscous_rad(VISCOUS, inertia + 1e-8, t) - viscous_rad(VISCOUS, inertia - 1e-8, t)) / 2e-8,
            viscous_rad(VISCOUS, inertia, t) / RELEASE_RAD,
            (-decay * t).exp() * (angular * t).sin() / angular,
            1.0,
        ]
    };
    let times_s = &swings[0].times_s;
    let columns = DMatrix::from_fn(times_s.len(), 5, |i, j| row(times_s[i])[j]);
    let covariance = (columns.transpose() * &columns).try_inverse().unwrap();
    for (j, symbol) in ["Mw", "I"].into_iter().enumerate() {
        let number = &found.numbers[j];
        let expected = noise_rad * covariance[(j, j)].sqrt();
        assert_eq!((number.unknown.symbol, number.status), (symbol, Status::Identified));
        assert!((number.std.unwrap() / expected - 1.0).abs() < 0.1, "{number:?} {expected}");
    }
}

#[test]
fn tolerances_of_the_mass_widen_what_scales_with_it_and_tie_it_together() {
    let (swings, count) = (noisy_swing(0.0, 1e-5), Tally::default());
    let mut rig = Parameters::frictionless(PENDULUM);
    rig.set_friction(VISCOUS, 1e-3, 0.0, 0.0);
    let mut problem = problem_of(&swings, &rig, &count);
    problem.unknowns.retain(|unknown| ["Mw", "Mc"].contains(&unknown.symbol));
    let mass = Known { value: PENDULUM.mass_kg, std: 0.02 * PENDULUM.mass_kg };
    problem.tolerances = Tolerances { mass: Some(mass), ..Tolerances::default() };
    let model = Fitted::at(&problem, &Point { values: vec![VISCOUS, 1e-3], starts: at_rest(RELEASE_RAD) });
    let stds = [1e-5, 3e-5];
    let number = |j: usize| Number {
        unknown: problem.unknowns[j].clone(),
        value: [VISCOUS, 1e-3][j],
        std: Some(stds[j]),
        status: Status::Identified,
        upper: Some(2e-3),
    };
    let correlations = vec![vec![Some(1.0), Some(-0.5)], vec![Some(-0.5), Some(1.0)]];
    let found = Uncertainty { numbers: vec![number(0), number(1)], correlations, alike: Vec::new(), coloured: false };
    let found = tolerated(&problem, &model, found);
    // Torques grow with the mass: 2 % of both are in common.
    let by_mass = [0.02 * VISCOUS, 0.02 * 1e-3];
    let wider: Vec<f64> = (0..2).map(|j| stds[j].hypot(by_mass[j])).collect();
    for j in 0..2 {
        assert!((found.numbers[j].std.unwrap() / wider[j] - 1.0).abs() < 1e-9, "{:?}", found.numbers[j]);
        assert_eq!(found.numbers[j].upper, Some(2e-3));
        let with_mass = found.correlations[j][2].unwrap();
        assert!((with_mass - by_mass[j] / wider[j]).abs() < 1e-9, "{with_mass}");
    }
    let both = (-0.5 * stds[0] * stds[1] + by_mass[0] * by_mass[1]) / (wider[0] * wider[1]);
    assert!((found.correlations[0][1].unwrap() - both).abs() < 1e-9, "{:?} {both}", found.correlations);
    assert_eq!(found.numbers[2].unknown.quantity, Quantity::Mass);
}

#[test]
fn pairs_are_judged_at_the_numbers_that_were_found_and_about_the_zero() {
    let (zero_rad, count) = (3e-3, Tally::default());
    let swings = noisy_swing(zero_rad, 0.0);
    // The rig has five times the friction; the guess is right.
    let problem = viscous_problem(&swings, 5.0 * VISCOUS, &count);
    let mut starts = at_rest(RELEASE_RAD);
    starts[0].offset_rad = zero_rad;
    let point = Point { values: vec![VISCOUS, PENDULUM.inertia_kg_m2], starts };
    let linear = linearise(&problem, &point, Window::Whole, &mut Steps::found(&problem, &point));
    let stuck = Stiction::level(2.0 * PENDULUM.gravity_torque_nm() * RELEASE_RAD);
    let costs = answered_costs(&problem, &linear, &point, &[Stiction::NONE, stuck]);
    // The columns hold most of a swing that sticks, a sine, but not as well as the swing itself, to 1e-5 of it.
    let motion: f64 = swings[0].angles_rad.iter().map(|angle| (angle - zero_rad).powi(2)).sum();
    assert!(costs[0].abs() < 1e-9 * motion, "{costs:?} {motion}");
    assert!(costs[1] > 1e-6 * motion, "{costs:?} {motion}");
}

#[test]
fn a_straight_curve_leaves_of_a_viscous_swing_its_noise() {
    let (noise_rad, count) = (1e-5, Tally::default());
    let swings = noisy_swing(0.0, noise_rad);
    let problem = viscous_problem(&swings, VISCOUS, &count);
    let speeds: Vec<f32> = (0..=12).map(|k| 0.005 * k as f32).collect();
    let torques: Vec<f64> = speeds.iter().map(|speed| VISCOUS * f64::from(*speed)).collect();
    let fine = fitted(&problem).with_curve(&Curve::new(&speeds, &torques).unwrap()).unwrap();
    let found = choice(&problem, &fine, Begin::Anew).unwrap();
    assert!((found.straight_rad / noise_rad - 1.0).abs() < 0.05, "{found:?}");
    assert!((found.left_out_rad / noise_rad - 1.0).abs() < 0.05, "{found:?}");
    // A bend that is not there predicts nothing.
    assert!(found.better_by.abs() < 4.0, "{found:?}");
}

#[test]
fn friction_that_is_unknown_begins_at_a_usual_value_but_never_with_more_than_the_swings_have() {
    let (swings, count) = (noisy_swing(0.0, 1e-5), Tally::default());
    let problem = problem_of(&swings, &Parameters::frictionless(PENDULUM), &count);
    let mut model = Fitted::at(&problem, &Point { values: problem.template_values(), starts: at_rest(RELEASE_RAD) });
    start_in_the_middle(&problem, &mut model);
    let scale = |symbol: &str| problem.unknowns.iter().find(|unknown| unknown.symbol == symbol).unwrap().scale;
    assert_eq!(model.parameters.values(base::VISCOUS).unwrap(), [scale("Mw")]);
    let most_nm = largest_coulomb_nm(&problem);
    assert!(most_nm < scale("Mc"));
    assert_eq!(model.parameters.values(base::COULOMB).unwrap(), [most_nm]);
}

#[test]
fn dry_friction_takes_no_more_than_twice_the_stiffness_times_the_release_over_the_half_swings() {
    let (swings, count) = (noisy_swing(0.0, 1e-5), Tally::default());
    let problem = problem_of(&swings, &Parameters::frictionless(PENDULUM), &count);
    // Each half swing shrinks by 2·Mc/mgl; the swing lasts for 10 s, up to a half swing from its end.
    let half_s = PI * (PENDULUM.pivot_inertia_kg_m2() / PENDULUM.gravity_torque_nm()).sqrt();
    let of = |seconds: f64| 0.5 * PENDULUM.gravity_torque_nm() * RELEASE_RAD * half_s / seconds;
    let found = largest_coulomb_nm(&problem);
    assert!((of(10.0)..of(10.0 - half_s)).contains(&found), "{found}");
}

#[test]
fn friction_is_sought_up_to_twice_of_what_the_decay_shows() {
    let (swings, count) = (noisy_swing(0.0, 1e-6), Tally::default());
    let problem = problem_of(&swings, &Parameters::frictionless(PENDULUM), &count);
    let ranges = from_recording(&problem, PENDULUM.inertia_kg_m2).0;
    let of = |symbol: &str| ranges[problem.unknowns.iter().position(|unknown| unknown.symbol == symbol).unwrap()];
    let (low, high) = of("Mw");
    assert!(low == 0.0 && (high / (2.0 * VISCOUS) - 1.0).abs() < 0.05, "{high}");
    let pivot = PENDULUM.pivot_inertia_kg_m2();
    assert!((of("I").1 - PENDULUM.inertia_kg_m2 - 0.2 * pivot).abs() < 1e-9);
}

#[test]
fn windows_double_up_to_most_of_the_longest_swing_at_its_pace() {
    let mut swings = [noisy_swing(0.0, 1e-5)[0].clone()];
    let angles_rad: Vec<f64> = times_s(15.0).iter().map(|t| (6.0 * t).cos()).collect();
    swings[0] = swings[0].like(&times_s(15.0), &angles_rad);
    swings[0].pace = 1.0;
    assert_eq!(windows_s(&swings).collect::<Vec<_>>(), [1.2, 2.5, 5.0, 10.0]);
    swings[0].pace = 2.0;
    assert_eq!(windows_s(&swings).collect::<Vec<_>>(), [2.4, 5.0, 10.0]);
}

#[test]
fn a_model_that_leaves_most_of_the_motion_is_hopeless_and_a_better_one_is_not() {
    let (swings, count) = (noisy_swing(0.0, 1e-5), Tally::default());
    let problem = viscous_problem(&swings, VISCOUS, &count);
    let motion: f64 = swings[0].angles_rad.iter().map(|angle| angle * angle).sum();
    let built = |share: f64| {
        let model = Fitted { cost: share * share * motion, ..fitted(&problem) };
        let report = Report { problem: &problem, model, given: &[] };
        report.build(&[], Responses::default(), Vec::new(), &count, Instant::now())
    };
    let hopeless = built(0.61).unwrap_err();
    assert!(matches!(hopeless, FitError::Hopeless { error, .. } if error > 0.0), "{hopeless}");
    assert!(built(0.59).is_ok());
}

#[test]
fn other_effects_make_a_model_that_is_not_fitted_yet() {
    let (swings, count) = (noisy_swing(0.0, 1e-5), Tally::default());
    let problem = viscous_problem(&swings, VISCOUS, &count);
    let model = fitted(&problem);
    assert!(model.termination.is_some() && model.cost.is_finite());
    let curve = Curve::new(&[0.0, 0.02, 0.06], &[0.0, 1e-5, 3e-5]).unwrap();
    for other in [model.with_curve(&curve).unwrap(), model.without(base::VISCOUS)] {
        assert!(other.termination.is_none() && other.cost.is_infinite());
    }
}

#[test]
fn a_gain_that_surprises_is_followed_by_another_step() {
    let (swings, count) = (viscous_swing(VISCOUS), Tally::default());
    let problem = viscous_problem(&swings, VISCOUS, &count);
    let mut from = Point { values: problem.template_values(), starts: at_rest(RELEASE_RAD) };
    from.values[1] *= 1.05;
    let run = |tolerance: Tolerance| descend(&problem, &from, Window::Whole, tolerance, Steps::new(&problem));
    let before = problem.costs(Window::Whole, std::slice::from_ref(&from))[0];
    let first = run(Tolerance { max_iterations: 1, ..Tolerance::FINE }).cost;
    // What the first step gains is just worth it.
    let least_gain = 0.99 * (before - first) / problem.least_variance();
    let end = run(Tolerance { least_gain, ..Tolerance::FINE });
    assert_eq!(end.termination, Termination::LittleGain);
    assert!(end.cost < 0.1 * first, "{} {first} {before}", end.cost);
}

/// Mc of a swing that is held by it alone, N·m.
const DRY_NM: f64 = 1.3e-4;

/// The model of such a swing with the level that stops it where it rests.
fn stopped<'a>(swings: &'a [Swing], count: &'a Tally) -> (Problem<'a>, Fitted) {
    let mut rig = Parameters::frictionless(PENDULUM);
    rig.set_friction(0.0, DRY_NM, 0.0, 0.0);
    let problem = problem_of(swings, &rig, count);
    let point = Point { values: problem.template_values(), starts: at_rest(0.02) };
    let model = Fitted::at(&problem, &point).with_stiction(Stiction::NONE);
    let model = stop_level::levels(&problem, &model).swap_remove(0);
    (problem, model)
}

#[test]
fn levels_that_are_as_likely_as_allowed_frame_the_own_one() {
    let (swings, count) = (dry_swing(DRY_NM, 1.1e-3), Tally::default());
    let (problem, model) = stopped(&swings, &count);
    let own = likely(&problem, &model, 0.0);
    let all = likely(&problem, &model, 1e3);
    assert!(all.0 < own.0 && own.1 < all.1, "{own:?} {all:?}");
    // Up to the torque that holds the release.
    assert!(all.1 <= PENDULUM.gravity_torque_nm() * 0.02, "{all:?}");
}

#[test]
fn a_few_of_many_swings_cover_their_amplitudes() {
    let times_s = times_s(2.0);
    let swing = |size: usize| {
        let angles_rad: Vec<f64> = times_s.iter().map(|t| 0.1 * size as f64 * (6.0 * t).cos()).collect();
        Swing::new(&format!("{size}"), &times_s, &angles_rad, 1e-4)
    };
    // Fifteen of sizes 1 to 15, in the order of multiples of 4 modulo 16.
    let sizes: Vec<usize> = (1..16).map(|k: usize| if k.is_multiple_of(2) { k } else { (k * 7) % 16 }).collect();
    let swings: Vec<Swing> = sizes.iter().map(|size| swing(*size)).collect();
    let found: Vec<usize> = scouts(&swings).into_iter().map(|idx| sizes[idx]).collect();
    assert_eq!(found, [1, 3, 5, 7, 9, 11, 13, 15]);
    assert_eq!(scouts(&swings[..8]), [0, 1, 2, 3, 4, 5, 6, 7]);
}

#[test]
fn the_responses_of_the_true_model_are_its_noise() {
    let (noise_rad, zero_rad, count) = (1e-5, 3e-3, Tally::default());
    let swings = noisy_swing(zero_rad, noise_rad);
    let problem = viscous_problem(&swings, VISCOUS, &count);
    let mut starts = at_rest(RELEASE_RAD);
    starts[0].offset_rad = zero_rad;
    let point = Point { values: problem.template_values(), starts };
    let found = responses_at(&problem, &point, Window::Whole);
    assert!((found.mse_angle.sqrt() / noise_rad - 1.0).abs() < 0.05, "{found:?}");
    assert_eq!([found.positive_peaks, found.negative_peaks, found.zero_crossings], [0.0; 3]);
}

#[test]
fn values_of_stiction_stand_among_the_others() {
    let (swings, count) = (noisy_swing(0.0, 1e-5), Tally::default());
    let problem = problem_of(&swings, &Parameters::frictionless(PENDULUM), &count);
    let own: Vec<f64> = (0..problem.unknowns.len()).map(|j| 10.0 + j as f64).collect();
    let smooth: Vec<f64> = (0..problem.without_stiction().unknowns.len()).map(|j| j as f64).collect();
    let symbols: Vec<&str> = problem.unknowns.iter().map(|unknown| unknown.symbol).collect();
    assert_eq!(symbols, ["Mw", "Mc", "Ms", "DV", "I"]);
    assert_eq!(problem.with_values_but_stiction(&own, &smooth), [0.0, 1.0, 12.0, 13.0, 2.0]);
}

#[test]
fn a_free_torque_takes_the_friction_that_a_model_lacks() {
    let (swings, count) = (noisy_swing(0.0, 1e-5), Tally::default());
    let mut problem = viscous_problem(&swings, VISCOUS, &count);
    problem.unknowns.retain(|unknown| unknown.symbol == "I");
    let whole = free_torque(&problem, &fitted(&problem));
    // Nothing is left beyond the noise.
    assert!(whole.is_none_or(|found| found.as_torque < 0.5), "{whole:?}");
    let mut lacking = viscous_problem(&swings, 0.8 * VISCOUS, &count);
    lacking.unknowns.retain(|unknown| unknown.symbol == "I");
    let found = free_torque(&lacking, &fitted(&lacking)).unwrap();
    assert!(found.as_torque > 0.9 && found.as_torque > found.as_reading, "{found:?}");
    assert_eq!(found.as_clock, None, "one release can't tell a clock from a law");
    // Nine periods and a half, a block each, of which the first and the last hold the rest.
    assert!((7..=10).contains(&found.n_blocks), "{found:?}");
}

#[test]
fn a_clock_that_warms_up_in_each_release_explains_what_it_leaves() {
    let late = |[swing]: [Swing; 1]| {
        let longest_s = swing.times_s.last().copied().unwrap_or(1.0);
        let read = |t: &f64| t + 5e-3 * (1.0 - (-4.0 * t / longest_s).exp());
        let times_s: Vec<f64> = swing.times_s.iter().map(read).collect();
        Swing::new("late", &times_s, &swing.angles_rad, swing.noise_rad)
    };
    let (swings, count) = ([0.0, 1e-3].map(|zero_rad| late(noisy_swing(zero_rad, 1e-5))), Tally::default());
    let mut problem = viscous_problem(&swings, VISCOUS, &count);
    problem.unknowns.retain(|unknown| unknown.symbol == "I");
    let point =
        Point { values: problem.template_values(), starts: [at_rest(RELEASE_RAD), at_rest(RELEASE_RAD)].concat() };
    let begin = Fitted::at(&problem, &point).with_stiction(Stiction::NONE);
    let found = free_torque(&problem, &begin.descended(&problem, Window::Whole, Tolerance::FINE)).unwrap();
    assert!(found.as_clock.is_some_and(|share| share > 0.9), "{found:?}");
}

#[test]
fn a_ridge_costs_in_the_equations_what_it_costs_beside_the_errors() {
    let (swings, count) = (noisy_swing(0.0, 1e-5), Tally::default());
    let problem = viscous_problem(&swings, VISCOUS, &count);
    let speeds = [0.0, 0.02, 0.04, 0.06];
    let bent = Curve::new(&speeds, &[0.0, 2e-5, 1e-5, 3e-5]).unwrap();
    let model = fitted(&problem).with_curve(&bent).unwrap();
    let cost = |ridge: Option<Ridge>| {
        let problem = Problem { ridge, ..model.problem(&problem) };
        let equations = linearise(&problem, &model.point(), Window::Whole, &mut Steps::new(&problem)).equations;
        (equations.cost, problem.costs(Window::Whole, &[model.point()])[0])
    };
    let ((free, also_free), (held, also_held)) = (cost(None), cost(Some(Ridge::new(&speeds, 1.0))));
    assert!((free / also_free - 1.0).abs() < 1e-9 && (held / also_held - 1.0).abs() < 1e-9, "{held} {also_held}");
    assert!(held > 1.001 * free, "{held} {free}");
}

#[test]
fn knots_stand_over_all_speeds_of_the_swings() {
    let (swings, count) = (noisy_swing(0.0, 1e-5), Tally::default());
    let problem = viscous_problem(&swings, VISCOUS, &count);
    let knots = placed(&problem, &fitted(&problem)).unwrap();
    let largest = RELEASE_RAD * (PENDULUM.gravity_torque_nm() / PENDULUM.pivot_inertia_kg_m2()).sqrt();
    assert!(knots.len() > MAX_KNOTS / 2 && knots.len() <= MAX_KNOTS, "{knots:?}");
    assert!(knots[0] == 0.0 && (f64::from(knots[knots.len() - 1]) / largest - 1.0).abs() < 0.02, "{knots:?}");
    // A curve of so many knots leaves no tenth of the speeds without one.
    assert!(knots.windows(2).all(|pair| (1e-4..0.1).contains(&(f64::from(pair[1] - pair[0]) / largest))), "{knots:?}");
}

#[test]
fn a_level_between_two_turning_points_is_as_uncertain_as_if_each_were_as_likely() {
    let (swings, count) = (dry_swing(DRY_NM, 1.1e-3), Tally::default());
    let (problem, model) = stopped(&swings, &count);
    let found = uncertainty(&problem, &model);
    let level = found.numbers.iter().find(|number| number.unknown.symbol == "Ms").unwrap();
    // Evenly over 2·Mc.
    let expected = 2.0 * DRY_NM / 12f64.sqrt();
    assert!((level.std.unwrap() / expected - 1.0).abs() < 0.2, "{level:?} {expected}");
}

/// A swing that never rests, nearly without noise.
fn large_swing(truth: &Parameters<f64>) -> Swing {
    let model = Model::new(truth);
    let mut state = model.release(1.4, 0.0);
    let times_s: Vec<f64> = (0..800).map(|i| f64::from(i) / 100.0).collect();
    let mut angles_rad = Vec::new();
    for i in 0..times_s.len() {
        let noise_rad = 5e-5 * if i % 2 == 0 { 1.0 } else { -1.0 };
        angles_rad.push(state.angle_rad + noise_rad);
        (0..5).for_each(|_| model.step(&mut state, 2e-3));
    }
    Swing::new("large", &times_s, &angles_rad, 5e-5)
}

#[test]
fn an_inertia_is_known_no_better_than_a_band_that_no_swing_shows_lets_it_be() {
    let mut truth = Parameters::paper();
    truth.set_friction(2e-4, 2e-4, 2.4e-4, 0.03);
    let (swings, count) = ([large_swing(&truth)], Tally::default());
    let mut rig = truth.clone();
    Stiction::NONE.put_into(&mut rig);
    let problem = problem_of(&swings, &rig, &count);
    let found = uncertainty(&problem, &fitted_as_it_is(&problem));
    let inertia = found.numbers.iter().find(|number| number.unknown.symbol == "I").unwrap();
    let off = (inertia.value - truth.pendulum.inertia_kg_m2) / inertia.std.unwrap();
    assert!(off > 0.1 && off < 2.0, "{off}");
}
