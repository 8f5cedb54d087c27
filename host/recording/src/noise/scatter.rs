//! How much values scatter: about zero, about a line.

use crate::median;

/// The median size of what is normally distributed, in standard deviations.
pub(crate) const MEDIAN_SIZE: f64 = 0.6745;

/// Scatter about a straight line (rms), in the unit of the values.
pub fn rms_about_line(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let centred = |idx: usize| idx as f64 - (n - 1.0) / 2.0;
    let spread: f64 = (0..values.len()).map(|idx| centred(idx).powi(2)).sum();
    let slope = values.iter().enumerate().map(|(idx, value)| centred(idx) * (value - mean)).sum::<f64>() / spread;
    let residuals = values.iter().enumerate().map(|(idx, value)| value - mean - slope * centred(idx));
    (residuals.map(|residual| residual * residual).sum::<f64>() / (n - 2.0)).sqrt()
}

/// Standard deviation of what is normally distributed about zero, by its median size: what is seldom does not move it.
pub(crate) fn robust_spread(values: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = values.iter().map(|value| value.abs()).collect();
    if sizes.is_empty() { 0.0 } else { median(&mut sizes) / MEDIAN_SIZE }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scatter_about_a_line_has_two_degrees_of_freedom_less_than_samples() {
        // 1, −1, −1, 1 has neither mean nor slope: Σ r² / (4 − 2) = 2.
        let values: Vec<f64> =
            [1.0, -1.0, -1.0, 1.0].iter().enumerate().map(|(i, r)| 5.0 + 3.0 * i as f64 + r).collect();
        assert!((rms_about_line(&values) - 2f64.sqrt()).abs() < 1e-12);
    }
}
