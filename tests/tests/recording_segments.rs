//! Cutting recordings of real and of simulated rigs: release, free swing, rest.

use std::path::{Path, PathBuf};

use host::recording::segment::{SegmentOptions, Segments, segment};
use host::recording::{ReadOptions, Recording, read};
use serde_json::Value;

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../host/data/recordings").join(name)
}

fn load(name: &str) -> Recording {
    read(&data(name), &ReadOptions::default()).unwrap()
}

fn cut(recording: &Recording) -> Segments {
    segment(recording, &SegmentOptions::default()).unwrap()
}

/// One release of a simulated rig with what is known about it.
struct Release {
    name: String,
    recording: Recording,
    release_s: f64,
    stop_s: f64,
}

fn releases() -> Vec<Release> {
    let mut releases = Vec::new();
    for case in 1..=8 {
        let truth = std::fs::read_to_string(data(&format!("hidden/p{case:02}/truth.json"))).unwrap();
        let truth: Value = serde_json::from_str(&truth).unwrap();
        for (idx, release) in truth["releases"].as_array().unwrap().iter().enumerate() {
            let name = format!("hidden/p{case:02}/release_{}.csv", idx + 1);
            let recording = load(&name);
            let number = |key: &str| release[key].as_f64().unwrap();
            releases.push(Release { recording, release_s: number("t_release"), stop_s: number("t_stop"), name });
        }
    }
    releases
}

#[test]
fn the_free_swing_begins_within_60_ms_after_every_hidden_release_and_never_before() {
    for Release { name, recording, release_s, .. } in releases() {
        let segments = cut(&recording);
        let late_s = recording.times_s()[segments.free.start] - release_s;
        println!("{name}: fitted {:+.4} s, free {late_s:+.4} s", segments.release_s - release_s);
        assert!((0.0..0.06).contains(&late_s), "{name}: {late_s} {:?}", segments.notes);
    }
}

#[test]
fn every_fourth_sample_suffices_to_find_the_hidden_releases() {
    for Release { name, recording, release_s, .. } in releases() {
        let every_fourth = |values: &[f64]| values.iter().copied().step_by(4).collect::<Vec<f64>>();
        let (times_s, angles_rad) = (every_fourth(recording.times_s()), every_fourth(recording.angles_rad()));
        let slow = Recording::new(recording.header().clone(), times_s, angles_rad, None).unwrap();
        let late_s = slow.times_s()[cut(&slow).free.start] - release_s;
        println!("{name} at {:.0} Hz: free {late_s:+.4} s", slow.rate_hz());
        // Up to one step of the slow recording (20 ms) later than at full rate.
        assert!((0.0..0.08).contains(&late_s), "{name}: {late_s}");
    }
}

/// A number in −1..1 that looks random, from a seed (Steele, Lea, Flood 2014: splitmix64).
fn scramble(seed: u64) -> f64 {
    let mut bits = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((bits ^ (bits >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

#[test]
fn more_noise_and_a_lead_in_of_a_fifth_of_a_second_do_not_hide_a_release_or_a_stop() {
    // Three steps of the converter, white.
    let half_width_rad = 3.0 * 1.449e-3 * 3f64.sqrt();
    for (seed, Release { name, recording, release_s, stop_s }) in releases().into_iter().enumerate() {
        let start = recording.index_at(release_s - 0.2);
        let noisy = |idx: usize| {
            let random = scramble((seed * 1_000_000 + idx) as u64);
            -recording.angles_rad()[idx] + half_width_rad * random
        };
        let times_s = recording.times_s()[start..].to_vec();
        let angles_rad = (start..recording.len()).map(noisy).collect();
        let noisy = Recording::new(recording.header().clone(), times_s, angles_rad, None).unwrap();
        let segments = cut(&noisy);
        let late_s = noisy.times_s()[segments.free.start] - release_s;
        let rest_late_s = segments.rest.as_ref().map(|rest| noisy.times_s()[rest.start] - stop_s);
        println!("{name} noisier: free {late_s:+.4} s, rest {rest_late_s:?}");
        assert!((0.0..0.08).contains(&late_s), "{name}: {late_s}");
        assert!(rest_late_s.is_some_and(|late_s| late_s > 0.0), "{name}: {rest_late_s:?}");
    }
}

/// A pendulum held at 0.8 rad and let go at 0.6 s, with dry and viscous friction: `α = −70 sin θ − 0.1 ω − 0.4 sgn ω`,
/// ten small steps a sample.
fn let_go_at_600_ms(rate_hz: f64) -> Recording {
    let (mut angle, mut velocity) = (0.8_f64, 0.0_f64);
    let dt_s = 0.1 / rate_hz;
    let n_held = (0.6 * rate_hz).round() as usize;
    let mut read = |idx: usize| {
        for _ in 0..if idx > n_held { 10 } else { 0 } {
            let dry = if velocity == 0.0 { 0.0 } else { 0.4 * velocity.signum() };
            velocity += dt_s * (-70.0 * angle.sin() - 0.1 * velocity - dry);
            angle += dt_s * velocity;
        }
        ((angle + 1e-3 * scramble(idx as u64)) / 3e-4).round() * 3e-4
    };
    let angles_rad = (0..(8.0 * rate_hz) as usize).map(&mut read).collect();
    Recording::uniform(rate_hz, angles_rad).unwrap()
}

#[test]
fn a_release_is_found_to_a_few_ms_at_every_rate() {
    for rate_hz in [100.0, 1000.0, 5000.0, 10_000.0, 20_000.0] {
        let recording = let_go_at_600_ms(rate_hz);
        let segments = cut(&recording);
        let late_s = segments.release_s - 0.6;
        println!("{rate_hz} Hz: {:+.2} ms", 1e3 * late_s);
        assert!(late_s.abs() < 0.005, "{rate_hz} Hz: {late_s}");
        let free_late_s = recording.times_s()[segments.free.start] - 0.6;
        assert!((0.0..0.03).contains(&free_late_s), "{rate_hz} Hz: {free_late_s}");
    }
}

#[test]
fn the_lead_in_ends_before_every_hidden_release() {
    for Release { name, recording, release_s, .. } in releases() {
        let lead_in = cut(&recording).lead_in.expect(&name);
        assert_eq!(lead_in.start, 0);
        let early_s = release_s - recording.times_s()[lead_in.end - 1];
        assert!((0.0..0.05).contains(&early_s), "{name}: {early_s}");
    }
}

#[test]
fn the_rest_begins_after_every_hidden_stop() {
    for Release { name, recording, stop_s, .. } in releases() {
        let rest = cut(&recording).rest.expect(&name);
        let late_s = recording.times_s()[rest.start] - stop_s;
        println!("{name}: rest {late_s:+.3} s");
        assert!((0.0..3.0).contains(&late_s), "{name}: {late_s}");
        assert_eq!(rest.end, recording.len());
    }
}

/// Begin and end of the free swing, s, with everything that was noted.
fn free_s(name: &str) -> (f64, f64, Segments) {
    let recording = load(name);
    let segments = cut(&recording);
    let (start, end) = (segments.free.start, segments.free.end);
    println!("{name}: {:?}", segments);
    (recording.times_s()[start], recording.times_s()[end - 1], segments)
}

#[test]
fn the_hand_at_the_start_of_the_short_pendulum_is_cut() {
    let (start_s, end_s, segments) = free_s("real/jensenbenard_hand_on_start.csv");
    assert!((0.3..0.75).contains(&start_s), "{start_s}");
    assert!(end_s > 4.9, "{end_s}");
    assert!(segments.notes[0].contains("hand"), "{:?}", segments.notes);
}

#[test]
fn the_short_pendulum_swings_freely_almost_from_the_start() {
    let (start_s, _, _) = free_s("real/jensenbenard_free_swing.csv");
    assert!((0.1..0.4).contains(&start_s), "{start_s}");
}

#[test]
fn the_arm_lifted_by_hand_is_free_after_it_was_let_go() {
    let (start_s, end_s, segments) = free_s("real/dynamicslab_single_arm.csv");
    assert!((4.86..5.6).contains(&start_s), "{start_s}");
    assert!((85.0..93.0).contains(&end_s), "{end_s}");
    assert!(segments.lead_in.is_some_and(|lead_in| lead_in.len() > 350));
    assert!(segments.rest.is_some());
}

#[test]
fn the_string_pendulum_is_free_throughout_and_never_rests() {
    let (start_s, end_s, segments) = free_s("real/tylertian_string.csv");
    assert!(start_s < 0.6, "{start_s}");
    assert!(end_s > 116.0, "{end_s}");
    assert!(segments.rest.is_none());
}

#[test]
fn the_rebuilt_recording_of_the_paper_is_free_from_its_first_sample() {
    for name in ["reconstructed_recording.csv", "reconstructed_recording_noisy.csv"] {
        let recording = load(&format!("../paper/{name}"));
        let segments = cut(&recording);
        println!("{name}: {segments:?}");
        assert_eq!(segments.free.start, 0, "{name}: {segments:?}");
    }
}

/// A swing of 20 s from 1.2 rad, and the rest of two hours at 100 Hz, in a noise of 1 mrad and an unstated unit.
#[test]
fn two_hours_of_rest_hide_neither_the_swing_before_nor_its_unit() {
    let (mut angle, mut velocity) = (1.2, 0.0_f64);
    let mut swing = Vec::new();
    for step in 0..200_000 {
        if step % 100 == 0 {
            swing.push(angle);
        }
        let acceleration = -40.0 * f64::sin(angle) - 0.8 * velocity.signum();
        velocity = if velocity.abs() < 1e-4 && angle.abs() < 0.02 { 0.0 } else { velocity + 1e-4 * acceleration };
        angle += 1e-4 * velocity;
    }
    let noise = |row: u64| 1e-3 * (0..4).map(|idx| scramble(4 * row + idx)).sum::<f64>() * 0.75_f64.sqrt();
    let reading = |row: u64| swing.get(row as usize).or(swing.last()).unwrap() + noise(row);
    let rows = (0..720_000).map(|row| format!("{:.2},{:.5}\n", row as f64 / 100.0, reading(row)));
    let text = format!("t,theta\n{}", rows.collect::<String>());
    let recording = host::recording::read_bytes("long.csv", text.as_bytes(), &ReadOptions::default()).unwrap();
    let notes = recording.notes().join("; ");
    assert!(!notes.contains("up to 0."), "{notes}");
    let segments = cut(&recording);
    let rest_s = recording.times_s()[segments.rest.unwrap().start];
    assert!((8.0..25.0).contains(&rest_s) && segments.n_turning_points > 20, "{rest_s} {:?}", segments.notes);
}
