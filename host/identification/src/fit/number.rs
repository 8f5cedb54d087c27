//! A number of a fitted model, and how far it may be trusted.

use super::problem::Unknown;
use serde::Serialize;

/// A number is not identified from this relative standard deviation on.
pub const UNKNOWN_SHARE: f64 = 0.5;

/// How far a number may be trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// The swings tell it, to its standard deviation.
    Identified,
    /// The swings only tell that it is not larger.
    UpperBound,
    /// It lies on the end of its range.
    AtBound,
    /// The swings do not tell it, or only together with another number.
    NotIdentified,
}

/// A number of a fitted model.
#[derive(Clone, Debug)]
pub struct Number {
    /// What it is.
    pub unknown: Unknown,
    /// Its value.
    pub value: f64,
    /// Standard deviation, if the swings give one.
    pub std: Option<f64>,
    /// How far it may be trusted.
    pub status: Status,
    /// With 95 % confidence it is not larger; where that is all the swings tell.
    pub upper: Option<f64>,
}

/// All numbers of a fitted model.
#[derive(Clone, Debug)]
pub struct Uncertainty {
    /// The unknowns of the model, then Ms and DV.
    pub numbers: Vec<Number>,
    /// Correlations in the same order; absent where the covariance says nothing.
    pub correlations: Vec<Vec<Option<f64>>>,
    /// Symbols of numbers that make up for each other, so that only what they do together is known.
    pub alike: Vec<Vec<&'static str>>,
    /// Are the residuals correlated in time? The standard deviations allow for it.
    pub coloured: bool,
}
