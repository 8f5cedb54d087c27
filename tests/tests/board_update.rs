//! `host update` on the Feather's own image: the rig goes into its bootloader, the bootloader writes the file of the
//! release, and the program asks what runs then. Only dfu-util is not the real one: there is no bus between two programs
//! that it could use, so what stands in for it hands the file to the emulated bootloader.
#![cfg(unix)]

use serde_json::{Value, json};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tests::HANG;
use tests::emulator::{Chip, Terminal};
use tests::image::{Board, firmware, workspace};
use tests::plant::Scenario;
use tests::program::{PATIENT, path};

/// What the program calls: it passes its arguments on and says what it is told to say.
const DFU_UTIL: &str = r#"#!/bin/sh
[ "$1" = --version ] && exit 0
echo "$*" > "$(dirname "$0")/asked"
cat "$(dirname "$0")/answer"
"#;

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Between two looks at what the emulator says.
const LOOK_EVERY: Duration = Duration::from_millis(20);

/// A board, and a dfu-util that reaches it.
struct Bench {
    board: Arc<Mutex<Terminal>>,
    port: String,
    folder: tempfile::TempDir,
    dfu_util: Option<JoinHandle<()>>,
}

impl Bench {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let program = folder.path().join("dfu-util");
        std::fs::write(&program, DFU_UTIL).unwrap();
        std::fs::set_permissions(&program, PermissionsExt::from_mode(0o755)).unwrap();
        for pipe in ["asked", "answer"] {
            assert!(Command::new("mkfifo").arg(folder.path().join(pipe)).status().unwrap().success());
        }
        let board = Terminal::start(&Chip::of(Board::FeatherF405), Scenario::default()).unwrap();
        let port = board.port().to_owned();
        let board = Arc::new(Mutex::new(board));
        let (theirs, pipes) = (Arc::clone(&board), folder.path().to_owned());
        let dfu_util = std::thread::spawn(move || be_dfu_util(&theirs, &pipes));
        Self { board, port, folder, dfu_util: Some(dfu_util) }
    }

    fn host(&self, arguments: &[&str]) -> Output {
        let path_variable = std::env::var("PATH").unwrap();
        Command::new(path())
            .args(arguments)
            .args(["--port", &self.port, "--json"])
            .current_dir(self.folder.path())
            .env("PATH", format!("{}:{path_variable}", self.folder.path().display()))
            .env(PATIENT.0, PATIENT.1)
            .env("XDG_STATE_HOME", self.folder.path())
            .output()
            .unwrap()
    }

    /// What must succeed; gives the object that it prints.
    #[track_caller]
    fn done(&self, arguments: &[&str]) -> Value {
        let output = self.host(arguments);
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success(), "{arguments:?}: {said}\n{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_str(&said).unwrap()
    }

    /// Gives the rig what is in `before.toml` with another inertia.
    fn push_other(&self, factor: f64) {
        let before = std::fs::read_to_string(self.folder.path().join("before.toml")).unwrap();
        let mut table: toml::Table = before.parse().unwrap();
        let inertia = &mut table["pendulum"]["inertia"];
        let place = if inertia.is_table() { &mut inertia["value"] } else { inertia };
        *place = toml::Value::Float(place.as_float().unwrap() * factor);
        std::fs::write(self.folder.path().join("other.toml"), table.to_string()).unwrap();
        self.done(&["push", "--rig", "other.toml"]);
    }

    fn inertia(&self, file: &str) -> f64 {
        let table: toml::Table = std::fs::read_to_string(self.folder.path().join(file)).unwrap().parse().unwrap();
        let inertia = &table["pendulum"]["inertia"];
        inertia.get("value").unwrap_or(inertia).as_float().unwrap()
    }

    fn events_of(&self, kind: &str) -> Vec<Value> {
        events_of(&self.board, kind)
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        std::fs::write(self.folder.path().join("asked"), "end\n").unwrap();
        self.dfu_util.take().map(JoinHandle::join);
    }
}

fn events_of(board: &Mutex<Terminal>, kind: &str) -> Vec<Value> {
    board.lock().unwrap().events().into_iter().filter(|event| event["event"] == kind).collect()
}

/// Waits until something has happened so often.
fn wait_for(board: &Mutex<Terminal>, kind: &str, n: usize) -> Vec<Value> {
    let began = Instant::now();
    loop {
        let events = events_of(board, kind);
        if events.len() >= n {
            return events;
        }
        assert!(began.elapsed() < HANG, "no {kind}");
        std::thread::sleep(LOOK_EVERY);
    }
}

/// Lists the emulated bootloader once it runs, and gives it what it is to write. Its serial number is the one that the
/// board showed on USB before.
fn be_dfu_util(board: &Mutex<Terminal>, pipes: &Path) {
    let mut n_downloads = 0;
    loop {
        let asked = std::fs::read_to_string(pipes.join("asked")).unwrap();
        let answer = match asked.split_whitespace().next() {
            Some("--list") => {
                wait_for(board, "bootloader", n_downloads + 1);
                let usb = wait_for(board, "usb", 1);
                format!("Found DFU: [0483:df11] ver=2200, alt=0, serial={}\n", usb[0]["serial"])
            }
            Some("--device") => {
                // Named as from the folder that the program runs in.
                let file = pipes.join(asked.split_whitespace().next_back().unwrap());
                board.lock().unwrap().say(&json!({ "do": "download", "image": file })).unwrap();
                n_downloads += 1;
                wait_for(board, "download", n_downloads);
                String::new()
            }
            _ => return,
        };
        std::fs::write(pipes.join("answer"), answer).unwrap();
    }
}

/// The release's file, made of an image that calls itself so.
fn release(folder: &Path, version: &str) -> PathBuf {
    let mut image = std::fs::read(firmware(Board::FeatherF405).unwrap()).unwrap();
    let identity = |version: &str| format!("pendulum-rig firmware {version} for feather-f405;");
    let (old, new) = (identity(VERSION), identity(version));
    assert_eq!(old.len(), new.len(), "a version as long as ours");
    let at = image.windows(old.len()).position(|bytes| bytes == old.as_bytes()).unwrap();
    image[at..at + new.len()].copy_from_slice(new.as_bytes());
    let (elf, dfu) = (folder.join("image.elf"), folder.join("feather-f405.dfu"));
    std::fs::write(&elf, image).unwrap();
    let made = Command::new("python3").arg(workspace().join("tests/dfuse.py")).args([&elf, &dfu]).status().unwrap();
    assert!(made.success());
    dfu
}

#[test]
fn an_update_brings_the_image_onto_the_board_and_leaves_the_saved_model() {
    let bench = Bench::new();
    bench.done(&["pull", "-o", "before.toml"]);
    bench.push_other(1.125);

    release(bench.folder.path(), VERSION);
    let updated = bench.done(&["update", "."]);
    println!("{updated}");
    assert_eq!((&updated["board"], &updated["to"]), (&json!("feather-f405"), &json!(VERSION)));
    let written = bench.events_of("download");
    println!("{written:?}");
    assert_eq!(written.len(), 1);
    let erased = written[0]["erased"].as_array().unwrap();
    assert!(erased.contains(&json!(0)) && erased.contains(&json!(4)), "{erased:?}");
    assert!([1, 2, 3].iter().all(|of_store| !erased.contains(&json!(of_store))), "{erased:?}");

    bench.done(&["pull", "-o", "after.toml"]);
    assert!((bench.inertia("after.toml") / bench.inertia("before.toml") - 1.125).abs() < 1e-6);
}

#[test]
fn an_image_that_is_not_what_it_calls_itself_is_found_out() {
    let bench = Bench::new();
    release(bench.folder.path(), "9.9.9");
    let output = bench.host(&["update", "."]);
    let said = String::from_utf8_lossy(&output.stderr);
    println!("{said}");
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains(&format!("says it runs {VERSION}, not 9.9.9")), "{said}");
    assert_eq!(bench.events_of("download").len(), 1);
}

#[test]
fn undo_brings_back_what_was_pushed_before_and_the_board_keeps_it_without_power() {
    let bench = Bench::new();
    bench.done(&["pull", "-o", "before.toml"]);
    bench.push_other(1.125);
    bench.push_other(1.25);
    bench.done(&["undo"]);
    bench.board.lock().unwrap().say(&json!({ "do": "power" })).unwrap();
    bench.done(&["pull", "-o", "after.toml"]);
    assert!((bench.inertia("after.toml") / bench.inertia("before.toml") - 1.125).abs() < 1e-6);
    assert_eq!(bench.events_of("reset").iter().filter(|reset| reset["cause"] == "watchdog").count(), 0);
}
