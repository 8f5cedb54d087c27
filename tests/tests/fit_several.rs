//! Several swings of one rig at once, some held out; and what a fit says about itself.

#[path = "../../shared/tests/physics_reference/mod.rs"]
mod physics_reference;

use host::fit::identify::{Fit, FitError, Method, Options, Verdict, fit};
use host::recording::segment::SegmentOptions;
use host::swing::Swing;
use physics_reference::Reference;
use shared::parameters::{Parameters, base};
use tests::chance::Chance;
use tests::measured::{self, noise_rad};
use tests::paper_data::drawing;

/// The rig of these tests: within the box of Table 2.
fn rig() -> Parameters<f64> {
    let mut truth = drawing();
    truth.set_friction(5e-4, 7e-4, 4e-3, 0.03);
    truth.pendulum.inertia_kg_m2 = 0.0027;
    truth
}

fn release(truth: &Parameters<f64>, start_rad: f64, seed: u64) -> Swing {
    let mut pendulum = Reference::release(truth, None, start_rad, 0.0);
    let recording = measured::recording(start_rad, &mut Chance::new(seed), |seconds| {
        pendulum.advance(seconds);
        (pendulum.angle_rad, pendulum.velocity_rad_s)
    });
    Swing::from_recording("release", &recording, &SegmentOptions::default()).unwrap().0
}

fn fitted(swings: &[Swing], held_out: &[Swing], method: Method, ranges: &[(&str, f64, f64)]) -> Result<Fit, FitError> {
    let ranges = ranges.iter().map(|(symbol, low, high)| ((*symbol).to_owned(), *low, *high)).collect();
    fit(swings, held_out, &drawing(), &Options { method, ranges }, &|_| {})
}

fn found<'a>(fit: &'a Fit, symbol: &str) -> &'a host::fit::identify::Identified {
    fit.identified.iter().find(|found| found.symbol == symbol).unwrap()
}

#[test]
fn three_releases_to_both_sides_predict_a_fourth_within_10_percent_of_the_noise() {
    let swings: Vec<Swing> =
        [(1.5, 1), (-0.9, 2), (2.2, 3)].map(|(start_rad, seed)| release(&rig(), start_rad, seed)).to_vec();
    let held_out = [release(&rig(), -1.2, 4)];
    for method in [Method::Both, Method::LeastSquares] {
        let fit = fitted(&swings, &held_out, method, &[]).unwrap();
        let noises = fit.held_out_rmse_rad.unwrap() / noise_rad();
        println!("{method:?}: {noises:.3} noises held out, {:.3} fitted", fit.rmse_rad / noise_rad());
        assert!((noises - 1.0).abs() <= 0.1, "{method:?}: {noises} noises on the held-out swing");
        assert_eq!(fit.starts.len(), 3);
    }
}

#[test]
fn more_swings_make_the_uncertainties_smaller() {
    let swings: Vec<Swing> = [(1.5, 1), (-1.5, 2), (1.5, 3)].map(|(start, seed)| release(&rig(), start, seed)).to_vec();
    let std =
        |swings: &[Swing], symbol| found(&fitted(swings, &[], Method::LeastSquares, &[]).unwrap(), symbol).std.unwrap();
    for symbol in ["Mw", "Mc", "I"] {
        // Three equal swings: 1/√3 ≈ 0.58, and the noise decides the rest.
        let ratio = std(&swings, symbol) / std(&swings[..1], symbol);
        assert!((0.4..0.8).contains(&ratio), "{symbol}: {ratio}");
    }
}

#[test]
fn twenty_swings_tell_the_truth_within_their_uncertainties() {
    // More than find the way, and more than have their derivatives kept.
    let mut chance = Chance::new(20);
    let swings: Vec<Swing> = (0..20).map(|seed| release(&rig(), chance.within(0.7..2.2), 100 + seed)).collect();
    let fit = fitted(&swings, &[], Method::Both, &[]).unwrap();
    assert!(fit.rmse_rad < 1.005 * noise_rad(), "{} noises", fit.rmse_rad / noise_rad());
    assert_eq!(fit.starts.len(), 20);
    for (symbol, truth) in [("Mw", 5e-4), ("Mc", 7e-4), ("Ms", 4e-3), ("DV", 0.03), ("I", 0.0027)] {
        let found = found(&fit, symbol);
        let stds = (found.value - truth) / found.std.unwrap();
        println!("{symbol}: {} {stds:.2} ± off", found.value);
        assert!(stds.abs() < 3.5, "{symbol}: {found:?}");
    }
}

#[test]
fn friction_that_is_not_there_is_named() {
    let mut slippery = rig();
    slippery.set_friction(5e-4, 0.0, 1e-3, 0.0);
    let fit = fitted(&[release(&slippery, 1.5, 5)], &[], Method::LeastSquares, &[]).unwrap();
    let coulomb = found(&fit, "Mc");
    assert!(coulomb.value < 1e-5 && coulomb.verdict != Verdict::Identified, "{coulomb:?}");
    assert!(fit.warnings.iter().any(|warning| warning.starts_with("Mc ")), "{:?}", fit.warnings);
}

#[test]
fn a_velocity_band_without_a_trace_is_named() {
    let mut bandless = rig();
    bandless.set_friction(5e-4, 7e-4, 8e-4, 0.0);
    let fit = fitted(&[release(&bandless, 1.5, 6)], &[], Method::Both, &[]).unwrap();
    assert_eq!(found(&fit, "DV").value, 0.0);
    assert!(fit.warnings.iter().any(|warning| warning.starts_with("DV has no visible effect")), "{:?}", fit.warnings);
}

#[test]
fn a_value_outside_its_given_range_is_told() {
    let swing = release(&rig(), 1.5, 7);
    let fit = fitted(&[swing], &[], Method::Both, &[("Mc", 1e-3, 2e-3)]).unwrap();
    let value = found(&fit, "Mc").value;
    assert!((value / 7e-4 - 1.0).abs() < 0.02, "{value}");
    assert!(fit.warnings.iter().any(|warning| warning.starts_with("Mc lies outside the range")), "{:?}", fit.warnings);
}

#[test]
fn missing_physics_is_told() {
    let mut pendulum = Reference::release(&rig(), Some(|_, velocity, _| -2e-4 * velocity * velocity.abs()), 2.2, 0.0);
    let recording = measured::recording(2.2, &mut Chance::new(8), |seconds| {
        pendulum.advance(seconds);
        (pendulum.angle_rad, pendulum.velocity_rad_s)
    });
    let swing = Swing::from_recording("drag", &recording, &SegmentOptions::default()).unwrap().0;
    let fit = fitted(&[swing], &[], Method::LeastSquares, &[]).unwrap();
    assert!(fit.warnings.iter().any(|warning| warning.contains("physics is missing")), "{:?}", fit.warnings);
}

#[test]
fn ranges_that_mean_nothing_are_refused_with_what_is_expected() {
    let short = Swing::new("short", &[0.0, 0.01, 0.02, 0.03], &[1.0, 0.99, 0.98, 0.97], 1e-3);
    let refused = |range| fitted(std::slice::from_ref(&short), &[], Method::Both, &[range]).unwrap_err().to_string();
    for (range, words) in [
        (("Mc", 1e-3, 1e-4), "0.001 … 0.0001 of Mc"),
        (("Mc", 1e-3, 1e-3), "smaller one first"),
        (("Mw", -1e-3, 1e-3), "not below 0"),
        (("I", f64::NAN, 3e-3), "two finite numbers"),
        (("DV", 0.0, f64::INFINITY), "two finite numbers"),
        (("Mx", 0.0, 1.0), "Mw, Mc, Ms, DV, I"),
    ] {
        let said = refused(range);
        assert!(said.contains(words), "{range:?}: {said}");
    }
}

#[test]
fn without_a_swing_there_is_no_fit() {
    assert_eq!(fitted(&[], &[], Method::Both, &[]).unwrap_err(), FitError::NoSwing);
}

#[test]
fn what_is_no_pendulum_is_not_fitted() {
    let times_s: Vec<f64> = (0..3000).map(|sample| f64::from(sample) * 0.01).collect();
    let mut chance = Chance::new(9);
    let angles_rad: Vec<f64> = times_s.iter().map(|_| chance.within(-1.0..1.0)).collect();
    let noise = Swing::new("noise", &times_s, &angles_rad, 1e-3);
    assert!(matches!(fitted(&[noise], &[], Method::LeastSquares, &[]), Err(FitError::Hopeless { .. })));
}

#[test]
fn the_model_has_the_base_effects_after_a_fit() {
    let fit = fitted(&[release(&rig(), 1.5, 10)], &[], Method::LeastSquares, &[]).unwrap();
    for id in [base::VISCOUS, base::COULOMB, base::STICTION] {
        assert!(fit.parameters.values(id).is_some());
    }
    assert_eq!(fit.parameters.check(), Ok(()));
}
