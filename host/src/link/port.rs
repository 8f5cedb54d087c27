//! What a session needs of a way to the rig.

use std::io;
use std::time::Duration;

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
