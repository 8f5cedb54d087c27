//! Curves for the page: as many points as it can show, extremes kept; single precision, which no screen can tell.

use super::app::App;
use crate::diagnose::Diagnosis;
use crate::error::Failure;
use crate::plot::decimate::decimated;
use crate::plot::friction::friction;
use crate::plot::{Content, Picture, Style};
use crate::report::pictures_of;
use serde::{Deserialize, Serialize};
use shared::effect::CURVE_NAME;

/// Points of a curve at most.
const MOST_POINTS: usize = 6000;

/// Points of a curve if nothing is said.
const USUAL_POINTS: usize = 2000;

/// Points of a line in a picture.
const PICTURE_POINTS: usize = 3000;

/// What is to be drawn.
#[derive(Clone, Copy, Debug, Default, Deserialize)]
pub(super) struct Range {
    /// From here, s.
    from: Option<f64>,
    /// To here, s.
    to: Option<f64>,
    /// In about so many points.
    points: Option<usize>,
}

/// A curve.
#[derive(Debug, Serialize)]
pub(super) struct Line {
    x: Vec<f32>,
    y: Vec<f32>,
}

/// One recording over time.
#[derive(Debug, Serialize)]
pub(super) struct Trace {
    measured: Line,
    modelled: Option<Line>,
    residual: Option<Line>,
    noise_rad: f64,
    duration_s: f64,
    rmse_rad: Option<f64>,
}

/// A part of a curve, thinned; `times_s` rises.
pub(super) fn line(times_s: &[f64], values: &[f64], range: &Range) -> Line {
    let from = range.from.map_or(0, |from| times_s.partition_point(|t| *t < from).saturating_sub(1));
    let to = range.to.map_or(times_s.len(), |to| (times_s.partition_point(|t| *t <= to) + 1).min(times_s.len()));
    let from = from.min(to);
    let n_points = range.points.unwrap_or(USUAL_POINTS).clamp(2, MOST_POINTS);
    let (x, y) = decimated(&times_s[from..to], &values[from..to], n_points);
    let single = |values: Vec<f64>| values.into_iter().map(|value| value as f32).collect();
    Line { x: single(x), y: single(y) }
}

/// A recording with the model beside it, as far as there is one.
pub(super) fn trace(app: &App, id: u32, range: &Range) -> Result<Trace, Failure> {
    let (recording, run) = app.read(|state| (state.recording(id), state.runs.get(&id).cloned()));
    let recording = recording?;
    let swing = &recording.measurement.swing;
    let of_run = |values: &dyn Fn(&crate::compare::follow::Followed) -> Vec<f64>| {
        run.as_ref().map(|run| line(&swing.times_s, &values(run), range))
    };
    Ok(Trace {
        measured: line(&swing.times_s, &swing.angles_rad, range),
        modelled: of_run(&|run| run.angles_rad.clone()),
        residual: of_run(&|run| run.residuals_rad.clone()),
        noise_rad: recording.measurement.noise.level_rad(),
        duration_s: swing.duration_s(),
        rmse_rad: run.as_ref().map(|run| crate::compare::rms(&run.residuals_rad)),
    })
}

/// Name and explanation of a picture.
#[derive(Debug, Serialize)]
pub(super) struct Title {
    key: String,
    title: String,
    explanation: String,
}

/// The pictures of the comparison; what the page draws from curves itself is left out.
pub(super) fn titles(app: &App) -> Vec<Title> {
    let Some(comparison) = app.read(|state| state.comparison.clone()) else { return Vec::new() };
    let is_own = |picture: &Picture| picture.key.starts_with("motion-") || starts_with_number(&picture.key);
    let shown = pictures_of(&comparison).into_iter().filter(|picture| !is_own(picture));
    shown.map(|Picture { key, title, explanation, .. }| Title { key, title, explanation }).collect()
}

/// `residual-1`, but not `residual-angle`.
fn starts_with_number(key: &str) -> bool {
    key.strip_prefix("residual-").is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()))
}

/// One picture of the comparison, or that of the friction curve which the diagnosis offers.
pub(super) fn picture(app: &App, key: &str) -> Result<Picture, Failure> {
    let missing = || Failure::wrong_use(format!("there is no picture {key}")).next("compare recordings first");
    if key == CURVE_NAME {
        return app.read(|state| state.diagnosis.clone()).and_then(|found| of_curve(&found)).ok_or_else(missing);
    }
    let comparison = app.read(|state| state.comparison.clone()).ok_or_else(missing)?;
    let found = pictures_of(&comparison).into_iter().find(|picture| picture.key == key);
    found.map(thinned).ok_or_else(missing)
}

fn of_curve(diagnosis: &Diagnosis) -> Option<Picture> {
    let curve = diagnosis.curve.as_ref()?;
    friction(&curve.parameters, &curve.stds)
}

fn thinned(mut picture: Picture) -> Picture {
    if let Content::Curves(curves) = &mut picture.content {
        for curve in curves.iter_mut().filter(|curve| matches!(curve.style, Style::Line | Style::Dashed)) {
            (curve.x, curve.y) = decimated(&curve.x, &curve.y, PICTURE_POINTS);
        }
    }
    picture
}

/// A recording with the model beside it as a table.
pub(super) fn table(app: &App, id: u32) -> Result<(String, String), Failure> {
    let (recording, run) = app.read(|state| (state.recording(id), state.runs.get(&id).cloned()));
    let recording = recording?;
    let run = run.ok_or_else(|| Failure::failed("the model did not run beside it yet").next("wait for the verdict"))?;
    let swing = &recording.measurement.swing;
    let columns = swing.times_s.iter().zip(&swing.angles_rad).zip(run.angles_rad.iter().zip(&run.residuals_rad));
    let line = |((t, measured), (modelled, residual)): ((&f64, &f64), (&f64, &f64))| {
        format!("{t:.6},{measured:.7},{modelled:.7},{residual:.7}\n")
    };
    let head = "t_s,measured_rad,modelled_rad,residual_rad\n".to_owned();
    Ok((recording.name.clone(), columns.map(line).fold(head, |text, line| text + &line)))
}
