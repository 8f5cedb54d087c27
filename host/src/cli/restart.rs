//! `host restart`: starts the rig's firmware anew, or the chip's bootloader.

use super::{output, port};
use crate::error::Failure;
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
    /// Start the chip's bootloader (USB DFU) instead of the firmware
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
    let what = if options.bootloader { "its bootloader" } else { "again" };
    let done = Restarted { port: options.port.clone(), firmware, bootloader: options.bootloader };
    if options.json {
        output::json("restart", &done)
    } else {
        output::result(&format!("{} on {} starts {what}", done.firmware, done.port))
    }
    Ok(())
}
