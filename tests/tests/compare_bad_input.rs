//! Recordings that do not fit the model at all, or too little of one: said so, with the most likely reason.

mod compare_support;

use compare_support::{Release, measurement, readings, rig};
use host::compare::measurement::Measurement;
use host::compare::verdict::Answer;
use host::compare::{CompareError, Comparison, Options, compare};
use host::noise;
use host::swing::Swing;

/// A swing of the rig, then changed.
fn changed(change: impl Fn(f64, f64) -> (f64, f64)) -> Comparison {
    let (times_s, angles_rad) = readings(&rig(), &Release::of(1.3, 5));
    let (times_s, angles_rad): (Vec<f64>, Vec<f64>) =
        times_s.iter().zip(&angles_rad).map(|(time_s, angle_rad)| change(*time_s, *angle_rad)).unzip();
    judged(&times_s, &angles_rad)
}

fn judged(times_s: &[f64], angles_rad: &[f64]) -> Comparison {
    let found = noise::of_samples(times_s, angles_rad, None);
    let swing = Swing::new("strange.csv", times_s, angles_rad, found.total_rms);
    let comparison = compare(&rig(), &[Measurement::of_swing(swing)], &[], &Options::default()).unwrap();
    println!("{}", comparison.verdict.join("\n"));
    comparison
}

fn check_reason(comparison: &Comparison, words: &str) {
    assert_eq!(comparison.answer, Answer::DoesNotFit);
    let reason = &comparison.mismatches[0].reason;
    assert!(reason.contains(words), "{reason}");
    assert!(comparison.verdict.iter().any(|sentence| sentence.contains(words)));
}

#[test]
fn degrees_are_recognised() {
    check_reason(&changed(|t, angle| (t, angle.to_degrees())), "in degrees");
}

#[test]
fn angles_converted_twice_are_recognised() {
    check_reason(&changed(|t, angle| (t, angle.to_radians())), "57.3 times too small");
}

#[test]
fn turns_are_recognised() {
    check_reason(&changed(|t, angle| (t, angle / std::f64::consts::TAU)), "in turns");
}

#[test]
fn a_zero_at_the_top_is_recognised() {
    check_reason(&changed(|t, angle| (t, angle + std::f64::consts::PI)), "zero seems to be at the top");
}

#[test]
fn milliseconds_are_recognised() {
    check_reason(&changed(|t, angle| (1e3 * t, angle)), "milliseconds");
}

#[test]
fn another_pendulum_is_recognised_by_its_inertia() {
    let mut other = rig();
    other.pendulum.inertia_kg_m2 *= 2.5;
    let (times_s, angles_rad) = readings(&other, &Release::of(1.3, 5));
    check_reason(&judged(&times_s, &angles_rad), "another pendulum");
}

#[test]
fn a_driven_pendulum_is_recognised() {
    let growing = |t: f64, _| (t, 0.2 * (0.03 * t).exp() * (5.9 * t).cos());
    check_reason(&changed(growing), "driven");
}

#[test]
fn a_zero_that_is_somewhat_off_is_noted() {
    let comparison = changed(|t, angle| (t, angle + 0.2));
    assert_eq!(comparison.answer, Answer::NothingMissing);
    assert!(comparison.recordings[0].notes.iter().any(|note| note.contains("zero is off")));
}

#[test]
fn a_short_recording_without_rest_or_lead_in_names_what_cannot_be_judged() {
    let (times_s, angles_rad) = readings(&rig(), &Release { seconds: 3.0, ..Release::of(0.5, 5) });
    let comparison = judged(&times_s, &angles_rad);
    let limits = comparison.limits.join(" ");
    for words in ["record longer", "comes to rest", "no still stretch", "release from 1.4 rad"] {
        assert!(limits.contains(words), "{words}: {limits}");
    }
}

/// Dry friction takes it off a swing that is well seen.
#[test]
fn a_pendulum_that_hangs_still_at_the_end_comes_to_rest() {
    let mut rubbing = rig();
    rubbing.set_friction(5e-4, 7e-3, 1e-2, 0.0);
    let (times_s, angles_rad) = readings(&rubbing, &Release { seconds: 15.0, ..Release::of(1.3, 5) });
    let limits = judged(&times_s, &angles_rad).limits.join(" ");
    assert!(!limits.contains("comes to rest"), "{limits}");
}

#[test]
fn very_short_and_motionless_swings_do_no_harm() {
    for (seconds, angle_rad) in [(0.1, 1.0), (0.6, 1.0), (20.0, 0.0)] {
        let (times_s, angles_rad) = readings(&rig(), &Release { seconds, ..Release::of(angle_rad, 5) });
        let comparison = judged(&times_s, &angles_rad);
        assert!(!comparison.verdict.is_empty());
        serde_json::to_string(&comparison).unwrap();
        assert!(host::report::report(&comparison).contains("</html>"));
    }
}

#[test]
fn no_recording_is_refused() {
    assert_eq!(compare(&rig(), &[], &[], &Options::default()).unwrap_err(), CompareError::NoRecording);
}

#[test]
fn a_pendulum_still_in_the_hand_spoils_the_fit_and_is_seen() {
    let kept_in = measurement("real/jensenbenard_hand_on_start.csv", Some(0.0));
    assert!(kept_in.from_s < 0.01);
    let mut rig = compare_support::normalised(&kept_in);
    rig.set_friction(2.0e-3, 1.56e-2, 1.6e-2, 0.0);
    let comparison = compare(&rig, &[kept_in], &[], &Options::default()).unwrap();
    println!("{}", comparison.verdict.join("\n"));
    assert_ne!(comparison.answer, Answer::NothingMissing);
}
