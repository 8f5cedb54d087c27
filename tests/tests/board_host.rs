//! The program `host` on the boards' own images, as a person uses it: look, fit, keep, restart, compare.
#![cfg(unix)]

use serde_json::{Value, json};
use std::path::Path;
use std::process::Command;
use tests::emulator::{Chip, Terminal};
use tests::image::Board;
use tests::plant::Scenario;
use tests::program::{PATIENT, path};

/// Of both boards' processors.
const CLOCK_HZ: u64 = 168_000_000;

/// More friction than the paper's: swings end within 14 s, and the next one need not be waited for long.
fn brisk() -> Scenario {
    let mut scenario = Scenario { rest_s: 1.5, lift_s: 0.7, hold_s: 1.0, swing_s: 18.0, ..Scenario::default() };
    scenario.parameters.set_friction(5.4e-4, 3e-3, 3.3e-3, 0.055);
    scenario
}

/// Runs the program; gives the object that it prints.
fn host(folder: &Path, arguments: &[&str]) -> Value {
    let output = Command::new(path())
        .args(arguments)
        .arg("--json")
        .current_dir(folder)
        .env(PATIENT.0, PATIENT.1)
        .env("XDG_STATE_HOME", folder)
        .output()
        .unwrap();
    let (said, errors) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "host {arguments:?}: {said}\n{errors}");
    serde_json::from_str(&said).unwrap_or_else(|error| panic!("host {arguments:?}: {error}: {said}"))
}

fn rig(path: &Path) -> toml::Table {
    std::fs::read_to_string(path).unwrap().parse().unwrap()
}

fn works_on(kind: Board) {
    let scenario = brisk();
    let board = Terminal::start(&Chip::of(kind), scenario.clone()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let (folder, port) = (folder.path(), board.port());

    let statistics = host(folder, &["statistics", "--port", port]);
    println!("{statistics}");
    println!("{}", host(folder, &["doctor", "--port", port]));
    println!("{}", host(folder, &["fit", "--port", port, "-o", "rig.toml"]));
    // The rig has looked at its swing meanwhile: what it lost, and the stack that is left.
    let statistics = host(folder, &["statistics", "--port", port]);
    println!("{statistics}");
    let number = |place: &str| {
        statistics.pointer(place).and_then(Value::as_u64).unwrap_or_else(|| panic!("no {place} in {statistics}"))
    };
    assert_eq!(number("/overruns"), 0);
    assert!(4 * number("/health/stack_used") <= 3 * number("/health/stack_size"), "{statistics}");
    for stage in ["sample", "observer", "frame", "save"] {
        let [n, worst] = ["count", "worst"].map(|what| number(&format!("/chip/{stage}/{what}")));
        let mean = statistics["chip"][stage]["mean"].as_f64().unwrap();
        // Even a whole save, without an erase, takes less than a tenth of a second.
        assert!(n > 0 && mean > 10.0 && mean <= worst as f64 && worst < CLOCK_HZ / 10, "{stage}: {statistics}");
    }
    assert_eq!(number("/chip/clock_hz"), CLOCK_HZ);
    let doctor = host(folder, &["doctor", "--port", port]);
    println!("{doctor}");
    for (what, words) in [
        ("chip", &["on its crystal"][..]),
        ("speed", &["cycles a sample"]),
        ("cycles", &["a sample ", "the observer ", "a frame ", "a save ", ", at most "]),
    ] {
        let findings = doctor["findings"].as_array().unwrap();
        let found = findings.iter().find(|finding| finding["what"] == what).map(|finding| finding["found"].to_string());
        assert!(found.is_some_and(|found| words.iter().all(|word| found.contains(word))), "{what}: {doctor}");
    }
    host(folder, &["restart", "--port", port]);
    host(folder, &["pull", "--port", port, "-o", "pulled.toml"]);
    let (fitted, pulled) = (rig(&folder.join("rig.toml")), rig(&folder.join("pulled.toml")));
    for ((name, fitted), (same, pulled)) in numbers(&fitted["pendulum"]).into_iter().zip(numbers(&pulled["pendulum"])) {
        assert!(name == same && (pulled / fitted - 1.0).abs() < 1e-6, "{name} {fitted}, {same} {pulled}");
    }
    let truth = scenario.parameters.pendulum.inertia_kg_m2;
    let found = fitted["pendulum"]["inertia"]["value"].as_float().unwrap();
    assert!((found / truth - 1.0).abs() < 5e-3, "inertia {found} instead of {truth}");
    host(folder, &["push", "--rig", "pulled.toml", "--port", port]);

    let events = board.events();
    let failure = events.iter().find(|event| event["event"] == "failure");
    assert_eq!(failure, None);
    let resets: Vec<&Value> = events.iter().filter(|event| event["event"] == "reset").collect();
    assert!(resets.iter().all(|reset| reset["cause"] != json!("watchdog")), "{resets:?}");
}

/// Names and numbers; the board keeps 32 bits of what the file has in 64, and not where they came from.
fn numbers(table: &toml::Value) -> Vec<(String, f64)> {
    let number = |value: &toml::Value| value.get("value").unwrap_or(value).as_float().unwrap_or(f64::NAN);
    let table = table.as_table().unwrap();
    table.iter().map(|(name, value)| (name.clone(), number(value))).collect()
}

#[test]
fn the_feather_is_looked_at_fitted_restarted_and_compared() {
    works_on(Board::FeatherF405);
}

#[test]
fn the_nucleo_is_looked_at_fitted_restarted_and_compared() {
    works_on(Board::NucleoF446);
}

/// 84 MHz in 64 conversions of 6836 ticks each.
const NEAREST_TO_192_HZ: f64 = 84e6 / (64.0 * 6836.0);

#[test]
fn a_recording_at_another_rate_has_the_one_that_the_board_makes_of_it() {
    // Short swings: two recordings each wait for the next.
    let scenario = Scenario { swing_s: 14.0, ..brisk() };
    let board = Terminal::start(&Chip::of(Board::NucleoF446), scenario.clone()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let (folder, port) = (folder.path(), board.port());
    host(folder, &["pull", "--port", port, "-o", "rig.toml"]);
    let recorded = host(folder, &["record", "--port", port, "--rate", "192", "--limit", "8", "-o", "swing.csv"]);
    println!("{recorded}");
    let is_made = |rate_hz: f64| (rate_hz / NEAREST_TO_192_HZ - 1.0).abs() < 1e-7;
    assert!(is_made(recorded["rate_hz"].as_f64().unwrap()), "{recorded}");

    let swing = std::fs::read_to_string(folder.join("swing.csv")).unwrap();
    let header = swing.lines().find_map(|line| line.strip_prefix("# rate_hz: ")).unwrap();
    assert!(is_made(header.parse().unwrap()), "{header}");
    let time_s = |row: &str| row.split_once(',').and_then(|(time, _)| time.parse::<f64>().ok());
    let times_s: Vec<f64> = swing.lines().filter_map(time_s).collect();
    let step_s = (times_s[times_s.len() - 1] - times_s[0]) / (times_s.len() - 1) as f64;
    assert!((step_s * NEAREST_TO_192_HZ - 1.0).abs() < 1e-6, "{step_s} s");

    let fit = host(folder, &["fit", "swing.csv", "--rig", "rig.toml", "-o", "fitted.toml"]);
    let parameters = fit["parameters"].as_array().unwrap();
    let inertia = parameters.iter().find(|parameter| parameter["symbol"] == "I").unwrap()["value"].as_f64().unwrap();
    let truth = scenario.parameters.pendulum.inertia_kg_m2;
    assert!((inertia / truth - 1.0).abs() < 1e-3, "{inertia} of {truth}");
    // Afterwards the rig samples as before.
    let usual = host(folder, &["record", "--port", port, "--limit", "3", "-o", "usual.csv"]);
    assert_eq!(usual["rate_hz"], json!(1000.0));

    for rate in ["49.9", "10001", "-192", "nan", "fast"] {
        let port_and_rate = format!("record --port {port} --rate {rate} -o wrong.csv");
        tests::program::host(folder, &port_and_rate).failed(2, &[rate, "expected 50 to 10000 samples a second"]);
    }
}

/// Of an encoder with 1000 lines, mounted so that it counts the other way.
const COUNTS: i32 = -4000;

/// The model file's sensor, and the rig's after a push: no other firmware is needed, and none of its defaults are lost.
#[test]
fn a_push_makes_the_nucleo_read_an_encoder_and_its_swing_gives_the_parameters_back() {
    let mut scenario = Scenario { edges_per_turn: Some(COUNTS), ..brisk() };
    scenario.parameters.set_friction(5.4e-4, 4e-3, 4.4e-3, 0.055);
    let board = Terminal::start(&Chip::of(Board::NucleoF446), scenario.clone()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let (folder, port) = (folder.path(), board.port());
    host(folder, &["pull", "--port", port, "-o", "rig.toml"]);
    let model = std::fs::read_to_string(folder.join("rig.toml")).unwrap();
    let (model, _) = model.split_once("[sensor]").unwrap();
    let sensor = format!("[sensor]\nkind = \"encoder\"\ncounts_per_turn = {COUNTS}\n");
    std::fs::write(folder.join("rig.toml"), format!("{model}{sensor}")).unwrap();
    assert_eq!(host(folder, &["push", "--port", port, "--calibration"])["calibration"], json!(true));
    host(folder, &["restart", "--port", port]);

    println!("{}", host(folder, &["record", "--port", port, "-o", "swing.csv"]));
    let swing = std::fs::read_to_string(folder.join("swing.csv")).unwrap();
    assert!(swing.contains("\n# sensor: encoder\n"), "{}", &swing[..300]);
    let fit = host(folder, &["fit", "swing.csv", "--rig", "rig.toml", "-o", "fitted.toml"]);
    println!("{fit}");
    for (symbol, truth, tolerance) in [
        ("I", scenario.parameters.pendulum.inertia_kg_m2, 1e-3),
        ("Mc", scenario.parameters.values(2).unwrap()[0], 0.02),
        ("Mw", scenario.parameters.values(1).unwrap()[0], 0.05),
    ] {
        let parameters = fit["parameters"].as_array().unwrap();
        let found = parameters.iter().find(|parameter| parameter["symbol"] == symbol).unwrap();
        let value = found["value"].as_f64().unwrap();
        println!("{symbol}: {value} of {truth}");
        assert!((value / truth - 1.0).abs() < tolerance, "{symbol}: {value} of {truth}; {found}");
    }
    host(folder, &["pull", "--port", port, "-o", "pulled.toml"]);
    assert!(std::fs::read_to_string(folder.join("pulled.toml")).unwrap().contains(&sensor));
    let events = board.events();
    assert_eq!(events.iter().find(|event| event["event"] == "failure"), None);
}
