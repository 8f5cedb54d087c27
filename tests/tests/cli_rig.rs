//! `doctor`, `calibrate` and `restart`, as a newcomer meets them.

use tests::program::{Run, host};

/// The findings that ask for a look, by name, from `host doctor --json`.
fn to_look_at(run: &Run) -> Vec<String> {
    let json: serde_json::Value = serde_json::from_str(run.succeeded()).unwrap();
    let findings = json["findings"].as_array().unwrap();
    let look: Vec<String> = findings
        .iter()
        .filter(|finding| finding["ok"] == false)
        .inspect(|finding| assert!(finding["next"].is_string(), "{finding}"))
        .map(|finding| finding["what"].as_str().unwrap().to_owned())
        .collect();
    assert_eq!(json["healthy"], look.is_empty());
    look
}

#[test]
fn the_doctor_finds_a_new_simulated_rig_uncalibrated_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let run = host(folder.path(), "doctor --port sim --json");
    assert_eq!(to_look_at(&run), ["flash", "calibration"]);
    let text = host(folder.path(), "doctor --port sim");
    assert!(text.succeeded().contains("ok         sampling       1000 samples/s"), "{text:?}");
}

#[test]
fn the_doctor_finds_a_broken_wire_and_another_model() {
    let folder = tempfile::tempdir().unwrap();
    host(folder.path(), "init --mass 0.2 --length 0.3 --inertia 0.004").succeeded();
    let run = host(folder.path(), "doctor --port sim:broken-wire --json");
    assert_eq!(to_look_at(&run), ["flash", "potentiometer", "calibration", "model"]);
}

#[test]
fn the_doctor_says_plainly_that_a_port_is_not_there() {
    let folder = tempfile::tempdir().unwrap();
    let run = host(folder.path(), "doctor --port /dev/nope --json");
    assert!(to_look_at(&run).contains(&"rig".to_owned()));
}

#[test]
fn the_rule_for_udev_is_the_one_in_the_docs() {
    let folder = tempfile::tempdir().unwrap();
    let shipped = include_str!("../../docs/99-pendulum-rig.rules");
    assert_eq!(host(folder.path(), "doctor --udev-rule").succeeded(), shipped);
}

#[test]
fn known_angles_give_back_the_gain_of_the_simulated_potentiometer() {
    let folder = tempfile::tempdir().unwrap();
    let run = host(folder.path(), "calibrate --port sim --angles 85.94,-68.75,45.84,-103.13 --json");
    let json: serde_json::Value = serde_json::from_str(run.succeeded()).unwrap();
    let nominal = json["before"]["radian_per_code"].as_f64().unwrap();
    let found = json["after"]["radian_per_code"].as_f64().unwrap();
    // A tenth of a code of 700 or more, and the angles' two decimals.
    assert!((found / nominal - 1.0).abs() < 1e-3, "{run:?}");
    assert!(json["nonlinearity_percent"].as_f64().unwrap() < 0.05, "{run:?}");
    let written = std::fs::read_to_string(folder.path().join("rig.toml")).unwrap();
    assert!(written.contains("radians_per_code = 0.00144"), "{written}");
}

#[test]
fn a_swing_gives_back_the_gain() {
    let folder = tempfile::tempdir().unwrap();
    host(folder.path(), "calibrate --port sim").succeeded();
    host(folder.path(), "record --port sim -o swing.csv").succeeded();
    let run = host(folder.path(), "calibrate --recording swing.csv --json");
    let json: serde_json::Value = serde_json::from_str(run.succeeded()).unwrap();
    let ratio =
        json["after"]["radian_per_code"].as_f64().unwrap() / json["before"]["radian_per_code"].as_f64().unwrap();
    assert!((ratio - 1.0).abs() < 1e-3 && json["gain_std"].as_f64().unwrap() < 1e-3, "{run:?}");
}

#[test]
fn swings_of_different_gains_are_refused_in_any_order() {
    let folder = tempfile::tempdir().unwrap();
    host(folder.path(), "calibrate --port sim").succeeded();
    host(folder.path(), "record --port sim -o a.csv").succeeded();
    let text = std::fs::read_to_string(folder.path().join("a.csv")).unwrap();
    let line = text.lines().find(|line| line.starts_with("# radians_per_code")).unwrap();
    std::fs::write(folder.path().join("b.csv"), text.replace(line, "# radians_per_code: 0.0014")).unwrap();
    for order in ["--recording a.csv --recording b.csv", "--recording b.csv --recording a.csv"] {
        host(folder.path(), &format!("calibrate {order}")).failed(2, &["different gains", "one calibration"]);
    }
}

#[test]
fn a_file_that_can_not_be_written_is_told_before_the_rig_is_changed() {
    let folder = tempfile::tempdir().unwrap();
    let run = host(folder.path(), "calibrate --port sim --rig none/rig.toml");
    run.failed(1, &["could not write none/rig.toml", "a folder that exists"]);
    assert!(!run.stderr.contains("hang still"), "{run:?}");
}

#[test]
fn impossible_calibrations_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    host(folder.path(), "calibrate --port sim --wait 1e300").failed(2, &["expected above 0 to 86400 s"]);
    host(folder.path(), "calibrate --port sim --angles 4").failed(2, &["between 5 and 180"]);
    host(folder.path(), "calibrate --port sim --angles 30").failed(1, &["twice off", "in the order"]);
    host(folder.path(), "calibrate --port sim:broken-wire").failed(1, &["an end of its range", "three wires"]);
    host(folder.path(), "calibrate --port sim --wait 0.1").failed(1, &["within 0.1 s", "not still at rest"]);
    host(folder.path(), "calibrate --port sim --angles 45,60 --wait 0.9").failed(1, &["not still at a new angle"]);
    host(folder.path(), "calibrate").failed(2, &["--port"]);
    assert!(!folder.path().join("rig.toml").exists());
}

#[test]
fn an_encoder_is_calibrated_recorded_and_looked_at_like_a_potentiometer() {
    let folder = tempfile::tempdir().unwrap();
    let run = host(folder.path(), "calibrate --port sim:encoder --json");
    let json: serde_json::Value = serde_json::from_str(run.succeeded()).unwrap();
    assert_eq!((&json["after"]["kind"], &json["after"]["counts_per_turn"]), (&"encoder".into(), &4096.into()));
    assert_eq!(json["after"]["zero_code"], 32_768.0);
    let written = std::fs::read_to_string(folder.path().join("rig.toml")).unwrap();
    assert!(written.ends_with("[sensor]\nkind = \"encoder\"\ncounts_per_turn = 4096\n"), "{written}");

    assert_eq!(to_look_at(&host(folder.path(), "doctor --port sim:encoder --json")), Vec::<String>::new());
    let said = host(folder.path(), "doctor --port sim:encoder");
    assert!(said.succeeded().contains("encoder        stands at 32768"), "{said:?}");
    assert!(said.succeeded().contains("4096 counts a turn, 1.53398 mrad each"), "{said:?}");
    host(folder.path(), "doctor --port sim --json").succeeded();

    host(folder.path(), "record --port sim:encoder -o swing.csv").succeeded();
    let swing = std::fs::read_to_string(folder.path().join("swing.csv")).unwrap();
    assert!(
        swing.contains("# sensor: encoder\n") && swing.contains("# radians_per_code: 0.0015339"),
        "{}",
        &swing[..400]
    );
    let fit = host(folder.path(), "fit swing.csv --json");
    let fit: serde_json::Value = serde_json::from_str(fit.succeeded()).unwrap();
    assert_eq!(fit["left"], "noise");
    // A count, √12 times.
    assert!((fit["noise"].as_f64().unwrap() / (1.533_98e-3 / 12_f64.sqrt()) - 1.0).abs() < 0.02, "{}", fit["noise"]);
}

/// Counts are no noise: where the pendulum turns and rests they are wrong alike, sample for sample and swing for swing.
#[test]
fn the_stated_uncertainty_of_counts_holds_the_truth() {
    let folder = tempfile::tempdir().unwrap();
    host(folder.path(), "init --mass 0.1466084 --length 0.1562177 --inertia 0.0026975").succeeded();
    let model = std::fs::read_to_string(folder.path().join("rig.toml")).unwrap();
    let truth = [("Mw", 5.4e-4), ("Mc", 7.1e-4), ("I", 0.002_697_5)];
    for (counts, start) in [(400, 1.01), (4000, 1.23)] {
        let sensor = format!("\n[sensor]\nkind = \"encoder\"\ncounts_per_turn = {counts}\n");
        std::fs::write(folder.path().join("rig.toml"), format!("{model}{sensor}")).unwrap();
        let simulate = format!("simulate --start {start} --seconds 40 --noise 0 -o swing.csv --force");
        host(folder.path(), &format!("{simulate} --with Mw=5.4e-4 --with Mc=7.1e-4")).succeeded();
        let fit = host(folder.path(), "fit swing.csv -o fitted.toml --force --json");
        let fit: serde_json::Value = serde_json::from_str(fit.succeeded()).unwrap();
        for (symbol, truth) in truth {
            let found = fit["parameters"].as_array().unwrap().iter().find(|number| number["symbol"] == symbol).unwrap();
            let (value, std) = (found["value"].as_f64().unwrap(), found["std"].as_f64().unwrap());
            assert!((value - truth).abs() < 2.5 * std, "{counts} counts, {start} rad: {symbol} {value} ± {std}");
            println!("{counts} counts, {start} rad: {symbol} {value} ± {std}");
            assert!(std < 0.25 * truth, "{counts} counts, {start} rad: {symbol} ± {std} says nothing");
        }
    }
}

#[test]
fn what_makes_no_sense_for_an_encoder_is_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let known = ["encoder is known", "4096 counts a turn", "leave --angles"];
    host(folder.path(), "calibrate --port sim:encoder --angles 45").failed(1, &known);
    host(folder.path(), "calibrate --port sim:encoder").succeeded();
    host(folder.path(), "record --port sim:encoder -o swing.csv").succeeded();
    host(folder.path(), "calibrate --recording swing.csv").failed(1, &known);
    host(folder.path(), "calibrate --port sim --rig other.toml").succeeded();
    let other = ["swing.csv was recorded from a sensor of kind encoder"];
    host(folder.path(), "calibrate --recording swing.csv --rig other.toml").failed(2, &other);
    host(folder.path(), "calibrate --port sim:encoder --encoder 3").failed(2, &["counts_per_turn of 16 to 32768"]);
}

#[test]
fn a_push_changes_the_sensor_and_the_doctor_tells_which_one_is_meant() {
    let folder = tempfile::tempdir().unwrap();
    host(folder.path(), "calibrate --port sim:encoder --encoder=-4096").succeeded();
    let run = host(folder.path(), "push --port sim");
    assert!(run.stderr.contains("reads a sensor of kind potentiometer, the file means one of kind encoder"), "{run:?}");
    let pushed = host(folder.path(), "push --port sim --calibration --json");
    assert!(pushed.succeeded().contains("\"calibration\": true"), "{pushed:?}");
    assert!(to_look_at(&host(folder.path(), "doctor --port sim --json")).contains(&"sensor in file".to_owned()));
}

#[test]
fn an_angle_that_is_off_the_line_is_seen() {
    let folder = tempfile::tempdir().unwrap();
    let run = host(folder.path(), "calibrate --port sim --angles 85.94,-68.75,55");
    assert!(run.succeeded().contains("linearity  look here"), "{run:?}");
}

#[test]
fn angles_that_were_not_held_so_are_refused_or_doubted() {
    let folder = tempfile::tempdir().unwrap();
    let swapped = ["held at 45.84° it reads 51.1° off", "nothing was saved", "--angles=85.94,-68.75,45.84"];
    host(folder.path(), "calibrate --port sim --angles 45.84,-68.75,85.94").failed(1, &swapped);
    assert!(!folder.path().join("rig.toml").exists());
    let run = host(folder.path(), "calibrate --port sim --angles=-90 --json");
    let json: serde_json::Value = serde_json::from_str(run.succeeded()).unwrap();
    assert!(json["doubts"].as_array().unwrap().len() == 2, "{json}");
    assert!(
        run.stderr.contains("doubtful: the gain is +4.8 % off") && run.stderr.contains("sign of the gain"),
        "{run:?}"
    );
}

#[test]
fn the_rig_restarts_and_starts_its_bootloader() {
    let folder = tempfile::tempdir().unwrap();
    assert!(host(folder.path(), "restart --port sim").succeeded().contains("starts again"));
    assert!(host(folder.path(), "restart --port sim --bootloader").succeeded().contains("bootloader"));
}
