//! Angular velocities, as a phone on the pendulum measures them: fitted as rates, with bias and scale of the gyroscope.
//!
//! Pendulum and gyroscope are those of `tests::hidden`, which share no code with the product.

use host::recording::{Existing, save};
use serde_json::Value;
use std::fs;
use std::path::Path;
use tests::hidden::{Gyroscope, Hidden, Random, Rig};
use tests::page::Server;
use tests::program::host;

/// A usual phone: 2 % off, some hundredths of a rad/s at rest.
const PHONE: Gyroscope = Gyroscope { scale: 1.02, bias_rad_s: 0.013, noise_rad_s: 4e-3, rate_hz: 200.0 };

/// So many standard deviations a number may be off.
const MOST_STDS: f64 = 3.5;

/// A folder with the model of somebody who knows the geometry, and one file a release.
fn phone_on(rig: &Rig, phone: Gyroscope, unit: &str, per_rad: f64) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let Rig { mass_kg, length_m, drawn_inertia_kg_m2, .. } = rig;
    let init = format!("init --mass {mass_kg} --length {length_m} --inertia {drawn_inertia_kg_m2}");
    host(folder.path(), &init).succeeded();
    for release_idx in 0..rig.releases_rad.len() {
        let text = phone.file(rig, release_idx, unit, per_rad);
        fs::write(folder.path().join(format!("swing{}.csv", release_idx + 1)), text).unwrap();
    }
    folder
}

fn json(folder: &Path, arguments: &str) -> Value {
    serde_json::from_str(host(folder, &format!("{arguments} --json --quiet")).succeeded()).unwrap()
}

/// Mw, Mc, I and the scale of the sensor, each with the truth.
fn truths(rig: &Rig, phone: Gyroscope) -> [(&'static str, f64); 4] {
    [("Mw", rig.viscous), ("Mc", rig.coulomb_nm), ("I", rig.inertia_kg_m2), ("eg", phone.scale - 1.0)]
}

#[track_caller]
fn check(fit: &Value, truths: &[(&'static str, f64)]) {
    for (symbol, truth) in truths {
        let found = fit["parameters"].as_array().unwrap().iter().find(|found| found["symbol"] == *symbol);
        let found = found.unwrap_or_else(|| panic!("no {symbol} in {fit}"));
        let (value, std) = (found["value"].as_f64().unwrap(), found["std"].as_f64().expect("a standard deviation"));
        println!("{symbol}: {value:.5e} ± {std:.1e}, truth {truth:.5e}: {:.2} stds", (value - truth) / std);
        assert!((value - truth).abs() < MOST_STDS * std, "{symbol}: {value:e} ± {std:e}, truth {truth:e}");
    }
}

fn rig(seed: u64) -> Rig {
    Rig { releases_rad: vec![1.2, -0.7], ..Rig::random(seed) }
}

#[test]
fn a_phones_gyroscope_gives_friction_and_inertia_within_their_errors() {
    for seed in [3, 4, 5] {
        let rig = rig(seed);
        let folder = phone_on(&rig, PHONE, "rad/s", 1.0);
        let fit = json(folder.path(), "fit swing1.csv --hold-out swing2.csv -o rig.toml");
        check(&fit, &truths(&rig, PHONE));
        assert_eq!(fit["left"], "noise", "{fit}");
        let held_out = fit["held_out_rmse"].as_f64().unwrap();
        assert!((held_out / PHONE.noise_rad_s - 1.0).abs() < 0.05, "held out {held_out} rad/s");
        // The same model beside the same rates, and the search for what is missing.
        let compared = json(folder.path(), "compare swing1.csv --hold-out swing2.csv");
        assert_eq!(
            (&compared["answer"], &compared["measured"]),
            (&Value::from("nothing-missing"), &Value::from("rate"))
        );
        let diagnosed = json(folder.path(), "diagnose swing1.csv swing2.csv");
        assert_eq!(diagnosed["verdict"], Value::from(Vec::<Value>::new()), "{diagnosed}");
    }
}

#[test]
fn degrees_a_second_are_the_same_swing() {
    let rig = rig(6);
    let folder = phone_on(&rig, PHONE, "deg/s", 1f64.to_degrees());
    check(&json(folder.path(), "fit swing1.csv swing2.csv --method least-squares"), &truths(&rig, PHONE));
}

#[test]
fn a_drag_that_hides_in_rates_is_found() {
    let rig = Rig { releases_rad: vec![1.4, -1.0], ..Rig::random(8) }.with("quadratic-drag");
    let rig = rig.scaled(3.0);
    let folder = phone_on(&rig, PHONE, "rad/s", 1.0);
    let diagnosed = json(folder.path(), "diagnose swing1.csv swing2.csv");
    assert_eq!(diagnosed["verdict"], Value::from(vec!["quadratic-drag"]), "{diagnosed}");
}

/// A bias that wanders as the chip warms up, by a quarter of a degree per second in half a minute.
#[test]
fn a_bias_that_wanders_is_named() {
    let drift = Hidden { name: "zero-drift", size: 1.5e-4, shape: [0.0; 2], largest: 1.0, is_listed: false };
    let rig = Rig { hidden: vec![drift], ..rig(9) };
    let folder = phone_on(&rig, PHONE, "rad/s", 1.0);
    let diagnosed = json(folder.path(), "diagnose swing1.csv swing2.csv");
    assert_eq!(diagnosed["verdict"], Value::from(vec!["zero-drift"]), "{diagnosed}");
    check_value(&diagnosed, "dz", drift.size);
}

fn check_value(diagnosed: &Value, symbol: &str, truth: f64) {
    let value = diagnosed["values"].as_array().unwrap().iter().find(|value| value["symbol"] == symbol).unwrap();
    let (found, std) = (value["value"].as_f64().unwrap(), value["std"].as_f64().unwrap());
    assert!((found - truth).abs() < MOST_STDS * std && std < 0.2 * truth, "{symbol}: {found} ± {std}, truth {truth}");
}

#[test]
fn rates_and_angles_are_not_fitted_at_once() {
    let rig = rig(7);
    let folder = phone_on(&rig, PHONE, "rad/s", 1.0);
    save(&rig.recording(0), &folder.path().join("angles.csv"), Existing::Keep).unwrap();
    for command in ["fit", "compare", "diagnose"] {
        host(folder.path(), &format!("{command} swing1.csv angles.csv"))
            .failed(1, &["angles.csv holds angles", "swing1.csv"]);
    }
}

/// Numbers without names: the model file says what they are, and a misspelt word is refused with its line.
#[test]
fn the_model_file_says_what_recordings_hold_that_do_not() {
    let rig = rig(6);
    let folder = phone_on(&rig, PHONE, "rad/s", 1.0);
    let named = fs::read_to_string(folder.path().join("swing1.csv")).unwrap();
    let bare = named.lines().skip(1).map(|row| row.split(',').collect::<Vec<_>>());
    let bare: Vec<String> = bare.map(|cells| format!("{},{}", cells[0], cells[3])).collect();
    fs::write(folder.path().join("bare.csv"), bare.join("\n") + "\n").unwrap();
    host(folder.path(), "fit bare.csv").failed(1, &["bare.csv", "angular"]);
    let model = fs::read_to_string(folder.path().join("rig.toml")).unwrap();
    fs::write(folder.path().join("rig.toml"), format!("{model}\n[sensor]\nmeasured = \"rate\"\n")).unwrap();
    check(&json(folder.path(), "fit bare.csv --method least-squares -o rig.toml"), &truths(&rig, PHONE));
    let compared = json(folder.path(), "compare bare.csv");
    assert_eq!((&compared["measured"], &compared["answer"]), (&Value::from("rate"), &Value::from("nothing-missing")));
    fs::write(folder.path().join("rig.toml"), format!("{model}\n[sensor]\nmeasured = \"speed\"\n")).unwrap();
    host(folder.path(), "fit bare.csv").failed(1, &["sensor.measured", "\"angle\" or \"rate\""]);
}

/// The scale of a phone's gyroscope is not that of the rig's potentiometer: neither command nor page sends it.
#[test]
fn a_gyroscopes_scale_is_not_sent_to_a_rig_with_a_potentiometer() {
    let rig = rig(6);
    let folder = phone_on(&rig, PHONE, "rad/s", 1.0);
    let words = ["sensor-gain", "gyroscope", "--without-sensor"];
    host(folder.path(), "push --port sim").succeeded();
    host(folder.path(), "fit swing1.csv --method least-squares -o rates.toml").succeeded();
    host(folder.path(), "improve swing1.csv --rig rates.toml --add quadratic-drag -o improved.toml").succeeded();
    for model in ["rates", "improved"] {
        host(folder.path(), &format!("push --rig {model}.toml --port sim")).failed(2, &words);
    }
    let sent = host(folder.path(), "push --rig rates.toml --port sim --without-sensor");
    assert!(sent.succeeded().contains("viscous") && !sent.succeeded().contains("sensor-gain"), "{sent:?}");
    Server::start(folder.path(), "--rig improved.toml --port sim").post("/api/rig/push", "{}").refused(422, words[0]);

    // What the page itself fitted is known as well as what the command did.
    let server = Server::start(folder.path(), "--rig rig.toml --port sim swing1.csv");
    let is_fitted = |state: &Value| state["comparison"]["answer"] == "nothing-missing";
    server.tab().wait_for(|state| is_fitted(state) && state["rig"]["firmware"].is_string());
    server.post("/api/rig/push", "{}").refused(422, words[0]);

    // A number that somebody knows of the potentiometer, or that its angles gave, is the rig's own.
    let known = fs::read_to_string(folder.path().join("rates.toml")).unwrap();
    let typed: String = known
        .lines()
        .map(|line| if line.starts_with("eg") { "eg = 0.01\n".to_owned() } else { format!("{line}\n") })
        .collect();
    fs::write(folder.path().join("typed.toml"), typed).unwrap();
    host(folder.path(), "push --rig typed.toml --port sim").succeeded();
    let typed = fs::read_to_string(folder.path().join("typed.toml")).unwrap() + "\n[sensor]\nmeasured = \"rate\"\n";
    fs::write(folder.path().join("typed.toml"), typed).unwrap();
    host(folder.path(), "push --rig typed.toml --port sim").failed(2, &words);
    save(&rig.recording(0), &folder.path().join("angles.csv"), Existing::Keep).unwrap();
    host(folder.path(), "fit angles.csv --rig rates.toml --method least-squares -o angles.toml").succeeded();
    host(folder.path(), "push --rig angles.toml --port sim").succeeded();
}

/// Bias and scale do not depend on luck: many phones, many pendulums.
#[test]
#[ignore = "long: some minutes"]
fn many_phones() {
    let n_rigs = std::env::var("RATE_RIGS").ok().and_then(|n| n.parse().ok()).unwrap_or(20);
    for seed in 100..100 + n_rigs {
        let mut random = Random::new(seed);
        let phone = Gyroscope {
            scale: random.between(0.96, 1.04),
            bias_rad_s: random.between(-0.03, 0.03),
            noise_rad_s: random.log_between(1e-3, 1e-2),
            rate_hz: random.pick(&[100.0, 200.0, 400.0]),
        };
        let rig = Rig { releases_rad: vec![random.between(0.7, 1.4)], ..Rig::random(seed) };
        let folder = phone_on(&rig, phone, "rad/s", 1.0);
        println!("seed {seed}: {phone:?}");
        check(&json(folder.path(), "fit swing1.csv --method least-squares"), &truths(&rig, phone));
    }
}
