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
use tests::qemu::Qemu;

/// Recordings; `QEMU_RUNS=20` takes some minutes.
const N_RUNS: u64 = 3;

/// Of the ten kinds of faults: flips and all at once come early.
const FIRST_SEED: u64 = 9;

/// Seconds that a swing is recorded for.
const LIMIT_S: f64 = 4.0;

/// Seconds on the wall that a recording takes, more or less.
const LENGTH_S: f64 = 3.0;

const QEMU_LIMIT: Duration = Duration::from_secs(900);

/// The board's serial port behind a bad link.
struct FaultySerial {
    port: Box<dyn Port>,
    link: BadLink,
}

impl FaultySerial {
    fn restart(&mut self) -> io::Result<()> {
        let mut buffer = [0; MAX_FRAME];
        let reset = wire::encode(&Frame::Command(0, Command::Reset), &mut buffer).unwrap();
        self.port.write(reset)?;
        // What was said before the restart has arrived by then.
        self.listen(Duration::from_millis(500))?;
        self.link.restarted();
        Ok(())
    }

    fn listen(&mut self, until: Duration) -> io::Result<()> {
        let end = self.port.elapsed() + until;
        while self.port.elapsed() < end {
            let mut bytes = [0; 4096];
            let n_bytes = self.port.read(&mut bytes, Duration::from_millis(20))?;
            bytes[..n_bytes].iter().for_each(|byte| self.link.take(*byte));
        }
        Ok(())
    }
}

impl Port for FaultySerial {
    fn name(&self) -> &str {
        "faulty-serial"
    }

    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let now_s = self.port.elapsed().as_secs_f64();
        if now_s > self.link.faults.breaks_at_s {
            return Err(io::Error::other("unplugged"));
        }
        if self.link.is_to_restart(now_s) {
            self.restart()?;
        }
        if self.link.stalls() {
            std::thread::sleep(Duration::from_secs_f64(self.link.faults.stall_s));
        }
        if self.link.is_empty() {
            let mut bytes = [0; 4096];
            let n_bytes = self.port.read(&mut bytes, timeout)?;
            bytes[..n_bytes].iter().for_each(|byte| self.link.take(*byte));
        }
        Ok(self.link.read(buffer))
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.port.write(bytes)
    }

    fn elapsed(&self) -> Duration {
        self.port.elapsed()
    }
}

/// `None` if the link was too bad for a recording.
fn run(port: &str, seed: u64, path: &Path) -> Option<(Taken, Option<usize>)> {
    let sent = Sent::default();
    let link = BadLink::new(Faults::of(seed, LENGTH_S), &sent);
    let port = link::open(port).unwrap();
    let mut session = Session::open(Box::new(FaultySerial { port, link })).ok()?;
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
    let qemu = Qemu::start(&firmware(Board::Qemu).unwrap(), scenario, QEMU_LIMIT).unwrap();
    let (mut n_taken, mut n_with_gaps) = (0, 0);
    for seed in FIRST_SEED..FIRST_SEED + n_runs {
        let path = folder.path().join("swing.csv");
        let began = std::time::Instant::now();
        let taken = run(qemu.port(), seed, &path);
        let (end, n_samples, lost) = taken
            .as_ref()
            .map_or((None, 0, 0), |(taken, _)| (Some(format!("{:?}", taken.end)), taken.n_samples, taken.samples_lost));
        println!("seed {seed}: {n_samples} samples, {lost} lost, ended by {end:?}, after {:.1?}", began.elapsed());
        if let Some((taken, n_gaps)) = taken {
            n_taken += u64::from(taken.n_samples > 0);
            n_with_gaps += u64::from(n_gaps.is_some_and(|n_gaps| n_gaps > 0));
        }
        let _ = std::fs::remove_file(&path);
    }
    println!("{n_runs} runs: {n_taken} recordings, {n_with_gaps} with gaps");
    assert!(n_taken > n_runs / 2 && n_with_gaps > 0, "{n_taken} {n_with_gaps}");
}
