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
