//! `host export`: the model for a controller or a script of one's own.

use super::{output, rig};
use crate::error::Failure;
use crate::export::{ExportError, Language, export, fmu};
use crate::files::{self, Existing};
use crate::formula::effect_of;
use crate::rigfile::RigFile;
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Write the model as a C header, a Python module, a MATLAB function or an FMU
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
    /// A functional mock-up unit (FMI 3.0, co-simulation), for Simulink, OpenModelica and others
    Fmu,
}

const EXAMPLE: &str = "\
Example:
  host export --format c rig.toml -o rig.h
  host export --format python rig.toml -o rig.py
  host export --format matlab rig.toml -o rig.m
  host export --format fmu rig.toml -o rig.fmu

All hold every effect of the model, the sensor's too. The formulas are taken from the program that
runs on the board, in double precision; no effect is written a second time.";

#[derive(Serialize)]
struct Exported {
    #[serde(serialize_with = "output::lossy")]
    file: PathBuf,
    format: Format,
    effects: Vec<&'static str>,
    /// Of text; of an archive none are counted.
    n_lines: Option<usize>,
    /// In an archive.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    files: Vec<String>,
}

pub(super) fn run(options: &Options) -> Result<(), Failure> {
    let model = rig::load(options.rig.as_deref())?;
    let language = match options.format {
        Format::C => Language::C,
        Format::Python => Language::Python,
        Format::Matlab => Language::Matlab,
        Format::Fmu => return unit(options, &model),
    };
    let text = export(&model, language)?;
    let Some(path) = &options.output else {
        output::result(text.trim_end());
        return Ok(());
    };
    check(options, path)?;
    output::write(path, &text, options.force)?;
    let n_lines = text.lines().count();
    told(options, path, &model, Some(n_lines), Vec::new())
}

fn unit(options: &Options, model: &RigFile) -> Result<(), Failure> {
    let Some(path) = &options.output else {
        return Err(Failure::wrong_use("an FMU is an archive and no text").next("name its file with -o rig.fmu"));
    };
    check(options, path)?;
    let unit = fmu(model)?;
    files::write(path, &unit.archive, Existing::forced(options.force))?;
    if let Some(why) = &unit.not_compiled {
        output::warn(&format!(
            "it holds sources only, which the program that opens it has to compile: {why}; with a C compiler here \
             (CC names it), it holds the library too"
        ));
    }
    told(options, path, model, None, unit.files)
}

fn check(options: &Options, path: &Path) -> Result<(), Failure> {
    let rig = rig::chosen_path(options.rig.as_deref());
    output::check(&[path], &rig.as_deref().into_iter().collect::<Vec<_>>(), options.force)
}

fn told(
    options: &Options,
    path: &Path,
    model: &RigFile,
    n_lines: Option<usize>,
    files: Vec<String>,
) -> Result<(), Failure> {
    let done = Exported { file: path.to_owned(), format: options.format, effects: effects(model), n_lines, files };
    let size = match n_lines {
        Some(n_lines) => format!("{n_lines} lines"),
        None => format!("with {}", done.files.join(", ")),
    };
    if options.json {
        output::json("export", &done)
    } else {
        output::result(&format!("wrote {}, {size}: {}", path.display(), done.effects.join(", ")))
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
        let next = match error {
            ExportError::Archive { .. } => "export it with --format c instead",
            _ => "take that effect out of a copy of the file, and export the rest",
        };
        Self::failed(error).next(next)
    }
}
