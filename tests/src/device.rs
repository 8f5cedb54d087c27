//! Devices on a pseudo terminal, which the program opens as a serial port.

use host::sim::{Scenario, SimulatedRig};
use nix::fcntl::{OFlag, open};
use nix::pty::{PtyMaster, grantpt, posix_openpt, ptsname_r, unlockpt};
use nix::sys::stat::Mode;
use nix::sys::termios::{SetArg, cfmakeraw, tcgetattr, tcsetattr};
use std::io::{Read, Write};
use std::os::fd::OwnedFd;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// The device looks for bytes this often.
const TICK: Duration = Duration::from_millis(1);

/// So often it offers what it says.
const N_TRIES: u32 = 50;

/// Something behind a serial port; it is unplugged when dropped.
pub struct Device {
    /// For `--port`.
    pub port: String,
    leave: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Device {
    /// A device that gets what was received since the last tick and gives what it says.
    pub fn new(mut on_tick: impl FnMut(&[u8]) -> Vec<u8> + Send + 'static) -> Self {
        let (mut master, slave, port) = pseudo_terminal().expect("pseudo terminals");
        let leave = Arc::new(AtomicBool::new(false));
        let told = leave.clone();
        let thread = std::thread::spawn(move || {
            // Kept open, so that the terminal outlives the programs that open and close it.
            let _slave = slave;
            while !told.load(Ordering::Relaxed) {
                tick(&mut master, &mut on_tick);
            }
        });
        Self { port, leave, thread: Some(thread) }
    }

    /// The simulated rig, so many times faster than real time.
    pub fn rig(scenario: &str, speed: f64) -> Self {
        let mut rig = SimulatedRig::new(Scenario::by_name(scenario).expect("a scenario"), 1);
        let began = Instant::now();
        Self::new(move |received| {
            rig.receive(received);
            while rig.elapsed_s() < speed * began.elapsed().as_secs_f64() {
                rig.sample();
            }
            rig.output().drain(..).collect()
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

fn tick(master: &mut PtyMaster, on_tick: &mut impl FnMut(&[u8]) -> Vec<u8>) {
    std::thread::sleep(TICK);
    let mut buffer = [0; 4096];
    let n_received = master.read(&mut buffer).unwrap_or(0);
    let said = on_tick(&buffer[..n_received]);
    // What nobody takes is lost, as on a real wire.
    let mut rest = said.as_slice();
    for _ in 0..N_TRIES {
        let n_taken = master.write(rest).unwrap_or(0);
        rest = &rest[n_taken..];
        if rest.is_empty() {
            return;
        }
        std::thread::sleep(TICK);
    }
}
