//! Recordings of the firmware in QEMU over a link that flips, drops, inserts, repeats, delays, splits, stalls, breaks or
//! restarts: no wrong number enters a file, and what is missing is missing from its times, sample by sample.
#![cfg(unix)]

use host::link::{self, Port, Session};
use host::record::{Plan, Taken, record};
use host::recording::Existing;
use shared::wire::{self, Command, Frame, MAX_FRAME};
use std::io;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use tests::faults::{BadLink, Faults, Sent};
use tests::image::{Board, firmware};
use tests::plant::Scenario;
use tests::qemu::{Gauge, Qemu};

/// Recordings; `QEMU_RUNS=20` takes some minutes.
const N_RUNS: u64 = 3;

/// Of the ten kinds of faults: flips and all at once come early.
const FIRST_SEED: u64 = 9;

/// Seconds that a swing is recorded for.
const LIMIT_S: f64 = 4.0;

/// Seconds of the rig's clock that a recording takes, waiting included.
const LENGTH_S: f64 = 12.0;

/// Between two looks at the rig's clock.
const LOOK_EVERY: Duration = Duration::from_millis(10);

/// Samples that may pass from one look to the next: a PC that is kept from reading finds the rig's clock stopped.
const SAMPLES_PER_LOOK: u64 = 32;

/// The board's serial port behind a bad link. Its clock is the rig's, so that faults come after so many samples.
struct FaultySerial {
    port: Box<dyn Port>,
    link: BadLink,
    rig: Gauge,
    began_s: f64,
}

impl FaultySerial {
    fn restart(&mut self) -> io::Result<()> {
        let mut buffer = [0; MAX_FRAME];
        let reset = wire::encode(&Frame::Command(0, Command::Reset), &mut buffer).unwrap();
        self.port.write(reset)?;
        let n_starts = self.rig.n_starts();
        while self.rig.n_starts() == n_starts {
            self.take()?;
        }
        // The last that was said before the restart.
        while self.take()? > 0 {}
        self.link.restarted();
        Ok(())
    }

    fn take(&mut self) -> io::Result<usize> {
        self.rig.let_pass(SAMPLES_PER_LOOK);
        let mut bytes = [0; 4096];
        let n_bytes = self.port.read(&mut bytes, LOOK_EVERY)?;
        bytes[..n_bytes].iter().for_each(|byte| self.link.take(*byte));
        Ok(n_bytes)
    }
}

impl Port for FaultySerial {
    fn name(&self) -> &str {
        "faulty-serial"
    }

    fn read(&mut self, buffer: &mut [u8], _: Duration) -> io::Result<usize> {
        let now_s = self.rig.seconds() - self.began_s;
        if now_s > self.link.faults.breaks_at_s {
            return Err(io::Error::other("unplugged"));
        }
        if self.link.is_to_restart(now_s) {
            self.restart()?;
        }
        if self.link.stalls() {
            let until_s = self.rig.seconds() + self.link.faults.stall_s;
            while self.rig.seconds() < until_s {
                self.take()?;
            }
        }
        if self.link.is_empty() {
            self.take()?;
        }
        Ok(self.link.read(buffer))
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.port.write(bytes)
    }

    fn elapsed(&self) -> Duration {
        Duration::from_secs_f64(self.rig.seconds())
    }
}

/// `None` if the link was too bad for a recording.
fn run(qemu: &Qemu, seed: u64, path: &Path) -> Option<(Taken, Option<usize>)> {
    let sent = Sent::default();
    let link = BadLink::new(Faults::of(seed, LENGTH_S), &sent);
    let port = link::open(qemu.port()).unwrap();
    let (rig, began_s) = (qemu.gauge(), qemu.gauge().seconds());
    let mut session = Session::open(Box::new(FaultySerial { port, link, rig, began_s })).ok()?;
    let plan = Plan { path, existing: Existing::Keep, wait_s: 60.0, limit_s: LIMIT_S, live_every: 0, started: None };
    let taken = record(&mut session, &plan, &mut (), &AtomicBool::new(false)).ok()?;
    let n_gaps = sent.check(path, &taken, &format!("seed {seed}, {:?}", Faults::of(seed, LENGTH_S).0));
    Some((taken, n_gaps))
}

#[test]
fn no_wrong_number_of_the_firmware_enters_a_recording_whatever_the_link_does() {
    let n_runs = std::env::var("QEMU_RUNS").map_or(N_RUNS, |runs| runs.parse().unwrap());
    let folder = tempfile::tempdir().unwrap();
    let scenario = Scenario { rest_s: 1.5, lift_s: 0.7, hold_s: 1.0, swing_s: 6.0, ..Scenario::default() };
    let qemu = Qemu::start(&firmware(Board::Qemu).unwrap(), scenario.clone()).unwrap();
    let (mut n_taken, mut n_with_gaps) = (0, 0);
    for seed in FIRST_SEED..FIRST_SEED + n_runs {
        let path = folder.path().join("swing.csv");
        qemu.set_scenario(scenario.clone());
        let taken = run(&qemu, seed, &path);
        let (end, n_samples, lost) = taken
            .as_ref()
            .map_or((None, 0, 0), |(taken, _)| (Some(format!("{:?}", taken.end)), taken.n_samples, taken.samples_lost));
        println!("seed {seed}: {n_samples} samples, {lost} lost, ended by {end:?}");
        if let Some((taken, n_gaps)) = taken {
            n_taken += u64::from(taken.n_samples > 0);
            n_with_gaps += u64::from(n_gaps.is_some_and(|n_gaps| n_gaps > 0));
        }
        let _ = std::fs::remove_file(&path);
    }
    println!("{n_runs} runs: {n_taken} recordings, {n_with_gaps} with gaps");
    assert!(n_taken > n_runs / 2 && n_with_gaps > 0, "{n_taken} {n_with_gaps}");
}
