//! Devices on a pseudo terminal, which the program opens as a serial port.

use host::sim::{Scenario, SimulatedRig};
use nix::fcntl::{OFlag, open};
use nix::pty::{PtyMaster, grantpt, posix_openpt, ptsname_r, unlockpt};
use nix::sys::stat::Mode;
use nix::sys::termios::{SetArg, cfmakeraw, tcgetattr, tcsetattr};
use shared::wire::{Command, Deframer, Frame, MAX_FRAME, encode};
use std::io::{Read, Write};
use std::os::fd::OwnedFd;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Duration;

/// The device looks for bytes this often.
const TICK: Duration = Duration::from_millis(1);

/// Samples that the rig takes in a tick at most: beside a PC that listens, a hundred times faster than real time.
const SAMPLES_PER_TICK: usize = 100;

/// Something behind a serial port; it is unplugged when dropped.
pub struct Device {
    /// For `--port`.
    pub port: String,
    leave: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Device {
    /// A device that gets what was received since the last tick and gives what it says. It is not asked again before
    /// all of that was taken, so that nothing is lost however slowly the program at the far end reads.
    pub fn new(mut on_tick: impl FnMut(&[u8]) -> Vec<u8> + Send + 'static) -> Self {
        let (mut master, slave, port) = pseudo_terminal().expect("pseudo terminals");
        let leave = Arc::new(AtomicBool::new(false));
        let told = leave.clone();
        let thread = std::thread::spawn(move || {
            // Kept open, so that the terminal outlives the programs that open and close it.
            let _slave = slave;
            let mut unsent = Vec::new();
            while !told.load(Ordering::Relaxed) {
                tick(&mut master, &mut unsent, &mut on_tick);
            }
        });
        Self { port, leave, thread: Some(thread) }
    }

    /// The simulated rig, as fast as it is listened to.
    pub fn rig(scenario: &str) -> Self {
        Self::rig_until(scenario, f64::INFINITY)
    }

    /// The same; but so many seconds of its own clock after a stream was asked for, no more time passes for it, though
    /// it goes on answering.
    pub fn rig_until(scenario: &str, end_s: f64) -> Self {
        let mut rig = SimulatedRig::new(Scenario::by_name(scenario).expect("a scenario"), 1);
        let (mut deframer, mut until_s) = (Deframer::new(), f64::INFINITY);
        Self::new(move |received| {
            let starts = |frame: &Frame| matches!(frame, Frame::Command(_, Command::Start(_)));
            let frames = received.iter().filter_map(|byte| deframer.push(*byte)?.ok());
            if frames.filter(starts).count() > 0 {
                until_s = rig.elapsed_s() + end_s;
            }
            rig.receive(received);
            for _ in 0..SAMPLES_PER_TICK {
                if rig.elapsed_s() < until_s {
                    rig.sample();
                }
            }
            rig.output().drain(..).collect()
        })
    }

    /// The simulated rig with older firmware: some frames mean nothing to it.
    pub fn rig_that_knows(scenario: &str, knows: impl Fn(&Frame) -> bool + Send + 'static) -> Self {
        let mut rig = SimulatedRig::new(Scenario::by_name(scenario).expect("a scenario"), 1);
        let mut deframer = Deframer::new();
        Self::new(move |received| {
            for frame in received.iter().filter_map(|byte| deframer.push(*byte)?.ok()).filter(&knows) {
                rig.receive(encode(&frame, &mut [0; MAX_FRAME]).expect("it came in a frame"));
            }
            (0..SAMPLES_PER_TICK).for_each(|_| rig.sample());
            rig.output().drain(..).collect()
        })
    }

    /// The simulated rig with another tongue: each of its frames is sent as `say` has it.
    pub fn rig_that_says(scenario: &str, mut say: impl FnMut(Frame) -> Vec<Frame> + Send + 'static) -> Self {
        let mut rig = SimulatedRig::new(Scenario::by_name(scenario).expect("a scenario"), 1);
        let mut deframer = Deframer::new();
        Self::new(move |received| {
            rig.receive(received);
            (0..SAMPLES_PER_TICK).for_each(|_| rig.sample());
            let frames = rig.output().drain(..).filter_map(|byte| deframer.push(byte)?.ok()).flat_map(&mut say);
            frames.flat_map(|frame| encode(&frame, &mut [0; MAX_FRAME]).expect("it fits a frame").to_vec()).collect()
        })
    }

    /// Pulls the cable.
    pub fn unplug(self) {}
}

impl Drop for Device {
    fn drop(&mut self) {
        self.leave.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Both ends and the name of the far one. Closed in the programs that tests start, or a cable could not be pulled.
fn pseudo_terminal() -> nix::Result<(PtyMaster, OwnedFd, String)> {
    let master = posix_openpt(OFlag::O_RDWR | OFlag::O_NOCTTY | OFlag::O_CLOEXEC | OFlag::O_NONBLOCK)?;
    grantpt(&master)?;
    unlockpt(&master)?;
    let name = ptsname_r(&master)?;
    let slave = open(name.as_str(), OFlag::O_RDWR | OFlag::O_NOCTTY | OFlag::O_CLOEXEC, Mode::empty())?;
    let mut settings = tcgetattr(&slave)?;
    cfmakeraw(&mut settings);
    tcsetattr(&slave, SetArg::TCSANOW, &settings)?;
    Ok((master, slave, name))
}

fn tick(master: &mut PtyMaster, unsent: &mut Vec<u8>, on_tick: &mut impl FnMut(&[u8]) -> Vec<u8>) {
    std::thread::sleep(TICK);
    if unsent.is_empty() {
        let mut buffer = [0; 4096];
        let n_received = master.read(&mut buffer).unwrap_or(0);
        *unsent = on_tick(&buffer[..n_received]);
    }
    let n_taken = master.write(unsent).unwrap_or(0);
    unsent.drain(..n_taken);
}
