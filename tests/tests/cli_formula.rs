//! Formulas of one's own from the command line: simulated, fitted, stored in the model file, pushed, pulled back.
#![cfg(target_os = "linux")]

use shared::rig::{Outcome, Rig};
use shared::wire::{Answer, Deframer, Frame, MAX_FRAME, Refusal, StoreState, encode};
use tests::device::Device;
use tests::program::{host, host_with};

const LAW: &str = "torque = -k*omega*abs(omega)^p; k in 0..1e-3 N·m; p in 0..3";

/// A model file, and two swings with a law that grows with the cube of speed.
fn bench() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    host(folder.path(), "init --mass 0.1466084 --length 0.1562177 --inertia 0.00284252 -o rig.toml").succeeded();
    for (start, file) in [("1.4", "one.csv"), ("-0.8", "two.csv")] {
        let arguments = ["simulate", "--effect", "-k*omega^3; k in 0..1e-4", "--with", "k=2e-5", "--rate", "100"];
        let more = ["--seconds", "25", "--start", start, "-o", file];
        host_with(folder.path(), &[&arguments[..], &more].concat()).succeeded();
    }
    folder
}

#[test]
fn a_formula_is_fitted_stored_run_on_the_rig_and_pulled_back() {
    let folder = bench();
    let fit = ["fit", "one.csv", "two.csv", "--method", "least-squares", "--effect", LAW, "-o", "fitted.toml"];
    host_with(folder.path(), &fit).succeeded();
    let file = std::fs::read_to_string(folder.path().join("fitted.toml")).unwrap();
    assert!(file.contains("[effect.custom]") && file.contains(LAW), "{file}");
    let model = host::rigfile::RigFile::load(&folder.path().join("fitted.toml")).unwrap();
    let values = model.parameters().values(1000).unwrap().to_vec();
    assert!((values[0] / 2e-5 - 1.0).abs() < 0.15 && (values[1] - 2.0).abs() < 0.06, "{values:?}");

    let device = Device::rig("plain");
    host(folder.path(), &format!("push --rig fitted.toml --port {}", device.port)).succeeded();
    host(folder.path(), &format!("pull --port {} -o pulled.toml", device.port)).succeeded();
    let pulled = host::rigfile::RigFile::load(&folder.path().join("pulled.toml")).unwrap();
    let rounded = |values: &[f64]| values.iter().map(|value| *value as f32).collect::<Vec<f32>>();
    assert_eq!(pulled.parameters().formula, model.parameters().formula);
    assert_eq!(rounded(pulled.parameters().values(1000).unwrap()), rounded(&values));

    let removed = host(folder.path(), "improve one.csv two.csv --rig fitted.toml --remove custom --json");
    let removed: serde_json::Value = serde_json::from_str(removed.succeeded()).unwrap();
    let rmse = |step: usize| removed["steps"][step]["rmse"].as_f64().unwrap();
    assert!(rmse(1) > 1.5 * rmse(0), "{removed}");
}

#[test]
fn a_wrong_formula_is_refused_with_its_place_marked() {
    let folder = tempfile::tempdir().unwrap();
    let refused = host_with(folder.path(), &["simulate", "--effect", "-k*omga; k in 0..1", "-o", "x.csv"]);
    refused.failed(2, &["omga is unknown", "  -k*omga; k in 0..1\n     ^^^^"]);
    let refused = host_with(folder.path(), &["simulate", "--effect", "1/theta", "-o", "x.csv"]);
    refused.failed(2, &["no finite value at theta = 0.000"]);
    let model = host(folder.path(), "init --mass 0.1466084 --length 0.1562177 --inertia 0.00284252 -o rig.toml");
    model.succeeded();
    let path = folder.path().join("rig.toml");
    let file =
        std::fs::read_to_string(&path).unwrap() + "\n[effect.custom]\nformula = \"-k*omega; k in 1..0\"\nk = 1\n";
    std::fs::write(&path, file).unwrap();
    host(folder.path(), "simulate -o x.csv")
        .failed(1, &["rig.toml, line", "effect.custom.formula", "range of k is empty"]);
}

#[test]
fn a_plan_ranks_experiments_by_what_they_would_tell() {
    let folder = bench();
    let planned = host(folder.path(), "plan one.csv two.csv --json");
    let planned: serde_json::Value = serde_json::from_str(planned.succeeded()).unwrap();
    let experiments = planned["experiments"].as_array().unwrap();
    let worst: Vec<f64> = experiments.iter().map(|experiment| experiment["worst"].as_f64().unwrap()).collect();
    assert!(worst.windows(2).all(|pair| pair[0] >= pair[1]) && worst.len() == 20, "{planned}");
    assert_eq!(planned["models"][0], "power-law-drag");
    // A law of speed shows where it is fast.
    assert!(experiments[0]["experiment"]["release_rad"].as_f64().unwrap().abs() >= 1.5, "{planned}");
    let words = host(folder.path(), "plan one.csv two.csv");
    assert!(words.succeeded().contains("Best: a release from"), "{words:?}");
}

/// A rig whose firmware is from before custom formulas.
fn older_rig() -> Device {
    let mut rig = Rig::new("old", 4095, Err(StoreState::Empty));
    let mut deframer = Deframer::new();
    Device::new(move |received| {
        let frames: Vec<Frame> = received.iter().filter_map(|byte| deframer.push(*byte)?.ok()).collect();
        let answers = frames.into_iter().filter_map(|frame| match frame {
            Frame::CustomFormula(_) => Some(Frame::Answer(0, Answer::Refused(Refusal::NotHere))),
            other => match rig.on_frame(other) {
                Outcome::Send(frame) => Some(frame),
                _ => None,
            },
        });
        let encoded = |frame: Frame| encode(&frame, &mut [0; MAX_FRAME]).unwrap().to_vec();
        answers.flat_map(encoded).collect()
    })
}

#[test]
fn older_firmware_refuses_a_formula_by_name() {
    let folder = tempfile::tempdir().unwrap();
    host(folder.path(), "init --mass 0.1466084 --length 0.1562177 --inertia 0.00284252 -o rig.toml").succeeded();
    let path = folder.path().join("rig.toml");
    let file =
        std::fs::read_to_string(&path).unwrap() + "\n[effect.custom]\nformula = \"-k*omega; k in 0..1\"\nk = 1e-4\n";
    std::fs::write(&path, file).unwrap();
    let device = older_rig();
    let refused = host(folder.path(), &format!("push --rig rig.toml --port {}", device.port));
    refused.failed(1, &["does not know custom formulas", "update the firmware"]);
}
