//! Recordings outlive the program: killed at any moment, it leaves a file that is the beginning of the whole.
#![cfg(target_os = "linux")]

use host::link::{Port, Session};
use host::record::Plan;
use host::recording::Existing;
use host::sim::{Scenario, SimulatedRig};
use std::cell::Cell;
use std::io;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::rc::Rc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};
use tests::HANG;
use tests::chance::Chance;
use tests::program::{self, host};

/// Runs; `TRUST_RUNS` makes it more.
const N_RUNS: u64 = 100;

/// Samples that need not be in the file yet: the second between two flushes, and what is on its way from the rig.
const NOT_YET_THERE: u64 = 1000 + 100;

/// The rows of a recording without its header.
fn rows(text: &str) -> Vec<&str> {
    text.split_inclusive('\n').filter(|line| line.starts_with(|first: char| first.is_ascii_digit())).collect()
}

/// Records with a limit on the size of files, bytes. What writes beyond it is killed by the system (SIGXFSZ), so that a
/// kill comes after so many bytes however fast the computer is.
fn record(folder: &Path, most_bytes: u64) -> ExitStatus {
    let limit = format!("--fsize={most_bytes}");
    let record = ["record", "--quiet", "--port", "sim", "-o", "swing.csv", "--force"];
    let mut command = Command::new("prlimit");
    command.args([&limit, "--core=0"]).arg(program::path()).args(record).current_dir(folder);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status().unwrap()
}

#[test]
fn a_recording_killed_after_any_byte_is_the_beginning_of_the_whole() {
    let n_runs = std::env::var("TRUST_RUNS").map_or(N_RUNS, |runs| runs.parse().unwrap());
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("swing.csv");
    assert!(record(folder.path(), u64::MAX >> 1).success());
    let text = std::fs::read_to_string(&path).unwrap();
    let whole = rows(&text);
    let header = text.len() - whole.iter().map(|row| row.len()).sum::<usize>();
    let mut n_read = 0;
    for seed in 0..n_runs {
        let n_bytes = Chance::new(seed).within(0.0..text.len() as f64) as usize;
        std::fs::remove_file(&path).unwrap();
        let status = record(folder.path(), n_bytes as u64);
        assert!(status.signal().is_some(), "seed {seed}: {status}");
        let kept = std::fs::read_to_string(&path).unwrap();
        assert_eq!(kept.len(), n_bytes, "seed {seed}");
        // The header has the time of day.
        assert_eq!(kept.get(header..), text[..n_bytes].get(header..), "seed {seed}");
        let n_whole = rows(&kept).iter().filter(|row| row.ends_with('\n')).count();
        if n_whole >= host::recording::MIN_SAMPLES {
            n_read += 1;
            let recording = host::recording::read(&path, &Default::default()).unwrap();
            assert_eq!(recording.len(), n_whole, "seed {seed}");
        }
    }
    println!("{n_runs} runs cut in {} bytes, {n_read} read back", text.len());
    assert!(n_read > n_runs * 9 / 10, "{n_read}");
}

#[test]
fn a_recording_killed_over_an_old_file_leaves_that_and_its_own_beginning() {
    const N_BYTES: usize = 100_000;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("swing.csv");
    assert!(record(folder.path(), u64::MAX >> 1).success());
    let old = std::fs::read_to_string(&path).unwrap();
    assert!(record(folder.path(), N_BYTES as u64).signal().is_some());
    assert_eq!(std::fs::read_to_string(&path).unwrap(), old);
    let files: Vec<PathBuf> = std::fs::read_dir(folder.path()).unwrap().map(|file| file.unwrap().path()).collect();
    let beside: Vec<&PathBuf> = files.iter().filter(|file| **file != path).collect();
    assert_eq!(beside.len(), 1, "{files:?}");
    assert!(beside[0].extension().is_some_and(|extension| extension == "new"), "{files:?}");
    let kept = std::fs::read_to_string(beside[0]).unwrap();
    assert_eq!(kept.len(), N_BYTES);
    // The header has the time of day.
    let (rows_kept, rows_old) = (rows(&kept), rows(&old));
    let n_whole = rows_kept.len() - 1;
    assert!(n_whole > 1000 && rows_kept[..n_whole] == rows_old[..n_whole], "{n_whole} rows");
}

#[test]
fn an_old_recording_stays_until_there_is_a_better_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("o.csv");
    std::fs::write(&path, "precious").unwrap();
    let n_files = || std::fs::read_dir(folder.path()).unwrap().count();
    let record = |more: &str| host(folder.path(), &format!("record --port sim -o o.csv --force {more}"));
    record("--wait 0.8").failed(1, &["within 0.8 s"]);
    record("--wait 1").failed(1, &["no release was seen within 1 s"]);
    assert_eq!((std::fs::read_to_string(&path).unwrap().as_str(), n_files()), ("precious", 1));
    record("--limit 0.5").failed(1, &["the time was up", "samples are kept in", ".new", "--limit"]);
    assert_eq!((std::fs::read_to_string(&path).unwrap().as_str(), n_files()), ("precious", 2));
    record("--limit 5").succeeded();
    assert!(rows(&std::fs::read_to_string(&path).unwrap()).len() > 5000 && n_files() == 2);
}

/// The simulated rig, with a look at the file on the disk before every read: what is there then, a kill would leave.
struct Watched {
    rig: SimulatedRig,
    path: PathBuf,
    began: Option<u64>,
    n_looks: Rc<Cell<u64>>,
}

impl Watched {
    /// Are all samples in the file but those of the last second?
    fn look(&mut self) {
        let now = (self.rig.elapsed_s() * 1000.0).round() as u64;
        let Ok(text) = std::fs::read_to_string(&self.path) else { return };
        let n_rows = rows(&text).len() as u64;
        // The lead-in comes at once with the release; from there on the file grows as time goes on.
        let began = match (self.began, n_rows) {
            (_, 0) => return,
            (None, _) => *self.began.insert(now - n_rows),
            (Some(began), _) => began,
        };
        assert!(began + n_rows + NOT_YET_THERE > now, "{n_rows} rows {} ms after the first", now - began);
        self.n_looks.set(self.n_looks.get() + 1);
    }
}

impl Port for Watched {
    fn name(&self) -> &str {
        "watched"
    }

    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize> {
        self.look();
        Ok(self.rig.read(buffer, timeout))
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.rig.receive(bytes);
        Ok(())
    }

    fn elapsed(&self) -> Duration {
        Duration::from_secs_f64(self.rig.elapsed_s())
    }
}

#[test]
fn at_any_moment_all_but_the_last_second_of_a_recording_is_on_the_disk() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("swing.csv");
    let n_looks = Rc::new(Cell::new(0));
    let rig = SimulatedRig::new(Scenario::by_name("plain").unwrap(), 1);
    let port = Watched { rig, path: path.clone(), began: None, n_looks: n_looks.clone() };
    let mut session = Session::open(Box::new(port)).unwrap();
    let existing = Existing::Keep;
    let plan = Plan { path: &path, existing, wait_s: 20.0, limit_s: 10.0, live_every: 0, started: None };
    let taken = host::record::record(&mut session, &plan, &mut (), &AtomicBool::new(false)).unwrap();
    assert!(taken.n_samples > 10_000 && n_looks.get() > 500, "{} samples, {n_looks:?} looks", taken.n_samples);
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
    let angle = |k: i32| 0.1 + 1e-4 * f64::from(k);
    let text = |side: f64| {
        let row = |k: i32| format!("{:.3},{}\n", 1e-3 * f64::from(k), side * angle(k));
        format!("t,theta\n{}", (0..2000).map(row).collect::<String>())
    };
    let texts = [text(1.0), text(-1.0)];
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
        let _until_then = AtLast(&done);
        let mut seen = [0, 0];
        let began = Instant::now();
        while seen.iter().any(|n| *n < 50) && began.elapsed() < HANG {
            let recording = read().unwrap();
            let angles = recording.angles_rad();
            let side = angles[0].signum();
            let is_whole = angles.iter().zip(0..).all(|(found, k)| *found == side * angle(k));
            assert!(angles.len() == 2000 && is_whole, "a mixture");
            seen[usize::from(angles[0] < 0.0)] += 1;
        }
        assert!(seen.iter().all(|n| *n >= 50), "{seen:?}");
    });
}

/// Ends the other thread however this one ends.
struct AtLast<'a>(&'a AtomicBool);

impl Drop for AtLast<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
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
    let (done, n_reads) = (AtomicBool::new(false), AtomicU64::new(0));
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !done.load(Ordering::Relaxed) {
                std::fs::write(&path, &whole).unwrap();
                // The second of two reads that end from now on finds the whole file; the first may have found less.
                let before = n_reads.load(Ordering::Relaxed);
                while n_reads.load(Ordering::Relaxed) < before + 2 && !done.load(Ordering::Relaxed) {
                    std::thread::yield_now();
                }
            }
        });
        let _until_then = AtLast(&done);
        let (mut n_read, mut n_refused) = (0, 0);
        let began = Instant::now();
        while n_read < 1000 && began.elapsed() < HANG {
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
            n_reads.fetch_add(1, Ordering::Relaxed);
        }
        println!("{n_read} read, {n_refused} refused");
        assert_eq!(n_read, 1000);
    });
}
