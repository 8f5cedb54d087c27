//! The story of the response surfaces: how the box moved and narrowed, what each surface looks like, and how far it
//! can be believed.

use super::app::App;
use crate::error::Failure;
use crate::fit::identify::Fit;
use crate::fit::quality::Responses;
use crate::fit::sequential::Stage;
use crate::rsm::{Anova, AnovaRow, Coefficient, Goodness, LackOfFit, Surface, anova, coefficient_table};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Points of a surface along each side.
const GRID: usize = 41;

/// Points of a curve through a surface.
const CURVE: usize = 61;

/// Which surface.
#[derive(Debug, Deserialize)]
pub(super) struct Which {
    stage: usize,
    #[serde(default)]
    response: usize,
    #[serde(default)]
    x: usize,
    #[serde(default)]
    y: usize,
}

/// Every design in turn.
#[derive(Serialize)]
pub(super) struct Path {
    responses: [&'static str; 5],
    stages: Vec<Stage>,
}

/// One surface over two factors, the others where the stage ended.
#[derive(Serialize)]
pub(super) struct SurfaceView {
    /// What each axis of the box moves.
    axes: Vec<String>,
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<Vec<f64>>,
    /// Where the move went, along the axes of the box.
    chosen: Vec<f64>,
    /// Runs of the design along the axes, a row a run.
    runs: Vec<Vec<f64>>,
    coefficients: Vec<Coefficient>,
    anova: Vec<AnovaRow>,
    goodness: Goodness,
    /// Of every response, along every factor.
    optimizer: Vec<Vec<Curve>>,
}

/// A response along one factor.
#[derive(Serialize)]
struct Curve {
    x: Vec<f64>,
    y: Vec<f64>,
}

fn fit(app: &App) -> Result<Arc<Fit>, Failure> {
    let nothing = || Failure::wrong_use("there is no fit yet").next("start one on the page");
    app.read(|state| state.fit.clone()).ok_or_else(nothing)
}

/// The path of the narrowing.
///
/// # Errors
/// No fit yet.
pub(super) fn path(app: &App) -> Result<Path, Failure> {
    Ok(Path { responses: Responses::NAMES, stages: fit(app)?.stages.clone() })
}

/// One surface with everything that is said about it.
///
/// # Errors
/// No fit yet, or no such surface.
pub(super) fn surface(app: &App, which: &Which) -> Result<SurfaceView, Failure> {
    let fit = fit(app)?;
    let missing = || {
        let what = format!("there is no surface {} of design {}", which.response, which.stage);
        Failure::wrong_use(what).next("the fit has been repeated: look at it anew")
    };
    let stage = fit.stages.get(which.stage).ok_or_else(missing)?;
    let surface = stage.surfaces.get(which.response).ok_or_else(missing)?;
    let goodness = stage.goodness.get(which.response).ok_or_else(missing)?;
    let n_factors = surface.factors().len();
    if which.x >= n_factors || which.y >= n_factors {
        return Err(missing());
    }
    Ok(view(stage, surface, goodness, which))
}

fn view(stage: &Stage, surface: &Surface, goodness: &Goodness, which: &Which) -> SurfaceView {
    let chosen: Vec<f64> = stage.region.coded(&stage.values).iter().map(|coded| coded.clamp(-1.0, 1.0)).collect();
    let height = |x: f64, y: f64| {
        let mut point = chosen.clone();
        point[which.x] = x;
        point[which.y] = y;
        predicted(surface, which.response, &point)
    };
    SurfaceView {
        x: coded_steps(GRID).collect(),
        y: coded_steps(GRID).collect(),
        z: coded_steps(GRID).map(|y| coded_steps(GRID).map(|x| height(x, y)).collect()).collect(),
        runs: surface.design().coded_runs().to_vec(),
        coefficients: coefficient_table(surface),
        anova: rows(anova(surface)),
        goodness: goodness.clone(),
        optimizer: stage.surfaces.iter().enumerate().map(|(k, surface)| curves(surface, k, &chosen)).collect(),
        axes: (0..surface.factors().len()).map(|axis| axis_words(stage, axis)).collect(),
        chosen,
    }
}

/// The parameters along an axis of the box, strongest first: a box that was turned moves several at once.
fn axis_words(stage: &Stage, axis: usize) -> String {
    let column = stage.region.axis(axis);
    let share =
        |(value, (_, low, high)): (&f64, &(&str, f64, f64))| 2.0 * value.abs() / (high - low).max(f64::MIN_POSITIVE);
    let mut shares: Vec<(f64, &str)> = column.iter().zip(&stage.ranges).map(|pair| (share(pair), pair.1.0)).collect();
    shares.sort_by(|a, b| b.0.total_cmp(&a.0));
    let strong: Vec<&str> = shares.iter().filter(|(share, _)| *share > NOTABLE).map(|(_, symbol)| *symbol).collect();
    if strong.is_empty() { format!("axis {}", axis + 1) } else { strong.join(" & ") }
}

/// A parameter is named with an axis that spans at least this share of its range.
const NOTABLE: f64 = 0.3;

fn coded_steps(n_steps: usize) -> impl Iterator<Item = f64> {
    (0..n_steps).map(move |k| 2.0 * k as f64 / (n_steps - 1) as f64 - 1.0)
}

/// What a surface says of a response; a mean square is never negative, though a parabola may be.
fn predicted(surface: &Surface, response: usize, coded: &[f64]) -> f64 {
    let height = surface.predict(coded);
    if Responses::NAMES[response].starts_with("mse") { height.max(0.0) } else { height }
}

/// A response along each factor, the others where the stage ended.
fn curves(surface: &Surface, response: usize, chosen: &[f64]) -> Vec<Curve> {
    let curve = |j: usize| {
        let height = |coded: f64| {
            let mut point = chosen.to_vec();
            point[j] = coded;
            predicted(surface, response, &point)
        };
        Curve { x: coded_steps(CURVE).collect(), y: coded_steps(CURVE).map(height).collect() }
    };
    (0..surface.factors().len()).map(curve).collect()
}

fn rows(table: Anova) -> Vec<AnovaRow> {
    let mut rows = vec![table.regression];
    rows.extend(table.groups);
    rows.push(table.residual);
    if let LackOfFit::Tested { lack_of_fit, pure_error } = table.lack_of_fit {
        rows.extend([lack_of_fit, pure_error]);
    }
    rows.push(table.total);
    rows
}
