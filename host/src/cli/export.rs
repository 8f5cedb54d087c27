//! `host export`: the model for a controller or a script of one's own.

use super::{output, rig};
use crate::error::Failure;
use crate::export::{ExportError, Language, export};
use crate::formula::effect_of;
use crate::rigfile::RigFile;
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::path::PathBuf;

/// Write the model as a C header, a Python module or a MATLAB function
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Options {
    /// The model file; ./rig.toml if there is one
    #[arg(value_name = "RIG.TOML")]
    rig: Option<PathBuf>,
    /// What to write
    #[arg(long, value_enum)]
    format: Format,
    /// The file to write; without it the text goes to stdout
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace the file if it exists
    #[arg(long)]
    force: bool,
    /// Print one JSON object instead of text
    #[arg(long, requires = "output")]
    json: bool,
}

#[derive(Clone, Copy, Debug, ValueEnum, Serialize)]
#[serde(rename_all = "kebab-case")]
enum Format {
    /// A C99 header
    C,
    /// A Python 3 module
    Python,
    /// A MATLAB function, also for Octave and Simulink
    Matlab,
}

const EXAMPLE: &str = "\
Example:
  host export --format c rig.toml -o rig.h
  host export --format python rig.toml -o rig.py
  host export --format matlab rig.toml -o rig.m

All hold every effect of the model, the sensor's too. The formulas are taken from the program that runs on the board,
in double precision; no effect is written a second time.";

#[derive(Serialize)]
struct Exported {
    #[serde(serialize_with = "output::lossy")]
    file: PathBuf,
    format: Format,
    effects: Vec<&'static str>,
    n_lines: usize,
}

pub(super) fn run(options: &Options) -> Result<(), Failure> {
    let model = rig::load(options.rig.as_deref())?;
    let language = match options.format {
        Format::C => Language::C,
        Format::Python => Language::Python,
        Format::Matlab => Language::Matlab,
    };
    let text = export(&model, language)?;
    let Some(path) = &options.output else {
        output::result(text.trim_end());
        return Ok(());
    };
    let rig = rig::chosen_path(options.rig.as_deref());
    output::check(&[path], &rig.as_deref().into_iter().collect::<Vec<_>>(), options.force)?;
    output::write(path, &text, options.force)?;
    let n_lines = text.lines().count();
    let done = Exported { file: path.clone(), format: options.format, effects: effects(&model), n_lines };
    if options.json {
        output::json("export", &done)
    } else {
        output::result(&format!("wrote {}, {n_lines} lines: {}", path.display(), done.effects.join(", ")))
    }
    Ok(())
}

fn effects(model: &RigFile) -> Vec<&'static str> {
    let parameters = model.parameters();
    let present = parameters.effects.iter().filter_map(|present| effect_of(parameters, present.id));
    present.map(|effect| effect.name).collect()
}

impl From<ExportError> for Failure {
    fn from(error: ExportError) -> Self {
        Self::failed(error).next("take that effect out of a copy of the file, and export the rest")
    }
}
