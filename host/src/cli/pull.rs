//! `host pull`: takes the model from the rig.

use super::{output, port, rig};
use crate::error::Failure;
use crate::link::Session;
use crate::operations::model::{Value, values};
use crate::rigfile::RigFile;
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;

/// Take model and calibration from the rig and write them to a file.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Options {
    /// Serial device or its serial number, sim, or sim:NAME
    #[arg(long, value_name = "PORT")]
    port: String,
    /// The file to write
    #[arg(short, long, value_name = "FILE", default_value = "rig.toml")]
    output: PathBuf,
    /// Update the file if it exists: its comments stay, and so do values that are the same on the rig
    #[arg(long)]
    force: bool,
    /// Print one JSON object instead of text
    #[arg(long)]
    json: bool,
}

const EXAMPLE: &str = "\
Example:
  host pull --port /dev/ttyACM0 -o rig.toml";

#[derive(Serialize)]
struct Pulled {
    port: String,
    firmware: String,
    #[serde(serialize_with = "output::lossy")]
    file: PathBuf,
    parameters: Vec<Value>,
}

pub(super) fn run(options: &Options) -> Result<(), Failure> {
    output::check(&[&options.output], &[], options.force)?;
    let mut session = port::connect(&options.port)?;
    let file = if options.output.exists() { updated(options, &mut session)? } else { session.model_file()? };
    file.save(&options.output)?;
    let (port, firmware) = (options.port.clone(), session.firmware());
    let pulled = Pulled { port, firmware, file: options.output.clone(), parameters: values(&file) };
    if options.json {
        output::json("pull", &pulled);
    } else {
        let name = options.output.display();
        output::result(&format!("wrote {name} as {} has it:\n{}", pulled.firmware, rig::listing(&file)));
    }
    Ok(())
}

fn updated(options: &Options, session: &mut Session) -> Result<RigFile, Failure> {
    let mut file = RigFile::load(&options.output)?;
    file.take_over(&session.parameters()?, &rig::source(session))?;
    file.set_sensor(session.settings()?.sensor);
    Ok(file)
}
