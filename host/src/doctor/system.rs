//! What the computer says: serial ports, who may use them, and who else does.

use super::Finding;
use crate::link::serial_number;
use serialport::{SerialPortInfo, SerialPortType};
use std::path::Path;

/// The rule for udev that this project ships.
pub const UDEV_RULE: &str = include_str!("../../../docs/99-pendulum-rig.rules");

/// Its name, by which an installed one is recognised.
const RULE_NAME: &str = "99-pendulum-rig.rules";

/// Where rules lie.
const RULE_FOLDERS: [&str; 3] = ["/etc/udev/rules.d", "/usr/lib/udev/rules.d", "/lib/udev/rules.d"];

pub(super) const HOW_TO_ALLOW: &str = "install the rule below with: host doctor --udev-rule | sudo tee \
    /etc/udev/rules.d/99-pendulum-rig.rules && sudo udevadm control --reload && sudo udevadm trigger";

/// Serial ports on USB; a bare UART of the computer is never the rig.
pub(super) fn ports() -> Vec<SerialPortInfo> {
    let all = serialport::available_ports().unwrap_or_default();
    all.into_iter().filter(|port| matches!(port.port_type, SerialPortType::UsbPort(_))).collect()
}

/// The port to look at when none is named.
pub(super) fn only_rig(ports: &[SerialPortInfo]) -> Option<String> {
    match ports {
        [only] => Some(only.port_name.clone()),
        _ => None,
    }
}

pub(super) fn look(ports: &[SerialPortInfo], port: Option<&str>) -> Vec<Finding> {
    let mut findings = vec![seen(ports, port)];
    if cfg!(target_os = "linux") {
        findings.push(modem_manager());
    }
    findings
}

fn seen(ports: &[SerialPortInfo], port: Option<&str>) -> Finding {
    let names: Vec<String> = ports.iter().map(described).collect();
    let list = if names.is_empty() { "no USB serial port".to_owned() } else { names.join(", ") };
    let next = match (port, names.len()) {
        (Some(_), 0) => {
            "the board behind this port does not show itself here: is it plugged in, with a cable that carries data?"
        }
        (Some(_), _) => return Finding::ok("serial ports", list),
        (None, 0) => {
            "no board shows itself. Plug one in, with a cable that carries data; a new one shows itself only once it has \
             firmware (docs/board-checks.md, step 1). Without a board: host doctor --port sim"
        }
        (None, _) => "there are several: name the rig's with --port, by its device or its serial number",
    };
    Finding::look("serial ports", list, next)
}

fn described(port: &SerialPortInfo) -> String {
    match &port.port_type {
        SerialPortType::UsbPort(usb) => {
            let product = usb.product.clone().unwrap_or_else(|| format!("{:04x}:{:04x}", usb.vid, usb.pid));
            let number = serial_number(port).map_or(String::new(), |number| format!(", serial number {number}"));
            format!("{} ({product}{number})", port.port_name)
        }
        _ => port.port_name.clone(),
    }
}

/// It talks to every new serial port for some seconds, in case it is a modem.
fn modem_manager() -> Finding {
    let has_rule = RULE_FOLDERS.iter().any(|folder| Path::new(folder).join(RULE_NAME).exists());
    match (is_running("ModemManager"), has_rule) {
        (false, _) => Finding::ok("ModemManager", "not running: nothing else will talk to a board"),
        (true, true) => Finding::ok("ModemManager", "running, and told by our udev rule to leave the rig alone"),
        (true, false) => Finding::look(
            "ModemManager",
            "running: it may hold a new port for some seconds and send it words of its own",
            HOW_TO_ALLOW.replace("the rule below", "our udev rule"),
        ),
    }
}

fn is_running(program: &str) -> bool {
    let Ok(processes) = std::fs::read_dir("/proc") else { return false };
    processes
        .flatten()
        .filter_map(|process| std::fs::read_to_string(process.path().join("comm")).ok())
        .any(|name| name.trim() == program)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_computer_without_a_board_is_judged_alike_with_and_without_a_named_port() {
        let [named, unnamed] = [Some("/dev/ttyUSB7"), None].map(|port| seen(&[], port));
        assert!(!named.ok && !unnamed.ok, "{named:?} {unnamed:?}");
        assert!(named.next.unwrap().contains("is it plugged in"));
    }
}
