use super::*;
use crate::link;
use crate::recording::{self, ReadOptions, Recording};

fn plan(path: &Path) -> Plan<'_> {
    Plan { path, existing: Existing::Keep, wait_s: 60.0, limit_s: 300.0, started: None, live_every: 0 }
}

/// Records in a fresh folder and reads the file, if there is one.
fn run(port: &str, change: impl Fn(&mut Plan)) -> (Result<Taken, RecordError>, Option<Recording>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("swing.csv");
    let mut plan = plan(&path);
    change(&mut plan);
    let mut session = link::connect(port).unwrap();
    let taken = record(&mut session, &plan, &mut (), &AtomicBool::new(false));
    let read = path.exists().then(|| recording::read(&path, &ReadOptions::default()).unwrap());
    (taken, read)
}

#[test]
fn a_swing_of_the_simulated_rig_is_recorded_from_the_held_angle_to_rest() {
    let (taken, read) = run("sim", |_| ());
    let (taken, read) = (taken.unwrap(), read.unwrap());
    assert!(matches!(taken.end, End::AtRest) && taken.is_usable());
    assert!((taken.release_rad - 1.5).abs() < 0.01, "{}", taken.release_rad);
    assert_eq!((taken.frames_lost, taken.samples_lost, taken.n_samples), (0, 0, read.len()));
    assert!(read.gaps().is_empty() && (read.rate_hz() - 1000.0).abs() < 1e-6);
    assert!(read.header().firmware.as_ref().unwrap().starts_with("simulated-rig"));
    let segments = recording::segment::segment(&read, &Default::default()).unwrap();
    let released = segments.release_s;
    assert!((0.5..4.0).contains(&released), "{released}");
}

#[test]
fn the_time_limit_ends_a_swing_and_keeps_it() {
    let (taken, read) = run("sim", |plan| plan.limit_s = 5.0);
    let taken = taken.unwrap();
    assert!(matches!(taken.end, End::TimeLimit) && taken.is_usable());
    let duration_s = read.unwrap().duration_s();
    assert!((6.0..8.0).contains(&duration_s), "{duration_s}");
}

#[test]
fn a_broken_wire_is_told_at_once_and_leaves_no_file() {
    let (taken, read) = run("sim:broken-wire", |_| ());
    assert!(matches!(taken, Err(RecordError::Disconnected { code: 0, .. })));
    assert!(read.is_none());
}

#[test]
fn a_wire_that_comes_off_keeps_what_was_recorded() {
    let (taken, read) = run("sim:loose-wire", |_| ());
    let taken = taken.unwrap();
    assert!(matches!(taken.end, End::Disconnected { code: 0, .. }));
    // Readings of a fifth of a second, and the one that was too many.
    assert_eq!(taken.samples_lost, 201);
    assert!(read.unwrap().duration_s() > 8.0);
}

#[test]
fn without_a_release_it_gives_up_and_leaves_no_file() {
    let (taken, read) = run("sim", |plan| plan.wait_s = 2.0);
    assert!(matches!(taken, Err(RecordError::NoRelease { .. })));
    assert!(read.is_none());
}

#[test]
fn an_existing_file_is_left_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("swing.csv");
    std::fs::write(&path, "mine").unwrap();
    let mut session = link::connect("sim").unwrap();
    let taken = record(&mut session, &plan(&path), &mut (), &AtomicBool::new(false));
    assert!(matches!(taken, Err(RecordError::Write(WriteError::Exists { .. }))));
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "mine");
}

#[test]
fn swings_that_begin_in_the_same_second_have_files_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    for _ in 0..3 {
        let path = unused_path(folder.path(), "-a");
        let name = path.file_name().unwrap().to_str().unwrap();
        assert!(path.starts_with(folder.path()) && !path.exists());
        assert!(name.starts_with("swing-20") && name.contains("-a") && name.ends_with(".csv"), "{name}");
        std::fs::write(&path, "").unwrap();
    }
}
