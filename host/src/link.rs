//! The link to the rig: bytes through a [`Port`], frames and answers through a [`Session`].
//!
//! A port is a serial device or the simulated rig in this process; a session neither knows nor cares which. It finds
//! out who is at the other end, matches answers to commands, asks again when one is lost, and counts what a stream
//! lost on its way.

mod error;
mod hello;
mod patience;
mod previous;
mod serial;
mod session;
mod tally;
mod transfer;

pub use error::LinkError;
pub(crate) use patience::patient;
pub use patience::{FACTORS, be_patient};
pub(crate) use serial::{probe_of, serial_number};
pub use session::Session;
pub use tally::Tally;

use crate::sim;
use std::io;
use std::time::Duration;

/// What `--port` calls the simulated rig; `sim:NAME` chooses a scenario.
pub const SIMULATED: &str = "sim";

/// A stream of bytes both ways, with a clock.
pub trait Port {
    /// As the user named it.
    fn name(&self) -> &str;

    /// Waits up to `timeout` for bytes and takes what is there; 0 if none came.
    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize>;

    /// Sends all bytes.
    fn write(&mut self, bytes: &[u8]) -> io::Result<()>;

    /// Time since the port was opened. The simulated rig's runs as fast as it is read.
    fn elapsed(&self) -> Duration;
}

/// Opens the port that a user named: `sim`, `sim:NAME`, a serial device such as `/dev/ttyACM0`, or the serial number of
/// a USB device.
///
/// # Errors
/// No such port or scenario, no permission, or somebody else is using it.
pub fn open(name: &str) -> Result<Box<dyn Port>, LinkError> {
    match name.split_once(':').unwrap_or((name, "")) {
        (SIMULATED, scenario) => sim::open(name, scenario),
        _ => serial::open(name),
    }
}

/// Opens the port and greets the rig behind it.
///
/// # Errors
/// As [`open`] and [`Session::open`].
pub fn connect(name: &str) -> Result<Session, LinkError> {
    Session::open(open(name)?)
}
