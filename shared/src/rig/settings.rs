//! What a rig can be set to.

use crate::sensor::Sensor;
use crate::wire::Settings;

/// Sampling rates that a rig may be asked for.
pub const LOWEST_RATE_HZ: f32 = 50.0;
/// See [`LOWEST_RATE_HZ`].
pub const HIGHEST_RATE_HZ: f32 = 10_000.0;

/// Of the rate, the highest cut-off of the filter.
pub const HIGHEST_CUTOFF: f32 = 0.45;

/// Of the observer.
pub const HIGHEST_BANDWIDTH_RAD_S: f32 = 100.0;

impl Settings {
    /// The same at another rate, with a cut-off that goes with it.
    pub fn at_rate(self, rate_hz: f32) -> Self {
        Self { rate_hz, cutoff_hz: self.cutoff_hz.min(HIGHEST_CUTOFF * rate_hz), ..self }
    }

    /// The same with another sensor, or with another calibration.
    pub fn with_sensor(self, sensor: Sensor) -> Self {
        Self { sensor, ..self }
    }
}

/// The position of the sensor among the settings.
pub(super) const SENSOR: u8 = 3;

/// `Err` with the position of the first setting outside its range.
pub(super) fn check_settings(settings: &Settings) -> Result<(), u8> {
    let good = [
        (LOWEST_RATE_HZ..=HIGHEST_RATE_HZ).contains(&settings.rate_hz),
        settings.cutoff_hz > 0.0 && settings.cutoff_hz <= HIGHEST_CUTOFF * settings.rate_hz,
        (0.0..=HIGHEST_BANDWIDTH_RAD_S).contains(&settings.bandwidth_rad_s),
        settings.sensor.is_valid(),
    ];
    good.iter().position(|good| !good).map_or(Ok(()), |index| Err(index as u8))
}
