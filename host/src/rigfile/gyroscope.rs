//! What a model has of a gyroscope: scale and other effects of the sensor that were found from rates. They say nothing
//! of the potentiometer of a rig, whose angles its observer would correct by them.

use super::{RigFile, RigFileError};
use crate::formula::effect_of;
use crate::recording::Measured;
use shared::effect::{Effect, Family};

impl RigFile {
    /// May a rig that measures angles take it?
    ///
    /// # Errors
    /// Effects of the sensor that were found from rates.
    pub fn check_sensor(&self) -> Result<(), RigFileError> {
        let names: Vec<&str> = self.gyroscope().iter().map(|effect| effect.name).collect();
        if names.is_empty() { Ok(()) } else { Err(RigFileError::OtherSensor { effects: names.join(" and ") }) }
    }

    /// Takes those effects out.
    pub fn remove_gyroscope(&mut self) {
        self.gyroscope().iter().for_each(|effect| self.remove_effect(effect.id));
    }

    fn gyroscope(&self) -> Vec<&'static Effect<f64>> {
        let is_of_rates = |id: u16| {
            if self.measured == Some(Measured::Rate) {
                return true;
            }
            let sources = self.knowledge.iter().filter(|(known, _)| known.is_of(id)).map(|(_, known)| &known.source);
            sources.flatten().any(|source| source.measured == Measured::Rate)
        };
        let present = self.parameters.effects.iter().filter_map(|effect| effect_of(&self.parameters, effect.id));
        present.filter(|effect| effect.family == Family::Reading && is_of_rates(effect.id)).collect()
    }
}
