//! A thousand recordings over links that flip, drop, insert, repeat, delay, split, stall, break or restart: no wrong
//! number ever enters a file, and what is missing is missing from its times, sample by sample.

use host::link::{Port, Session};
use host::record::{Plan, Taken, record};
use host::recording::{self, Existing, ReadOptions, Recording};
use host::sim::{Scenario, SimulatedRig};
use shared::wire::{self, Command, Deframer, Frame, MAX_FRAME};
use std::collections::{BTreeMap, VecDeque};
use std::io;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};
use std::time::Duration;
use tests::chance::Chance;

/// Recordings; `TRUST_RUNS` makes it more.
const N_RUNS: u64 = 1000;

/// Seconds that a swing is recorded for.
const LIMIT_S: f64 = 4.0;

/// How a link misbehaves. Shares are per byte, times in simulated seconds.
#[derive(Clone, Debug)]
struct Faults {
    flips: f64,
    drops: f64,
    inserts: f64,
    repeats: f64,
    /// Longest piece that one read gives.
    piece: usize,
    /// Share of reads that give nothing for `stall_s`.
    stalls: f64,
    stall_s: f64,
    breaks_at_s: f64,
    restarts_at_s: f64,
}

impl Faults {
    fn of(seed: u64) -> (Self, Chance) {
        let mut chance = Chance::new(seed);
        let mut share = |on: bool| if on { 10.0_f64.powf(chance.within(-5.5..-3.0)) } else { 0.0 };
        let kind = seed % 10;
        let all = kind == 9;
        let (flips, drops) = (share(kind == 0 || all), share(kind == 1 || all));
        let (inserts, repeats) = (share(kind == 2 || all), share(kind == 3 || all));
        let stalls = if kind == 5 || all { 1e-3 } else { 0.0 };
        let stall_s = chance.within(0.0..4.0);
        let at_s = chance.within(0.0..12.0);
        let piece = if kind == 4 || all { 1 + chance.within(0.0..40.0) as usize } else { 4096 };
        let never = f64::INFINITY;
        let faults = Self {
            flips,
            drops,
            inserts,
            repeats,
            piece,
            stalls,
            stall_s,
            breaks_at_s: if kind == 6 { at_s } else { never },
            restarts_at_s: if kind == 7 || kind == 8 { at_s } else { never },
        };
        (faults, chance)
    }
}

/// Every code that the rig sent, by its number, for each of its starts.
type Sent = Arc<Mutex<Vec<BTreeMap<u64, u16>>>>;

/// The simulated rig at the far end of a faulty link.
struct FaultyLink {
    rig: SimulatedRig,
    faults: Faults,
    chance: Chance,
    /// What the rig sent, before anything happened to it.
    sent: Sent,
    listener: Deframer,
    arriving: VecDeque<u8>,
}

impl FaultyLink {
    fn new(seed: u64, sent: &Sent) -> Box<Self> {
        let (faults, chance) = Faults::of(seed);
        let rig = SimulatedRig::new(Scenario::by_name("plain").unwrap(), seed);
        sent.lock().unwrap().push(BTreeMap::new());
        let sent = Arc::clone(sent);
        Box::new(Self { rig, faults, chance, sent, listener: Deframer::new(), arriving: VecDeque::new() })
    }

    fn happens(&mut self, share: f64) -> bool {
        share > 0.0 && self.chance.within(0.0..1.0) < share
    }

    /// Notes what the rig says, then spoils it.
    fn take_output(&mut self) {
        while let Some(byte) = self.rig.output().pop_front() {
            if let Some(Ok(Frame::Samples(samples))) = self.listener.push(byte) {
                let numbered = samples.codes.iter().enumerate();
                let numbered = numbered.map(|(k, code)| (samples.first_sample + k as u64, *code));
                self.sent.lock().unwrap().last_mut().unwrap().extend(numbered);
            }
            self.deliver(byte);
        }
    }

    fn deliver(&mut self, byte: u8) {
        if self.happens(self.faults.inserts) {
            let noise = self.chance.within(0.0..256.0) as u8;
            self.arriving.push_back(noise);
        }
        if self.happens(self.faults.drops) {
            return;
        }
        let flipped = if self.happens(self.faults.flips) { 1 << self.chance.within(0.0..8.0) as u8 } else { 0 };
        let byte = byte ^ flipped;
        self.arriving.push_back(byte);
        if self.happens(self.faults.repeats) {
            self.arriving.push_back(byte);
        }
    }

    fn restart(&mut self) {
        self.faults.restarts_at_s = f64::INFINITY;
        let mut buffer = [0; MAX_FRAME];
        let reset = wire::encode(&Frame::Command(0, Command::Reset), &mut buffer).unwrap();
        self.rig.receive(reset);
        self.take_output();
        self.sent.lock().unwrap().push(BTreeMap::new());
    }

    fn pass(&mut self, seconds: f64) {
        let until_s = self.rig.elapsed_s() + seconds;
        while self.rig.elapsed_s() < until_s {
            self.rig.sample();
            self.take_output();
        }
    }
}

impl Port for FaultyLink {
    fn name(&self) -> &str {
        "faulty-link"
    }

    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize> {
        if self.rig.elapsed_s() > self.faults.breaks_at_s {
            return Err(io::Error::other("unplugged"));
        }
        if self.rig.elapsed_s() > self.faults.restarts_at_s {
            self.restart();
        }
        if self.happens(self.faults.stalls) {
            self.pass(self.faults.stall_s);
        }
        self.take_output();
        let until_s = self.rig.elapsed_s() + timeout.as_secs_f64();
        while self.arriving.is_empty() && self.rig.elapsed_s() < until_s {
            self.rig.sample();
            self.take_output();
        }
        let n_bytes = self.arriving.len().min(buffer.len()).min(self.faults.piece);
        self.arriving.drain(..n_bytes).zip(buffer).for_each(|(byte, slot)| *slot = byte);
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

/// Numbers of a file's rows, from its times.
fn numbers(recording: &Recording) -> Vec<u64> {
    recording.times_s().iter().map(|time_s| (time_s * 1000.0).round() as u64).collect()
}

/// Is every row a code that was sent, at its place?
fn is_true(recording: &Recording, sent: &BTreeMap<u64, u16>) -> bool {
    let codes = recording.codes().unwrap();
    let numbers = numbers(recording);
    sent.keys().any(|first| numbers.iter().zip(codes).all(|(number, code)| sent.get(&(first + number)) == Some(code)))
}

fn run(seed: u64, path: &Path) -> Option<Taken> {
    let sent = Sent::default();
    let port = FaultyLink::new(seed, &sent);
    let mut session = Session::open(port).ok()?;
    let plan = Plan { path, existing: Existing::Keep, wait_s: 20.0, limit_s: LIMIT_S, live_every: 0, started: None };
    let taken = record(&mut session, &plan, &mut (), &AtomicBool::new(false)).ok()?;
    let Ok(recording) = recording::read(path, &ReadOptions::default()) else {
        assert!(taken.n_samples < recording::MIN_SAMPLES, "seed {seed}: {} samples, unreadable", taken.n_samples);
        return Some(taken);
    };
    assert_eq!(recording.len(), taken.n_samples, "seed {seed}");
    let sent = sent.lock().unwrap();
    assert!(sent.iter().any(|sent| is_true(&recording, sent)), "seed {seed}: {:?}", Faults::of(seed).0);
    let numbers = numbers(&recording);
    let missing = (numbers[numbers.len() - 1] - numbers[0] + 1) as usize - numbers.len();
    let told: usize = recording.gaps().iter().filter_map(|gap| gap.n_missing).sum();
    assert_eq!(missing, told, "seed {seed}: gaps");
    Some(taken)
}

#[test]
fn no_wrong_number_enters_a_recording_whatever_the_link_does() {
    let n_runs = std::env::var("TRUST_RUNS").map_or(N_RUNS, |runs| runs.parse().unwrap());
    let folder = tempfile::tempdir().unwrap();
    let (mut n_taken, mut n_usable, mut n_with_gaps) = (0, 0, 0);
    for seed in 0..n_runs {
        let path = folder.path().join("swing.csv");
        if let Some(taken) = run(seed, &path) {
            n_taken += 1;
            n_usable += u64::from(taken.is_usable());
            n_with_gaps += u64::from(taken.samples_lost > 0);
        }
        let _ = std::fs::remove_file(&path);
    }
    println!("{n_runs} runs: {n_taken} recordings, {n_usable} usable, {n_with_gaps} with samples lost");
    // A test that never gets as far as a recording would prove nothing.
    assert!(n_usable > n_runs / 2 && n_with_gaps > n_runs / 10, "{n_usable} {n_with_gaps}");
}
