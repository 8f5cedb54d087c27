//! Devices on a pseudo terminal, which the program opens as a serial port.

use host::sim::{Scenario, SimulatedRig};
use serialport::{SerialPort, TTYPort};
use std::io::{Read, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// How long the device waits for bytes before it goes on.
const TICK: Duration = Duration::from_millis(1);

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
        let (mut master, slave) = TTYPort::pair().expect("pseudo terminals");
        let port = slave.name().expect("a pseudo terminal has a name");
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

fn tick(master: &mut TTYPort, on_tick: &mut impl FnMut(&[u8]) -> Vec<u8>) {
    let mut buffer = [0; 4096];
    let _ = master.set_timeout(TICK);
    let n_received = master.read(&mut buffer).unwrap_or(0);
    let said = on_tick(&buffer[..n_received]);
    // What nobody takes is lost, as on a real wire.
    let _ = master.set_timeout(Duration::from_millis(50));
    let _ = master.write_all(&said);
}
