//! A whole comparison of swings whose law is known in closed form: small ones with viscous friction and white noise.

use super::beside::begun_as_fitted;
use super::follow::Followed;
use super::measurement::Measurement;
use super::pictures::pictures;
use super::recording::Judged;
use super::verdict::Answer;
use super::{Comparison, Options, compare, follow, recording};
use crate::fit::problem::Start;
use crate::plot::Content;
use crate::random::Noise;
use crate::swing::Swing;
use shared::motion::Pendulum;
use shared::parameters::Parameters;
use std::sync::LazyLock;

pub(super) const PENDULUM: Pendulum<f64> =
    Pendulum { mass_kg: 0.15, length_m: 0.16, inertia_kg_m2: 2.7e-3, gravity_m_s2: 9.81 };

/// Mw, N·m·s/rad.
pub(super) const VISCOUS: f64 = 4e-4;

/// So small that sin θ = θ to 7e-5 of it.
const RELEASE_RAD: f64 = 0.02;

/// The sensor's zero, rad.
pub(super) const OFFSET_RAD: f64 = 0.01;

pub(super) const NOISE_RAD: f64 = 1e-4;

pub(super) fn rig(viscous: f64) -> Parameters<f64> {
    let mut rig = Parameters::frictionless(PENDULUM);
    rig.set_friction(viscous, 0.0, 0.0, 0.0);
    rig
}

/// ω_d in rad/s and λ = Mw/2J in 1/s.
pub(super) fn frequency_and_decay() -> (f64, f64) {
    let decay = VISCOUS / (2.0 * PENDULUM.pivot_inertia_kg_m2());
    let square = PENDULUM.gravity_torque_nm() / PENDULUM.pivot_inertia_kg_m2() - decay * decay;
    (square.sqrt(), decay)
}

/// θ = A·e^(−λt)·(cos ω_d t + λ/ω_d·sin ω_d t), from rest, with a zero that is off.
pub(super) fn swing(name: &str, noise_rad: f64, seed: u64) -> Swing {
    let (angular, decay) = frequency_and_decay();
    let mut noise = Noise::new(seed);
    let times_s: Vec<f64> = (0..1600).map(|i| f64::from(i) / 200.0).collect();
    let angle_rad = |t: f64| {
        RELEASE_RAD * (-decay * t).exp() * ((angular * t).cos() + decay / angular * (angular * t).sin()) + OFFSET_RAD
    };
    let angles_rad: Vec<f64> = times_s.iter().map(|t| angle_rad(*t) + noise_rad * noise.normal()).collect();
    Swing::new(name, &times_s, &angles_rad, noise_rad.max(1e-7))
}

pub(super) fn measurement(name: &str, seed: u64) -> Measurement {
    Measurement::of_swing(swing(name, NOISE_RAD, seed))
}

/// Two recordings beside the true model.
static COMPARISON: LazyLock<Comparison> = LazyLock::new(|| {
    let measurements = [measurement("one.csv", 1), measurement("two.csv", 2)];
    compare(&rig(VISCOUS), &measurements, &[], &Options::default()).unwrap()
});

/// One recording beside the true model.
pub(super) fn judged() -> Judged {
    COMPARISON.recordings[0].clone()
}

#[test]
fn beside_the_true_model_nothing_but_noise_and_the_zero_is_left() {
    let found = &*COMPARISON;
    assert_eq!(found.answer, Answer::NothingMissing, "{:?}", found.verdict);
    // 3200 samples tell an rms to 1/√6400.
    assert!((found.totals.residual_rad / NOISE_RAD - 1.0).abs() < 0.05, "{:?}", found.totals);
    assert!((found.totals.ratio - found.totals.residual_rad / NOISE_RAD).abs() < 1e-9);
    // The rms of a sine that falls from 0.02 to 0.0157 rad in 8 s: that of e^(−λt)/√2 over the time.
    let (_, decay) = frequency_and_decay();
    let motion_rad = RELEASE_RAD * ((1.0 - (-16.0 * decay).exp()) / (32.0 * decay)).sqrt();
    let share = NOISE_RAD / motion_rad;
    assert!((found.totals.nrmse_fit - (1.0 - share)).abs() < 0.05 * share, "{:?} {share}", found.totals);
    assert!((found.totals.explained - (1.0 - share * share)).abs() < 0.1 * share * share, "{:?}", found.totals);
    assert!(found.verdict[0].starts_with("The model explains 99.9"), "{:?}", found.verdict);
    let but = "Nothing is missing at this noise level but the sensor's zero, which is off by 10.00";
    assert!(found.verdict[1].contains(but), "{:?}", found.verdict);
    let zero = found.knowledge.as_ref().and_then(|knowledge| knowledge.zero).unwrap();
    assert!((zero.value - OFFSET_RAD).abs() < 4.0 * zero.std.unwrap(), "{zero:?}");
}

#[test]
fn a_recording_of_angles_is_told_what_angles_lack() {
    let limits = &COMPARISON.limits;
    assert!(limits.iter().any(|limit| limit.starts_with("No recording comes to rest")), "{limits:?}");
    assert!(!limits.iter().any(|limit| limit.contains("Rates, not angles")), "{limits:?}");
}

#[test]
fn held_out_recordings_have_totals_of_their_own_if_there_are_some() {
    assert_eq!(COMPARISON.held_out_totals, None);
    let measurements = [measurement("one.csv", 1), measurement("two.csv", 2)];
    let found = compare(&rig(VISCOUS), &measurements[..1], &measurements[1..], &Options::default()).unwrap();
    let totals = found.held_out_totals.unwrap();
    assert!((totals.residual_rad / NOISE_RAD - 1.0).abs() < 0.08, "{totals:?}");
    assert!(found.verdict.iter().any(|words| words.contains("carries over")), "{:?}", found.verdict);
}

#[test]
fn every_recording_has_pictures_with_its_number_and_two_are_set_beside_each_other() {
    let mut found = COMPARISON.clone();
    let all = pictures(&found);
    for key in ["motion-1", "residual-1", "motion-2", "residual-2", "by-recording", "correlations"] {
        assert_eq!(all.iter().filter(|picture| picture.key == key).count(), 1, "{key}");
    }
    let beside = all.iter().find(|picture| picture.key == "by-recording").unwrap();
    let Content::Curves(curves) = &beside.content else { panic!("{beside:?}") };
    let line = curves.iter().find(|curve| curve.name == "all together").unwrap();
    assert_eq!(line.x, [0.5, 2.5]);
    found.recordings.truncate(1);
    assert!(!pictures(&found).iter().any(|picture| picture.key == "by-recording"));
}

#[test]
fn a_run_begins_where_a_fit_begins_it_if_that_leaves_less() {
    let (rig, [measurement]) = (rig(VISCOUS), [measurement("one.csv", 1)]);
    let follow_from = |start: Start| follow::follow_from(&measurement.swing, &rig, start);
    let good = follow_from(judged().start);
    let bad = Followed { residuals_rad: vec![0.01; good.residuals_rad.len()], ..good.clone() };
    let left_of = |begun: &Followed, start: Start| {
        let begun = vec![recording::judge(&measurement, &rig, begun.clone())];
        let again = begun_as_fitted(std::slice::from_ref(&measurement), begun, &rig, &[start]);
        again[0].verdict.residual_rad / NOISE_RAD
    };
    assert!((left_of(&bad, good.start) - 1.0).abs() < 0.1);
    let elsewhere = Start { velocity_rad_s: 50.0, ..good.start };
    assert!((left_of(&good, elsewhere) - 1.0).abs() < 0.1);
}
