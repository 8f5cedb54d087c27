//! The model in another language: one C header, Python module or MATLAB function that needs nothing else; or the C
//! header in a functional mock-up unit.
//!
//! The physics is not written a second time. The model is generic over its number type, so it is run once with numbers
//! that write down what is done to them (`symbol.rs`); what they wrote is printed in the other language (`print.rs`).
//! Every effect in the list is exported that way, those added later and typed formulas too. Only the loop over the pieces of a step is
//! written by hand, in `c.rs`, `python.rs` and `matlab.rs`.

mod c;
mod fmu;
mod matlab;
mod print;
mod python;
mod symbol;
mod trace;

pub use fmu::{Fmu, fmu};

use crate::formula::effect_of;
use crate::rigfile::{Quantity, RigFile};
use shared::parameters::Parameters;
use trace::Trace;

/// What can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// A C99 header.
    C,
    /// A Python 3 module.
    Python,
    /// A MATLAB function.
    Matlab,
}

/// Why a model can't be exported.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ExportError {
    /// An effect decides by its numbers which way its program goes, so that one run does not show all of it.
    #[error("{name} can't be exported: its program takes different ways for different numbers")]
    Effect {
        /// Its name.
        name: &'static str,
    },
    /// The same of no effect in particular.
    #[error("this model can't be exported: its program takes different ways for different numbers")]
    Model,
    /// The system or the archive's library refused.
    #[error("the archive can't be made: {why}")]
    Archive {
        /// In its words.
        why: String,
    },
}

/// The text of a header or module.
///
/// # Errors
/// A model whose program one run does not show.
pub fn export(file: &RigFile, language: Language) -> Result<String, ExportError> {
    let parameters = file.parameters();
    let trace = Trace::of(parameters).ok_or_else(|| culprit(parameters))?;
    let numbers = numbers(file);
    Ok(match language {
        Language::C => c::header(&numbers, &trace, &laws(parameters), c::Numbers::Defined),
        Language::Python => python::module(&numbers, &trace, &laws(parameters)),
        Language::Matlab => matlab::function_file(&numbers, &trace, &laws(parameters)),
    })
}

fn culprit(parameters: &Parameters<f64>) -> ExportError {
    let alone = |id: u16| {
        let mut single = Parameters::frictionless(parameters.pendulum);
        let values = parameters.values(id).unwrap_or_default();
        (single.formula, single.curve) = (parameters.formula.clone(), parameters.curve.clone());
        single.set(id, values).ok().and_then(|()| Trace::of(&single)).is_none()
    };
    let effect = parameters.effects.iter().find(|effect| alone(effect.id));
    match effect.and_then(|effect| effect_of(parameters, effect.id)) {
        Some(effect) => ExportError::Effect { name: effect.name },
        None => ExportError::Model,
    }
}

/// A number of the model under the name it has in formulas.
struct Number {
    name: String,
    /// As a person writes it: `viscous.Mw`.
    path: String,
    value: f64,
    unit: &'static str,
    meaning: &'static str,
}

impl Number {
    fn comment(&self) -> String {
        format!("{}, {}", self.unit, self.meaning)
    }
}

fn numbers(file: &RigFile) -> Vec<Number> {
    let describe = |quantity: Quantity| Number {
        name: trace::name_of(quantity),
        value: quantity.get(file.parameters()).unwrap_or_default(),
        path: format!("{}.{}", quantity.owner(), quantity.key()),
        unit: quantity.unit(),
        meaning: quantity.meaning(),
    };
    Quantity::all(file.parameters()).into_iter().map(describe).collect()
}

/// Name and law of each effect, for a comment.
fn laws(parameters: &Parameters<f64>) -> Vec<String> {
    let known = parameters.effects.iter().filter_map(|effect| effect_of(parameters, effect.id));
    known.map(|effect| format!("{}: {}", effect.name, effect.formula)).collect()
}
