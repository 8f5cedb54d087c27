//! A serial device: USB, UART or a pseudo terminal.
//!
//! The port is locked both ways while open: `TIOCEXCL` keeps other users out, an advisory `flock` other programs of
//! the same (or the super) user.

use super::{LinkError, Port, patient};
use serialport::{ErrorKind, SerialPort, SerialPortInfo, SerialPortType};
use std::io::{self, Read, Write};
use std::time::{Duration, Instant};

/// Of the rig's UART; USB ignores it.
const BAUD: u32 = 921_600;

/// A device that takes no bytes for so long is gone.
const WRITE_TIMEOUT: Duration = Duration::from_secs(2);

/// `name` is a device or the serial number of a USB device.
pub(super) fn open(name: &str) -> Result<Box<dyn Port>, LinkError> {
    let ports = serialport::available_ports().unwrap_or_default();
    let device = with_serial_number(name, &ports).unwrap_or(name);
    let port = serialport::new(device, BAUD)
        .timeout(patient(WRITE_TIMEOUT))
        .open()
        .map_err(|error| explain(device, &error))?;
    Ok(Box::new(Serial { name: device.to_owned(), port, opened: Instant::now() }))
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
    ports.sort_by_key(|port| !matches!(port.port_type, SerialPortType::UsbPort(_)));
    let described = |port: &SerialPortInfo| match serial_number(port) {
        Some(number) => format!("{} (serial number {number})", port.port_name),
        None => port.port_name.clone(),
    };
    ports.iter().map(described).take(AT_MOST).collect()
}

/// The device whose USB serial number this is.
fn with_serial_number<'p>(number: &str, ports: &'p [SerialPortInfo]) -> Option<&'p str> {
    let has = |port: &&SerialPortInfo| serial_number(port).is_some_and(|own| own.eq_ignore_ascii_case(number));
    ports.iter().find(has).map(|port| port.port_name.as_str())
}

/// What tells this USB device from others of its kind.
pub(crate) fn serial_number(port: &SerialPortInfo) -> Option<&str> {
    match &port.port_type {
        SerialPortType::UsbPort(usb) => usb.serial_number.as_deref(),
        _ => None,
    }
}

/// Vendor and products of ST-Links whose port is a board's, V2-1 and V3.
const ST: u16 = 0x0483;
const ST_LINKS: std::ops::RangeInclusive<u16> = 0x3740..=0x375f;

/// The ST-Link that `name` is the port of, as probe-rs tells it from others (vendor:product:serial number); `None` where
/// there is no other one to be told from.
pub(crate) fn probe_of(name: &str) -> Option<String> {
    let device = std::fs::canonicalize(name).map_or(name.to_owned(), |path| path.display().to_string());
    probe_among(&device, &serialport::available_ports().unwrap_or_default())
}

fn probe_among(name: &str, ports: &[SerialPortInfo]) -> Option<String> {
    let selector = |port: &SerialPortInfo| match &port.port_type {
        SerialPortType::UsbPort(usb) if usb.vid == ST && ST_LINKS.contains(&usb.pid) => {
            Some(format!("{:04x}:{:04x}:{}", usb.vid, usb.pid, usb.serial_number.as_deref()?))
        }
        _ => None,
    };
    let device = with_serial_number(name, ports).unwrap_or(name);
    let own = ports.iter().find(|port| port.port_name == device).and_then(selector)?;
    ports.iter().filter_map(selector).any(|other| other != own).then_some(own)
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

#[cfg(test)]
mod tests {
    use super::*;
    use serialport::UsbPortInfo;

    fn port(name: &str, number: Option<&str>) -> SerialPortInfo {
        let usb = UsbPortInfo {
            vid: 0x1209,
            pid: 1,
            serial_number: number.map(str::to_owned),
            manufacturer: None,
            product: Some("Pendulum rig".to_owned()),
        };
        SerialPortInfo { port_name: name.to_owned(), port_type: SerialPortType::UsbPort(usb) }
    }

    #[test]
    fn of_several_probes_on_one_computer_the_one_of_the_port_is_told() {
        let probe = |name: &str, number: &str| {
            let mut probe = port(name, Some(number));
            let SerialPortType::UsbPort(usb) = &mut probe.port_type else { panic!() };
            (usb.vid, usb.pid) = (0x0483, 0x374b);
            probe
        };
        let ports =
            [probe("/dev/ttyACM0", "066AFF1"), port("/dev/ttyACM1", Some("B")), probe("/dev/ttyACM2", "066AFF2")];
        let of = |name: &str, ports: &[SerialPortInfo]| probe_among(name, ports);
        assert_eq!(of("/dev/ttyACM2", &ports).as_deref(), Some("0483:374b:066AFF2"));
        assert_eq!(of("066aff1", &ports).as_deref(), Some("0483:374b:066AFF1"));
        assert_eq!(of("/dev/ttyACM1", &ports), None, "its probe is not known by its port");
        assert_eq!(of("/dev/ttyACM0", &ports[..2]), None, "there is one probe");
    }

    #[test]
    fn two_rigs_are_told_apart_by_their_serial_numbers() {
        let ports = [
            port("/dev/ttyACM0", Some("326A36603830")),
            port("/dev/ttyACM1", Some("2055387B5431")),
            port("/dev/ttyACM2", None),
        ];
        assert_eq!(with_serial_number("2055387b5431", &ports), Some("/dev/ttyACM1"));
        assert_eq!(with_serial_number("326A36603830", &ports), Some("/dev/ttyACM0"));
        for other in ["326A3660383", "", "/dev/ttyACM2"] {
            assert_eq!(with_serial_number(other, &ports), None, "{other}");
        }
    }
}
