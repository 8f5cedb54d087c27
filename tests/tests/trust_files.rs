//! Recordings outlive the program: killed at any moment, it leaves a file that is the beginning of the whole.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;
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
