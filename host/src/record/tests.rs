use super::*;
use crate::link::{self, Port, changed};
use crate::recording::{self, ReadOptions, Recording};
use shared::wire::{Answer, Clock, Command, Frame, Hello, MAX_FRAME};
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
    // The file begins before the release is noticed, with the end of the hold.
    let before_s = read.duration_s() - taken.swing_s;
    assert!((1.2..3.0).contains(&before_s), "{before_s}");
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
    let mut names: Vec<String> = Vec::new();
    for _ in 0..3 {
        let path = unused_path(folder.path(), "-a");
        let name = path.file_name().unwrap().to_str().unwrap();
        assert!(path.starts_with(folder.path()) && !path.exists());
        assert!(name.starts_with("swing-20") && name.contains("-a") && name.ends_with(".csv"), "{name}");
        // Where the second was over meanwhile, no number is needed.
        let same = names.iter().filter(|other| name.starts_with(&other[..22])).count();
        assert!(same == 0 || name.ends_with(&format!("-a-{}.csv", same + 1)), "{name} {names:?}");
        names.push(name.to_owned());
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

/// Frames of samples in 12 s: in the middle of the first swing.
const MID_SWING: usize = 750;

/// What becomes of the frames of samples, by their number since the program began.
fn with_samples(mut change: impl FnMut(usize, Frame) -> Vec<Frame> + Send + 'static) -> Session {
    let mut n_frames = 0;
    let counted = move |frame| {
        n_frames += usize::from(matches!(frame, Frame::Samples(_)));
        change(n_frames, frame)
    };
    changed::session(counted).unwrap()
}

#[test]
fn samples_that_come_twice_are_taken_once() {
    let twice = |n_frames, frame| match frame {
        Frame::Samples(_) if n_frames % 50 == 0 => vec![frame.clone(), frame],
        frame => vec![frame],
    };
    for run in [recorded_behind_cable, heard_behind_cable] {
        let mut session = with_samples(twice);
        let end = run(&mut session).unwrap();
        assert!(matches!(end, End::AtRest), "{end:?}");
        let tally = session.tally();
        assert!(tally.frames_repeated > 15 && tally.frames_lost == 0, "{tally:?}");
        assert_eq!((tally.samples_lost, tally.frames_repeated), (0, tally.frames / 50));
    }
}

#[test]
fn a_rig_that_greets_within_a_swing_was_started_anew_and_nobody_waits_for_its_samples() {
    let greets = |n_frames, frame| match frame {
        Frame::Samples(_) if n_frames == MID_SWING => vec![Frame::Hello(Hello::new("simulated-rig"))],
        Frame::Samples(_) if n_frames > MID_SWING => Vec::new(),
        frame => vec![frame],
    };
    for run in [recorded_behind_cable, heard_behind_cable] {
        let end = run(&mut with_samples(greets)).unwrap();
        assert!(matches!(end, End::Lost(LinkError::Restarted { .. })), "{end:?}");
    }
}

#[test]
fn a_greeting_that_was_long_on_its_way_is_no_restart() {
    let greeted_twice = |_, frame| match frame {
        // A rig answers in order, so that the answer to `Start` is the last thing before which one may come.
        Frame::Answer(2, Answer::Done) => vec![Frame::Hello(Hello::new("simulated-rig")), frame],
        frame => vec![frame],
    };
    for run in [recorded_behind_cable, heard_behind_cable] {
        let end = run(&mut with_samples(greeted_twice)).unwrap();
        assert!(matches!(end, End::AtRest), "{end:?}");
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
    let header_on = |clock| header(&settings, "0.1.0", clock, Some("2026-03-01T12:00:00Z".to_owned()));
    assert_eq!(header_on(Clock::Internal).clock.as_deref(), Some("internal"));
    let header = header_on(Clock::Crystal);
    assert_eq!(header.clock, None);
    assert_eq!((header.rate_hz, header.cutoff_hz), (Some(500.0), Some(40.0)));
    assert_eq!((header.firmware.as_deref(), header.sensor.as_deref()), (Some("0.1.0"), Some("encoder")));
    assert_eq!(header.started.as_deref(), Some("2026-03-01T12:00:00Z"));
    // 4096 steps a turn.
    let step_rad = header.calibration.unwrap().radians_per_code;
    assert!((step_rad - std::f64::consts::TAU / 4096.0).abs() < 1e-9, "{step_rad}");
}

/// The first things that a person may see while it swings.
#[derive(Default)]
struct Seen {
    stage: Option<Stage>,
    swinging: Vec<Live>,
}

impl Watch for Seen {
    fn stage(&mut self, stage: Stage) {
        self.stage = Some(stage);
    }
    fn live(&mut self, live: &Live) {
        if self.stage == Some(Stage::Swinging) {
            self.swinging.push(*live);
        }
    }
}

#[test]
fn while_it_swings_a_person_sees_its_amplitude_and_the_seconds_since_the_release() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("swing.csv");
    let plan = Plan { limit_s: 3.0, ..plan(&path) };
    let mut seen = Seen::default();
    record(&mut link::connect("sim").unwrap(), &plan, &mut seen, &AtomicBool::new(false)).unwrap();
    let (first, last) = (seen.swinging.first().unwrap(), seen.swinging.last().unwrap());
    assert!(first.elapsed_s < 0.2 && (2.5..3.1).contains(&last.elapsed_s), "{first:?} {last:?}");
    assert!(seen.swinging.iter().all(|live| live.amplitude_rad > 0.5 && live.amplitude_rad < 1.6), "{last:?}");
    assert!(seen.swinging.iter().any(|live| live.angle_rad < -0.5));
}

#[test]
fn what_leaves_no_recording_is_told_with_what_to_do_next() {
    use crate::error::Failure;
    use shared::sensor::Potentiometer;
    let told = |error: RecordError| {
        let failure = Failure::from(error);
        (failure.what().to_owned(), failure.next_step().unwrap_or_default().to_owned())
    };
    let (what, next) = told(RecordError::NoRelease { seconds: 60.0 });
    assert!(what == "no release was seen within 60 s" && next.contains("lift the pendulum"), "{what}; {next}");
    let (what, next) = told(RecordError::NeverStill { seconds: 60.0, spread_rad: 0.25 });
    assert!(what.contains("varies by 0.250 rad") && next.contains("by hand"), "{what}; {next}");
    let (what, next) = told(RecordError::StoppedEarly);
    assert!(what.contains("nothing was recorded") && next == "repeat the command", "{what}; {next}");
    let (what, next) = told(RecordError::Write(WriteError::Exists { path: "swing.csv".into() }));
    assert!(what.contains("swing.csv") && next.contains("--force"), "{what}; {next}");
    let sensor = Sensor::Potentiometer(Potentiometer::nominal(4095));
    let (what, next) = told(RecordError::Disconnected { code: 7, sensor });
    assert!(what.contains("reads code 7 of 0 … 4095"), "{what}");
    assert!(next.contains("hangs in the middle of its travel"), "{next}");
}
