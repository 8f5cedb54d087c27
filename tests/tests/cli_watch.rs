//! `host watch` on simulated rigs: what is missing is named with its size, nothing is named where nothing is missing, and
//! why.

use host::look::Look;
use host::record::{Listener as _, Stage};
use host::sim::Scenario;
use host::watch::{Event, Watcher};
use serde_json::Value;
use shared::model::Model;
use shared::parameters::Parameters;
use std::path::Path;
use tests::program::host;

fn watched(port: &str) -> Value {
    let run = host(Path::new("."), &format!("watch --port {port} --json --quiet"));
    serde_json::from_str(run.succeeded()).unwrap()
}

/// Names that may stand for what is missing: the first and those that can't be told from it.
fn possible(look: &Value) -> Vec<&str> {
    let candidates = look["candidates"].as_array().unwrap();
    let is_possible = |(place, candidate): &(usize, &Value)| *place == 0 || candidate["tied"] == true;
    let names = candidates.iter().enumerate().filter(is_possible);
    names.map(|(_, candidate)| candidate["name"].as_str().unwrap()).collect()
}

#[test]
fn a_hidden_drag_is_named_with_its_size_within_five_releases() {
    let look = watched("sim:mystery-1");
    assert_eq!(look["named"], serde_json::json!(["quadratic-drag"]), "{look:#}");
    assert!(look["swings"].as_u64().unwrap() <= 5 && look["reason"].is_null() && look["judge"] == "rig");
    let number = &look["candidates"][0]["values"][0];
    let (size, std) = (number["value"].as_f64().unwrap(), number["std"].as_f64().unwrap());
    let truth = Scenario::by_name("mystery-1").unwrap().truth[0].1;
    assert!((size / truth - 1.0).abs() < 0.03 && std > 0.0 && number["unit"] == "N·m·s²/rad²", "{number}");
    assert!(
        look["candidates"][0]["p"].as_f64().unwrap() < 1e-3 && look["candidates"][0]["windows"].as_u64() >= Some(8)
    );
}

#[test]
fn where_nothing_is_missing_nothing_is_named_but_wrong_numbers_are_told() {
    // Of five releases the rig's memory holds the last three.
    let rigs = [("sim", 3, "rig"), ("sim:mystery-4 --swings 2", 2, "rig"), ("sim:old-firmware", 5, "program")];
    for (port, swings, judge) in rigs {
        let look = watched(port);
        assert_eq!(look["named"], serde_json::json!([]), "{port}: {look:#}");
        // The rig's own friction and inertia are those of a drawing.
        assert!(look["reason"].as_str().unwrap().starts_with("numbers are wrong"), "{port}: {look:#}");
        assert_eq!((&look["swings"], &look["judge"]), (&serde_json::json!(swings), &serde_json::json!(judge)));
        let watched = if port.ends_with("--swings 2") { 2 } else { 5 };
        assert_eq!(look["watched"], watched, "{port}: {look:#}");
    }
}

#[test]
fn what_else_is_hidden_is_named_or_told_as_not_to_be_told_apart() {
    for name in ["mystery-2", "mystery-3", "mystery-7"] {
        let look = watched(&format!("sim:{name}"));
        let truth = Scenario::by_name(name).unwrap().hidden_effects();
        assert!(!look["named"].as_array().unwrap().is_empty(), "{name}: {look:#}");
        assert!(possible(&look).contains(&truth[0]), "{name} hides {truth:?}: {:?}", possible(&look));
    }
}

/// Within one release friction that fades with time looks like a law of speed, because the amplitude falls too.
#[test]
fn friction_that_drifts_takes_more_than_one_release() {
    let look = watched("sim:mystery-6");
    assert!(look["swings"].as_u64().unwrap() > 1, "{look:#}");
    assert!(possible(&look).contains(&"drifting-friction"), "{look:#}");
}

#[test]
fn a_person_reads_a_sentence_and_bars() {
    let run = host(Path::new("."), "watch --port sim:mystery-1 --swings 1");
    let text = run.succeeded();
    assert!(text.starts_with("The rig itself names what is missing: quadratic-drag (Cq = ("), "{text}");
    assert!(text.contains(", after one release."), "{text}");
    assert!(text.contains("quadratic-drag            █"), "{text}");
    assert!(run.stderr.contains("released: watching"), "{}", run.stderr);
}

#[test]
fn a_wire_that_is_broken_or_breaks_names_no_effect_but_the_wire() {
    for name in ["broken-wire", "loose-wire"] {
        let run = host(Path::new("."), &format!("watch --port sim:{name} --json"));
        run.failed(1, &["code 0", "wires"]);
        assert_eq!(run.stdout, "", "{name}");
    }
}

const RATE_HZ: f64 = 500.0;

/// Steps of a converter: without any noise there is nothing to test against.
const STEP_RAD: f64 = 1.4e-3;

/// What a watcher says of a swing of the paper's pendulum in thick air, with a gap after so many seconds.
fn heard(drag: f64, gap_after_s: Option<f64>) -> Look {
    let mut truth = Parameters::paper();
    truth.set(10, &[drag]).unwrap();
    let (model, mut tell) = (Model::new(&truth), |_: Event| ());
    let mut watcher = Watcher::new(Parameters::paper(), RATE_HZ, &mut tell);
    watcher.stage(Stage::Swinging);
    let mut state = model.release(1.4, 0.0);
    for n in 0..12_000 {
        watcher.reading((state.angle_rad / STEP_RAD).round() * STEP_RAD);
        if gap_after_s == Some(f64::from(n) / RATE_HZ) {
            (0..300).for_each(|_| model.step(&mut state, 1.0 / RATE_HZ));
            watcher.gap();
        }
        model.step(&mut state, 1.0 / RATE_HZ);
    }
    watcher.rests()
}

#[test]
fn a_gap_in_the_swing_changes_nothing_of_what_is_missing() {
    for gap_after_s in [None, Some(7.0)] {
        let look = heard(2e-4, gap_after_s);
        assert_eq!(look.named, ["quadratic-drag"], "{gap_after_s:?}: {look:?}");
        let number = &look.candidates[0].values[0];
        assert!((number.value / 2e-4 - 1.0).abs() < 0.05, "{gap_after_s:?}: {number:?}");
    }
}
