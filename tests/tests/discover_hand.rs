//! A hand that was still pushing while the recording ran is no law of the pendulum: it is never named as an effect.
//!
//! The independent plant swings with nothing hidden. In the first 2, 5 or 10 s the angle is that of a pendulum which is
//! led: its swings are too wide or too narrow by some 5 to 30 %, with a wobble of the hand's own, and both fade away.

mod compare_support;

use compare_support::{measurement, normalised};
use host::diagnose::diagnose;
use host::recording::Recording;
use host::recording::segment::SegmentOptions;
use host::swing::Swing;
use std::f64::consts::{FRAC_PI_2, TAU};
use tests::hidden::{Random, Rig};

/// The hand lets go after one of these, s.
const HANDS_S: [f64; 3] = [2.0, 5.0, 10.0];

/// The angles as a hand led them until so many seconds after the first.
fn led(times_s: &[f64], angles_rad: &[f64], until_s: f64, random: &mut Random) -> Vec<f64> {
    let widened = random.sign() * random.log_between(0.05, 0.3);
    let largest = angles_rad.iter().fold(0.0_f64, |largest, angle| largest.max(angle.abs()));
    let wobble_rad = largest * random.log_between(0.01, 0.05);
    let (wobbles_hz, phase) = (random.between(0.2, 2.0), random.between(0.0, TAU));
    let at = |(time_s, angle_rad): (&f64, &f64)| {
        let since_s = time_s - times_s[0];
        let grip = (FRAC_PI_2 * since_s / until_s).min(FRAC_PI_2).cos().powi(2);
        angle_rad * (1.0 + widened * grip) + wobble_rad * grip * (TAU * wobbles_hz * since_s + phase).sin()
    };
    times_s.iter().zip(angles_rad).map(at).collect()
}

fn swing_of(name: &str, recording: &Recording, angles_rad: Vec<f64>) -> Option<Swing> {
    let led = Recording::new(recording.header().clone(), recording.times_s().to_vec(), angles_rad, None).unwrap();
    Swing::from_recording(name, &led, &SegmentOptions::default()).ok().map(|(swing, _)| swing)
}

/// Names that the diagnosis of a simulated rig gives which nobody hid, where a hand led the first release.
fn accused(seed: u64, until_s: f64) -> Vec<&'static str> {
    let rig = Rig { rate_hz: 100.0, offset_rad: 0.0, ..Rig::random(seed) };
    // Every other one has a single release.
    let n_releases = if seed.is_multiple_of(2) { 1 } else { rig.releases_rad.len() };
    let rig = Rig { releases_rad: rig.releases_rad[..n_releases].to_vec(), ..rig };
    let mut random = Random::new(seed ^ 0x4a11d);
    let of_release = |release_idx: usize| {
        let recording = rig.recording(release_idx);
        let angles_rad = match release_idx {
            0 => led(recording.times_s(), recording.angles_rad(), until_s, &mut random),
            _ => recording.angles_rad().to_vec(),
        };
        swing_of(&format!("release {}", release_idx + 1), &recording, angles_rad)
    };
    let swings: Vec<Swing> = (0..rig.releases_rad.len()).filter_map(of_release).collect();
    let diagnosis = diagnose(&swings, &[], &rig.known());
    println!(
        "{seed}, {until_s} s, {} releases: {:?}, not claimed {:?}, {:.1} noises left",
        swings.len(),
        diagnosis.verdict,
        diagnosis.unproven.iter().map(|claim| (claim.effect, claim.p, claim.value, claim.std)).collect::<Vec<_>>(),
        diagnosis.rmse_after / rig.total_noise_rad()
    );
    diagnosis.verdict
}

#[test]
fn a_hand_on_a_simulated_rig_is_no_effect() {
    for (place, until_s) in HANDS_S.into_iter().cycle().take(6).enumerate() {
        assert!(accused(9_000 + place as u64, until_s).is_empty(), "{place}");
    }
}

#[test]
#[ignore = "takes minutes: tests/more hands"]
fn a_hundred_hands_are_no_effect() {
    let n_accused = (0..90).filter(|k| !accused(9_100 + k, HANDS_S[*k as usize % 3]).is_empty()).count();
    assert_eq!(n_accused, 0, "of 90 rigs");
}

/// Real swings: a hand adds no effect to those that are named, or can't be told from them, without it.
#[test]
#[ignore = "takes minutes: tests/more hands"]
fn a_hand_on_a_real_pendulum_adds_no_effect() {
    for (name, from_s) in
        [("tylertian_string", None), ("dynamicslab_single_arm", Some(14.2)), ("more/jlefebvre_full", None)]
    {
        let measured = measurement(&format!("real/{name}.csv"), from_s);
        let (rig, swing) = (normalised(&measured), &measured.swing);
        let free = diagnose(std::slice::from_ref(swing), &[], &rig);
        for until_s in HANDS_S {
            let angles_rad = led(&swing.times_s, &swing.angles_rad, until_s, &mut Random::new(until_s as u64));
            let spoilt = Swing::new(name, &swing.times_s, &angles_rad, swing.noise_rad);
            let found = diagnose(&[spoilt], &[], &rig);
            println!(
                "{name}, {until_s} s: {:?}; without a hand {:?} {:?}",
                found.verdict, free.verdict, free.undecided
            );
            let is_known = |name: &&str| free.verdict.contains(name) || free.undecided.contains(name);
            assert!(found.verdict.iter().all(is_known), "{name}: {:?}", found.verdict);
        }
    }
}
