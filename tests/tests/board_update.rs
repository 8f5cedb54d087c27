//! `host update` on the boards' own images: the rig goes into its bootloader, or a probe halts it; the file of the release
//! is written, and the program asks what runs then. Only dfu-util and probe-rs are not the real ones: there is no bus
//! between two programs that they could use, so what stands in for them hands the file to the emulator.
#![cfg(unix)]

use serde_json::{Value, json};
use std::ffi::OsString;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tests::HANG;
use tests::emulator::{Chip, Terminal};
use tests::image::{Board, firmware, workspace};
use tests::plant::Scenario;
use tests::program::{PATIENT, path};

/// What the program calls: it passes its arguments on, and says what it is told to say or fails as dfu-util does.
const TOOL: &str = r#"#!/bin/sh
[ "$1" = --version ] && exit 0
echo "$*" > "$(dirname "$0")/asked"
answer=$(cat "$(dirname "$0")/answer")
[ "$answer" = refused ] && exit 74
echo "$answer"
"#;

const REFUSED: &str = "refused";

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Between two looks at what the emulator says.
const LOOK_EVERY: Duration = Duration::from_millis(20);

/// A board, and tools that reach it.
struct Bench {
    board: Arc<Mutex<Terminal>>,
    port: String,
    folder: tempfile::TempDir,
    tools: Option<JoinHandle<()>>,
}

impl Bench {
    fn of(chip: &Chip) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for name in ["dfu-util", "probe-rs"] {
            let program = folder.path().join(name);
            std::fs::write(&program, TOOL).unwrap();
            std::fs::set_permissions(&program, PermissionsExt::from_mode(0o755)).unwrap();
        }
        for pipe in ["asked", "answer"] {
            assert!(Command::new("mkfifo").arg(folder.path().join(pipe)).status().unwrap().success());
        }
        let board = Terminal::start(chip, Scenario::default()).unwrap();
        let port = board.port().to_owned();
        let board = Arc::new(Mutex::new(board));
        let (theirs, pipes) = (Arc::clone(&board), folder.path().to_owned());
        let tools = std::thread::spawn(move || be_the_tools(&theirs, &pipes));
        Self { board, port, folder, tools: Some(tools) }
    }

    fn feather() -> Self {
        Self::of(&Chip::of(Board::FeatherF405))
    }

    fn host(&self, arguments: &[&str]) -> Output {
        let programs = format!("{}:{}", self.folder.path().display(), std::env::var("PATH").unwrap());
        self.host_with(&programs.into(), arguments)
    }

    /// With other programs than those of the bench.
    fn host_with(&self, programs: &OsString, arguments: &[&str]) -> Output {
        Command::new(path())
            .args(arguments)
            .args(["--port", &self.port, "--json"])
            .current_dir(self.folder.path())
            .env("PATH", programs)
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

    /// The rig's model is that of `before.toml` with another inertia.
    #[track_caller]
    fn still_has(&self, factor: f64) {
        self.done(&["pull", "-o", "after.toml"]);
        let ratio = self.inertia("after.toml") / self.inertia("before.toml");
        assert!((ratio / factor - 1.0).abs() < 1e-6, "{ratio} times the inertia");
    }

    fn events_of(&self, kind: &str) -> Vec<Value> {
        events_of(&self.board, kind)
    }

    fn press_reset(&self) {
        self.board.lock().unwrap().say(&json!({ "do": "reset" })).unwrap();
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        std::fs::write(self.folder.path().join("asked"), "end\n").unwrap();
        self.tools.take().map(JoinHandle::join);
    }
}

fn events_of(board: &Mutex<Terminal>, kind: &str) -> Vec<Value> {
    board.lock().unwrap().events().into_iter().filter(|event| event["event"] == kind).collect()
}

/// Waits until something has happened so often, or was refused.
fn wait_for(board: &Mutex<Terminal>, kind: &str, n: usize) -> Vec<Value> {
    let began = Instant::now();
    loop {
        let events = events_of(board, kind);
        if events.len() >= n || !events_of(board, REFUSED).is_empty() {
            return events;
        }
        assert!(began.elapsed() < HANG, "no {kind}");
        std::thread::sleep(LOOK_EVERY);
    }
}

/// Lists the emulated bootloader once it runs, and gives it or the emulated probe what is to be written. The
/// bootloader's serial number is the one that the board showed on USB before.
fn be_the_tools(board: &Mutex<Terminal>, pipes: &Path) {
    let mut n_written = 0;
    loop {
        let asked = std::fs::read_to_string(pipes.join("asked")).unwrap();
        // Named as from the folder that the program runs in.
        let file = || pipes.join(asked.split_whitespace().next_back().unwrap());
        let mut write = |what: &str| {
            board.lock().unwrap().say(&json!({ "do": what, "image": file() })).unwrap();
            let is_written = wait_for(board, what, n_written + 1).len() > n_written;
            n_written += usize::from(is_written);
            if is_written { String::new() } else { REFUSED.to_owned() }
        };
        let answer = match asked.split_whitespace().next() {
            Some("--list") => {
                wait_for(board, "bootloader", n_written + 1);
                let usb = wait_for(board, "usb", 1);
                format!("Found DFU: [0483:df11] ver=2200, alt=0, serial={}\n", usb[0]["serial"])
            }
            Some("--device") => write("download"),
            Some("download") => write("probe"),
            Some("reset") => {
                board.lock().unwrap().say(&json!({ "do": "reset" })).unwrap();
                String::new()
            }
            _ => return,
        };
        std::fs::write(pipes.join("answer"), answer).unwrap();
    }
}

/// The release's file for a board in this folder, made of an image that calls itself so.
fn release(folder: &Path, board: Board, version: &str) {
    let name = board.feature().trim_start_matches("board-");
    let mut image = std::fs::read(firmware(board).unwrap()).unwrap();
    let identity = |version: &str| format!("pendulum-rig firmware {version} for {name};");
    let (old, new) = (identity(VERSION), identity(version));
    assert_eq!(old.len(), new.len(), "a version as long as ours");
    let at = image.windows(old.len()).position(|bytes| bytes == old.as_bytes()).unwrap();
    image[at..at + new.len()].copy_from_slice(new.as_bytes());
    let [elf, dfu] = ["elf", "dfu"].map(|suffix| folder.join(format!("{name}.{suffix}")));
    std::fs::write(&elf, image).unwrap();
    let made = Command::new("python3").arg(workspace().join("tests/dfuse.py")).args([&elf, &dfu]).status().unwrap();
    assert!(made.success());
}

#[test]
fn an_update_brings_the_image_onto_the_board_and_leaves_the_saved_model() {
    let bench = Bench::feather();
    bench.done(&["pull", "-o", "before.toml"]);
    bench.push_other(1.125);

    release(bench.folder.path(), Board::FeatherF405, VERSION);
    let updated = bench.done(&["update", "."]);
    println!("{updated}");
    assert_eq!((&updated["board"], &updated["to"]), (&json!("feather-f405"), &json!(VERSION)));
    let written = bench.events_of("download");
    println!("{written:?}");
    assert_eq!(written.len(), 1);
    let erased = written[0]["erased"].as_array().unwrap();
    assert!(erased.contains(&json!(0)) && erased.contains(&json!(4)), "{erased:?}");
    assert!([1, 2, 3].iter().all(|of_store| !erased.contains(&json!(of_store))), "{erased:?}");

    bench.still_has(1.125);
}

/// A probe leaves the processor halted.
#[test]
fn the_nucleo_is_updated_through_its_probe_and_runs_again_with_its_saved_model() {
    let bench = Bench::of(&Chip::of(Board::NucleoF446));
    bench.done(&["pull", "-o", "before.toml"]);
    bench.push_other(1.125);
    release(bench.folder.path(), Board::NucleoF446, VERSION);
    let updated = bench.done(&["update", "."]);
    println!("{updated}");
    assert_eq!((&updated["board"], &updated["to"]), (&json!("nucleo-f446"), &json!(VERSION)));
    assert_eq!(bench.events_of("probe").len(), 1);
    bench.still_has(1.125);
}

#[test]
fn a_chip_that_is_protected_against_reading_takes_no_image_and_keeps_what_it_has() {
    for (board, words) in [
        (Board::FeatherF405, ["dfu-util ended with exit status: 74", "protected against reading"]),
        (Board::NucleoF446, ["probe-rs ended with exit status: 74", "protected against reading"]),
    ] {
        let bench = Bench::of(&Chip { read_protection: 1, ..Chip::of(board) });
        bench.done(&["pull", "-o", "before.toml"]);
        bench.push_other(1.125);
        release(bench.folder.path(), board, VERSION);
        let output = bench.host(&["update", "."]);
        let said = String::from_utf8_lossy(&output.stderr);
        println!("{said}");
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(words.iter().all(|word| said.contains(word)), "{said}");
        assert_eq!(bench.events_of(REFUSED).len(), 1, "{board:?}");
        bench.press_reset();
        bench.still_has(1.125);
    }
}

#[test]
fn without_its_tool_an_update_says_what_to_install_and_touches_nothing() {
    for (board, tool) in [(Board::FeatherF405, "dfu-util"), (Board::NucleoF446, "probe-rs")] {
        let bench = Bench::of(&Chip::of(board));
        release(bench.folder.path(), board, VERSION);
        let nowhere = bench.folder.path().join("nowhere").into_os_string();
        let output = bench.host_with(&nowhere, &["update", "."]);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{said}");
        let words = [&format!("{tool} is needed"), "install it", "nothing was changed"];
        assert!(words.iter().all(|word| said.contains(word)), "{said}");
        // Power came on before somebody listened.
        assert_eq!(["bootloader", "probe", "reset"].map(|kind| bench.events_of(kind).len()), [0; 3]);
    }
}

#[test]
fn an_image_that_is_not_what_it_calls_itself_is_found_out() {
    let bench = Bench::feather();
    release(bench.folder.path(), Board::FeatherF405, "9.9.9");
    let output = bench.host(&["update", "."]);
    let said = String::from_utf8_lossy(&output.stderr);
    println!("{said}");
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains(&format!("says it runs {VERSION}, not 9.9.9")), "{said}");
    assert_eq!(bench.events_of("download").len(), 1);
}

#[test]
fn undo_brings_back_what_was_pushed_before_and_the_board_keeps_it_without_power() {
    let bench = Bench::feather();
    bench.done(&["pull", "-o", "before.toml"]);
    bench.push_other(1.125);
    bench.push_other(1.25);
    bench.done(&["undo"]);
    bench.board.lock().unwrap().say(&json!({ "do": "power" })).unwrap();
    bench.still_has(1.125);
    assert_eq!(bench.events_of("reset").iter().filter(|reset| reset["cause"] == "watchdog").count(), 0);
}
