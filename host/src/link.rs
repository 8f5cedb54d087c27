//! The link to the rig: bytes through a [`Port`], frames and answers through a [`Session`].
//!
//! A port is a serial device or the simulated rig in this process; a session neither knows nor cares which. It finds
//! out who is at the other end, matches answers to commands, asks again when one is lost, and counts what a stream
//! lost on its way.

#[cfg(test)]
pub(crate) mod changed;
mod error;
mod hello;
mod paced;
mod patience;
mod port;
mod previous;
mod received;
mod recent;
mod serial;
mod session;
mod simulated;
mod tally;
mod transfer;

pub use error::LinkError;
pub use paced::Paced;
pub(crate) use patience::patient;
pub use patience::{FACTORS, be_patient};
pub use port::Port;
pub(crate) use serial::{probe_of, serial_number};
pub use session::Session;
pub use tally::Tally;

/// What `--port` calls the simulated rig; `sim:NAME` chooses a scenario.
pub const SIMULATED: &str = "sim";

/// Opens the port that a user named: `sim`, `sim:NAME`, a serial device such as `/dev/ttyACM0`, or the serial number of
/// a USB device.
///
/// # Errors
/// No such port or scenario, no permission, or somebody else is using it.
pub fn open(name: &str) -> Result<Box<dyn Port>, LinkError> {
    match name.split_once(':').unwrap_or((name, "")) {
        (SIMULATED, scenario) => simulated::open(name, scenario),
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
