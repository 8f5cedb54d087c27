//! `host restart`: starts the rig's firmware anew, or the chip's bootloader.

use super::{output, port};
use crate::error::Failure;
use crate::update::Way;
use clap::Args;
use serde::Serialize;
use shared::wire::Command;

/// Restart the rig, or start its bootloader to update the firmware over USB.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Options {
    /// Serial device or its serial number, sim, or sim:NAME
    #[arg(long, value_name = "PORT")]
    port: String,
    /// Start the chip's bootloader instead of the firmware: a Feather's is on its USB (DFU), a Nucleo's on pins of its chip
    #[arg(long)]
    bootloader: bool,
    /// Print one JSON object instead of text
    #[arg(long)]
    json: bool,
}

const EXAMPLE: &str = "\
Example:
  host restart --port /dev/ttyACM0
  host restart --port /dev/ttyACM0 --bootloader     then: dfu-util -l

Model and calibration that were saved stay.";

#[derive(Serialize)]
struct Restarted {
    port: String,
    firmware: String,
    bootloader: bool,
}

pub(super) fn run(options: &Options) -> Result<(), Failure> {
    let mut session = port::connect(&options.port)?;
    session.tell(if options.bootloader { &Command::Bootloader } else { &Command::Reset })?;
    let firmware = session.firmware();
    let what = if options.bootloader { its_bootloader(&session.rig().name) } else { "again" };
    let done = Restarted { port: options.port.clone(), firmware, bootloader: options.bootloader };
    if options.json {
        output::json("restart", &done)
    } else {
        output::result(&format!("{} on {} starts {what}", done.firmware, done.port))
    }
    Ok(())
}

/// Where it listens, which is not everywhere the port that the rig had.
fn its_bootloader(board: &str) -> &'static str {
    match Way::of(board) {
        Ok(Way::Probe { .. }) => {
            "its bootloader, which this port does not reach: it listens on pins of the chip (USART1: D8, D2). The board's \
             reset button, or `probe-rs reset`, starts the firmware again; a new one comes by host update"
        }
        _ => "its bootloader",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_board_whose_bootloader_is_not_on_its_port_says_where_it_is_and_how_to_come_back() {
        assert_eq!(its_bootloader("feather-f405"), "its bootloader");
        let nucleo = its_bootloader("nucleo-f446");
        assert!(nucleo.contains("USART1") && nucleo.contains("reset button"), "{nucleo}");
    }
}
