//! How long a rig may be silent before it counts as gone.

use std::ops::RangeInclusive;
use std::sync::OnceLock;
use std::time::Duration;

/// How much more patient one may ask to be.
pub const FACTORS: RangeInclusive<f64> = 1.0..=1000.0;

static FACTOR: OnceLock<f64> = OnceLock::new();

/// Waits so many times longer for a rig from now on, as one in an emulator or on a busy computer needs it: a number
/// within [`FACTORS`]. The first call counts.
pub fn be_patient(factor: f64) {
    let _ = FACTOR.set(factor);
}

/// What is waited instead of the time that a board answers within.
pub(crate) fn patient(usual: Duration) -> Duration {
    usual.mul_f64(*FACTOR.get().unwrap_or(&1.0))
}
