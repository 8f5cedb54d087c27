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

/// The timer counts 16 bits.
const MOST_TICKS: u32 = 0x1_0000;

/// What the boards' crystals are good for: a rate that is no further off than this is as good as one that is exact.
const TOLERANCE: f64 = 50e-6;

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

impl Plan {
    /// The rate that it makes with a timer of `clock_hz`: off by no more than what an `f32` rounds, 6e-8.
    pub fn rate_hz(&self, clock_hz: u32) -> f32 {
        (f64::from(clock_hz) / f64::from(self.per_sample * self.ticks)) as f32
    }

    /// How far it is from `rate_hz`, as a share.
    fn error(&self, rate_hz: f32, clock_hz: u32) -> f64 {
        let made_hz = f64::from(clock_hz) / f64::from(self.per_sample * self.ticks);
        (made_hz / f64::from(rate_hz) - 1.0).abs()
    }
}

/// The plan for `rate_hz` (50 … 10 000) with a timer of `clock_hz`, at most `most_per_s` conversions a second. If the
/// rate can be met exactly, the plan that does so with the most conversions; else of those that are as good as exact
/// the one with the most; else the nearest.
pub fn plan(rate_hz: f32, clock_hz: u32, most_per_s: u32) -> Plan {
    let candidates = || {
        (LEAST.ilog2()..=MOST.ilog2())
            .rev()
            .map(|power| 1 << power)
            .filter(|per_sample| *per_sample == LEAST || *per_sample as f32 * rate_hz <= most_per_s as f32)
            .map(|per_sample| {
                let ticks = f64::from(clock_hz) / (f64::from(per_sample) * f64::from(rate_hz)) + 0.5;
                Plan { per_sample, ticks: (ticks as u32).max(1) }
            })
            .filter(|plan| plan.ticks <= MOST_TICKS)
    };
    let error = |plan: &Plan| plan.error(rate_hz, clock_hz);
    let nearest = || candidates().min_by(|a, b| error(a).total_cmp(&error(b)));
    let made = |plan: &Plan| plan.rate_hz(clock_hz) == rate_hz;
    let as_good = |plan: &Plan| error(plan) <= TOLERANCE;
    candidates()
        .find(made)
        .or_else(|| candidates().find(as_good))
        .or_else(nearest)
        .unwrap_or(Plan { per_sample: MOST, ticks: MOST_TICKS })
}

/// The sample that these conversions (0 … 4095 each) make.
pub fn sample(conversions: impl Iterator<Item = u16>) -> Code {
    let (sum, n) = conversions.fold((0, 0), |(sum, n), conversion| (sum + u32::from(conversion), n + 1));
    Code(((STEPS * sum + n / 2) / n) as u16)
}

/// The sample that these counts make: the one in the middle, which is as old as the mean of that many conversions. A
/// count has no noise that a mean would lower, and may begin again at zero between two of them.
pub fn middle(mut counts: impl ExactSizeIterator<Item = u16>) -> Code {
    let half = counts.len() / 2;
    Code(counts.nth(half).unwrap_or_default())
}
