//! The paper's swing, rebuilt with known parameters and noise: they come back, whatever the first ranges.

use host::fit::identify::{Fit, Method, Options, fit};
use host::recording::segment::SegmentOptions;
use host::recording::{ReadOptions, read};
use host::swing::Swing;
use tests::paper_data::{drawing, json, levels, path};

/// What least squares must reach, as shares of the true values: (Mw and Mc, I).
const BY_LEAST_SQUARES: (f64, f64) = (1e-3, 2e-4);

/// What every method must reach.
const BY_ALL: (f64, f64) = (5e-3, 5e-4);

/// The recording's noise is 1.08 mrad: 1 mrad white, and the steps of a 12-bit converter over 340°.
const MOST_ERROR_RAD: f64 = 1.2e-3;

fn swing() -> Swing {
    let recording = read(&path("reconstructed_recording_noisy.csv"), &ReadOptions::default()).unwrap();
    Swing::from_recording("noisy", &recording, &SegmentOptions::default()).unwrap().0
}

fn table_2() -> Vec<(String, f64, f64)> {
    levels("1")
}

fn check(method: Method, ranges: Vec<(String, f64, f64)>, (friction, inertia): (f64, f64)) {
    let fit = fit(&[swing()], &[], &drawing(), &Options { method, ranges }, &|_| {}).unwrap();
    let truth = &json("reconstruction.json")["recording"];
    for (symbol, share) in [("Mw", friction), ("Mc", friction), ("I", inertia)] {
        let error = value(&fit, symbol) / truth[symbol].as_f64().unwrap() - 1.0;
        println!("{method:?} {symbol}: off by {:+.4} %", 100.0 * error);
        assert!(error.abs() <= share, "{method:?} {symbol}: off by {:+.4} %", 100.0 * error);
    }
    println!("{method:?}: error {:.3} mrad, noise {:.3} mrad", 1e3 * fit.rmse_rad, 1e3 * fit.noise_rad);
    assert!(fit.rmse_rad <= MOST_ERROR_RAD, "{method:?}: {} rad", fit.rmse_rad);
}

fn value(fit: &Fit, symbol: &str) -> f64 {
    fit.identified.iter().find(|found| found.symbol == symbol).unwrap().value
}

#[test]
fn the_known_parameters_come_back_without_ranges() {
    check(Method::Both, Vec::new(), BY_ALL);
}

#[test]
fn the_known_parameters_come_back_from_the_ranges_of_table_2() {
    check(Method::Both, table_2(), BY_ALL);
}

#[test]
fn response_surfaces_alone_find_them_without_ranges_and_from_table_2() {
    check(Method::Rsm, Vec::new(), BY_ALL);
    check(Method::Rsm, table_2(), BY_ALL);
}

#[test]
fn least_squares_alone_finds_them_more_closely() {
    check(Method::LeastSquares, Vec::new(), BY_LEAST_SQUARES);
    check(Method::LeastSquares, table_2(), BY_LEAST_SQUARES);
}

#[test]
fn a_second_fit_gives_the_same_numbers() {
    let options = Options { method: Method::Both, ranges: Vec::new() };
    let [first, second] = [(); 2].map(|()| fit(&[swing()], &[], &drawing(), &options, &|_| {}).unwrap());
    assert_eq!(first.parameters, second.parameters);
}

#[test]
fn every_stage_lowers_the_error_or_leaves_the_values() {
    let options = Options { method: Method::Rsm, ranges: table_2() };
    let fit = fit(&[swing()], &[], &drawing(), &options, &|_| {}).unwrap();
    assert!(!fit.stages.is_empty());
    for stage in &fit.stages {
        assert!(stage.after.mse_angle <= stage.before.mse_angle, "{stage:?}");
    }
    assert!(fit.responses.mse_angle < 1e-3 * fit.responses_before.mse_angle);
    // The last peak before rest may drown in the noise.
    assert!(fit.responses.values()[2..].iter().all(|count| count.abs() <= 1.0), "{:?}", fit.responses);
}
