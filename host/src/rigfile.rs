//! `rig.toml`, the model of one rig: geometry, the sensor's calibration, and every effect with its values, how certain
//! they are and where they came from.
//!
//! In and out: a commented text file that a person may edit; comments and order survive every update. Effects stand
//! there by name, parameters by symbol, in SI units and radians. A value is a number, or an inline table
//! `{ value = 5.4e-4, std = 2e-6, method = "least squares", recordings = ["swing.csv"] }`. Mass, length and inertia
//! with a `std` and no method are measured to that tolerance; what a fit makes of them keeps it as `prior`.

mod adopt;
mod curve;
mod error;
mod guess;
mod gyroscope;
mod keys;
mod quantity;
mod read;
mod reader;
mod tolerance;
mod write;

pub use crate::fit::curve::KnownCurve;
pub use error::RigFileError;
pub use quantity::Quantity;

use crate::error::Failure;
use crate::files::{self, Existing};
use crate::fit::tolerance::{KnownRig, Tolerances};
use crate::recording::Measured;
use crate::swing::{Swing, kind};
use shared::effect::CUSTOM_FORMULA_ID;
use shared::motion::Pendulum;
use shared::parameters::Parameters;
use shared::sensor::Sensor;
use std::path::{Path, PathBuf};
use toml_edit::DocumentMut;

/// The version this program writes, and the highest it reads.
pub const FORMAT_VERSION: i64 = 1;

/// Where a command looks for the model when none is named.
pub const USUAL_NAME: &str = "rig.toml";

/// Where a value came from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Source {
    /// How it was found: `least squares`, `guess`, `read from feather-f405` …
    pub method: String,
    /// The recordings it was found from.
    pub recordings: Vec<String>,
    /// What those hold.
    pub measured: Measured,
}

/// More recordings than so many are counted instead of named: every value has this list.
const MOST_NAMED: usize = 4;

impl Source {
    /// Found by a method from recordings, which are named without their folders.
    pub fn new(method: &str, recordings: &[PathBuf]) -> Self {
        let name = |path: &PathBuf| path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        let mut names: Vec<String> = recordings.iter().map(name).collect();
        if names.len() > MOST_NAMED {
            let more = names.len() - (MOST_NAMED - 1);
            names.truncate(MOST_NAMED - 1);
            names.push(format!("and {more} more"));
        }
        Self { method: method.to_owned(), recordings: names, measured: Measured::Angle }
    }

    /// Found by a method from these swings.
    pub fn of_swings(method: &str, swings: &[Swing]) -> Self {
        let names: Vec<PathBuf> = swings.iter().map(|swing| PathBuf::from(&swing.name)).collect();
        Self::new(method, &names).of(kind(swings))
    }

    /// The same, found from readings of this kind.
    pub fn of(self, measured: Measured) -> Self {
        Self { measured, ..self }
    }

    /// As a rig of this name reported it.
    pub fn read_from(rig: &str) -> Self {
        Self::new(&format!("read from {rig}"), &[])
    }
}

/// How much is known of a value besides itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Knowledge {
    /// Standard deviation, in the value's unit.
    pub std: Option<f64>,
    /// Where it came from; `None` for a number typed by hand.
    pub source: Option<Source>,
}

/// A model file in memory.
#[derive(Clone, Debug)]
pub struct RigFile {
    document: DocumentMut,
    parameters: Parameters<f64>,
    knowledge: Vec<(Quantity, Knowledge)>,
    tolerances: Tolerances,
    sensor: Option<Sensor>,
    measured: Option<Measured>,
    normalised: bool,
}

impl RigFile {
    /// The model of a pendulum whose geometry is known; friction is a guess from its size until a fit.
    ///
    /// # Errors
    /// Numbers that no pendulum has.
    pub fn new(pendulum: Pendulum<f64>) -> Result<Self, RigFileError> {
        Self::written(&guess::parameters(pendulum), false)
    }

    /// The model of a pendulum of which only the motion is known: m·g·l = 1, so that every torque and moment of
    /// inertia is per m·g·l.
    ///
    /// # Errors
    /// A gravity of no place.
    pub fn normalised(gravity_m_s2: f64) -> Result<Self, RigFileError> {
        Self::written(&guess::parameters(guess::normalised_pendulum(gravity_m_s2)), true)
    }

    /// The model that a rig reports, with where it came from.
    ///
    /// # Errors
    /// Parameters that this program does not know.
    pub fn of_rig(parameters: &Parameters<f32>, source: &Source) -> Result<Self, RigFileError> {
        let reported = parameters.map(exactly);
        reported.check().map_err(RigFileError::Model)?;
        let mut file = Self::new(reported.pendulum)?;
        file.take_over(parameters, source)?;
        // A guess that happens to be right came from the rig all the same.
        for quantity in Quantity::all(&reported).into_iter().filter(|quantity| quantity.owner() != "pendulum") {
            let knowledge = Knowledge { std: None, source: Some(source.clone()) };
            file.set(quantity, quantity.get(&reported).unwrap_or_default(), knowledge)?;
        }
        Ok(file)
    }

    fn written(parameters: &Parameters<f64>, normalised: bool) -> Result<Self, RigFileError> {
        parameters.check().map_err(RigFileError::Model)?;
        Self::parse(USUAL_NAME, &write::template(parameters, normalised))
    }

    /// Reads the file at `path`.
    pub fn load(path: &Path) -> Result<Self, RigFileError> {
        let file = path.display().to_string();
        let bytes = std::fs::read(path).map_err(|source| RigFileError::Unreadable { file: file.clone(), source })?;
        let text = String::from_utf8(bytes).map_err(|_| RigFileError::NotText { file: file.clone() })?;
        Self::parse(&file, &text)
    }

    /// Reads a text; `file` is what messages call it.
    pub fn parse(file: &str, text: &str) -> Result<Self, RigFileError> {
        read::parse(file, text)
    }

    /// Writes the file as a whole or not at all: a power cut leaves the old one. Whether it may be replaced was asked
    /// before.
    ///
    /// # Errors
    /// The system refuses.
    pub fn save(&self, path: &Path) -> Result<(), RigFileError> {
        files::write(path, self.document.to_string(), Existing::Overwrite).map_err(RigFileError::NotWritten)
    }

    /// The model. Always passes its check.
    pub fn parameters(&self) -> &Parameters<f64> {
        &self.parameters
    }

    /// The model, and how surely its geometry is known.
    pub fn known(&self) -> KnownRig<'_> {
        KnownRig { parameters: &self.parameters, tolerances: self.tolerances }
    }

    /// Are torques and moments of inertia per m·g·l, because the geometry is unknown?
    pub fn is_normalised(&self) -> bool {
        self.normalised
    }

    /// Does it hold the guess for its pendulum, to the last digit, as a file straight from `init` does?
    pub fn is_fresh(&self) -> bool {
        let pendulum = self.parameters.pendulum;
        let guesses = [Self::new(pendulum), Self::normalised(pendulum.gravity_m_s2)];
        guesses.iter().flatten().any(|guess| guess.parameters == self.parameters)
    }

    /// The sensor's calibration, if the file has one.
    pub fn sensor(&self) -> Option<&Sensor> {
        self.sensor.as_ref()
    }

    /// What recordings hold that do not say it, if the file does: `measured = "rate"` under `[sensor]`.
    pub fn measured(&self) -> Option<Measured> {
        self.measured
    }

    /// How well a value is known, if anything but the number is.
    pub fn knowledge(&self, quantity: Quantity) -> Option<&Knowledge> {
        self.knowledge.iter().find(|(known, _)| *known == quantity).map(|(_, knowledge)| knowledge)
    }

    /// Sets a value, its standard deviation and where it came from. An effect that is absent is added, its other
    /// numbers at their start values.
    ///
    /// # Errors
    /// A value outside its range, or more effects than a model may have; the file then stays as it was.
    pub fn set(&mut self, quantity: Quantity, value: f64, knowledge: Knowledge) -> Result<(), RigFileError> {
        let value = self.told(quantity, value, &knowledge);
        let mut parameters = self.parameters.clone();
        let added = quantity.add_effect(&mut parameters).map_err(RigFileError::Model)?;
        quantity.set(&mut parameters, value);
        parameters.check().map_err(RigFileError::Model)?;
        self.parameters = parameters;
        if added {
            write::add_effect(&mut self.document, quantity, &self.parameters);
        }
        let prior = self.tolerance_after(quantity, value, &knowledge);
        write::set_value(&mut self.document, quantity, value, &knowledge, prior);
        self.knowledge.retain(|(known, _)| *known != quantity);
        self.knowledge.push((quantity, knowledge));
        Ok(())
    }

    /// Takes an effect out.
    pub fn remove_effect(&mut self, id: u16) {
        self.parameters.remove(id);
        self.remove_effect_text(id);
    }

    fn remove_effect_text(&mut self, id: u16) {
        self.knowledge.retain(|(known, _)| !known.is_of(id));
        write::remove_effect(&mut self.document, id);
    }

    /// Takes over a whole model, as a rig reports it. Values that are the same to the rig's precision (f32) stay
    /// untouched, with what is known of them.
    ///
    /// # Errors
    /// As [`RigFile::set`].
    pub fn take_over(&mut self, parameters: &Parameters<f32>, source: &Source) -> Result<(), RigFileError> {
        let new = parameters.map(exactly);
        new.check().map_err(RigFileError::Model)?;
        let gone: Vec<u16> = self.parameters.effects.iter().map(|effect| effect.id).collect();
        let other_law = |id: u16| id == CUSTOM_FORMULA_ID && new.formula != self.parameters.formula;
        let gone: Vec<u16> = gone.into_iter().filter(|id| new.values(*id).is_none() || other_law(*id)).collect();
        gone.into_iter().for_each(|id| self.remove_effect(id));
        for quantity in Quantity::all(&new) {
            let value = quantity.get(&new).unwrap_or_default();
            let same = quantity.get(&self.parameters).is_some_and(|old| old as f32 == value as f32);
            if !same {
                self.set(quantity, value, Knowledge { std: None, source: Some(source.clone()) })?;
            }
        }
        let same = self.parameters.map(|value| value as f32).curve == parameters.curve;
        if let Some(curve) = new.curve.filter(|_| !same) {
            self.set_curve(&KnownCurve { curve, stds: Vec::new() }, source)?;
        }
        Ok(())
    }

    /// Sets the sensor and its calibration.
    pub fn set_sensor(&mut self, sensor: Sensor) {
        write::set_sensor(&mut self.document, &sensor);
        self.sensor = Some(sensor);
    }
}

impl std::fmt::Display for RigFile {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(out, "{}", self.document)
    }
}

/// The decimal number a person would write for an f32: 0.00054, not 0.0005400000140070915.
fn exactly(value: f32) -> f64 {
    value.to_string().parse().unwrap_or(f64::from(value))
}

impl From<RigFileError> for Failure {
    fn from(error: RigFileError) -> Self {
        let failure = match error {
            RigFileError::OtherSensor { .. } => Self::wrong_use(&error),
            _ => Self::failed(&error),
        };
        failure.next(error.next_step())
    }
}

#[cfg(test)]
mod tests;
