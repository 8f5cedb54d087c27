//! Something touches the pendulum in the middle of a swing: it is told when and how much, and the numbers hold all the same.
//! And what is only missing from the model is no touch. The swing is that of the independent integrator.

#[path = "../../shared/tests/physics_reference/mod.rs"]
mod physics_reference;

use host::compare::compare;
use host::compare::measurement::Measurement;
use host::compare::verdict::Answer;
use host::diagnose::diagnose;
use host::fit::identify::{Fit, Method, Options, fit};
use host::random::Noise;
use host::recording::segment::SegmentOptions;
use host::recording::{ReadOptions, read_bytes};
use host::swing::Swing;
use physics_reference::{Law, Reference};
use shared::parameters::Parameters;

const RATE_HZ: f64 = 100.0;

const SECONDS: f64 = 26.0;

/// Of a dozen periods.
const SHORT_SECONDS: f64 = 11.0;

/// Held for a second, then a swing of the paper's pendulum, whose rate jumps at these times by so much, s and rad/s.
fn swing(law: Option<Law>, noise_rad: f64, jumps: &[(f64, f64)], seed: u64) -> Swing {
    swing_of(SECONDS, law, noise_rad, jumps, seed, |_| 0.0)
}

/// The same of another length, with what the sensor adds at each time, rad.
fn swing_of(
    seconds: f64,
    law: Option<Law>,
    noise_rad: f64,
    jumps: &[(f64, f64)],
    seed: u64,
    added_rad: impl Fn(f64) -> f64,
) -> Swing {
    let paper = Parameters::paper();
    let (mut pendulum, mut noise) = (Reference::release(&paper, law, 1.0, 0.0), Noise::new(seed));
    let mut text = format!("# format: pendulum-recording 1\n# rate_hz: {RATE_HZ}\nt,theta\n");
    for k in 0..(seconds * RATE_HZ) as u32 {
        let time_s = f64::from(k) / RATE_HZ;
        if time_s >= 1.0 {
            pendulum.advance(1.0 / RATE_HZ);
        }
        if let Some((_, jump_rad_s)) = jumps.iter().find(|(at_s, _)| (at_s - time_s).abs() < 0.5 / RATE_HZ) {
            let velocity_rad_s = pendulum.velocity_rad_s + jump_rad_s;
            pendulum = Reference::release(&paper, law, pendulum.angle_rad, velocity_rad_s);
        }
        let reading_rad = pendulum.angle_rad + added_rad(time_s) + noise_rad * noise.normal();
        text += &format!("{time_s:.6},{reading_rad:.7}\n");
    }
    let recording = read_bytes("touched.csv", text.as_bytes(), &ReadOptions::default()).unwrap();
    Swing::from_recording("touched.csv", &recording, &SegmentOptions::default()).unwrap().0
}

/// A rig that knows its geometry but for the inertia.
fn rig() -> Parameters<f64> {
    let mut rig = Parameters::paper();
    rig.pendulum.inertia_kg_m2 *= 1.03;
    rig.set_friction(5e-4, 5e-4, 5e-3, 0.03);
    rig
}

fn fitted(swings: &[Swing], method: Method) -> Fit {
    fit(swings, &[], &rig(), &Options { method, ranges: Vec::new() }, &|_| {}).unwrap()
}

/// Told are these jumps, each at its time and within its ±, the numbers are those of the paper, and only noise is left.
#[track_caller]
fn check(jumps: &[(f64, f64)], noise_rad: f64) {
    let fit = fitted(&[swing(None, noise_rad, jumps, 3)], Method::LeastSquares);
    assert_eq!(fit.touches.len(), jumps.len(), "{:?}", fit.touches);
    for (touch, (at_s, jump_rad_s)) in fit.touches.iter().zip(jumps) {
        println!("{touch:?}");
        assert!((touch.time_s - at_s).abs() < 0.1, "at {at_s} s: {touch:?}");
        assert!((touch.jump_rad_s - jump_rad_s).abs() < 3.0 * touch.std_rad_s, "{jump_rad_s} rad/s: {touch:?}");
    }
    let truth = Parameters::paper();
    let truths =
        [("Mw", truth.values(1).unwrap()[0]), ("Mc", truth.values(2).unwrap()[0]), ("I", truth.pendulum.inertia_kg_m2)];
    for (symbol, truth) in truths {
        let found = fit.identified.iter().find(|found| found.symbol == symbol).unwrap();
        let (value, std) = (found.value, found.std.unwrap());
        println!("{symbol}: {value:.4e} ± {std:.1e} instead of {truth:.4e}");
        let limit = (4.0 * std).max(2e-3 * truth);
        assert!((value - truth).abs() < limit && std < 0.02 * truth, "{symbol}: {value} ± {std} instead of {truth}");
    }
    assert!(fit.rmse_rad < 1.05 * noise_rad, "{}", fit.rmse_rad);
}

#[test]
fn a_light_touch_is_told_and_spoils_no_number() {
    check(&[(12.0, 0.05)], 1e-3);
}

#[test]
fn a_hard_touch_is_told_and_spoils_no_number() {
    check(&[(9.4, -0.4)], 1e-3);
}

#[test]
fn two_touches_are_told() {
    check(&[(8.0, 0.1), (18.0, -0.15)], 1e-3);
}

#[test]
fn a_swing_that_nothing_touched_has_no_touch() {
    for seed in 0..6 {
        let fit = fitted(&[swing(None, 1e-3, &[], seed)], Method::LeastSquares);
        assert_eq!(fit.touches, [], "{seed}");
    }
}

/// No place of a dozen periods stands out of the others, but both parts are explained.
#[test]
fn a_touch_of_a_short_swing_is_told() {
    for (at_s, jump_rad_s) in [(5.0, 0.3), (5.5, -0.1), (6.3, 0.2)] {
        let swings = [swing_of(SHORT_SECONDS, None, 1e-3, &[(at_s, jump_rad_s)], 3, |_| 0.0)];
        let fit = fitted(&swings, Method::LeastSquares);
        assert!(fit.touches.len() == 1 && (fit.touches[0].time_s - at_s).abs() < 0.2, "{at_s} {:?}", fit.touches);
        assert!(fit.rmse_rad < 1.05e-3, "{at_s} {}", fit.rmse_rad);
        assert_eq!(diagnose(&swings, &[], &rig()).touches.len(), 1);
    }
}

/// Another start would explain that as well, with another zero.
#[test]
fn a_zero_that_jumps_in_a_short_swing_is_no_touch() {
    for (at_s, size_rad) in [(5.0, 0.01), (5.2, 0.03), (5.5, 0.01), (5.7, -0.03), (6.1, 0.03)] {
        let jumps = |time_s: f64| if time_s < at_s { 0.0 } else { size_rad };
        let fit = fitted(&[swing_of(SHORT_SECONDS, None, 1e-3, &[], 3, jumps)], Method::LeastSquares);
        assert!(fit.rmse_rad > 2.0 * fit.noise_rad, "{at_s}: {} of {}", fit.rmse_rad, fit.noise_rad);
        assert_eq!(fit.touches, [], "{at_s}");
    }
}

/// Drag of the air, a detent of twelve notches, a spring, and friction that depends on the side: all of them leave many
/// times the noise.
#[test]
fn what_is_missing_from_the_model_is_no_touch() {
    let laws: [Law; 4] = [
        |_, velocity, _| -2e-4 * velocity * velocity.abs(),
        |angle, _, _| -3e-3 * (12.0 * angle).sin(),
        |angle, _, _| -0.05 * angle.powi(3),
        |angle, _, direction| if angle > 0.0 { -6e-4 * direction } else { 0.0 },
    ];
    for (k, law) in laws.into_iter().enumerate() {
        for seconds in [SECONDS, SHORT_SECONDS] {
            let fit = fitted(&[swing_of(seconds, Some(law), 1e-4, &[], 5, |_| 0.0)], Method::LeastSquares);
            assert!(fit.rmse_rad > 2.0 * fit.noise_rad, "law {k} is seen: {} of {}", fit.rmse_rad, fit.noise_rad);
            assert_eq!(fit.touches, [], "law {k}");
        }
    }
}

#[test]
fn a_touch_beside_missing_physics_is_told() {
    let law: Law = |_, velocity, _| -2e-4 * velocity * velocity.abs();
    let fit = fitted(&[swing(Some(law), 1e-3, &[(12.0, 0.2)], 5)], Method::LeastSquares);
    assert!(fit.touches.len() == 1 && (fit.touches[0].time_s - 12.0).abs() < 0.1, "{:?}", fit.touches);
}

#[test]
fn what_spoils_the_numbers_is_said_with_what_to_do_next() {
    let swings = [swing(None, 1e-3, &[(12.0, 0.1)], 3)];
    let said = |method| fitted(&swings, method).warnings[0].clone();
    let anew = said(Method::LeastSquares);
    assert!(anew.starts_with("something touched the pendulum at 1") && anew.contains("spoils no number"), "{anew}");
    assert!(anew.contains("host fit touched.csv --from 12."), "{anew}");
    assert!(said(Method::Rsm).contains("which spoils the numbers"), "{}", said(Method::Rsm));
}

#[test]
fn a_diagnosis_names_the_touch_and_no_missing_physics() {
    let found = diagnose(&[swing(None, 1e-3, &[(12.0, 0.2)], 3)], &[], &rig());
    assert_eq!((found.touches.len(), found.verdict.len(), found.unexplained), (1, 0, false), "{:?}", found.verdict);
}

#[test]
fn a_comparison_tells_the_touch_before_anything_else() {
    let swings = [swing(None, 1e-3, &[(12.0, 0.2)], 3)];
    let fit = fitted(&swings, Method::LeastSquares);
    let measurement = Measurement::of_swing(swings[0].clone());
    for question_numbers in [false, true] {
        let options = host::compare::Options { question_numbers, ..host::compare::Options::default() };
        let found = compare(&fit.parameters, std::slice::from_ref(&measurement), &[], &options).unwrap();
        assert_eq!((found.touches.len(), found.answer), (1, Answer::NothingMissing), "{:?}", found.verdict);
        assert!(found.verdict[1].starts_with("Something touched the pendulum at 1"), "{:?}", found.verdict);
        // Of the longer part, from the release on.
        let judged = &found.recordings[0];
        assert!((10.9..11.5).contains(&judged.from_s) && judged.duration_s > 12.0, "{} s", judged.from_s);
    }
}

/// A fit to both parts of it tells so, in place of numbers that do not fit.
#[test]
fn a_comparison_of_a_short_swing_blames_the_touch_and_no_number() {
    let swings = [swing_of(SHORT_SECONDS, None, 1e-3, &[(5.0, 0.3)], 3, |_| 0.0)];
    let fit = fitted(&swings, Method::LeastSquares);
    assert_eq!(fit.touches.len(), 1);
    let options = host::compare::Options { question_numbers: true, ..host::compare::Options::default() };
    let measurement = Measurement::of_swing(swings[0].clone());
    let found = compare(&fit.parameters, &[measurement], &[], &options).unwrap();
    assert_eq!((found.touches.len(), found.answer), (1, Answer::NothingMissing), "{:?}", found.verdict);
}
