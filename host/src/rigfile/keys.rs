//! The keys of a model file.

pub(super) const TOP_KEYS: [&str; 5] = ["format", "pendulum", "sensor", "effect", "notes"];
pub(super) const PENDULUM_KEYS: [&str; 5] = ["mass", "length", "inertia", "gravity", "normalised"];
/// Beside the numbers of the sensor.
pub(super) const SENSOR_KEYS: [&str; 2] = ["measured", "kind"];
pub(super) const FORMULA_KEY: &str = "formula";
pub(super) const VALUE_KEYS: [&str; 5] = ["value", "std", "method", "recordings", "measured"];
/// Of mass, length and inertia.
pub(super) const MEASURED_KEYS: [&str; 6] = ["value", "std", "method", "recordings", "measured", PRIOR_KEY];

/// What was measured before any swing.
pub(super) const PRIOR_KEY: &str = "prior";
pub(super) const PRIOR_KEYS: [&str; 2] = ["value", "std"];
