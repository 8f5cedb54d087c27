//! Mass, length and inertia as the page sends and sees them.

use serde::{Deserialize, Serialize};
use shared::motion::Pendulum;

/// All three, or none where they are unknown.
#[derive(Deserialize, Serialize)]
pub(super) struct Geometry {
    /// Mass, kg.
    pub(super) mass_kg: Option<f64>,
    /// From the pivot to the centre of mass, m.
    pub(super) length_m: Option<f64>,
    /// About the centre of mass, kg·m².
    pub(super) inertia_kg_m2: Option<f64>,
}

impl Geometry {
    /// Of a pendulum that is known.
    pub(super) fn of(pendulum: &Pendulum<f64>) -> Self {
        let Pendulum { mass_kg, length_m, inertia_kg_m2, .. } = *pendulum;
        Self { mass_kg: Some(mass_kg), length_m: Some(length_m), inertia_kg_m2: Some(inertia_kg_m2) }
    }
}
