//! Bad input: a clear message, a non-zero exit code, nothing on stdout. 2 is wrong use, 1 a failure.

use std::fs;
use std::path::Path;
use tests::program::host;

/// A folder with a model and one file.
fn with_file(name: &str, content: &[u8]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    host(folder.path(), "init --mass 0.15 --length 0.16 --inertia 0.0027").succeeded();
    fs::write(folder.path().join(name), content).unwrap();
    folder
}

/// Fits one file with this content.
#[track_caller]
fn check_recording(content: impl AsRef<[u8]>, words: &[&str]) {
    let folder = with_file("swing.csv", content.as_ref());
    let all = [&["swing.csv"], words].concat();
    host(folder.path(), "fit swing.csv").failed(1, &all);
}

/// 20 s of a 1 Hz swing at 100 Hz, with one line changed.
fn swing(changed_line: usize, change: &str) -> String {
    let row = |sample: usize| {
        let time_s = sample as f64 / 100.0;
        let angle_rad = (-0.05 * time_s).exp() * (2.0 * std::f64::consts::PI * time_s).cos();
        if sample == changed_line { change.to_owned() } else { format!("{time_s:.2},{angle_rad:.5}") }
    };
    let rows: Vec<String> = (0..2000).map(row).collect();
    format!("t,theta\n{}\n", rows.join("\n"))
}

#[test]
fn missing_file() {
    let folder = with_file("other.csv", b"");
    host(folder.path(), "fit swing.csv").failed(1, &["swing.csv", "no such file", "check the path"]);
}

#[test]
fn unreadable_file() {
    let folder = with_file("other.csv", b"");
    fs::create_dir(folder.path().join("swing.csv")).unwrap();
    host(folder.path(), "fit swing.csv").failed(1, &["swing.csv", "directory"]);
    check_recording(b"\x7fELF\x02\x01\x01\0\0\x03", &["not text", "export it as CSV"]);
}

#[test]
fn empty_file() {
    check_recording("", &["empty", "expected rows"]);
    check_recording("\n \n", &["empty"]);
}

#[test]
fn text_in_a_number_column() {
    check_recording(swing(500, "5.00,oops"), &["line 502", "oops"]);
}

#[test]
fn not_a_number_and_infinity() {
    check_recording(swing(500, "5.00,-inf"), &["line 502", "-inf"]);
    check_recording(swing(500, "5.00,inf"), &["line 502", "inf"]);
}

#[test]
fn a_cell_without_a_value_is_a_gap_that_is_told() {
    let folder = with_file("swing.csv", swing(500, "5.00,NaN").as_bytes());
    let run = host(folder.path(), "fit swing.csv --method least-squares");
    run.succeeded();
    assert!(run.stderr.contains("line 502") && run.stderr.contains("NaN") && run.stderr.contains("gap"), "{run:#?}");
}

#[test]
fn time_running_backwards() {
    // The clock is set back and counts on from there.
    let whole = swing(9999, "");
    let lines: Vec<&str> = whole.lines().collect();
    let set_back = [&lines[..501], &lines[301..]].concat().join("\n") + "\n";
    check_recording(set_back, &["line 502", "time goes back"]);
}

#[test]
fn fewer_than_two_swings() {
    let short: String = swing(9999, "").lines().take(120).map(|line| format!("{line}\n")).collect();
    check_recording(short, &["two swings"]);
}

#[test]
fn a_saturated_potentiometer_is_told_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let run = host(folder.path(), "record --port sim:broken-wire -o swing.csv");
    run.failed(1, &["potentiometer", "code 0", "end of its range", "wires"]);
    assert!(!folder.path().join("swing.csv").exists());
}

#[test]
fn a_wire_that_comes_off_keeps_what_was_recorded() {
    let folder = tempfile::tempdir().unwrap();
    host(folder.path(), "record --port sim:loose-wire -o swing.csv").failed(1, &["code 0", "are kept in swing.csv"]);
    assert!(fs::read_to_string(folder.path().join("swing.csv")).unwrap().lines().count() > 8000);
}

#[test]
fn no_such_port_and_no_such_scenario() {
    let folder = tempfile::tempdir().unwrap();
    host(folder.path(), "statistics --port /dev/ttyNONE").failed(1, &["no port /dev/ttyNONE", "--port sim"]);
    host(folder.path(), "statistics --port sim:none").failed(2, &["no simulated rig none", "plain, drag"]);
}

#[test]
fn a_file_is_no_port() {
    let folder = with_file("swing.csv", b"t,theta\n");
    host(folder.path(), "statistics --port ./swing.csv").failed(1, &["swing.csv could not be opened as a serial port"]);
}

#[test]
fn what_is_for_the_rig_needs_a_port() {
    let folder = with_file("swing.csv", swing(9999, "").as_bytes());
    for option in ["--wait 5", "--limit 60", "--no-push"] {
        host(folder.path(), &format!("fit swing.csv {option}")).failed(2, &["cannot be used with", "[RECORDING]"]);
    }
}

/// Before anything is served: nobody can listen at this address.
#[test]
fn a_page_is_not_begun_with_a_recording_that_is_not_there() {
    let folder = with_file("swing.csv", swing(9999, "").as_bytes());
    let run = host(folder.path(), "serve swing.csv swimg.csv --no-open --listen 192.0.2.1:80");
    run.failed(1, &["could not read recording swimg.csv", "no such file"]);
}

#[test]
fn ranges_reversed() {
    let folder = with_file("swing.csv", swing(9999, "").as_bytes());
    let run = host(folder.path(), "fit swing.csv --range Mw=1e-3..1e-4");
    run.failed(2, &["Mw=1e-3..1e-4", "reversed", "write Mw=0.0001..0.001"]);
    host(folder.path(), "fit swing.csv --range Mx=1..2").failed(2, &["no parameter Mx", "Mw"]);
    host(folder.path(), "fit swing.csv --from 9 --to 3").failed(2, &["--from 9 s", "--to 3 s", "--from 3 --to 9"]);
}

#[test]
fn a_release_in_degrees_is_refused_with_the_same_in_radians() {
    let folder = tempfile::tempdir().unwrap();
    host(folder.path(), "simulate plain --start 90 -o swing.csv").failed(2, &["90 rad", "90 degrees are 1.571 rad"]);
    assert!(!folder.path().join("swing.csv").exists());
}

/// As a bus makes of a failed transfer.
#[test]
fn one_absurd_reading_is_left_out_as_a_gap() {
    for reading in ["1e300", "-1e300", "1e9"] {
        let rows: Vec<String> = (0..2000)
            .map(|k| f64::from(k) * 0.01)
            .map(|t| {
                let theta = 0.8 * (-0.03 * t).exp() * (6.0 * t).cos();
                format!("{t:.2},{theta:.5}")
            })
            .collect();
        let spoilt =
            rows.iter().enumerate().map(|(k, row)| if k == 700 { format!("7.00,{reading}") } else { row.clone() });
        let text = format!("t,theta\n{}\n", spoilt.collect::<Vec<_>>().join("\n"));
        let folder = with_file("swing.csv", text.as_bytes());
        let run = host(folder.path(), "fit swing.csv --method least-squares");
        run.succeeded();
        assert!(run.stderr.contains("1 reading jumps out of the swing and back, at 7.000 s"), "{}", run.stderr);
    }
}

#[test]
fn negative_or_absurd_geometry() {
    let folder = tempfile::tempdir().unwrap();
    for mass in ["-1", "nan", "0", "inf", "heavy"] {
        let arguments = format!("init --mass {mass} --length 0.16 --inertia 0.0027");
        host(folder.path(), &arguments).failed(2, &[mass, "--mass", "expected"]);
    }
    host(folder.path(), "init --mass 1").failed(2, &["--length", "--inertia"]);
    host(folder.path(), "init --unknown-geometry --mass 1").failed(2, &["cannot be used with"]);
    assert!(!folder.path().join("rig.toml").exists());
}

#[test]
fn a_bad_model_file_is_told_with_line_and_key() {
    let folder = with_file("swing.csv", swing(9999, "").as_bytes());
    let path = folder.path().join("rig.toml");
    let good = fs::read_to_string(&path).unwrap();
    fs::write(&path, good.replace("mass = 0.15", "mass = -0.15")).unwrap();
    host(folder.path(), "fit swing.csv").failed(1, &["rig.toml, line 8", "pendulum.mass", "next:"]);
    host(folder.path(), "push --port sim").failed(1, &["rig.toml, line 8", "pendulum.mass"]);
}

#[test]
fn existing_files_are_not_replaced_unasked() {
    let folder = with_file("swing.csv", b"mine");
    for arguments in [
        "init --unknown-geometry -o swing.csv",
        "record --port sim -o swing.csv",
        "simulate -o swing.csv",
        "pull --port sim -o swing.csv",
    ] {
        host(folder.path(), arguments).failed(2, &["swing.csv exists already", "--force"]);
    }
    assert_eq!(fs::read(folder.path().join("swing.csv")).unwrap(), b"mine");
}

#[test]
fn no_model_and_no_port() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("swing.csv"), swing(9999, "")).unwrap();
    host(folder.path(), "fit swing.csv").failed(2, &["no rig.toml here", "host init", "host pull"]);
    host(folder.path(), "push --port sim").failed(2, &["no rig.toml here"]);
    host(folder.path(), "fit").failed(2, &["RECORDING"]);
}

#[test]
fn a_folder_that_is_not_there() {
    let folder = tempfile::tempdir().unwrap();
    host(folder.path(), "record --port sim -o nowhere/swing.csv").failed(1, &["nowhere/swing.csv", "folder"]);
    host(folder.path(), "init --unknown-geometry -o nowhere/rig.toml").failed(1, &["nowhere/rig.toml", "folder"]);
    assert!(!Path::new("nowhere").exists());
}

/// The paper's pendulum, recorded; then a model file in which one number is in another unit. Every command that holds
/// a model against a recording refuses, and says which line cures it.
#[test]
fn a_mass_in_grams_and_a_length_in_centimetres_are_refused_with_the_line_that_cures_them() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    host(folder, "init --mass 0.1466084 --length 0.1562177 --inertia 0.00284252").succeeded();
    host(folder, "simulate plain --seconds 20 --rate 100 -o swing.csv").succeeded();
    host(folder, "init --mass 146.6084 --length 0.1562177 --inertia 0.00284252 -o grams.toml").succeeded();
    for command in ["fit", "compare", "diagnose", "improve", "plan"] {
        let run = host(folder, &format!("{command} swing.csv --rig grams.toml"));
        run.failed(1, &["swing.csv", "146.6084 kg", "grams", "`mass = 0.1466084` in rig.toml"]);
    }
    host(folder, "init --mass 0.1466084 --length 15.62177 --inertia 0.00284252 -o cm.toml").succeeded();
    host(folder, "fit swing.csv --rig cm.toml").failed(1, &["period", "metres", "`length = 0.1562177`"]);
    host(folder, "init --mass 0.1466084 --length 0.1562177 --inertia 28.4252 -o gcm2.toml").succeeded();
    host(folder, "fit swing.csv --rig gcm2.toml").failed(1, &["period", "kg·m²", "`inertia = 2."]);
}
