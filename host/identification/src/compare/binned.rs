//! Means of scattered points over equally filled bins, with standard errors that allow for scatter beyond the points'
//! own spreads.

use serde::Serialize;

/// A point of a curve against something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Against what.
    pub x: f64,
    /// The value.
    pub value: f64,
    /// Its standard error.
    pub spread: f64,
}

/// Mean of the samples of a bin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Mean {
    /// Mean x.
    pub x: f64,
    /// Mean value.
    pub value: f64,
    /// Its standard error.
    pub spread: f64,
    /// Samples in the bin.
    pub n: usize,
}

impl Mean {
    /// The mean in standard errors.
    pub fn z(&self) -> f64 {
        self.value / self.spread.max(1e-300)
    }
}

/// Bins at most.
const MOST_BINS: usize = 14;

/// Samples of a bin, at least.
const FEWEST: usize = 4;

/// Equally filled bins along x.
pub fn binned(samples: &[Sample]) -> Vec<Mean> {
    let mut sorted = samples.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x));
    let size = sorted.len().div_ceil(MOST_BINS).max(FEWEST);
    sorted.chunks(size).filter(|bin| bin.len() >= FEWEST).map(mean).collect()
}

/// The weighted mean of samples in order of x. Its error is the larger of what the spreads say and what the scatter of
/// neighbours says, which a trend within the bin does not widen.
pub fn mean(samples: &[Sample]) -> Mean {
    let n = samples.len();
    let weights: Vec<f64> = samples.iter().map(|sample| sample.spread.max(1e-300).powi(-2)).collect();
    let total: f64 = weights.iter().sum();
    let average = |of: &dyn Fn(&Sample) -> f64| {
        samples.iter().zip(&weights).map(|(sample, weight)| weight * of(sample)).sum::<f64>() / total
    };
    let value = average(&|sample| sample.value);
    let neighbours: f64 = samples.windows(2).map(|pair| (pair[1].value - pair[0].value).powi(2)).sum();
    let scatter = 0.5 * neighbours / (n as f64 * (n as f64 - 1.0).max(1.0));
    let x = samples.iter().map(|sample| sample.x).sum::<f64>() / n as f64;
    Mean { x, value, spread: scatter.max(total.recip()).sqrt(), n }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scatter_beyond_the_spreads_widens_the_error() {
        let samples = |scatter: f64| -> Vec<Sample> {
            (0..8).map(|i| Sample { x: f64::from(i), value: scatter * f64::from(i % 2), spread: 0.1 }).collect()
        };
        assert!((mean(&samples(0.0)).spread - 0.1 / 8f64.sqrt()).abs() < 1e-12);
        assert!(mean(&samples(2.0)).spread > 0.3);
        assert_eq!(binned(&samples(0.0)).len(), 2);
    }

    #[test]
    fn the_scatter_of_neighbours_gives_the_error_of_the_mean() {
        // Half the mean square of the seven differences of 2 is the variance, 2; that of the mean of eight is 0.25.
        let sample = |i: u32| Sample { x: f64::from(i), value: 5.0 + 2.0 * f64::from(i % 2), spread: 0.1 };
        let found = mean(&(0..8).map(sample).collect::<Vec<_>>());
        assert_eq!((found.x, found.n), (3.5, 8));
        assert!((found.value - 6.0).abs() < 1e-12 && (found.spread - 0.5).abs() < 1e-12, "{found:?}");
    }
}
