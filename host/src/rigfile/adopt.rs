//! A model file takes over what was found from recordings, with where it came from.

use super::{Knowledge, Quantity, RigFile, RigFileError, Source};
use crate::fit::identify::Fit;
use shared::parameters::Parameters;

impl RigFile {
    /// Takes over a model that was found: its effects, and every value that differs.
    ///
    /// # Errors
    /// As [`RigFile::set`].
    pub fn adopt(&mut self, parameters: &Parameters<f64>, source: &Source) -> Result<(), RigFileError> {
        let gone: Vec<u16> = self.parameters().effects.iter().map(|effect| effect.id).collect();
        gone.into_iter().filter(|id| parameters.values(*id).is_none()).for_each(|id| self.remove_effect(id));
        for quantity in Quantity::all(parameters) {
            let value = quantity.get(parameters).unwrap_or_default();
            if quantity.get(self.parameters()) != Some(value) {
                self.set(quantity, value, Knowledge { std: None, source: Some(source.clone()) })?;
            }
        }
        Ok(())
    }

    /// Takes over the numbers of an identification, with their standard deviations.
    ///
    /// # Errors
    /// As [`RigFile::set`].
    pub fn adopt_fit(&mut self, fit: &Fit, source: &Source) -> Result<(), RigFileError> {
        for found in &fit.identified {
            let name = match found.name {
                "inertia" => found.symbol.to_owned(),
                effect => format!("{effect}.{}", found.symbol),
            };
            let Some(quantity) = Quantity::by_name(&name) else { continue };
            self.set(quantity, found.value, Knowledge { std: found.std, source: Some(source.clone()) })?;
        }
        Ok(())
    }
}
