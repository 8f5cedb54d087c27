//! Is only noise left? The one answer for fit, comparison, diagnosis, improvement, plan, page and report; and the
//! constants that decide it.
//!
//! The reduced chi-square is the sum of squared residuals over σ²·ν, with σ the noise of the sensor and ν the effective
//! number of samples less the numbers that were fitted. It is 1 where only noise is left, give or take two things: chance,
//! with the standard error √(2/ν), and σ, which is itself estimated from the recording.

pub use crate::recording::noise::Colour;
use serde::Serialize;

/// What a model leaves of the swings, the least first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Left {
    /// Nothing but noise.
    Noise,
    /// A little more than noise: enough to look for a cause, too little to call physics missing.
    Nearly,
    /// Clearly more than noise.
    Missing,
}

// The constants that decide verdicts, in one place. They say what may be claimed; how long a search may take is no matter
// of theirs.

/// Relative error of the noise's variance, as the estimate from differences has it (`noise.rs`: 2 % of the rms at worst,
/// usually below 1.5 %). Half of it: simulated rigs without anything missing are searched in vain. Twice: weak effects are
/// left in peace.
const NOISE_KNOWN: f64 = 0.03;

/// Within so many standard errors something may be chance: 95 % of it is …
pub const CHANCE_STDS: f64 = 2.0;

/// … and beyond so many it is none, however often one looks: 99.7 % lie within.
pub const NO_CHANCE_STDS: f64 = 3.0;

/// A single reading that is off by more than so many noises is seen to be.
pub const SEEN_NOISES: f64 = 4.0;

/// A remainder of more than this share of the noise's variance is called missing physics: 1.1 times the rms.
const MISSING: f64 = 0.21;

/// And of coloured noise, known from a still pendulum, this one: 1.3 times the rms. A moving one may have more of it.
const MISSING_BESIDE_COLOUR: f64 = 0.69;

/// A model that leaves this share of the motion, beyond the noise, hardly follows it. Of 201 recordings of strangers in which
/// more than noise was left 20 leave more, ten of them driven, held up or disturbed and two on a cart; half of it is left by
/// 61, many of them free swings, twice of it by none.
const HARDLY_FOLLOWED: f64 = 0.25;

/// What to look at before anybody asks which physics is missing, where a model hardly follows.
pub const LOOK_FIRST: &str = "see that the column is the angle of one pendulum, in that unit, let go and left alone";

/// No model is that much better than the noise.
const BELOW_NOISE: f64 = 0.7;

/// What to look at where an error is far below the noise.
const NOISE_TOO_LARGE: &str = "which was therefore estimated too large: look for jumps, gaps or wraps of the angle, or for hum near \
                               half the sampling rate, with which neighbouring readings alternate";

/// Why nothing is wrong with such an error where the readings have no noise of their own.
const NO_NOISE: &str = "which is what a model is simulated to: the readings have no noise of their own";

/// What an error far below the noise says of it, of readings with or without noise of their own.
pub fn far_below(has_no_noise: bool) -> &'static str {
    if has_no_noise { NO_NOISE } else { NOISE_TOO_LARGE }
}

/// Is an error (rms), as a share of the noise, one that no model has?
pub fn is_far_below_noise(share: f64) -> bool {
    share < BELOW_NOISE
}

/// Does a model that leaves this share of the motion, beyond the noise, lack more than an effect adds?
pub fn hardly_follows(left_of_motion: f64) -> bool {
    left_of_motion >= HARDLY_FOLLOWED
}

/// That each recording has a model of its own which leaves so much (rms, rad), where one for all hardly follows them.
pub fn followed_one_by_one(apart_rmse: f64, milli_unit: &str) -> String {
    format!(
        "each recording has a model of its own that follows it far better, to {:.2} {milli_unit}: what was changed between \
         them (a brake, the bearing, what hangs there)? Fit them one by one",
        1e3 * apart_rmse
    )
}

/// A reduced chi-square and the number of samples that it stands on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChiSquare {
    /// Variance of the residuals over that of the noise.
    pub reduced: f64,
    /// Effective number of samples less the fitted numbers.
    pub n_effective: f64,
    /// Present if the noise is coloured.
    pub colour: Option<Colour>,
}

impl ChiSquare {
    /// From a sum of squared residuals (rad²), the noise (rms, rad), the effective number of samples and how many numbers
    /// were fitted to them.
    pub fn new(cost_rad2: f64, noise_rad: f64, n_effective: f64, n_fitted: usize) -> Self {
        let n_effective = (n_effective - n_fitted as f64).max(1.0);
        Self {
            reduced: cost_rad2 / (noise_rad.powi(2) * n_effective).max(f64::MIN_POSITIVE),
            n_effective,
            colour: None,
        }
    }

    /// From an rms residual and the noise (both rad) over samples to which hardly anything was fitted.
    pub fn of_rms(rms_rad: f64, noise_rad: f64, n_effective: f64) -> Self {
        let n_effective = n_effective.max(1.0);
        Self { reduced: (rms_rad / noise_rad.max(f64::MIN_POSITIVE)).powi(2), n_effective, colour: None }
    }

    /// Beside a noise of this colour.
    pub fn beside(self, colour: Option<Colour>) -> Self {
        Self { colour, ..self }
    }

    /// Variance beyond the noise, as a share of the noise's; negative where less is left.
    pub fn excess(&self) -> f64 {
        self.reduced - 1.0
    }

    /// So much excess may be chance or an error in σ.
    fn tolerance(&self) -> f64 {
        let chance = |n_independent: f64| CHANCE_STDS * (2.0 / n_independent).sqrt();
        let of_noise = self.colour.map_or(0.0, |colour| chance(colour.n_independent));
        let share = self.colour.map_or(1.0, |colour| colour.independent_share);
        NOISE_KNOWN.hypot(of_noise).hypot(chance(share * self.n_effective))
    }

    /// The answer.
    pub fn left(&self) -> Left {
        let tolerance = self.tolerance();
        let missing = if self.colour.is_some() { MISSING_BESIDE_COLOUR } else { MISSING };
        match self.excess() {
            excess if excess <= tolerance => Left::Noise,
            excess if excess <= missing.max(tolerance) => Left::Nearly,
            _ => Left::Missing,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_variance_within_its_own_uncertainty_is_noise_however_few_the_samples() {
        // √(2/200) is 0.1: with 200 samples an excess of 0.2 is within two standard errors.
        assert_eq!(ChiSquare::of_rms(1.19_f64.sqrt(), 1.0, 200.0).left(), Left::Noise);
        assert_eq!(ChiSquare::of_rms(1.19_f64.sqrt(), 1.0, 50_000.0).left(), Left::Nearly);
        assert_eq!(ChiSquare::of_rms(1.02_f64.sqrt(), 1.0, 50_000.0).left(), Left::Noise);
        assert_eq!(ChiSquare::of_rms(1.12, 1.0, 50_000.0).left(), Left::Missing);
        assert_eq!(ChiSquare::of_rms(0.7, 1.0, 50_000.0).left(), Left::Noise);
    }

    #[test]
    fn coloured_noise_is_known_by_its_independent_samples_and_may_be_larger_while_the_pendulum_moves() {
        let colour = Colour { independent_share: 0.25, n_independent: 800.0 };
        let left = |ratio: f64, n: f64| ChiSquare::of_rms(ratio, 1.0, n).beside(Some(colour)).left();
        // √(2/800) twice is 0.1, and of 3,200 swinging samples as much: 0.145 together with that of any noise.
        assert_eq!((left(1.14_f64.sqrt(), 3200.0), left(1.15_f64.sqrt(), 3200.0)), (Left::Noise, Left::Nearly));
        assert_eq!((left(1.29, 1e6), left(1.31, 1e6)), (Left::Nearly, Left::Missing));
    }

    #[test]
    fn fitted_numbers_take_their_share_of_the_samples() {
        let chi_square = ChiSquare::new(90.0, 1.0, 100.0, 10);
        assert!((chi_square.reduced - 1.0).abs() < 1e-12 && chi_square.n_effective == 90.0);
    }
}
