//! `host compare`: show where a fitted model fails.

use super::comparison::{notes, text};
use super::given::{Given, check_geometry, check_held_out};
use super::output;
use crate::compare::recording::Curves;
use crate::compare::{self, Comparison, compare};
use crate::error::Failure;
use crate::plot::svg::svg;
use crate::report::{pictures_of, report};
use clap::Args;
use std::path::{Path, PathBuf};

/// Show how well the model follows recordings, where it fails, and whether noise or physics is left.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE)]
pub(super) struct Options {
    /// A recording that takes no part and shows how well the model predicts (may be repeated)
    #[arg(long, value_name = "FILE")]
    hold_out: Vec<PathBuf>,
    /// Write every picture as SVG into this folder
    #[arg(long, value_name = "FOLDER")]
    plot: Option<PathBuf>,
    /// Write a report for the browser, one file that needs no network
    #[arg(long, value_name = "FILE.html")]
    report: Option<PathBuf>,
    /// Write every sample here: measured, modelled and what is left, as a table
    #[arg(long, value_name = "FILE.csv")]
    csv: Option<PathBuf>,
    /// Replace pictures, a report and a table that exist there
    #[arg(long)]
    force: bool,
    // Last, because what follows these stands under their heading in the help.
    #[command(flatten)]
    given: Given,
}

const EXAMPLE: &str = "\
Example:
  host compare --rig rig.toml swing.csv
  host compare a.csv b.csv --hold-out c.csv --report report.html --csv series.csv
  host compare swing.csv --from 0.7 --plot pictures --json";

pub(super) fn run(options: &Options) -> Result<(), Failure> {
    let model = options.given.model()?;
    check_outputs(options)?;
    let reading = options.given.reading.of(&model);
    let measurements = reading.measurements(&options.given.recordings)?;
    let held_out = reading.measurements(&options.hold_out)?;
    let mut swings: Vec<_> = measurements.iter().map(|measurement| measurement.swing.clone()).collect();
    check_geometry(model.parameters(), &mut swings)?;
    let apart: Vec<_> = held_out.iter().map(|measurement| measurement.swing.clone()).collect();
    check_held_out(model.parameters(), &swings, &apart);
    let settings = compare::Options { fit_first: model.is_fresh(), question_numbers: true };
    let comparison = compare(model.known(), &measurements, &held_out, &settings).map_err(Failure::failed)?;
    if options.given.json {
        output::json("compare", &comparison)
    } else {
        notes(&comparison).iter().for_each(|note| output::warn(note));
        output::result(&text(&comparison))
    }
    write(options, &comparison)
}

/// The files that were asked for, behind the result: a disk that is full costs no answer.
fn write(options: &Options, comparison: &Comparison) -> Result<(), Failure> {
    if let Some(folder) = &options.plot {
        draw(folder, comparison, options.force)?;
    }
    if let Some(path) = &options.report {
        output::write(path, &report(comparison), options.force)?;
    }
    if let Some(path) = &options.csv {
        output::write(path, &series(comparison), options.force)?;
    }
    Ok(())
}

/// Neither what is read nor an earlier report is replaced; nor earlier pictures, known by their ending until it is
/// known which ones there will be.
fn check_outputs(options: &Options) -> Result<(), Failure> {
    let new: Vec<&Path> = options.report.iter().chain(&options.csv).map(PathBuf::as_path).collect();
    options.given.check_outputs(&new, &options.hold_out, options.force)?;
    options.plot.as_deref().map_or(Ok(()), output::check_folder)?;
    let inside = |folder: &PathBuf| folder.read_dir().into_iter().flatten().flatten().map(|entry| entry.path());
    let is_picture = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "svg");
    let earlier: Vec<PathBuf> = options.plot.iter().flat_map(inside).filter(is_picture).take(1).collect();
    output::check(&earlier.iter().map(PathBuf::as_path).collect::<Vec<_>>(), &[], options.force)
}

/// One row a sample of every recording, on the recordings' own clocks; names with their unit.
fn series(comparison: &Comparison) -> String {
    let unit = comparison.measured.unit().replace('/', "_");
    let mut text = format!("recording,t_s,measured_{unit},modelled_{unit},residual_{unit}\n");
    for judged in comparison.recordings.iter().chain(&comparison.held_out) {
        let Curves { times_s, angles_rad, modelled_rad, residuals_rad, .. } = &judged.curves;
        let name = judged.name.replace('"', "\"\"");
        let readings = angles_rad.iter().zip(modelled_rad).zip(residuals_rad);
        for (time_s, ((measured, modelled), residual)) in times_s.iter().zip(readings) {
            let time_s = time_s + judged.from_s;
            text += &format!("\"{name}\",{time_s:.6},{measured:.7},{modelled:.7},{residual:.7}\n");
        }
    }
    text
}

fn draw(folder: &Path, comparison: &Comparison, force: bool) -> Result<(), Failure> {
    output::make_folder(folder)?;
    pictures_of(comparison)
        .iter()
        .try_for_each(|picture| output::write(&folder.join(format!("{}.svg", picture.key)), &svg(picture), force))
}
