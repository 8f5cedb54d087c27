//! How many numbers an effect may have and remember.

/// The most parameters an effect may have.
pub const MAX_VALUES: usize = 4;

/// How many numbers an effect may remember between steps.
pub const MEMORY: usize = 2;

/// How many numbers a sensor effect may remember between readings.
pub const SENSOR_MEMORY: usize = 3;
