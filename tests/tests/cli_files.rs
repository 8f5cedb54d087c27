//! Nothing is lost: no output replaces a file unasked, none replaces what is read, and a result that could not be
//! written is a failure.

use std::fs;
use std::path::Path;
use tests::program::{self, host, host_with};

const INIT: &str = "init --mass 0.1466084 --length 0.1562177 --inertia 0.00270676";

/// A model, a recording, and a file of the user's that must stay.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    host(folder.path(), INIT).succeeded();
    host(folder.path(), "simulate --seconds 10 --rate 100 -o swing.csv").succeeded();
    fs::write(folder.path().join("mine.html"), "mine").unwrap();
    folder
}

fn listing(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// Refused before anything is computed, and the folder is as it was.
#[track_caller]
fn check_refused(folder: &Path, arguments: &str, words: &[&str]) {
    let content = || listing(folder).iter().map(|name| fs::read(folder.join(name)).ok()).collect::<Vec<_>>();
    let before = (listing(folder), content());
    host(folder, arguments).failed(2, words);
    assert!(before == (listing(folder), content()), "{arguments} changed a file");
}

#[test]
fn no_drawing_and_no_report_replaces_a_file_unasked() {
    let folder = folder();
    let path = folder.path();
    fs::create_dir(path.join("pictures")).unwrap();
    fs::write(path.join("pictures/old.svg"), "old").unwrap();
    fs::create_dir(path.join("pages")).unwrap();
    fs::write(path.join("pages/host-fit.1"), "old").unwrap();
    for arguments in [
        "compare swing.csv --report mine.html",
        "fit swing.csv --plot mine.html",
        "fit swing.csv -o mine.html",
        "fit --paper --plot mine.html",
        "improve swing.csv --plot mine.html",
        "improve swing.csv -o mine.html",
        "simulate -o mine.html",
        "export --format c -o mine.html",
    ] {
        check_refused(path, arguments, &["mine.html exists already", "--force"]);
    }
    check_refused(path, "compare swing.csv --plot pictures", &["old.svg exists already", "--force"]);
    check_refused(path, "man pages", &["host-fit.1 exists already", "--force"]);
    host(path, "compare swing.csv --report mine.html --force").succeeded();
    assert!(fs::read_to_string(path.join("mine.html")).unwrap().contains("<html"));
    host(path, "man pages --force").succeeded();
    assert!(fs::read_to_string(path.join("pages/host-fit.1")).unwrap().contains("host"));
}

#[cfg(unix)]
#[test]
fn a_link_to_nothing_is_a_file_that_exists() {
    let folder = folder();
    let path = folder.path();
    std::os::unix::fs::symlink("there.svg", path.join("link.svg")).unwrap();
    let refused = host(path, "fit swing.csv --plot link.svg");
    refused.failed(2, &["link.svg exists already"]);
    assert!(!refused.stderr.contains("fitting"), "{refused:?}");
    host(path, "fit swing.csv --method least-squares --plot link.svg --force").succeeded();
    assert!(path.join("link.svg").is_symlink());
    assert!(fs::read_to_string(path.join("there.svg")).unwrap().contains("<svg"));
}

/// The swing would be recorded and fitted for nothing.
#[test]
fn a_place_where_nothing_can_be_written_is_told_before_anything_is_done() {
    let folder = folder();
    let path = folder.path();
    let before = listing(path);
    for arguments in [
        "fit swing.csv -o none/x.toml",
        "fit swing.csv --plot none/x.svg",
        "fit --port sim -o none/x.toml",
        "improve swing.csv -o none/x.toml",
        "diagnose swing.csv --report none/x.html",
        "diagnose swing.csv --plot none/x.svg",
        "compare swing.csv --report none/x.html",
        "compare swing.csv --csv none/x.csv",
        "compare swing.csv --plot mine.html/x",
        "study . --report none/x.html",
        "simulate -o none/x.csv",
        "record --port sim -o none/x.csv",
    ] {
        let run = host(path, arguments);
        run.failed(1, &["could not write", "folder", "space"]);
        let is_early = ["…", "fitting", "released", "recordings"].iter().all(|word| !run.stderr.contains(word));
        assert!(is_early && run.stdout.is_empty(), "{arguments}: {run:?}");
        assert_eq!(listing(path), before, "{arguments}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_fit_that_can_not_be_written_is_shown_all_the_same() {
    let folder = folder();
    for arguments in ["fit swing.csv -o /dev/full --force", "fit swing.csv --plot /dev/full --force"] {
        let run = host(folder.path(), arguments);
        assert_eq!(run.code, 1, "{run:?}");
        assert!(run.stderr.contains("could not write /dev/full: No space left"), "{}", run.stderr);
        assert!(run.stdout.contains("identified") && !run.stdout.contains("/dev/full"), "{}", run.stdout);
    }
}

#[test]
fn what_is_read_is_never_replaced_by_any_name() {
    let folder = folder();
    let path = folder.path();
    fs::hard_link(path.join("swing.csv"), path.join("also.csv")).unwrap();
    for arguments in [
        "compare swing.csv --report swing.csv --force",
        "compare also.csv --report ./swing.csv --force",
        "compare also.csv --hold-out swing.csv --report swing.csv --force",
        "compare also.csv --report rig.toml --force",
        "fit swing.csv --plot swing.csv --force",
        "fit swing.csv -o also.csv --force",
        "fit swing.csv --plot rig.toml --force",
        "improve swing.csv --plot swing.csv --force",
        "simulate -o rig.toml --force",
        "export --format c -o rig.toml --force",
    ] {
        check_refused(path, arguments, &["is being read", "choose another name"]);
    }
    check_refused(path, "fit swing.csv -o new.toml --plot ./new.toml", &["asked for twice"]);
    // The model file that is read is what gets better.
    host(path, "fit swing.csv --method least-squares -o ./rig.toml").succeeded();
    assert!(fs::read_to_string(path.join("rig.toml")).unwrap().contains("least squares"));
}

#[cfg(target_os = "linux")]
#[test]
fn a_result_that_does_not_reach_standard_output_is_a_failure() {
    let folder = folder();
    for arguments in ["compare swing.csv --json", "export --format c", "effects", "simulate plain -o new.csv --json"] {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = std::process::Command::new(program::path())
            .args(arguments.split_whitespace())
            .current_dir(folder.path())
            .stdout(full)
            .output()
            .unwrap();
        let words = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{arguments}: {words}");
        assert!(words.contains("standard output") && words.contains("No space left"), "{arguments}: {words}");
    }
    assert!(folder.path().join("new.csv").exists(), "a file that was asked for is written all the same");
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    let mut process = std::process::Command::new(program::path());
    let status = process.args(["effects"]).stdout(writer).status().unwrap();
    assert!(status.success(), "a reader that went away is no failure: {status}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_name_that_is_not_utf_8_is_as_good_as_any() {
    use std::os::unix::ffi::OsStrExt;
    let folder = folder();
    let name = std::ffi::OsStr::from_bytes(b"schwung-\xe4.csv");
    fs::rename(folder.path().join("swing.csv"), folder.path().join(name)).unwrap();
    let copy = std::ffi::OsStr::from_bytes(b"kopie-\xf6.csv");
    let run = |arguments: &[&std::ffi::OsStr]| {
        let mut process = std::process::Command::new(program::path());
        let output = process.args(arguments).current_dir(folder.path()).output().unwrap();
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let words = |words: &'static str| words.split_whitespace().map(std::ffi::OsStr::new).collect::<Vec<_>>();
    for command in ["fit --method least-squares --json", "compare --json", "diagnose --json"] {
        let object: serde_json::Value = serde_json::from_str(&run(&[&words(command)[..], &[name]].concat())).unwrap();
        assert!(object.to_string().contains("schwung-"), "{command}");
    }
    run(&[&words("simulate --seconds 1 --json -o")[..], &[copy]].concat());
    assert!(folder.path().join(copy).exists());
}

#[test]
fn the_next_command_can_be_copied_whatever_the_names() {
    let folder = folder();
    let path = folder.path();
    fs::rename(path.join("swing.csv"), path.join("my first swing.csv")).unwrap();
    let run = host_with(path, &["fit", "my first swing.csv", "--method", "least-squares", "-o", "my rig.toml"]);
    let text = run.succeeded();
    assert!(text.contains("'my rig.toml'"), "{text}");
    let many: Vec<String> = (0..10).map(|idx| format!("copy{idx}.csv")).collect();
    let whole = fs::read_to_string(path.join("my first swing.csv")).unwrap();
    let lines: Vec<&str> = whole.split_inclusive('\n').collect();
    for (idx, name) in many.iter().enumerate() {
        // Each ends a little earlier, because a recording given twice is refused.
        fs::write(path.join(name), lines[..lines.len() - 10 * idx].concat()).unwrap();
    }
    let arguments = [&["fit", "--method", "least-squares"][..], &many.iter().map(String::as_str).collect::<Vec<_>>()];
    let text = host_with(path, &arguments.concat()).stdout;
    let next = text.lines().find(|line| line.starts_with("next")).unwrap_or_default();
    assert!(next.contains("copy0.csv") && next.contains("10 recordings") && !next.contains("copy9.csv"), "{text}");
}

#[test]
fn a_name_that_begins_with_a_dash_is_no_option_in_the_next_command() {
    let folder = folder();
    fs::rename(folder.path().join("swing.csv"), folder.path().join("-dash.csv")).unwrap();
    let run = host(folder.path(), "fit --method least-squares -o=-rig.toml -- -dash.csv");
    assert!(run.succeeded().contains("host push --rig ./-rig.toml"), "{}", run.stdout);
    let run = host(folder.path(), "fit --method least-squares -- -dash.csv");
    let next = run.succeeded().lines().find_map(|line| line.strip_prefix("next       host ")).unwrap();
    assert_eq!(next, "fit ./-dash.csv -o rig.toml");
    host(folder.path(), &format!("{next} --method least-squares")).succeeded();
}

/// Every command that takes recordings takes the runs of a file as several of them.
#[test]
fn the_runs_of_a_file_are_recordings_of_one_rig() {
    let folder = folder();
    let path = folder.path();
    let rows = |start: &str| {
        host(path, &format!("simulate --seconds 12 --rate 100 --start {start} --exact -o one.csv --force")).succeeded();
        let text = fs::read_to_string(path.join("one.csv")).unwrap();
        let rows = text.lines().filter(|line| line.starts_with(|sign: char| sign.is_ascii_digit()));
        rows.map(|row| format!("{row}\n")).collect::<String>()
    };
    let named = |run: u32, start: &str| rows(start).lines().map(|row| format!("{run},{row}\n")).collect::<String>();
    let text = format!("run,t,theta\n{}{}", named(1, "1.4"), named(2, "-1.0"));
    fs::write(path.join("both.csv"), text).unwrap();
    let fit = host(path, "fit both.csv --method least-squares --json -o fitted.toml");
    let fields: serde_json::Value = serde_json::from_str(fit.succeeded()).unwrap();
    let note = "note: both.csv, run 1: the file holds 2 runs (column 0 (run): 1, 2), each read as a recording; --run 2";
    assert!(fit.stderr.contains(note), "{}", fit.stderr);
    assert_eq!(fields["recordings"], serde_json::json!(["both.csv, run 1", "both.csv, run 2"]));
    assert!(fs::read_to_string(path.join("fitted.toml")).unwrap().contains("\"both.csv, run 2\""));
    let compared = host(path, "compare both.csv --run 2 --rig fitted.toml --json");
    let fields: serde_json::Value = serde_json::from_str(compared.succeeded()).unwrap();
    assert_eq!(fields["recordings"][0]["name"], "both.csv, run 2");
    assert_eq!(fields["recordings"].as_array().map(Vec::len), Some(1));
    host(path, "fit both.csv --run 1 --hold-out both.csv").failed(2, &["fitted", "held out"]);
    host(path, "fit both.csv --run 3").failed(1, &["no run 3", "2 runs", "--run"]);
}
