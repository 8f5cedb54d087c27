//! A model file takes over what was found from recordings, with where it came from.

use super::{Knowledge, KnownCurve, Quantity, RigFile, RigFileError, Source, write};
use crate::diagnose::Value;
use crate::fit::identify::Fit;
use shared::effect::{CURVE_NAME, CUSTOM_FORMULA_ID};
use shared::parameters::Parameters;

impl RigFile {
    /// Takes over a model that was found: its effects, and every number that differs, as well as `values` know it.
    ///
    /// # Errors
    /// As [`RigFile::set`].
    pub fn adopt(
        &mut self,
        parameters: &Parameters<f64>,
        values: &[Value],
        source: &Source,
    ) -> Result<(), RigFileError> {
        let other_law = |id: u16| id == CUSTOM_FORMULA_ID && parameters.formula != self.parameters().formula;
        let here = self.parameters().effects.iter().map(|effect| effect.id);
        let gone: Vec<u16> = here.filter(|id| parameters.values(*id).is_none() || other_law(*id)).collect();
        gone.into_iter().for_each(|id| self.remove_effect(id));
        for quantity in Quantity::all(parameters) {
            let value = quantity.get(parameters).unwrap_or_default();
            if quantity.get(self.parameters()) != Some(value) {
                let owner = if quantity == Quantity::Inertia { "inertia" } else { quantity.owner() };
                let known = values.iter().find(|known| known.effect == owner && known.symbol == quantity.symbol());
                let std = known.and_then(|known| known.std);
                let value = if std.is_none() { write::six_digits(value) } else { value };
                self.set(quantity, value, Knowledge { std, source: Some(source.clone()) })?;
            }
        }
        if let Some(curve) = parameters.curve.clone().filter(|curve| self.parameters().curve.as_ref() != Some(curve)) {
            let knots = values.iter().filter(|value| value.effect == CURVE_NAME);
            self.set_curve(&KnownCurve { curve, stds: knots.map(|knot| knot.std).collect() }, source)?;
        }
        Ok(())
    }

    /// Takes over the numbers of an identification, with their standard deviations.
    ///
    /// # Errors
    /// As [`RigFile::set`].
    pub fn adopt_fit(&mut self, fit: &Fit, source: &Source) -> Result<(), RigFileError> {
        let quantities = Quantity::all(&fit.parameters);
        for found in &fit.identified {
            let is_meant = |quantity: &&Quantity| match found.name {
                "inertia" => **quantity == Quantity::Inertia,
                name => quantity.owner() == name && quantity.symbol() == found.symbol,
            };
            let Some(quantity) = quantities.iter().find(is_meant) else { continue };
            // Mass and length stay as they were typed where no period asks for others.
            if quantity.is_measured() && quantity.get(self.parameters()) == Some(found.value) {
                continue;
            }
            self.set(*quantity, found.value, Knowledge { std: found.std, source: Some(source.clone()) })?;
        }
        Ok(())
    }
}
