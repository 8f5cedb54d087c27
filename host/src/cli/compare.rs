//! `host compare`: show where a fitted model fails.

use super::columns::Reading;
use super::comparison::text;
use super::given::Given;
use super::output;
use crate::compare::measurement::Measurement;
use crate::compare::pictures::pictures;
use crate::compare::{self, Comparison, compare};
use crate::error::Failure;
use crate::plot::svg::svg;
use crate::report::report;
use clap::Args;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

/// Show how well the model follows recordings, where it fails, and whether noise or physics is left.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Options {
    #[command(flatten)]
    given: Given,
    /// A recording that takes no part and shows how well the model predicts (may be repeated)
    #[arg(long, value_name = "FILE")]
    hold_out: Vec<PathBuf>,
    /// Write every picture as SVG into this folder
    #[arg(long, value_name = "FOLDER")]
    plot: Option<PathBuf>,
    /// Write a report for the browser, one file that needs no network
    #[arg(long, value_name = "FILE.html")]
    report: Option<PathBuf>,
}

const EXAMPLE: &str = "\
Example:
  host compare --rig rig.toml swing.csv
  host compare a.csv b.csv --hold-out c.csv --report report.html
  host compare swing.csv --from 0.7 --plot pictures --json";

pub(super) fn run(options: &Options) -> Result<(), Failure> {
    let model = options.given.model()?;
    let measurements = measurements(&options.given.reading, &options.given.recordings)?;
    let held_out = self::measurements(&options.given.reading, &options.hold_out)?;
    let settings = compare::Options { fit_first: model.is_fresh(), question_numbers: true };
    let comparison = compare(model.parameters(), &measurements, &held_out, &settings).map_err(Failure::failed)?;
    if let Some(folder) = &options.plot {
        draw(folder, &comparison)?;
    }
    if let Some(path) = &options.report {
        output::write(path, &report(&comparison))?;
    }
    if options.given.json {
        output::json("compare", &comparison)
    } else {
        output::result(&text(&comparison))
    }
    Ok(())
}

fn measurements(reading: &Reading, paths: &[PathBuf]) -> Result<Vec<Measurement>, Failure> {
    paths.par_iter().map(|path| reading.measurement(path)).collect()
}

fn draw(folder: &Path, comparison: &Comparison) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|error| output::not_written(folder, &error))?;
    pictures(comparison)
        .iter()
        .try_for_each(|picture| output::write(&folder.join(format!("{}.svg", picture.key)), &svg(picture)))
}
