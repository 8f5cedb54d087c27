//! `host fit`: from swings to parameters, and back to the rig.

mod drawing;
mod paper;
mod progress;
mod result;

use super::columns::Reading;
use super::given::{check_geometry, check_held_out};
use super::record::{Patience, attempt, only_usable, take};
use super::values::{Range, custom_effect};
use super::{output, port, rig};
use crate::error::Failure;
use crate::fit::identify::{self, Fit};
use crate::geometry::{of_another, too_long};
use crate::link::Session;
use crate::operations::fit::{self, Check, Outcome};
use crate::operations::geometry;
use crate::operations::given::refuse_doubles;
use crate::operations::json::named;
use crate::record::{in_words, unused_path};
use crate::recording::Existing;
use crate::rigfile::{RigFile, Source};
use crate::swing::Swing;
use clap::{ArgGroup, Args, ValueEnum};
use progress::Screen;
use result::{Done, Shown};
use shared::effect::Effect;
use shared::observer::Observer;
use shared::parameters::Parameters;
use std::path::{Path, PathBuf};

/// Than the rig.
const OTHER_SOURCES: [&str; 2] = ["recordings", "paper"];

/// Find friction and inertia from swings: recorded ones, or one that is recorded from the rig now.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLE, group(ArgGroup::new("source").required(true).args(["recordings", "port", "paper"])),
    mut_arg("wait", |wait| wait.conflicts_with_all(OTHER_SOURCES)),
    mut_arg("limit", |limit| limit.conflicts_with_all(OTHER_SOURCES)))]
pub(super) struct Options {
    /// Recordings to fit, all at once
    #[arg(value_name = "RECORDING")]
    recordings: Vec<PathBuf>,
    /// Record from the rig: serial device or its serial number, sim, or sim:NAME
    #[arg(long, value_name = "PORT")]
    port: Option<String>,
    /// The model file; ./rig.toml if there is one, else what the rig reports
    #[arg(long, value_name = "FILE")]
    rig: Option<PathBuf>,
    /// Response surfaces as in the paper, least squares, or one after the other
    #[arg(long, value_enum, default_value_t = Method::Both)]
    method: Method,
    /// Begin the search within this range instead of one found from the recording (may be repeated)
    #[arg(long, value_name = "NAME=LOW..HIGH")]
    range: Vec<Range>,
    /// Add a torque of your own to the model, with parameters to be found
    #[arg(long, value_name = "FORMULA", value_parser = custom_effect, allow_hyphen_values = true, conflicts_with = "paper")]
    effect: Option<&'static Effect<f64>>,
    /// A recording that takes no part and shows how well the model predicts (may be repeated)
    #[arg(long, value_name = "FILE")]
    hold_out: Vec<PathBuf>,
    /// Write the model with the found values here
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace other files that exist there
    #[arg(long)]
    force: bool,
    /// Draw measured against model
    #[arg(long, value_name = "FILE.svg")]
    plot: Option<PathBuf>,
    /// If physics is missing, find out which effect, add it, and go on with the enlarged model
    #[arg(long)]
    discover: bool,
    /// Leave the rig as it is
    #[arg(long, conflicts_with_all = OTHER_SOURCES)]
    no_push: bool,
    /// Replay the paper's three designs and compare its tables with ours; needs no recording
    #[arg(long, conflicts_with_all = ["range", "method", "rig", "hold_out", "output"])]
    paper: bool,
    /// Print one JSON object instead of text
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    reading: Reading,
    #[command(flatten, next_help_heading = "Recording from the rig")]
    patience: Patience,
}

const EXAMPLE: &str = "\
Example:
  host fit --port sim                                  record, fit, push, check; without hardware
  host fit --port sim:mystery-1 --discover             the same on a rig with something hidden
  host fit swing.csv --rig rig.toml -o rig.toml
  host fit a.csv --effect 'torque = -k*omega*abs(omega)^p; k in 0..1e-3 N·m; p in 0..3' -o rig.toml
  host fit a.csv b.csv --hold-out c.csv --range Mw=1e-4..1e-3 --json

With --port the rig gets the new model. From files: next `host push --rig rig.toml --port PORT`.
A --range is where the search begins: swings that ask for a value outside it get it, with a note.";

/// `--method`; without words of their own, or the help would not fit a screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Method {
    Rsm,
    LeastSquares,
    Both,
}

impl Method {
    /// As it stands in the model file.
    fn words(self) -> &'static str {
        fit::words(self.into())
    }
}

impl From<Method> for identify::Method {
    fn from(method: Method) -> Self {
        match method {
            Method::Rsm => Self::Rsm,
            Method::LeastSquares => Self::LeastSquares,
            Method::Both => Self::Both,
        }
    }
}

pub(super) fn run(options: &Options) -> Result<(), Failure> {
    if options.paper {
        return paper::run(options.json, options.plot.as_deref(), options.force);
    }
    options.reading.check()?;
    let mut session = options.port.as_deref().map(port::connect).transpose()?;
    let mut model = model(options, session.as_mut())?;
    rig::tell_if_normalised(&model);
    let doubt = doubt_of_geometry(options, session.as_mut())?;
    doubt.iter().for_each(|doubt| output::warn(doubt));
    check_outputs(options)?;
    let recordings = match session.as_mut() {
        Some(session) => vec![record(session, options)?],
        None => options.recordings.clone(),
    };
    let reading = options.reading.of(&model);
    let mut swings = reading.swings(&recordings)?;
    let (held_out, _) = reading.swings_quietly(&options.hold_out)?;
    refuse_doubles(&swings, &held_out)?;
    let another = of_another(model.parameters(), &swings);
    another.iter().for_each(|words| output::warn(words));
    let told: Vec<String> = doubt.iter().chain(&another).cloned().collect();
    let too_long = too_long(model.parameters(), &swings).map(|(_, words)| words);
    let explained = |failure| geometry::explained(failure, doubt.as_deref().or(too_long.as_deref()));
    check_geometry(model.parameters(), &mut swings).map_err(explained)?;
    check_held_out(model.parameters(), &swings, &held_out);

    let mut outcome = identify(options, &swings, &held_out, &model).map_err(explained)?;
    outcome.fit.warnings.extend(told);
    let fit = &outcome.fit;
    let source = Source::of_swings(options.method.words(), &swings);
    model.adopt_fit(fit, &source)?;
    // A disk that is full or a rig that is gone costs no result: it is shown with what was done, and then the error.
    let mut done = Done::default();
    let finished = hand_over(options, session.as_mut(), &model, &outcome, &swings, &mut done);
    let shown = Shown { outcome: &outcome, swings: &swings, done: &done };
    result::show(options, &recordings, &shown);
    finished
}

/// Writes the model and the drawing, and gives the model to the rig.
fn hand_over(
    options: &Options,
    session: Option<&mut Session>,
    model: &RigFile,
    outcome: &Outcome,
    swings: &[Swing],
    done: &mut Done,
) -> Result<(), Failure> {
    let fit = &outcome.fit;
    if let Some(path) = &options.output {
        model.save(path)?;
        done.model = Some(path.clone());
    }
    if let Some(path) = &options.plot {
        drawing::of_fit(path, fit, swings, options.force)?;
        done.drawing = Some(path.clone());
    }
    if let Some(session) = session.filter(|_| !options.no_push) {
        let before = session.parameters()?.map(f64::from);
        session.push(&fit.parameters)?.iter().for_each(|note| output::warn(note));
        done.is_pushed = true;
        output::say(&format!("saved in {} and read back the same; a second swing shows the gain", session.firmware()));
        done.check = check(session, options, &before, fit)?;
    }
    Ok(())
}

/// The named file, `rig.toml` here, or what the rig reports.
fn model(options: &Options, session: Option<&mut Session>) -> Result<RigFile, Failure> {
    match (rig::chosen_path(options.rig.as_deref()), session) {
        (None, Some(session)) => session.model_file(),
        (Some(path), Some(session)) => {
            let file = RigFile::load(&path)?;
            if options.rig.is_none() {
                output::say(&rig::taken(&path, &file));
            }
            tell_if_of_another_sensor(&file, &path, session)?;
            Ok(file)
        }
        (_, None) => rig::load(options.rig.as_deref()),
    }
}

/// Says so where the file means a sensor that the rig does not read: it may be another rig's.
fn tell_if_of_another_sensor(file: &RigFile, path: &Path, session: &mut Session) -> Result<(), Failure> {
    let in_use = session.settings()?.sensor;
    if let Some(ours) = file.sensor().filter(|ours| !ours.is_like(&in_use)) {
        output::warn(&format!(
            "the model is that of {}, which means a sensor of kind {}, and the rig reads one of kind {}: is it another \
             rig's? --rig names another file",
            path.display(),
            ours.name(),
            in_use.name()
        ));
    }
    Ok(())
}

/// Where nobody gave a model, the rig's geometry may be the one that every board begins with.
fn doubt_of_geometry(options: &Options, session: Option<&mut Session>) -> Result<Option<String>, Failure> {
    match (rig::chosen_path(options.rig.as_deref()), session) {
        (None, Some(session)) => Ok(geometry::doubt(session)?),
        _ => Ok(None),
    }
}

fn check_outputs(options: &Options) -> Result<(), Failure> {
    let (rig, model, drawing) = (options.rig.as_deref(), options.output.as_deref(), options.plot.as_deref());
    rig::check_outputs(rig, model, drawing, &[&options.recordings, &options.hold_out], options.force)
}

fn record(session: &mut Session, options: &Options) -> Result<PathBuf, Failure> {
    let path = unused_path(Path::new(""), "");
    let taken = take(session, &path, Existing::Number, &options.patience)?;
    output::say(&in_words(&taken));
    Ok(taken.path)
}

/// The fit itself, and what is told meanwhile.
fn identify(options: &Options, swings: &[Swing], held_out: &[Swing], rig: &RigFile) -> Result<Outcome, Failure> {
    let method = options.method.into();
    let ranges =
        options.range.iter().map(|range| (range.quantity.symbol().to_owned(), range.low, range.high)).collect();
    let request = fit::Request { method, ranges, typed: options.effect, discover: options.discover };
    let screen = Screen::new(method, swings);
    fit::fit(swings, held_out, rig.known(), &request, &|news| screen.show(news))
}

/// Lets the observer judge old and new parameters by a second swing, unless nobody is there for it.
fn check(
    session: &mut Session,
    options: &Options,
    before: &Parameters<f64>,
    fit: &Fit,
) -> Result<Option<Check>, Failure> {
    let path = unused_path(Path::new(""), "-check");
    let recording = match attempt(session, &path, Existing::Number, &options.patience) {
        Err(error) if error.is_nobody_there() => {
            output::warn(&format!("the second swing was not made, so that the gain is not shown: {error}"));
            return Ok(None);
        }
        taken => only_usable(taken?)?,
    };
    output::say(&in_words(&recording));
    let recording = recording.path;
    let (swings, _) = options.reading.swings_quietly(std::slice::from_ref(&recording))?;
    let bandwidth_rad_s = f64::from(session.settings()?.bandwidth_rad_s);
    let innovation = |parameters| innovation_rms_rad(parameters, bandwidth_rad_s, &swings[0]);
    Ok(Some(Check {
        bandwidth_rad_s,
        innovation_before_rad: innovation(before),
        innovation_after_rad: innovation(&fit.parameters),
        recording: named(&recording),
    }))
}

/// Root mean square of measured minus predicted angle: the board's observer, run over a recorded swing.
fn innovation_rms_rad(parameters: &Parameters<f64>, bandwidth_rad_s: f64, swing: &Swing) -> f64 {
    let mut observer = Observer::new(parameters, bandwidth_rad_s);
    let (angle_rad, velocity_rad_s) = swing.start_guess();
    observer.start_at(angle_rad, velocity_rad_s);
    let mut before_s = swing.times_s[0];
    let sum: f64 = swing
        .times_s
        .iter()
        .zip(&swing.angles_rad)
        .map(|(time_s, angle_rad)| {
            let dt_s = time_s - std::mem::replace(&mut before_s, *time_s);
            observer.on_measurement(*angle_rad, dt_s).innovation_rad.powi(2)
        })
        .sum();
    (sum / swing.len() as f64).sqrt()
}
