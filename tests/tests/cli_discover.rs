//! Discovery from the command line: diagnose, improve, effects, and the scenarios to practise on.

use std::path::Path;
use tests::program::host;

/// Two swings of a scenario in a folder of their own, and a model file straight from `init`.
fn bench(scenario: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &str| {
        let run = host(folder.path(), arguments);
        assert_eq!(run.code, 0, "{arguments}: {}", run.stderr);
    };
    run("init --mass 0.1466084 --length 0.1562177 --inertia 0.00284252 -o rig.toml");
    run(&format!("simulate {scenario} --start 1.45 --rate 250 --seed 1 -o one.csv"));
    run(&format!("simulate {scenario} --start -0.9 --rate 250 --seed 2 -o two.csv"));
    folder
}

fn json(folder: &Path, arguments: &str) -> serde_json::Value {
    let run = host(folder, arguments);
    assert_eq!(run.code, 0, "{}", run.stderr);
    serde_json::from_str(&run.stdout).unwrap()
}

#[test]
fn a_hidden_drag_is_named_added_and_the_error_falls_to_the_noise() {
    let folder = bench("mystery-1");
    let run = host(folder.path(), "diagnose one.csv two.csv --json --report missing.html");
    let found: serde_json::Value = serde_json::from_str(run.succeeded()).unwrap();
    assert_eq!(found["verdict"], serde_json::json!(["quadratic-drag"]));
    let number = |key: &str| found[key].as_f64().unwrap();
    assert!(number("rmse_before") > 1.5 * number("noise") && number("rmse_after") < 1.05 * number("noise"));
    assert_eq!(found["unexplained"], false);
    assert_eq!(found["first_look"]["named"], serde_json::json!(["quadratic-drag"]));
    let told = "first look, as a rig makes it by itself: missing is quadratic-drag";
    assert!(run.stderr.contains(told), "{}", run.stderr);
    assert_eq!(found["not_tried"], serde_json::json!([]));
    for key in ["ranked", "undecided", "held_out_before", "held_out_after", "seconds", "simulations", "candidates"] {
        assert!(found.get(key).is_some(), "{key}");
    }
    check_report(folder.path());

    let improved = host(folder.path(), "improve one.csv two.csv -o better.toml");
    assert!(improved.stdout.contains("quadratic-drag"), "{}", improved.stdout);
    let again = json(folder.path(), "improve one.csv two.csv --rig better.toml --remove quadratic-drag --json");
    let rmse = |step: usize| again["steps"][step]["rmse"].as_f64().unwrap();
    assert!(rmse(1) > 1.5 * rmse(0), "{again}");
}

/// It says what is missing and on which parts that holds, and is not replaced.
fn check_report(folder: &Path) {
    let page = std::fs::read_to_string(folder.join("missing.html")).unwrap();
    let parts = ["<td>left</td>", "<td>right</td>", "<td>one.csv</td>", "<td>two.csv</td>"];
    for expected in ["Missing: quadratic-drag.", "<td>Cq</td>", "Error after each step"].iter().chain(&parts) {
        assert!(page.contains(expected), "{expected}");
    }
    let again = host(folder, "diagnose one.csv two.csv --report missing.html");
    assert!(again.code == 2 && !again.stderr.contains("first look"), "{}", again.stderr);
}

#[test]
fn an_innocent_rig_is_not_accused() {
    let folder = bench("mystery-4");
    let found = json(folder.path(), "diagnose one.csv two.csv --json");
    assert_eq!(found["verdict"], serde_json::json!([]));
    assert!(host(folder.path(), "diagnose one.csv two.csv").stdout.starts_with("Nothing is missing"));
    assert!(host(folder.path(), "simulate mystery-4 --reveal").stdout.contains("nothing is hidden"));
}

#[test]
fn a_held_out_swing_confirms_the_effect() {
    let folder = bench("mystery-2");
    let found = json(folder.path(), "diagnose one.csv --hold-out two.csv --json");
    let number = |key: &str| found[key].as_f64().unwrap();
    assert!(number("held_out_after") < 1.1 * number("noise"), "{found}");
    assert!(number("held_out_before") > number("held_out_after"));
    assert_eq!(found["carries"], "confirmed", "{found}");
    let words = host(folder.path(), "diagnose one.csv --hold-out two.csv").stdout;
    assert!(words.contains("held-out swings confirm it"), "{words}");
}

#[test]
fn unknown_names_are_told_with_what_there_is() {
    let folder = bench("mystery-4");
    host(folder.path(), "effects quadratic").failed(2, &["quadratic", "quadratic-drag"]);
    host(folder.path(), "improve one.csv --add nothing").failed(2, &["nothing", "host effects"]);
    host(folder.path(), "improve one.csv --remove stribeck").failed(1, &["stribeck", "not part of the model"]);
    host(folder.path(), "simulate mystery-99 -o x.csv").failed(2, &["mystery-99", "mystery-1"]);
}

#[test]
fn a_fit_on_a_model_that_improve_wrote_is_never_worse_than_that_model() {
    // A real arm on ball bearings, from a pendulum of 1 N·m whose inertia its period gives.
    let folder = tempfile::tempdir().unwrap();
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../host/data/recordings/real/dynamicslab_single_arm.csv");
    let file = data.canonicalize().unwrap();
    let file = file.display();
    let swing = format!("{file} --from 12 --to 40");
    let begun = host(folder.path(), "init --mass 10.2 --length 0.01 --inertia 0.0174 -o rig.toml");
    assert_eq!(begun.code, 0, "{}", begun.stderr);
    let added =
        format!("improve {swing} --add power-law-drag --add detent --add torsional-spring -o better.toml --json");
    let improved = json(folder.path(), &added);
    let written = improved["steps"].as_array().unwrap().last().unwrap()["rmse"].as_f64().unwrap();
    let fitted = json(folder.path(), &format!("fit {swing} --rig better.toml --method least-squares --json"));
    let after = fitted["rmse"].as_f64().unwrap();
    // The file has six digits.
    assert!(after < 1.01 * written, "improve left {written}, fit {after}");
}

#[test]
fn a_recording_given_twice_or_fitted_and_held_out_is_refused() {
    let folder = bench("mystery-4");
    std::fs::copy(folder.path().join("one.csv"), folder.path().join("copy.csv")).unwrap();
    host(folder.path(), "diagnose one.csv copy.csv").failed(2, &["one.csv", "copy.csv", "twice"]);
    host(folder.path(), "fit one.csv one.csv").failed(2, &["one.csv", "twice"]);
    host(folder.path(), "fit one.csv --hold-out copy.csv").failed(2, &["copy.csv", "held out", "confirms nothing"]);
    host(folder.path(), "improve one.csv --hold-out one.csv").failed(2, &["one.csv", "confirms nothing"]);
}

#[test]
fn what_was_not_tried_is_told_with_the_reason() {
    let folder = bench("mystery-1");
    let found = json(folder.path(), "diagnose one.csv --json");
    assert_eq!(found["not_tried"][0]["effect"], "drifting-friction", "{found}");
    let words = host(folder.path(), "diagnose one.csv").stdout;
    assert!(words.contains("Not tried: drifting-friction") && words.contains("several releases"), "{words}");
}
