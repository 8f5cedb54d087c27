//! The commands as a person uses them, on the simulated rig.

use serde_json::Value;
use tests::program::host;

const INIT: &str = "init --mass 0.1466084 --length 0.1562177 --inertia 0.00284252";

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

/// Stdout must be exactly one object.
fn json(stdout: &str) -> Value {
    serde_json::from_str(stdout).unwrap_or_else(|error| panic!("{error}:\n{stdout}"))
}

#[test]
fn a_file_straight_from_init_serves_every_command() {
    let folder = folder();
    host(folder.path(), INIT).succeeded();
    host(folder.path(), "simulate --seconds 20 -o simulated.csv").succeeded();
    host(folder.path(), "push --port sim").succeeded();
    host(folder.path(), "record --port sim -o swing.csv").succeeded();
    host(folder.path(), "fit swing.csv --method least-squares -o rig.toml").succeeded();
    let text = std::fs::read_to_string(folder.path().join("rig.toml")).unwrap();
    assert!(
        text.contains("recordings = [\"swing.csv\"]") && text.contains("# The model of one pendulum rig"),
        "{text}"
    );
    host(folder.path(), "push --rig rig.toml --port sim").succeeded();
}

#[test]
fn unknown_geometry_says_what_the_values_are_per() {
    let folder = folder();
    let run = host(folder.path(), "init --unknown-geometry -o rig.toml");
    assert!(run.succeeded().contains("per m·g·l"));
    let text = std::fs::read_to_string(folder.path().join("rig.toml")).unwrap();
    assert!(text.contains("normalised = true") && text.contains("per m·g·l"));
    host(folder.path(), "simulate --seconds 5 -o simulated.csv").succeeded();
}

#[test]
fn fit_from_a_port_records_fits_pushes_and_shows_the_gain() {
    let folder = folder();
    let result = json(host(folder.path(), "fit --port sim --method least-squares --json").succeeded());
    let number = |key: &str| result["check"][key].as_f64().unwrap();
    let (before, after) = (number("innovation_before_rad"), number("innovation_after_rad"));
    assert!(after < 1.3e-3 && before > 4.0 * after, "{before} → {after}");
    let inertia = result["parameters"].as_array().unwrap().iter().find(|p| p["symbol"] == "I").unwrap();
    assert!((inertia["value"].as_f64().unwrap() / 0.002_706_768_718 - 1.0).abs() < 5e-4, "{inertia}");
    let n_recordings = std::fs::read_dir(folder.path()).unwrap().count();
    assert_eq!(n_recordings, 2);
}

#[test]
fn no_push_leaves_the_rig_alone() {
    let folder = folder();
    let result = json(host(folder.path(), "fit --port sim --method least-squares --no-push --json").succeeded());
    assert!(result["check"].is_null());
}

#[test]
fn json_is_one_object_that_names_its_command() {
    let folder = folder();
    host(folder.path(), INIT).succeeded();
    let cases = [
        ("init", "init --unknown-geometry -o other.toml --json"),
        ("simulate", "simulate --seconds 2 -o simulated.csv --json"),
        ("record", "record --port sim -o swing.csv --json"),
        ("push", "push --port sim --json"),
        ("pull", "pull --port sim -o pulled.toml --json"),
        ("undo", "undo --port sim --json"),
        ("statistics", "statistics --port sim --json"),
    ];
    for (command, arguments) in cases {
        let object = json(host(folder.path(), arguments).succeeded());
        assert_eq!((object["command"].as_str(), object["format"].as_u64()), (Some(command), Some(1)));
    }
}

#[test]
fn pull_writes_what_the_rig_believes_and_updates_in_place() {
    let folder = folder();
    host(folder.path(), "pull --port sim").succeeded();
    let path = folder.path().join("rig.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("inertia = 0.00284252") && text.contains("zero_code = 2048.0"), "{text}");
    std::fs::write(&path, text.replace("[pendulum]", "[pendulum] # the brass one").replace("0.00284252", "0.003"))
        .unwrap();
    host(folder.path(), "pull --port sim").failed(2, &["rig.toml exists already", "--force"]);
    host(folder.path(), "pull --port sim --force").succeeded();
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(text.contains("# the brass one") && text.contains("0.00284252"), "{text}");
}

#[test]
fn a_simulated_swing_is_repeatable_and_knows_added_effects() {
    let folder = folder();
    host(folder.path(), INIT).succeeded();
    let swing = |name: &str, more: &str| {
        host(folder.path(), &format!("simulate --seconds 3 {more} -o {name}")).succeeded();
        std::fs::read_to_string(folder.path().join(name)).unwrap()
    };
    let plain = swing("a.csv", "--seed 1");
    assert_eq!(plain, swing("b.csv", "--seed 1"));
    assert_ne!(plain, swing("c.csv", "--seed 2"));
    assert_ne!(plain, swing("d.csv", "--seed 1 --with Cq=1e-3"));
    assert_eq!(plain.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())).count(), 3501);
}

#[test]
fn colours_stay_off_without_a_terminal() {
    let run = host(folder().path(), "fit missing.csv");
    assert!(!run.stderr.contains('\u{1b}'), "{}", run.stderr);
}

#[test]
fn every_help_fits_a_screen_and_has_an_example() {
    let folder = folder();
    let overview = host(folder.path(), "--help").succeeded().to_owned();
    let commands = overview.lines().filter_map(|line| line.strip_prefix("  ")?.split_whitespace().next());
    let known = ["init", "record", "fit", "push", "pull", "undo", "statistics", "simulate"];
    let listed: Vec<&str> = commands.filter(|word| known.contains(word)).collect();
    assert_eq!(listed, known, "{overview}");
    for command in known {
        let help = host(folder.path(), &format!("{command} --help")).succeeded().to_owned();
        assert!(help.lines().count() <= 60, "{command}: {} lines", help.lines().count());
        assert!(help.contains("Example:"), "{command}");
    }
}

#[cfg(unix)]
#[test]
fn a_pipe_or_a_link_named_as_the_file_stays_one() {
    use std::os::unix::fs::FileTypeExt;
    let folder = folder();
    let (pipe, link) = (folder.path().join("pipe"), folder.path().join("link.toml"));
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || std::fs::read_to_string(pipe).unwrap()
    });
    host(folder.path(), "init --unknown-geometry --force -o pipe").succeeded();
    // Looked at before the reader is waited for: it would wait for ever if the pipe were gone.
    assert!(pipe.metadata().unwrap().file_type().is_fifo());
    assert!(reader.join().unwrap().contains("normalised = true"));

    std::fs::write(folder.path().join("real.toml"), "").unwrap();
    std::os::unix::fs::symlink("real.toml", &link).unwrap();
    host(folder.path(), "init --unknown-geometry --force -o link.toml").succeeded();
    assert!(link.is_symlink());
    assert!(std::fs::read_to_string(folder.path().join("real.toml")).unwrap().contains("normalised = true"));
}
