//! What can be set besides the model.

use crate::sensor::Sensor;
use serde::{Deserialize, Serialize};

/// What can be set besides the model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Samples per second, 50 … 10 000. A rig that cannot make a rate exactly takes the nearest one it can, and gives
    /// that.
    pub rate_hz: f32,
    /// Cut-off of the Butterworth filter, below 0.45 of the rate.
    pub cutoff_hz: f32,
    /// Bandwidth of the observer, 0 … 100 rad/s; 0 lets the model run alone.
    pub bandwidth_rad_s: f32,
    /// Which sensor, and its calibration.
    #[serde(with = "crate::sensor::bytes")]
    pub sensor: Sensor,
}
