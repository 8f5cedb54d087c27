//! Recordings outlive the program: killed at any moment, it leaves a file that is the beginning of the whole.
#![cfg(unix)]

use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use tests::chance::Chance;
use tests::program::{self, host};

/// Runs; `TRUST_RUNS` makes it more.
const N_RUNS: u64 = 200;

const RECORD: [&str; 6] = ["record", "--quiet", "--port", "sim", "-o", "swing.csv"];

fn record(folder: &Path) -> Command {
    let mut command = Command::new(program::path());
    command.args(RECORD).current_dir(folder).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command
}

/// The rows of a recording without its header.
fn rows(text: &str) -> Vec<&str> {
    text.split_inclusive('\n').filter(|line| line.starts_with(|first: char| first.is_ascii_digit())).collect()
}

#[test]
fn a_recording_killed_at_any_moment_is_the_beginning_of_the_whole() {
    let n_runs = std::env::var("TRUST_RUNS").map_or(N_RUNS, |runs| runs.parse().unwrap());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("swing.csv");
    let began = Instant::now();
    assert!(record(folder.path()).status().unwrap().success());
    let takes = began.elapsed();
    let whole = std::fs::read_to_string(&path).unwrap();
    let whole = rows(&whole);
    let (mut n_cut, mut n_read) = (0, 0);
    for seed in 0..n_runs {
        let _ = std::fs::remove_file(&path);
        let mut process = record(folder.path()).spawn().unwrap();
        std::thread::sleep(takes.mul_f64(Chance::new(seed).within(0.0..1.2)));
        process.kill().unwrap();
        process.wait().unwrap();
        let Ok(text) = std::fs::read_to_string(&path) else { continue };
        let rows = rows(&text);
        // The last line may be cut.
        let n_whole = rows.iter().filter(|row| row.ends_with('\n')).count();
        assert!(n_whole + 1 >= rows.len(), "seed {seed}");
        assert_eq!(rows[..n_whole], whole[..n_whole], "seed {seed}");
        n_cut += u64::from(n_whole < whole.len());
        // What the system was given comes once a second of the swing: at 1 kHz at least a thousand rows or none.
        if n_whole >= 2000 {
            n_read += 1;
            let kept = host::recording::read(&path, &Default::default()).unwrap();
            assert_eq!(kept.len(), n_whole, "seed {seed}");
        }
    }
    println!("{n_runs} runs of {takes:?}: {n_cut} cut, {n_read} read back");
    assert!(n_cut > n_runs / 4 && n_read > n_runs / 8, "{n_cut} {n_read}");
}

#[test]
fn a_full_disk_is_named_and_ends_the_recording() {
    let folder = tempfile::tempdir().unwrap();
    host(folder.path(), "record --port sim --force -o /dev/full").failed(1, &["/dev/full", "No space left"]);
    host(folder.path(), "init --mass 0.1466084 --length 0.1562177 --inertia 0.00284252").succeeded();
    host(folder.path(), "simulate --force -o /dev/full").failed(1, &["/dev/full", "No space left"]);
}

#[test]
fn a_folder_that_takes_no_files_is_named_before_anybody_swings() {
    let folder = tempfile::tempdir().unwrap();
    host(folder.path(), "record --port sim -o /proc/swing.csv").failed(1, &["/proc/swing.csv"]);
    host(folder.path(), "record --port sim -o nowhere/swing.csv").failed(1, &["nowhere/swing.csv"]);
}

/// As whoever may not write there; the system's own files serve where the tests run as root.
#[test]
fn a_read_only_folder_is_named_and_what_lies_in_it_stays() {
    let folder = tempfile::tempdir().unwrap();
    let locked = folder.path().join("locked");
    std::fs::create_dir(&locked).unwrap();
    std::fs::write(locked.join("kept.csv"), "kept").unwrap();
    let allow = |writing: bool| {
        let mut permissions = std::fs::metadata(&locked).unwrap().permissions();
        std::os::unix::fs::PermissionsExt::set_mode(&mut permissions, if writing { 0o755 } else { 0o555 });
        std::fs::set_permissions(&locked, permissions).unwrap();
    };
    allow(false);
    let is_root = std::fs::write(locked.join("root"), "").is_ok();
    let place = if is_root { "/proc" } else { "locked" };
    host(folder.path(), &format!("record --port sim -o {place}/swing.csv")).failed(1, &[&format!("{place}/swing.csv")]);
    host(folder.path(), "init --mass 0.1466084 --length 0.1562177 --inertia 0.00284252").succeeded();
    host(folder.path(), &format!("simulate -o {place}/swing.csv")).failed(1, &[&format!("{place}/swing.csv")]);
    let init = format!("init --mass 0.1 --length 0.2 --inertia 0.001 -o {place}/rig.toml");
    host(folder.path(), &init).failed(1, &[&format!("{place}/rig.toml")]);
    allow(true);
    assert_eq!(std::fs::read_to_string(locked.join("kept.csv")).unwrap(), "kept");
}

#[test]
fn a_file_that_is_replaced_while_it_is_read_is_read_whole_before_or_after() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("swing.csv");
    let text = |angle: f64| {
        let rows: String = (0..2000).map(|k| format!("{:.3},{angle}\n", 1e-3 * f64::from(k))).collect();
        format!("t,theta\n{rows}")
    };
    let texts = [text(0.5), text(-0.25)];
    std::fs::write(&path, &texts[0]).unwrap();
    let read = || host::recording::read(&path, &Default::default());
    let done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            for k in 0.. {
                if done.load(Ordering::Relaxed) {
                    return;
                }
                let beside = folder.path().join("new.csv");
                std::fs::write(&beside, &texts[k % 2]).unwrap();
                std::fs::rename(&beside, &path).unwrap();
            }
        });
        let mut seen = [0, 0];
        let began = Instant::now();
        while seen.iter().any(|n| *n < 50) && began.elapsed() < Duration::from_secs(20) {
            let recording = read().unwrap();
            let angles = recording.angles_rad();
            assert!(angles.len() == 2000 && angles.iter().all(|angle| *angle == angles[0]), "a mixture");
            seen[usize::from(angles[0] < 0.0)] += 1;
        }
        done.store(true, Ordering::Relaxed);
        assert!(seen.iter().all(|n| *n >= 50), "{seen:?}");
    });
}

/// Written over in its place, as an editor or a second recording may do it.
#[test]
fn a_file_that_is_cut_while_it_is_read_is_its_beginning_or_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("swing.csv");
    let rows: String =
        (0..2000).map(|k| format!("{:.3},{}\n", 1e-3 * f64::from(k), 0.1 + 1e-4 * f64::from(k))).collect();
    let whole = format!("t,theta\n{rows}");
    std::fs::write(&path, &whole).unwrap();
    let all = host::recording::read(&path, &Default::default()).unwrap();
    let done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !done.load(Ordering::Relaxed) {
                std::fs::write(&path, &whole).unwrap();
            }
        });
        let (mut n_read, mut n_refused) = (0, 0);
        for _ in 0..2000 {
            match host::recording::read(&path, &Default::default()) {
                Ok(recording) => {
                    assert_eq!(recording.angles_rad(), &all.angles_rad()[..recording.len()]);
                    n_read += 1;
                }
                Err(error) => {
                    assert!(error.to_string().contains("swing.csv"), "{error}");
                    n_refused += 1;
                }
            }
        }
        done.store(true, Ordering::Relaxed);
        println!("{n_read} read, {n_refused} refused");
        assert!(n_read > 0);
    });
}
