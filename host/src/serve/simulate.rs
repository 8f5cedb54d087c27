//! What if? One recording simulated with other numbers, fast enough for a slider.

use super::app::App;
use super::draw::{Line, Range, line};
use super::state::State;
use crate::compare::follow::run;
use crate::error::Failure;
use crate::fit::problem::{Problem, Start};
use crate::fit::tally::Tally;
use crate::formula::effect_of;
use crate::rigfile::Quantity;
use serde::{Deserialize, Serialize};
use shared::effect::{CUSTOM_FORMULA_ID, Effect, Parameter};
use shared::parameters::Parameters;
use std::collections::BTreeMap;

/// A slider's request.
#[derive(Debug, Deserialize)]
pub(super) struct Question {
    recording: u32,
    /// Values by `effect.symbol` or symbol; an absent effect is added.
    values: BTreeMap<String, f64>,
    #[serde(flatten)]
    range: Range,
}

/// The swing it would be.
#[derive(Debug, Serialize)]
pub(super) struct Answer {
    rmse_rad: f64,
    modelled: Line,
    residual: Line,
}

/// Simulates one recording; it begins as the model's own run does.
///
/// # Errors
/// No such recording or value.
pub(super) fn answer(app: &App, question: &Question) -> Result<Answer, Failure> {
    let (parameters, recording, start) = app.read(|state| {
        let recording = state.recording(question.recording)?;
        Ok::<_, Failure>((parameters(state)?, recording, start(state, question.recording)))
    })?;
    let parameters = with(&parameters, &question.values)?;
    let swing = &recording.measurement.swing;
    let start = start.unwrap_or_else(|| {
        let (angle_rad, velocity_rad_s) = swing.start_guess();
        Start { angle_rad, velocity_rad_s, offset_rad: 0.0 }
    });
    let count = Tally::default();
    let problem = Problem::new(std::slice::from_ref(swing), &parameters, Vec::new(), &count);
    let run = run(&problem, start);
    Ok(Answer {
        rmse_rad: crate::compare::rms(&run.residuals_rad),
        modelled: line(&swing.times_s, &run.angles_rad, &question.range),
        residual: line(&swing.times_s, &run.residuals_rad, &question.range),
    })
}

fn parameters(state: &State) -> Result<Parameters<f64>, Failure> {
    let model = state.model.as_ref().ok_or_else(|| Failure::wrong_use("there is no model yet"))?;
    Ok(model.file.parameters().clone())
}

fn start(state: &State, id: u32) -> Option<Start> {
    state.runs.get(&id).map(|run| run.start)
}

/// A model with some values changed.
///
/// # Errors
/// A name that is none, or a value outside its range.
pub(super) fn with(model: &Parameters<f64>, values: &BTreeMap<String, f64>) -> Result<Parameters<f64>, Failure> {
    let mut parameters = model.clone();
    for (name, value) in values {
        let quantity = named(model, name)?;
        let refused = |error| Failure::wrong_use(error).next("choose a value within the range");
        quantity.add_effect(&mut parameters).map_err(refused)?;
        quantity.set(&mut parameters, *value);
    }
    parameters.check().map_err(|error| Failure::wrong_use(error).next("choose values within their ranges"))?;
    Ok(parameters)
}

/// A number by its name; those of the model's own formula come first.
///
/// # Errors
/// There is none of this name.
pub(super) fn named(model: &Parameters<f64>, name: &str) -> Result<Quantity, Failure> {
    let custom = effect_of(model, CUSTOM_FORMULA_ID);
    let of_formula = custom.filter(|custom| name.starts_with(custom.name));
    let found =
        of_formula.and_then(|custom| Quantity::by_formula_name(name, custom)).or_else(|| Quantity::by_name(name));
    let missing = || Failure::wrong_use(format!("there is no value called {name}")).next("use the names of the model");
    found.ok_or_else(missing)
}

/// A slider: a value and how far it can sensibly be moved.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Slider {
    /// As [`Quantity::by_name`] takes it.
    name: String,
    symbol: &'static str,
    owner: &'static str,
    unit: &'static str,
    meaning: &'static str,
    value: f64,
    std: Option<f64>,
    low: f64,
    high: f64,
}

/// The inertia is known from geometry within about this share.
const INERTIA_SHARE: f64 = 0.3;

/// A slider reaches this many times its value beyond it …
const REACH: f64 = 1.5;

/// … and at least this share of the physical range.
const LEAST_REACH: f64 = 0.05;

/// Sliders of a model: I and the numbers of its effects. Mass, length and gravity are measured by other means.
pub(super) fn sliders(parameters: &Parameters<f64>, std: impl Fn(Quantity) -> Option<f64>) -> Vec<Slider> {
    let wanted = Quantity::all(parameters)
        .into_iter()
        .filter(|quantity| !matches!(quantity, Quantity::Mass | Quantity::Length | Quantity::Gravity));
    wanted.map(|quantity| slider(quantity, quantity.get(parameters).unwrap_or_default(), std(quantity))).collect()
}

/// Sliders of an effect that is not in the model, at its start values.
pub(super) fn sliders_of(effect: &'static Effect<f64>) -> Vec<Slider> {
    let starts = effect.parameters.iter().map(|parameter| parameter.start);
    Quantity::all_of_effect(effect).zip(starts).map(|(quantity, start)| slider(quantity, start, None)).collect()
}

fn slider(quantity: Quantity, value: f64, std: Option<f64>) -> Slider {
    let (low, high) = reach(quantity, value);
    let (symbol, owner) = (quantity.symbol(), quantity.owner());
    let name = if owner == "pendulum" { symbol.to_owned() } else { quantity.full_name() };
    Slider { name, symbol, owner, unit: quantity.unit(), meaning: quantity.meaning(), value, std, low, high }
}

fn reach(quantity: Quantity, value: f64) -> (f64, f64) {
    let parameter = match quantity {
        Quantity::Effect { id, index } => Effect::<f64>::by_id(id).and_then(|effect| effect.parameters.get(index)),
        Quantity::Custom { effect, index } => effect.parameters.get(index),
        _ => None,
    };
    let Some(&Parameter { low, high, .. }) = parameter else {
        return ((1.0 - INERTIA_SHARE) * value, (1.0 + INERTIA_SHARE) * value);
    };
    let half = (REACH * value.abs()).max(LEAST_REACH * (high - low));
    ((value - half).max(low).min(value), value + half)
}

/// Values by name, for a model that is set by hand.
pub(super) type Values = BTreeMap<String, f64>;
