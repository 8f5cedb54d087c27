//! A fitted model and its numbers as a diagnosis shows them.

use crate::fit::fitted::Fitted;
use crate::fit::levels::NAME;
use crate::fit::problem::Problem;
use crate::fit::uncertainty::{Number, Status, without_bounds};
use serde::Serialize;

/// A fitted number.
#[derive(Clone, Debug, Serialize)]
pub struct Value {
    /// The effect whose number it is, or `inertia`.
    pub effect: &'static str,
    /// The literature's symbol.
    pub symbol: &'static str,
    /// The value.
    pub value: f64,
    /// Standard deviation, if the data give one.
    pub std: Option<f64>,
    /// SI unit.
    pub unit: &'static str,
    /// How far it may be trusted.
    pub status: Status,
    /// With 95 % confidence it is not larger; where that is all the swings tell.
    pub upper: Option<f64>,
}

impl Value {
    /// Is it smaller than so many of its standard deviations? One that has none is not known to be.
    pub fn is_within(&self, stds: f64) -> bool {
        self.std.is_some_and(|std| self.value.abs() < stds * std)
    }

    /// Do the swings ask for more of it than there can be? Where the range begins with nothing, nothing is no end of it.
    pub fn is_on_an_end(&self) -> bool {
        self.status == Status::AtBound && self.value != 0.0
    }
}

/// A model that was fitted.
#[derive(Clone, Debug, Serialize)]
pub struct Candidate {
    /// The effects added, joined by `+`; `none` for the base model.
    pub name: String,
    /// Root mean square error, rad.
    pub rmse: f64,
    /// Bayesian information criterion in units of the noise; lower is better.
    pub criterion: f64,
    /// The added effects' numbers.
    pub parameters: Vec<Value>,
}

impl Candidate {
    /// Is it the model to which nothing was added?
    pub fn is_base(&self) -> bool {
        self.name == "none"
    }

    /// Its name for a person.
    pub fn title(&self) -> &str {
        if self.is_base() { BASE_TITLE } else { &self.name }
    }
}

/// What the model is called to which nothing was added.
pub const BASE_TITLE: &str = "base model";

/// All fitted numbers of a model with their uncertainties, but Ms and DV.
pub fn values(of: &Problem, model: &Fitted) -> Vec<Value> {
    let numbers = without_bounds(of, model)
        .numbers
        .into_iter()
        .filter(|number| !number.unknown.is_stiction() && number.unknown.name != NAME);
    let value = |number: Number| Value {
        effect: number.unknown.name,
        symbol: number.unknown.symbol,
        value: number.value,
        std: number.std,
        unit: number.unknown.unit,
        status: number.status,
        upper: number.upper,
    };
    numbers.map(value).collect()
}
