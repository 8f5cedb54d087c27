//! Several conversions for each sample: how many, and their mean on the scale of [`FULL_SCALE`].
//!
//! The mean of m conversions keeps two bits more than one of them: code = 4·Σ/m. White noise of one conversion falls
//! by √m.

use crate::ports::FULL_SCALE;
use shared::units::Code;

/// More conversions bring nothing: by then the converter's own linearity is larger than its noise.
const MOST: u32 = 64;

/// Fewer would not fill the scale.
const LEAST: u32 = 4;

/// The largest code of one conversion.
const CONVERTER_FULL_SCALE: u16 = 4095;

/// Steps of the sample's scale in one conversion's.
const STEPS: u32 = (FULL_SCALE / CONVERTER_FULL_SCALE) as u32;

/// How many conversions make a sample at `rate_hz`, if at most `most_per_s` conversions can be done: a power of two.
pub fn conversions_per_sample(rate_hz: f32, most_per_s: f32) -> u32 {
    let mut conversions = LEAST;
    while conversions < MOST && 2.0 * conversions as f32 * rate_hz <= most_per_s {
        conversions *= 2;
    }
    conversions
}

/// Sums conversions up to a sample.
#[derive(Clone, Debug)]
pub struct Averager {
    per_sample: u32,
    sum: u32,
    n_summed: u32,
}

impl Averager {
    /// For `per_sample` conversions, a power of two from [`conversions_per_sample`].
    pub const fn new(per_sample: u32) -> Self {
        Self { per_sample, sum: 0, n_summed: 0 }
    }

    /// Takes a conversion, 0 … 4095; gives the sample that it completes.
    pub fn push(&mut self, conversion: u16) -> Option<Code> {
        self.sum += u32::from(conversion);
        self.n_summed += 1;
        if self.n_summed < self.per_sample {
            return None;
        }
        let code = (STEPS * self.sum + self.per_sample / 2) / self.per_sample;
        self.restart();
        Some(Code(code as u16))
    }

    /// Forgets a half-summed sample.
    pub fn restart(&mut self) {
        (self.sum, self.n_summed) = (0, 0);
    }
}
