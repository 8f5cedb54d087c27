//! What a rig itself says of its model.

use crate::limits::MAX_VALUES;
use crate::reason::Reason;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Version of [`Suspects`]: 1.
pub const SUSPECTS: u8 = 1;

/// Suspects that are told.
pub const MAX_SUSPECTS: usize = 5;

/// What the rig itself says of its model after the last releases.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Suspects {
    /// [`SUSPECTS`].
    pub version: u8,
    /// Is it looking, or about to?
    pub is_looking: bool,
    /// How often it has looked since power-up; what follows is of the last look.
    pub n_looks: u32,
    /// Releases it looked at.
    pub n_releases: u8,
    /// Windows that these gave …
    pub n_windows: u16,
    /// … in so many clusters: K.
    pub n_clusters: u8,
    /// Noise of the readings, rad.
    pub noise_rad: f32,
    /// What is left beyond the noise, as a share of the noise's squares: by the model as it is, and put right.
    pub excess: [f32; 2],
    /// The same with the first suspect in the model, where it is named.
    pub left: Option<f32>,
    /// Why none is named; none if the first one is.
    pub reason: Option<Reason>,
    /// The likeliest first.
    pub suspects: Vec<Suspected, MAX_SUSPECTS>,
    /// What the look took, in processor cycles of the chip; 0 if not measured.
    pub cycles: u64,
}

/// An effect that may be missing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Suspected {
    /// Its id.
    pub effect: u16,
    /// Its values.
    pub values: Vec<f32, MAX_VALUES>,
    /// Their standard deviations; none for a shape that was assumed.
    pub stds: Vec<Option<f32>, MAX_VALUES>,
    /// F(q, K − q) distributed where the effect is absent …
    pub f: f32,
    /// … with this q.
    pub n_tested: u8,
    /// Can't be told from the first one.
    pub is_tied: bool,
}

impl Suspects {
    /// Before the first look.
    pub const fn none() -> Self {
        Self {
            version: SUSPECTS,
            is_looking: false,
            n_looks: 0,
            n_releases: 0,
            n_windows: 0,
            n_clusters: 0,
            noise_rad: 0.0,
            excess: [0.0; 2],
            left: None,
            reason: Some(Reason::TooFewSwings),
            suspects: Vec::new(),
            cycles: 0,
        }
    }

    /// Is something named?
    pub fn names(&self) -> bool {
        self.reason.is_none() && !self.suspects.is_empty()
    }
}
