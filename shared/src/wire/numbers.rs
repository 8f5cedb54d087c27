//! Parameters as they travel: without the laws that have frames of their own, so that no frame has room for them.

use crate::motion::Pendulum;
use crate::parameters::{EffectValues, MAX_EFFECTS, Parameters};
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// The pendulum and the values of its effects.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Numbers {
    /// Geometry and inertia.
    pub pendulum: Pendulum<f32>,
    /// Present effects; one that is not listed does not act.
    pub effects: Vec<EffectValues<f32>, MAX_EFFECTS>,
}

impl From<&Parameters<f32>> for Numbers {
    fn from(parameters: &Parameters<f32>) -> Self {
        Self { pendulum: parameters.pendulum, effects: parameters.effects.clone() }
    }
}

/// Without laws.
impl From<Numbers> for Parameters<f32> {
    fn from(Numbers { pendulum, effects }: Numbers) -> Self {
        Self { effects, ..Self::frictionless(pendulum) }
    }
}
