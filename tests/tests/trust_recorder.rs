//! A recording is written while it is taken: whoever looks into the file during the swing finds all but the last second;
//! live points come beside it; and a potentiometer that reads nonsense leaves no recording.

use host::doctor::Signal;
use host::link::{Port, Session};
use host::record::{End, Live, Plan, RecordError, Stage, Taken, Watch, record};
use host::recording::Existing;
use host::sim::{Scenario, SimulatedRig};
use shared::wire::{self, Deframer, Frame};
use std::cell::RefCell;
use std::io;
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use tests::chance::Chance;
use tests::coded::Coded;

/// What `record` promises: so much of the swing may be missing from the file at any moment, s.
const AT_MOST_MISSING_S: f64 = 1.0;

/// Samples a second of the simulated rig.
const RATE_HZ: f64 = 1000.0;

/// One frame holds so many samples; they come together.
const FRAME: u64 = 16;

/// What was in the file whenever somebody looked: number of the last sample handed over, rows of the file.
type Looks = Rc<RefCell<Vec<(u64, usize)>>>;

/// The simulated rig behind a cable at which somebody stands and looks into the file.
struct Watched {
    rig: SimulatedRig,
    path: PathBuf,
    listener: Deframer,
    last_sample: u64,
    looks: Looks,
}

impl Watched {
    fn look(&self) {
        let text = std::fs::read_to_string(&self.path).unwrap_or_default();
        let is_row = |line: &&str| line.starts_with(|first: char| first.is_ascii_digit()) && line.ends_with('\n');
        let n_rows = text.split_inclusive('\n').filter(is_row).count();
        self.looks.borrow_mut().push((self.last_sample, n_rows));
    }
}

impl Port for Watched {
    fn name(&self) -> &str {
        "watched"
    }

    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize> {
        // What was read before has been taken by now.
        if self.last_sample % 512 < FRAME {
            self.look();
        }
        let n_bytes = self.rig.read(buffer, timeout);
        for byte in &buffer[..n_bytes] {
            if let Some(Ok(Frame::Samples(samples))) = self.listener.push(*byte) {
                self.last_sample = samples.first_sample + samples.codes.len() as u64;
            }
        }
        Ok(n_bytes)
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
fn at_any_moment_of_the_swing_all_but_its_last_second_is_in_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("swing.csv");
    let looks = Looks::default();
    let rig = SimulatedRig::new(Scenario::by_name("plain").unwrap(), 1);
    let port = Watched { rig, path: path.clone(), listener: Deframer::new(), last_sample: 0, looks: Rc::clone(&looks) };
    let mut session = Session::open(Box::new(port)).unwrap();
    let plan =
        Plan { path: &path, existing: Existing::Keep, wait_s: 60.0, limit_s: 12.0, live_every: 0, started: None };
    let taken = record(&mut session, &plan, &mut (), &AtomicBool::new(false)).unwrap();
    assert!(matches!(taken.end, End::TimeLimit), "{:?}", taken.end);

    let looks = looks.borrow();
    let during: Vec<&(u64, usize)> = looks.iter().filter(|(_, n_rows)| *n_rows > 0).collect();
    // The first row is the end of the hold; from it on every sample has a row.
    let (first_look, first_rows) = **during.first().expect("nothing is in the file while the pendulum swings");
    let begins = first_look - first_rows as u64;
    let mut worst_s = 0.0_f64;
    for (last_sample, n_rows) in &during {
        let missing_s = ((last_sample - begins) as f64 - *n_rows as f64) / RATE_HZ;
        worst_s = worst_s.max(missing_s);
        let most_s = AT_MOST_MISSING_S + (2 * FRAME) as f64 / RATE_HZ;
        assert!(missing_s <= most_s, "{missing_s} s of the swing are not in the file after {n_rows} rows");
    }
    println!("{} looks, {worst_s:.2} s missing at most, {} rows in the end", during.len(), taken.n_samples);
    // Somebody looked from the first second to the last.
    assert!(during.len() >= 20 && first_rows < 4000 && taken.n_samples > 10_000, "{during:?}");
}

/// Counts what a person would see.
#[derive(Default)]
struct Seen {
    points: Vec<(u64, f32)>,
    n_lives: usize,
}

impl Watch for Seen {
    fn stage(&mut self, _: Stage) {}

    fn live(&mut self, _: &Live) {
        self.n_lives += 1;
    }

    fn points(&mut self, live: &wire::Live) {
        let numbers = (0_u64..).map(|place| live.first_sample + place * u64::from(live.every));
        self.points.extend(numbers.zip(live.points.iter().map(|point| point.filtered_rad)));
    }
}

#[test]
fn live_points_come_beside_the_recording_one_for_every_so_many_samples() {
    const EVERY: u16 = 50;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("swing.csv");
    let mut session = host::link::connect("sim").unwrap();
    let plan =
        Plan { path: &path, existing: Existing::Keep, wait_s: 60.0, limit_s: 5.0, live_every: EVERY, started: None };
    let mut seen = Seen::default();
    let taken = record(&mut session, &plan, &mut seen, &AtomicBool::new(false)).unwrap();
    // From the start of the stream to its end, hanging and lifting included.
    let n_expected = taken.n_samples / usize::from(EVERY);
    assert!(seen.points.len() >= n_expected && seen.n_lives > n_expected, "{} of {n_expected}", seen.points.len());
    assert!(seen.points.windows(2).all(|pair| pair[1].0 == pair[0].0 + u64::from(EVERY)), "a point is missing");
    // They follow the pendulum: held at 1.5 rad, then swinging to the other side.
    let (least, most) = seen.points.iter().fold((0.0_f32, 0.0_f32), |(a, b), point| (a.min(point.1), b.max(point.1)));
    assert!((most - 1.5).abs() < 0.1 && (-1.5..-1.0).contains(&least), "from {least} to {most} rad");
}

/// What came of an attempt to record codes as a function of time.
fn recorded(code: impl FnMut(f64) -> u16 + 'static) -> (Result<Taken, RecordError>, bool) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("swing.csv");
    let mut session = Session::open(Box::new(Coded::new(code))).unwrap();
    let plan =
        Plan { path: &path, existing: Existing::Keep, wait_s: 20.0, limit_s: 20.0, live_every: 0, started: None };
    let taken = record(&mut session, &plan, &mut (), &AtomicBool::new(false));
    (taken, path.exists())
}

/// A wire that nothing holds: it wanders, and picks up the mains.
fn floating(seed: u64) -> impl FnMut(f64) -> u16 + 'static {
    let (mut chance, mut wandering) = (Chance::new(seed), 2048.0_f64);
    move |time_s| {
        wandering = (wandering + 12.0 * chance.normal()).clamp(300.0, 3800.0);
        let mains = 150.0 * (std::f64::consts::TAU * 50.0 * time_s).sin();
        (wandering + mains + 3.0 * chance.normal()).round() as u16
    }
}

#[test]
fn a_wire_that_floats_is_never_taken_for_a_pendulum_at_rest() {
    for seed in 0..5 {
        let (taken, left_a_file) = recorded(floating(seed));
        let Err(error) = taken else { panic!("seed {seed}: recorded") };
        assert!(matches!(error, RecordError::NeverStill { .. }), "seed {seed}: {error}");
        assert!(!left_a_file, "seed {seed}");
    }
}

#[test]
fn the_doctor_does_not_call_a_floating_wire_a_pendulum_at_rest() {
    let mut session = Session::open(Box::new(Coded::new(floating(7)))).unwrap();
    let settings = session.settings().unwrap();
    let signal = Signal::listen(&mut session, &settings).unwrap();
    assert!(!signal.is_still() || signal.hum_codes > 50.0 || signal.spread_codes > 50.0, "{signal:?}");
}
