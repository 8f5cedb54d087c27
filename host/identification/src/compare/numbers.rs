//! Are the numbers wrong, or is physics missing? A model whose numbers come from elsewhere is fitted to the recordings:
//! what the fit takes away was the numbers' fault.

use crate::fit::identify::{self, FitError, Method};
use crate::fit::tolerance::KnownRig;
use crate::swing::Swing;
use crate::verdict::{ChiSquare, Colour, Left};
use serde::Serialize;

/// The numbers are to blame when a fit removes at least this share of the variance beyond the noise: most of it. What
/// missing physics leaves of a wrong model, the numbers can hide by this share only by being wrong themselves.
const TO_BLAME: f64 = 0.5;

/// What the same model leaves once it is fitted to these recordings.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Refit {
    /// Root mean square residual, rad.
    pub residual_rad: f64,
    /// The same over the noise.
    pub ratio: f64,
    /// Is that only noise?
    pub left: Left,
}

impl Refit {
    /// What a fit to the swings leaves beside this noise, rad.
    pub fn of(swings: &[Swing], fit: &identify::Fit, noise_rad: f64) -> Self {
        let n_samples = swings.iter().map(Swing::len).sum::<usize>() as f64;
        let colours = swings.iter().filter_map(|swing| swing.colour);
        let chi_square = ChiSquare::of_rms(fit.rmse_rad, noise_rad, n_samples);
        let left = chi_square.beside(colours.reduce(Colour::worst)).left();
        Self { residual_rad: fit.rmse_rad, ratio: fit.rmse_rad / noise_rad.max(1e-300), left }
    }

    /// Does the fit take away most of what a model with this ratio of residual to noise leaves beyond the noise?
    pub fn blames_the_numbers(&self, ratio: f64) -> bool {
        let excess = |ratio: f64| (ratio * ratio - 1.0).max(0.0);
        excess(self.ratio) < (1.0 - TO_BLAME) * excess(ratio)
    }
}

/// The numbers that these swings want.
pub(super) fn least_squares(swings: &[Swing], rig: KnownRig) -> Result<identify::Fit, FitError> {
    let options = identify::Options { method: Method::LeastSquares, ranges: Vec::new() };
    identify::fit(swings, &[], rig, &options, &|_| ())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_to_blame_for_what_a_fit_takes_away() {
        let left = |ratio: f64| Refit { residual_rad: 0.0, ratio, left: Left::Nearly };
        assert!(left(1.0).blames_the_numbers(1.2) && left(5.0).blames_the_numbers(91.0));
        // Where nothing is left there is nothing to blame.
        assert!(!left(1.0).blames_the_numbers(1.0) && !left(0.99).blames_the_numbers(0.995));
        assert!(!left(3.9).blames_the_numbers(4.0) && !left(4.2).blames_the_numbers(4.0));
    }
}
