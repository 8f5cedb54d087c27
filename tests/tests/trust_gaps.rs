//! A fit over a recording with gaps allows for them: the parameters come back as from the whole. The swing is that of the
//! independent integrator.

#[path = "../../shared/tests/physics_reference/mod.rs"]
mod physics_reference;

use host::fit::identify::{Fit, Method, Options, fit};
use host::random::Noise;
use host::recording::segment::SegmentOptions;
use host::recording::{ReadOptions, read_bytes};
use host::swing::Swing;
use physics_reference::Reference;
use shared::parameters::Parameters;
use std::ops::Range;

const RATE_HZ: f64 = 200.0;

const SECONDS: f64 = 40.0;

const NOISE_RAD: f64 = 1e-3;

/// Held for a second, then a swing of the paper's pendulum; as a file without the samples in `gaps`, s.
fn file(gaps: &[Range<f64>]) -> String {
    let (mut pendulum, mut noise) = (Reference::release(&Parameters::paper(), None, 1.2, 0.0), Noise::new(3));
    let mut text = format!("# format: pendulum-recording 1\n# rate_hz: {RATE_HZ}\nt,theta\n");
    for k in 0..(SECONDS * RATE_HZ) as u32 {
        let time_s = f64::from(k) / RATE_HZ;
        if time_s >= 1.0 {
            pendulum.advance(1.0 / RATE_HZ);
        }
        let angle_rad = pendulum.angle_rad + NOISE_RAD * noise.normal();
        if !gaps.iter().any(|gap| gap.contains(&time_s)) {
            text += &format!("{time_s:.6},{angle_rad:.7}\n");
        }
    }
    text
}

fn fitted(gaps: &[Range<f64>]) -> Fit {
    let recording = read_bytes("gaps.csv", file(gaps).as_bytes(), &ReadOptions::default()).unwrap();
    let missing: usize = recording.gaps().iter().map(|gap| gap.n_missing.unwrap()).sum();
    let expected = gaps.iter().map(|gap| ((gap.end - gap.start) * RATE_HZ).round() as usize).sum();
    assert_eq!((recording.gaps().len(), missing), (gaps.len(), expected));
    let swing = Swing::from_recording("gaps.csv", &recording, &SegmentOptions::default()).unwrap().0;
    let mut rig = Parameters::paper();
    rig.pendulum.inertia_kg_m2 *= 1.03;
    rig.set_friction(5e-4, 5e-4, 5e-3, 0.03);
    fit(&[swing], &[], &rig, &Options { method: Method::LeastSquares, ranges: Vec::new() }, &|_| {}).unwrap()
}

/// Mw, Mc and I within 1 % of the truth, and the noise is what is left.
#[track_caller]
fn check(gaps: &[Range<f64>]) {
    let fit = fitted(gaps);
    let truth = Parameters::paper();
    let of = |symbol: &str| fit.identified.iter().find(|found| found.symbol == symbol).unwrap();
    for (symbol, truth) in
        [("Mw", truth.values(1).unwrap()[0]), ("Mc", truth.values(2).unwrap()[0]), ("I", truth.pendulum.inertia_kg_m2)]
    {
        let (value, std) = (of(symbol).value, of(symbol).std.unwrap());
        println!("{symbol}: {value:.4e} ± {std:.1e} instead of {truth:.4e}");
        let limit = (4.0 * std).max(2e-3 * truth);
        assert!((value - truth).abs() < limit && std < 0.01 * truth, "{symbol}: {value} ± {std} instead of {truth}");
    }
    assert!(fit.rmse_rad < 1.05 * NOISE_RAD, "{}", fit.rmse_rad);
}

#[test]
fn without_gaps() {
    check(&[]);
}

#[test]
fn many_short_gaps_change_nothing() {
    let gaps: Vec<Range<f64>> = (0..60).map(|k| 2.0 + 0.5 * f64::from(k)).map(|from| from..from + 0.08).collect();
    check(&gaps);
}

#[test]
fn long_gaps_change_nothing() {
    check(&[4.0..7.0, 11.5..12.5, 20.0..26.0]);
}
