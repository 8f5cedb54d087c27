//! The fit of a rig to its swings, with what may be asked of it: a typed torque, missing physics found and added.

use super::covariance::Covariance;
use super::json::{Doubt, doubts};
use super::stages;
pub use super::stages::After;
use crate::diagnose::{Diagnosis, Wishes, diagnose_with, zero_of_rig};
use crate::error::Failure;
use crate::fit::identify::{self, Fit, Identified, Progress};
use crate::fit::problem::Start;
use crate::fit::quality::Responses;
use crate::fit::sequential::Stage;
use crate::fit::tolerance::KnownRig;
use crate::fit::touch::Touch;
use crate::improve::{Change, change};
use crate::recording::Measured;
use crate::simulation::readings;
use crate::swing::{Swing, kind};
use crate::verdict::Left;
use serde::Serialize;
use shared::effect::Effect;
use shared::parameters::Parameters;

/// What is asked for.
#[derive(Clone)]
pub struct Request {
    /// How to identify.
    pub method: identify::Method,
    /// Search within these ranges, by symbol.
    pub ranges: Vec<(String, f64, f64)>,
    /// A torque that somebody typed.
    pub typed: Option<&'static Effect<f64>>,
    /// If physics is missing, find out which and go on with the enlarged model.
    pub discover: bool,
}

/// What happens meanwhile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum News {
    /// A typed torque may need several starts.
    Starting,
    /// A step of the identification begins.
    Identifying(Progress),
    /// Every effect is tried.
    Discovering,
    /// No effect explains what is left.
    NothingNamed,
    /// The friction level of the releases differs.
    LevelsDiffer,
}

impl std::fmt::Display for News {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Starting => write!(out, "looking where the formula's parameters may lie …"),
            Self::Identifying(progress) => write!(out, "{progress} …"),
            Self::Discovering => write!(out, "physics is missing: trying every effect …"),
            Self::LevelsDiffer => {
                write!(out, "the friction level differs between the releases; host diagnose says by how much")
            }
            Self::NothingNamed => write!(out, "no effect of the list explains what is left"),
        }
    }
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The numbers.
    pub fit: Fit,
    /// The responses after each stage.
    pub stages: Vec<After>,
    /// What was missing, if it was looked for and found.
    pub discovery: Option<Diagnosis>,
}

/// How well the rig's observer follows a fresh swing, before and after.
#[derive(Clone, Debug, Serialize)]
pub struct Check {
    /// The file of that swing.
    pub recording: String,
    /// The observer's bandwidth, rad/s.
    pub bandwidth_rad_s: f64,
    /// Measured minus predicted angle with the old parameters, rms, rad.
    pub innovation_before_rad: f64,
    /// The same with the new ones.
    pub innovation_after_rad: f64,
}

/// The fields of `fit --json`.
#[derive(Serialize)]
pub struct Fields<'a> {
    recordings: &'a [String],
    doubts: Vec<Doubt<'a>>,
    method: &'static str,
    measured: Measured,
    parameters: &'a [Identified],
    correlations: &'a [Vec<Option<f64>>],
    covariance: Covariance,
    rmse: f64,
    noise: f64,
    left: Left,
    hardly_follows: bool,
    held_out_rmse: Option<f64>,
    responses: &'a Responses,
    responses_before: &'a Responses,
    lowered: &'a [After],
    stages: &'a [Stage],
    touches: &'a [Touch],
    warnings: &'a [String],
    simulations: usize,
    seconds: f64,
    check: Option<&'a Check>,
    discovery: Option<&'a Diagnosis>,
}

/// A method as model files and results name it.
pub fn words(method: identify::Method) -> &'static str {
    match method {
        identify::Method::Rsm => "response surfaces",
        identify::Method::LeastSquares => "least squares",
        identify::Method::Both => "response surfaces, least squares",
    }
}

/// Fits friction and inertia of `rig` to the swings.
///
/// # Errors
/// As [`identify::fit`]; a typed torque that can't be added.
pub fn fit(
    swings: &[Swing],
    held_out: &[Swing],
    rig: KnownRig,
    request: &Request,
    tell: &(dyn Fn(News) + Sync),
) -> Result<Outcome, Failure> {
    let parameters = with_typed(swings, rig, request.typed, tell)?;
    let rig = KnownRig { parameters: &parameters, ..rig };
    let settings = identify::Options { method: request.method, ranges: request.ranges.clone() };
    let told = |progress| tell(News::Identifying(progress));
    let plain = identify::fit(swings, held_out, rig, &settings, &told).map_err(Failure::failed)?;
    let discovery = request.discover.then(|| discover(swings, held_out, &plain, request.typed, tell)).flatten();
    let mut fit = match &discovery {
        Some(found) => refit(swings, held_out, KnownRig { parameters: &found.parameters, ..rig })?,
        None => plain,
    };
    fit.warnings.extend(zero_of_rig::words(swings, &fit));
    let stages = stages::stages(&fit, request.method, swings);
    Ok(Outcome { fit, stages, discovery })
}

impl Outcome {
    /// The fields of `--json`: with the names of the recordings, what they hold, what speaks against them, the method
    /// that was asked for, and how a rig took the new model.
    pub fn fields<'a>(
        &'a self,
        recordings: &'a [String],
        swings: &'a [Swing],
        method: identify::Method,
        check: Option<&'a Check>,
    ) -> Fields<'a> {
        let fit = &self.fit;
        Fields {
            recordings,
            doubts: doubts(swings),
            method: words(method),
            measured: kind(swings),
            parameters: &fit.identified,
            correlations: &fit.correlations,
            covariance: Covariance::of(fit),
            rmse: fit.rmse_rad,
            noise: fit.noise_rad,
            left: fit.left,
            hardly_follows: fit.hardly_follows,
            held_out_rmse: fit.held_out_rmse_rad,
            responses: &fit.responses,
            responses_before: &fit.responses_before,
            lowered: &self.stages,
            stages: &fit.stages,
            touches: &fit.touches,
            warnings: &fit.warnings,
            simulations: fit.n_simulations,
            seconds: fit.seconds,
            check,
            discovery: self.discovery.as_ref(),
        }
    }
}

/// The model's readings at a swing's times, from a start: rad, or rad/s where rates were measured.
pub fn modelled(swing: &Swing, start: &Start, parameters: &Parameters<f64>) -> Vec<f64> {
    let of_model = readings(parameters, start.release(swing), swing.schedule(parameters), swing.len());
    of_model.into_iter().map(|reading| reading + start.offset_rad).collect()
}

/// The same of a fitted swing, where the model begins anew behind whatever touched the pendulum.
pub fn modelled_by(fit: &Fit, swing_idx: usize, swing: &Swing) -> Vec<f64> {
    let mut readings = modelled(swing, &fit.starts[swing_idx], &fit.parameters);
    for touch in fit.touches.iter().filter(|touch| touch.swing_idx == swing_idx) {
        if let Some(start) = &touch.anew {
            let behind = touch.samples.end..swing.len();
            readings.splice(behind.clone(), modelled(&swing.part(behind), start, &fit.parameters));
        }
    }
    readings
}

/// The model with the effect that was typed, fitted well enough to begin with: a formula may need several starts.
fn with_typed(
    swings: &[Swing],
    rig: KnownRig,
    typed: Option<&'static Effect<f64>>,
    tell: &(dyn Fn(News) + Sync),
) -> Result<Parameters<f64>, Failure> {
    let Some(effect) = typed else { return Ok(rig.parameters.clone()) };
    tell(News::Starting);
    let steps = change(swings, &[], rig, &[Change::Add(effect)]).map_err(Failure::failed)?;
    Ok(steps.last().map_or_else(|| rig.parameters.clone(), |step| step.parameters.clone()))
}

/// What is missing, if the base model leaves more than the noise and something can be named.
fn discover(
    swings: &[Swing],
    held_out: &[Swing],
    fit: &Fit,
    typed: Option<&'static Effect<f64>>,
    tell: &(dyn Fn(News) + Sync),
) -> Option<Diagnosis> {
    if fit.left == Left::Noise {
        return None;
    }
    tell(News::Discovering);
    let found = diagnose_with(swings, held_out, fit.rig(), Wishes { typed, ..Wishes::default() });
    let named = found.parameters.effects.len() > found.base_parameters.effects.len();
    match &found.levels {
        Some(_) => tell(News::LevelsDiffer),
        None if !named => tell(News::NothingNamed),
        None => {}
    }
    named.then_some(found)
}

/// All numbers of the enlarged model with their uncertainties.
fn refit(swings: &[Swing], held_out: &[Swing], found: KnownRig) -> Result<Fit, Failure> {
    let settings = identify::Options { method: identify::Method::LeastSquares, ranges: Vec::new() };
    identify::fit(swings, held_out, found, &settings, &|_| {}).map_err(Failure::failed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::examples::{self, swing};

    #[test]
    fn the_fields_say_what_was_found_and_the_method_that_was_asked_for() {
        let mut fit = examples::fit();
        (fit.rmse_rad, fit.noise_rad, fit.held_out_rmse_rad) = (2e-3, 1e-3, Some(3e-3));
        let outcome = Outcome { fit, stages: Vec::new(), discovery: None };
        let told = |method| serde_json::to_value(outcome.fields(&[], &[], method, None)).unwrap();
        let found = told(identify::Method::Rsm);
        assert_eq!(
            (&found["rmse"], &found["noise"], &found["held_out_rmse"]),
            (&2e-3.into(), &1e-3.into(), &3e-3.into())
        );
        let responses = |responses: &Responses| serde_json::to_value(responses).unwrap();
        assert_eq!(found["responses"], responses(&outcome.fit.responses));
        assert_eq!(found["responses_before"], responses(&outcome.fit.responses_before));
        assert_ne!(found["responses"], found["responses_before"]);
        let methods = [identify::Method::Rsm, identify::Method::LeastSquares, identify::Method::Both];
        let names = ["response surfaces", "least squares", "response surfaces, least squares"];
        assert_eq!(methods.map(|method| told(method)["method"].as_str().unwrap().to_owned()), names);
    }

    #[test]
    fn a_zero_that_is_off_is_in_the_readings_of_the_model() {
        let swing = swing();
        let start = |offset_rad| Start { angle_rad: 1.2, velocity_rad_s: 0.0, offset_rad };
        let [off, right] = [0.1, 0.0].map(|offset_rad| modelled(&swing, &start(offset_rad), &Parameters::paper()));
        assert!(off.iter().zip(&right).all(|(off, right)| (off - right - 0.1).abs() < 1e-12));
        assert!((right[0] - 1.2).abs() < 1e-12);
    }
}
