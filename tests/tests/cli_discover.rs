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
    let found = json(folder.path(), "diagnose one.csv two.csv --json");
    assert_eq!(found["verdict"], serde_json::json!(["quadratic-drag"]));
    let number = |key: &str| found[key].as_f64().unwrap();
    assert!(number("rmse_before") > 1.5 * number("noise") && number("rmse_after") < 1.05 * number("noise"));
    assert_eq!(found["unexplained"], false);
    for key in ["ranked", "undecided", "held_out_before", "held_out_after", "seconds", "simulations", "candidates"] {
        assert!(found.get(key).is_some(), "{key}");
    }

    let improved = host(folder.path(), "improve one.csv two.csv -o better.toml");
    assert!(improved.stdout.contains("quadratic-drag"), "{}", improved.stdout);
    let again = json(folder.path(), "improve one.csv two.csv --rig better.toml --remove quadratic-drag --json");
    let rmse = |step: usize| again["steps"][step]["rmse"].as_f64().unwrap();
    assert!(rmse(1) > 1.5 * rmse(0), "{again}");
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
}

#[test]
fn unknown_names_are_told_with_what_there_is() {
    let folder = bench("mystery-4");
    host(folder.path(), "effects quadratic").failed(2, &["quadratic", "quadratic-drag"]);
    host(folder.path(), "improve one.csv --add nothing").failed(2, &["nothing", "host effects"]);
    host(folder.path(), "improve one.csv --remove stribeck").failed(1, &["stribeck", "not part of the model"]);
    host(folder.path(), "simulate mystery-99 -o x.csv").failed(2, &["mystery-99", "mystery-1"]);
}
