//! Laws that no list of numbers holds: a typed formula, a friction curve. Each comes in a frame of its own, is held, and
//! goes with the next parameters that have its effect.

use crate::curve::{Curve, Knot, MAX_KNOTS};
use crate::effect::{CURVE_ID, CUSTOM_FORMULA_ID};
use crate::formula::{Formula, MAX_BYTES};
use crate::parameters::Parameters;
use crate::wire::{Numbers, Refusal};
use heapless::Vec;

/// What is held.
pub(super) struct Laws {
    formula: Option<Formula>,
    curve: Option<Curve<f32>>,
}

impl Laws {
    /// Those of a model.
    pub(super) fn of(parameters: &Parameters<f32>) -> Self {
        Self { formula: parameters.formula.clone(), curve: parameters.curve.clone() }
    }

    /// Holds the formula that comes, if any does; gives the one that is held.
    pub(super) fn take_formula(&mut self, bytes: &[u8]) -> Result<Vec<u8, MAX_BYTES>, Refusal> {
        if !bytes.is_empty() {
            self.formula = Some(Formula::from_bytes(bytes).ok_or(Refusal::Formula)?);
        }
        Ok(self.formula.as_ref().map_or(&[][..], Formula::bytes).iter().copied().collect())
    }

    /// Holds the curve that comes, if any does; gives the one that is held.
    pub(super) fn take_curve(&mut self, knots: &[Knot]) -> Result<Vec<Knot, MAX_KNOTS>, Refusal> {
        if !knots.is_empty() {
            self.curve = Some(Curve::through(knots).ok_or(Refusal::Curve)?);
        }
        Ok(self.curve.as_ref().map(Curve::knots).unwrap_or_default())
    }

    /// Parameters with the laws of the effects that they have.
    pub(super) fn complete(&self, numbers: Numbers) -> Parameters<f32> {
        let mut parameters = Parameters::from(numbers);
        if parameters.values(CUSTOM_FORMULA_ID).is_some() {
            parameters.formula.clone_from(&self.formula);
        }
        if parameters.values(CURVE_ID).is_some() {
            parameters.curve.clone_from(&self.curve);
        }
        parameters
    }
}

#[cfg(test)]
mod tests;
