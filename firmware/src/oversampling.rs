//! Several conversions for each sample: how many, and their mean on the scale of [`FULL_SCALE`].
//!
//! The mean of m conversions keeps two bits more than one of them: code = 4·Σ/m. White noise of one conversion falls
//! by √m.

use crate::ports::FULL_SCALE;
use micromath::F32;
use shared::units::Code;

/// More conversions bring nothing: by then the converter's own linearity is larger than its noise.
const MOST: u32 = 64;

/// Fewer would not fill the scale.
const LEAST: u32 = 4;

/// The largest code of one conversion.
const CONVERTER_FULL_SCALE: u16 = 4095;

/// Steps of the sample's scale in one conversion's.
const STEPS: u32 = (FULL_SCALE / CONVERTER_FULL_SCALE) as u32;

/// How a rate is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plan {
    /// Conversions for each sample: a power of two.
    pub per_sample: u32,
    /// Ticks of the timer from one conversion to the next.
    pub ticks: u32,
}

/// The plan for `rate_hz` with a timer of `clock_hz`, at most `most_per_s` conversions a second. Among the plans that
/// meet the rate exactly the one with the most conversions; if none does, the nearest with the most conversions.
pub fn plan(rate_hz: f32, clock_hz: u32, most_per_s: u32) -> Plan {
    let ticks = |per_sample: u32| F32(clock_hz as f32 / (per_sample as f32 * rate_hz));
    let affordable = |per_sample: &u32| *per_sample as f32 * rate_hz <= most_per_s as f32;
    let exact = |per_sample: &u32| ticks(*per_sample).fract() == F32::ZERO;
    let candidates = || (LEAST.ilog2()..=MOST.ilog2()).rev().map(|power| 1 << power).filter(affordable);
    let per_sample = candidates().find(exact).or_else(|| candidates().next()).unwrap_or(LEAST);
    Plan { per_sample, ticks: ticks(per_sample).round().0 as u32 }
}

/// The sample that these conversions (0 … 4095 each) make.
pub fn sample(conversions: impl Iterator<Item = u16>) -> Code {
    let (sum, n) = conversions.fold((0, 0), |(sum, n), conversion| (sum + u32::from(conversion), n + 1));
    Code(((STEPS * sum + n / 2) / n) as u16)
}
