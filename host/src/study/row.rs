//! What is known of one recording: where it comes from, and what a fit said of it.

use crate::fit::identify::Identified;
use serde::Serialize;
use std::fmt;

/// The name of a rig in the study's own folder.
pub const ROOT: &str = ".";

/// Which recording: unique in a study. Both names are relative and use `/` on every system.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct Key {
    /// Folder of the rig within the study; `.` for the study's own folder.
    pub rig: String,
    /// File within that folder.
    pub recording: String,
}

impl fmt::Display for Key {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.rig == ROOT {
            write!(out, "{}", self.recording)
        } else {
            write!(out, "{}/{}", self.rig, self.recording)
        }
    }
}

/// What a fit was made from: equal origins give equal numbers, to the bit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Origin {
    /// SHA-256 of the recording's file, hexadecimal.
    pub file_hash: String,
    /// SHA-256 of the model file, hexadecimal.
    pub model_hash: String,
    /// How recordings were read.
    pub options: String,
}

/// A row of the table of recordings.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Which recording.
    pub key: Key,
    /// What it was made from.
    pub origin: Origin,
    /// Version of the program that made it.
    pub program: String,
    /// When it was made: date and time, UTC.
    pub studied: String,
    /// When the swing was recorded, if the recording says.
    pub recorded: Option<String>,
    /// What was found, or why nothing was.
    pub outcome: Result<Outcome, String>,
}

impl Row {
    /// What was found, if anything.
    pub fn found(&self) -> Option<&Outcome> {
        self.outcome.as_ref().ok()
    }
}

/// What a fit found in a recording. Readings of a gyroscope are in rad/s where rad is said.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Samples of the free swing.
    pub n_samples: usize,
    /// Length of the free swing, s.
    pub duration_s: f64,
    /// Largest reading of the free swing, rad.
    pub amplitude_rad: f64,
    /// Period of small swings, s; `None` where too few swings tell.
    pub period_s: Option<f64>,
    /// Noise of the sensor, rms, rad.
    pub noise_rad: f64,
    /// Measured minus modelled, rms, rad.
    pub error_rad: f64,
    /// What the model leaves: `noise`, `nearly`, `missing`.
    pub left: String,
    /// What was noticed on the way.
    pub notes: Vec<String>,
    /// The fitted numbers, in the order of the fit.
    pub numbers: Vec<Number>,
}

impl Outcome {
    /// A number by its symbol.
    pub fn number(&self, symbol: &str) -> Option<&Number> {
        self.numbers.iter().find(|number| number.symbol == symbol)
    }

    /// Is more left than the noise of the sensor?
    pub fn leaves_more_than_noise(&self) -> bool {
        self.left != "noise"
    }
}

/// A fitted number, in SI units.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Number {
    /// The literature's symbol.
    pub symbol: String,
    /// The effect it belongs to, or `inertia`.
    pub effect: String,
    /// SI unit.
    pub unit: String,
    /// As fitted.
    pub value: f64,
    /// Its standard deviation, if the swing gives one.
    pub std: Option<f64>,
    /// With 95 % confidence it is not larger, where that is all the swing tells.
    pub upper: Option<f64>,
    /// How far it may be trusted: `identified`, `at-bound`, `upper-bound`, `not-identified`.
    pub status: String,
}

impl From<&Identified> for Number {
    fn from(found: &Identified) -> Self {
        Self {
            symbol: found.symbol.to_owned(),
            effect: found.name.to_owned(),
            unit: found.unit.to_owned(),
            value: found.value,
            std: found.std,
            upper: found.upper,
            status: word(&found.status),
        }
    }
}

/// A choice as it stands in files: the one word of its serialised form.
pub(super) fn word(choice: &impl Serialize) -> String {
    match serde_json::to_value(choice) {
        Ok(serde_json::Value::String(word)) => word,
        _ => String::new(),
    }
}
