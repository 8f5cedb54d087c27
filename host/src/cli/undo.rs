//! `host undo`: brings back what the rig had before the last push.

use super::{output, port, rig};
use crate::error::Failure;
use crate::operations::model::{Value, values};
use clap::Args;
use serde::Serialize;

/// Give the rig back the parameters that it had before this computer's last push or fit.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Options {
    /// Serial device or its serial number, sim, or sim:NAME
    #[arg(long, value_name = "PORT")]
    port: String,
    /// Print one JSON object instead of text
    #[arg(long)]
    json: bool,
}

const EXAMPLE: &str = "\
Example:
  host undo --port /dev/ttyACM0

Before `push`, `fit --port` and the page write to a rig, what it has is kept on this computer. A
second undo takes the first one back.";

#[derive(Serialize)]
struct Undone {
    port: String,
    firmware: String,
    parameters: Vec<Value>,
}

pub(super) fn run(options: &Options) -> Result<(), Failure> {
    let mut session = port::connect(&options.port)?;
    let before = session.previous()?;
    session.push(before.parameters())?.iter().for_each(|note| output::warn(note));
    let (port, firmware) = (options.port.clone(), session.firmware());
    let undone = Undone { port, firmware, parameters: values(&before) };
    if options.json {
        output::json("undo", &undone);
    } else {
        let listing = rig::listing(&before);
        output::result(&format!("{} has again what it had before:\n{listing}", undone.firmware));
    }
    Ok(())
}
