//! `host push`: sends a model to the rig and saves it there.

use super::{output, port, rig};
use crate::error::Failure;
use crate::operations::push::push;
use clap::Args;
use std::path::PathBuf;

/// Send a model to the rig, save it to flash, read it back and compare.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Options {
    /// The model file; ./rig.toml if there is one
    #[arg(long, value_name = "FILE")]
    rig: Option<PathBuf>,
    /// Serial device or its serial number, sim, or sim:NAME
    #[arg(long, value_name = "PORT")]
    port: String,
    /// Send the file's sensor calibration too, over the one the rig has
    #[arg(long)]
    calibration: bool,
    /// Leave out the effects of a sensor that the rig does not have: of a gyroscope whose rates were fitted
    #[arg(long)]
    without_sensor: bool,
    /// Print one JSON object instead of text
    #[arg(long)]
    json: bool,
}

const EXAMPLE: &str = "\
Example:
  host push --rig rig.toml --port /dev/ttyACM0

The rig keeps the model without power. Values are compared after rounding to the rig's 32-bit
numbers.";

pub(super) fn run(options: &Options) -> Result<(), Failure> {
    let mut file = rig::load(options.rig.as_deref())?;
    if options.without_sensor {
        file.remove_gyroscope();
    }
    file.check_sensor()?;
    let mut session = port::connect(&options.port)?;
    let pushed = push(&mut session, &file, options.calibration, &|note| output::warn(note))?;
    if options.json {
        output::json("push", &pushed);
    } else {
        let listing = rig::listing(&file);
        output::result(&format!("saved in {} and read back the same:\n{listing}", pushed.firmware));
    }
    Ok(())
}
