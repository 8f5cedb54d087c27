//! A serial device: USB, UART or a pseudo terminal.
//!
//! The port is locked both ways while open: `TIOCEXCL` keeps other users out, an advisory `flock` other programs of
//! the same (or the super) user.

use super::{LinkError, Port, patient};
use serialport::{ErrorKind, SerialPort};
use std::io::{self, Read, Write};
use std::time::{Duration, Instant};

/// Of the rig's UART; USB ignores it.
const BAUD: u32 = 921_600;

/// A device that takes no bytes for so long is gone.
const WRITE_TIMEOUT: Duration = Duration::from_secs(2);

pub(super) fn open(name: &str) -> Result<Box<dyn Port>, LinkError> {
    let port =
        serialport::new(name, BAUD).timeout(patient(WRITE_TIMEOUT)).open().map_err(|error| explain(name, &error))?;
    Ok(Box::new(Serial { name: name.to_owned(), port, opened: Instant::now() }))
}

struct Serial {
    name: String,
    port: Box<dyn SerialPort>,
    opened: Instant,
}

impl Port for Serial {
    fn name(&self) -> &str {
        &self.name
    }

    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize> {
        self.port.set_timeout(timeout).map_err(io::Error::from)?;
        match self.port.read(buffer) {
            Ok(0) => Err(io::Error::new(io::ErrorKind::UnexpectedEof, "the device is gone")),
            Ok(n_bytes) => Ok(n_bytes),
            Err(error) if is_passing(&error) => Ok(0),
            Err(error) => Err(error),
        }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.port.set_timeout(patient(WRITE_TIMEOUT)).map_err(io::Error::from)?;
        self.port.write_all(bytes)
    }

    fn elapsed(&self) -> Duration {
        self.opened.elapsed()
    }
}

/// Nothing came in time, or Ctrl-C interrupted the wait: no reason to give up.
fn is_passing(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted)
}

fn explain(name: &str, error: &serialport::Error) -> LinkError {
    let port = name.to_owned();
    let exists = std::path::Path::new(name).exists();
    match error.kind() {
        ErrorKind::Io(io::ErrorKind::PermissionDenied) => LinkError::NoPermission { port },
        ErrorKind::Io(io::ErrorKind::NotFound) => LinkError::NoSuchPort { port, seen: seen() },
        ErrorKind::NoDevice if exists => LinkError::Busy { users: users(name), port },
        ErrorKind::NoDevice => LinkError::NoSuchPort { port, seen: seen() },
        _ => LinkError::NotUsable { port, reason: error.to_string() },
    }
}

/// The ports there are; those on a bare UART chip that is not there are many, so USB comes first and the list is short.
fn seen() -> Vec<String> {
    const AT_MOST: usize = 8;
    let mut ports = serialport::available_ports().unwrap_or_default();
    ports.sort_by_key(|port| !matches!(port.port_type, serialport::SerialPortType::UsbPort(_)));
    ports.into_iter().map(|port| port.port_name).take(AT_MOST).collect()
}

/// Programs that have the device open, by the links in /proc; empty where there is no /proc.
fn users(name: &str) -> Vec<String> {
    let Ok(device) = std::fs::canonicalize(name) else { return Vec::new() };
    let Ok(processes) = std::fs::read_dir("/proc") else { return Vec::new() };
    let own = std::process::id().to_string();
    processes
        .flatten()
        .filter(|process| process.file_name() != *own)
        .filter(|process| has_open(&process.path(), &device))
        .filter_map(|process| {
            let program = std::fs::read_to_string(process.path().join("comm")).ok()?;
            Some(format!("{} (process {})", program.trim(), process.file_name().to_string_lossy()))
        })
        .collect()
}

fn has_open(process: &std::path::Path, device: &std::path::Path) -> bool {
    let Ok(files) = std::fs::read_dir(process.join("fd")) else { return false };
    files.flatten().any(|file| std::fs::read_link(file.path()).is_ok_and(|target| target == device))
}
