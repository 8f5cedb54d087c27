use super::*;
use crate::link::{self, Port};
use crate::recording::{self, ReadOptions, Recording};
use shared::wire::{Command, Frame, MAX_FRAME};
use std::io;
use std::time::Duration;

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

/// What happens to a rig or its cable.
#[derive(Clone, Copy, Debug)]
enum Mishap {
    Unplugged,
    /// For so many seconds.
    Silent(f64),
    StartedAnew,
}

/// The simulated rig until something happens, so many seconds after the port was opened.
struct Cable {
    port: Box<dyn Port>,
    mishap: Option<(f64, Mishap)>,
}

impl Port for Cable {
    fn name(&self) -> &str {
        "cable"
    }

    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let since_s = |at_s: f64| self.elapsed().as_secs_f64() - at_s;
        match self.mishap.filter(|(at_s, _)| since_s(*at_s) > 0.0) {
            Some((at_s, Mishap::Silent(seconds))) if since_s(at_s) < seconds => {
                self.port.read(buffer, timeout).map(|_| 0)
            }
            None | Some((_, Mishap::Silent(_))) => self.port.read(buffer, timeout),
            Some((_, Mishap::Unplugged)) => Err(io::Error::other("unplugged")),
            Some((_, Mishap::StartedAnew)) => {
                self.mishap = None;
                self.port = link::open("sim").unwrap();
                let start = Frame::Command(1, Command::Start(Stream { raw: true, live_every: 0 }));
                self.port.write(wire::encode(&start, &mut [0; MAX_FRAME]).unwrap())?;
                Ok(0)
            }
        }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.port.write(bytes)
    }

    fn elapsed(&self) -> Duration {
        self.port.elapsed()
    }
}

fn behind_cable(at_s: f64, mishap: Mishap) -> Session {
    Session::open(Box::new(Cable { port: link::open("sim").unwrap(), mishap: Some((at_s, mishap)) })).unwrap()
}

/// Hears nothing.
impl Listener for () {
    fn stage(&mut self, _: Stage) {}
    fn reading(&mut self, _: f64) {}
    fn gap(&mut self) {}
    fn pause(&mut self) {}
}

fn recorded_behind_cable(session: &mut Session) -> Result<End, RecordError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("swing.csv");
    record(session, &plan(&path), &mut (), &AtomicBool::new(false)).map(|taken| taken.end)
}

fn heard_behind_cable(session: &mut Session) -> Result<End, RecordError> {
    listen(session, Limits::USUAL, &mut (), &AtomicBool::new(false))
}

#[test]
fn what_happens_to_the_link_within_a_swing_ends_it_and_is_named() {
    for run in [recorded_behind_cable, heard_behind_cable] {
        let unplugged = run(&mut behind_cable(12.0, Mishap::Unplugged)).unwrap();
        assert!(matches!(unplugged, End::Lost(LinkError::Lost { .. })), "{unplugged:?}");
        let anew = run(&mut behind_cable(12.0, Mishap::StartedAnew)).unwrap();
        assert!(matches!(anew, End::Lost(LinkError::Restarted { .. })), "{anew:?}");
        let silent = run(&mut behind_cable(12.0, Mishap::Silent(1e9))).unwrap();
        assert!(matches!(silent, End::Lost(LinkError::StreamStopped { .. })), "{silent:?}");
        let paused = run(&mut behind_cable(12.0, Mishap::Silent(2.0))).unwrap();
        assert!(matches!(paused, End::AtRest), "{paused:?}");
    }
}

#[test]
fn what_happens_to_the_link_before_the_pendulum_is_still_is_an_error() {
    for run in [recorded_behind_cable, heard_behind_cable] {
        let unplugged = run(&mut behind_cable(0.3, Mishap::Unplugged));
        assert!(matches!(unplugged, Err(RecordError::Link(LinkError::Lost { .. }))), "{unplugged:?}");
    }
}

#[test]
fn a_file_says_how_it_was_taken() {
    use shared::sensor::Encoder;
    let sensor = Sensor::Encoder(Encoder::new(4096));
    let settings = wire::Settings { rate_hz: 500.0, cutoff_hz: 40.0, bandwidth_rad_s: 3.0, sensor };
    let header = header(&settings, "0.1.0", Some("2026-03-01T12:00:00Z".to_owned()));
    assert_eq!((header.rate_hz, header.cutoff_hz), (Some(500.0), Some(40.0)));
    assert_eq!((header.firmware.as_deref(), header.sensor.as_deref()), (Some("0.1.0"), Some("encoder")));
    assert_eq!(header.started.as_deref(), Some("2026-03-01T12:00:00Z"));
    // 4096 steps a turn.
    let step_rad = header.calibration.unwrap().radians_per_code;
    assert!((step_rad - std::f64::consts::TAU / 4096.0).abs() < 1e-9, "{step_rad}");
}
