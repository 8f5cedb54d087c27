//! A thousand recordings over links that flip, drop, insert, repeat, delay, split, stall, break or restart: no wrong
//! number ever enters a file, and what is missing is missing from its times, sample by sample.

use host::link::{Port, Session};
use host::record::{Plan, Taken, record};
use host::recording::Existing;
use host::sim::{Scenario, SimulatedRig};
use shared::wire::{self, Command, Frame, MAX_FRAME};
use std::io;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use tests::faults::{BadLink, Faults, Sent};

/// Recordings; `TRUST_RUNS` makes it more.
const N_RUNS: u64 = 1000;

/// Seconds that a swing is recorded for.
const LIMIT_S: f64 = 4.0;

/// Simulated seconds that a recording takes, waiting included.
const LENGTH_S: f64 = 12.0;

/// The simulated rig at the far end of a bad link.
struct FaultyLink {
    rig: SimulatedRig,
    link: BadLink,
}

impl FaultyLink {
    fn new(seed: u64, sent: &Sent) -> Box<Self> {
        let rig = SimulatedRig::new(Scenario::by_name("plain").unwrap(), seed);
        Box::new(Self { rig, link: BadLink::new(Faults::of(seed, LENGTH_S), sent) })
    }

    fn take_output(&mut self) {
        self.rig.output().drain(..).for_each(|byte| self.link.take(byte));
    }

    fn restart(&mut self) {
        let mut buffer = [0; MAX_FRAME];
        let reset = wire::encode(&Frame::Command(0, Command::Reset), &mut buffer).unwrap();
        self.rig.receive(reset);
        self.take_output();
        self.link.restarted();
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
        if self.rig.elapsed_s() > self.link.faults.breaks_at_s {
            return Err(io::Error::other("unplugged"));
        }
        if self.link.is_to_restart(self.rig.elapsed_s()) {
            self.restart();
        }
        if self.link.stalls() {
            self.pass(self.link.faults.stall_s);
        }
        self.take_output();
        let until_s = self.rig.elapsed_s() + timeout.as_secs_f64();
        while self.link.is_empty() && self.rig.elapsed_s() < until_s {
            self.rig.sample();
            self.take_output();
        }
        Ok(self.link.read(buffer))
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.rig.receive(bytes);
        Ok(())
    }

    fn elapsed(&self) -> Duration {
        Duration::from_secs_f64(self.rig.elapsed_s())
    }
}

fn run(seed: u64, path: &Path) -> Option<Taken> {
    let sent = Sent::default();
    let port = FaultyLink::new(seed, &sent);
    let mut session = Session::open(port).ok()?;
    let plan = Plan { path, existing: Existing::Keep, wait_s: 20.0, limit_s: LIMIT_S, live_every: 0, started: None };
    let taken = record(&mut session, &plan, &mut (), &AtomicBool::new(false)).ok()?;
    sent.check(path, &taken, &format!("seed {seed}, {:?}", Faults::of(seed, LENGTH_S).0));
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
