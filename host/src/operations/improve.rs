//! A larger model: what a diagnosis adds, or what somebody adds and takes out by hand.

use crate::diagnose::{Diagnosis, Wishes, diagnose_with};
use crate::error::Failure;
use crate::fit::tolerance::KnownRig;
use crate::formula::{FRICTION_CURVE, effect_of};
use crate::improve::{Change, Step, change};
use crate::recording::Measured;
use crate::rigfile::{RigFile, RigFileError, Source};
use crate::swing::{Swing, kind};
use serde::Serialize;
use shared::effect::{CURVE_NAME, CUSTOM_FORMULA_ID, CUSTOM_FORMULA_NAME, Effect};
use shared::parameters::Parameters;

/// How the values were found, as model files say it.
pub const METHOD: &str = "least squares, effects added";

/// How a larger model came about, as `--json` shows it.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
#[expect(clippy::large_enum_variant, reason = "there is one of it at a time")]
pub enum Improved {
    /// By a diagnosis.
    Diagnosed(Diagnosis),
    /// By hand.
    Changed {
        /// What the recordings hold; of rates, errors are in rad/s.
        measured: Measured,
        /// After each change.
        steps: Vec<Step>,
    },
}

/// Adds what is missing, or makes these changes if there are any.
///
/// # Errors
/// A change that can't be made.
pub fn improve(
    swings: &[Swing],
    held_out: &[Swing],
    rig: KnownRig,
    typed: Option<&'static Effect<f64>>,
    changes: &[Change],
) -> Result<Improved, Failure> {
    if changes.is_empty() {
        let wishes = Wishes { typed, ..Wishes::default() };
        return Ok(Improved::Diagnosed(diagnose_with(swings, held_out, rig, wishes)));
    }
    let steps = change(swings, held_out, rig, changes).map_err(Failure::failed)?;
    Ok(Improved::Changed { measured: kind(swings), steps })
}

impl Improved {
    /// Puts the larger model into a model file.
    ///
    /// # Errors
    /// As [`RigFile::set`].
    pub fn write_into(&self, file: &mut RigFile, source: &Source) -> Result<(), RigFileError> {
        match self {
            Self::Diagnosed(diagnosis) => file.adopt(&diagnosis.parameters, &diagnosis.values, source),
            Self::Changed { steps, .. } => {
                steps.last().map_or(Ok(()), |step| file.adopt(&step.parameters, &step.values, source))
            }
        }
    }
}

/// The effect of this name; `custom` is the one that was typed now, or is in the model.
///
/// # Errors
/// There is none.
pub fn effect_named(
    name: &str,
    typed: Option<&'static Effect<f64>>,
    rig: &Parameters<f64>,
) -> Result<&'static Effect<f64>, Failure> {
    if name == CUSTOM_FORMULA_NAME {
        return typed.or(effect_of(rig, CUSTOM_FORMULA_ID)).ok_or_else(|| {
            Failure::wrong_use("there is no custom effect to speak of").next("give its formula with --effect")
        });
    }
    if name == CURVE_NAME {
        return Ok(&FRICTION_CURVE);
    }
    Effect::<f64>::by_name(name).ok_or_else(|| {
        Failure::wrong_use(format!("there is no effect called {name}")).next("see the names with `host effects`")
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula;

    #[test]
    fn a_custom_effect_is_the_one_that_was_typed_now_else_that_of_the_model() {
        let [typed, own] = ["-k*omega; k in 0..1", "-k*theta; k in 0..1"].map(|text| formula::read(text).unwrap());
        let mut rig = Parameters::paper();
        assert!(effect_named(CUSTOM_FORMULA_NAME, None, &rig).is_err());
        formula::add(&mut rig, own, &[0.5]).unwrap();
        let named = |typed| effect_named(CUSTOM_FORMULA_NAME, typed, &rig).unwrap().formula;
        assert_eq!((named(Some(typed)), named(None)), (typed.formula, own.formula));
        assert_eq!(effect_named("eddy-brake", None, &rig).unwrap().name, "eddy-brake");
    }
}
