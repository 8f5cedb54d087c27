//! Repeatable random points.

use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

/// A generator; equal seeds give equal points.
#[derive(Clone, Debug)]
pub struct Random {
    bits: SplitMix64,
}

impl Random {
    /// A generator from any seed, zero included.
    pub fn new(seed: u64) -> Self {
        Self { bits: SplitMix64::seed_from_u64(seed) }
    }

    /// A point of the coded box, uniform in −1 to +1 in each factor.
    pub fn point_in_box(&mut self, n_factors: usize) -> Vec<f64> {
        (0..n_factors).map(|_| self.coded()).collect()
    }

    /// Orthonormal axes, one a factor: the box's own, mirrored at a random plane (Householder).
    pub fn turned_axes(&mut self, n_factors: usize) -> Vec<Vec<f64>> {
        let normal = self.point_in_box(n_factors);
        let squared_length = normal.iter().map(|part| part * part).sum::<f64>().max(f64::MIN_POSITIVE);
        let mirrored = |row: usize, column: usize| {
            let own = if row == column { 1.0 } else { 0.0 };
            own - 2.0 * normal[row] * normal[column] / squared_length
        };
        (0..n_factors).map(|row| (0..n_factors).map(|column| mirrored(row, column)).collect()).collect()
    }

    /// The upper 53 bits as a number from −1 up to, not including, +1.
    fn coded(&mut self) -> f64 {
        (self.bits.next_u64() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_fill_the_box_evenly() {
        let points = Random::new(7).point_in_box(10_000);
        let mean = points.iter().sum::<f64>() / 1e4;
        let variance = points.iter().map(|x| x * x).sum::<f64>() / 1e4;
        // Four standard errors: 0.577/100 for the mean, 0.3/100 for the variance 1/3.
        assert!(mean.abs() < 0.024 && (variance - 1.0 / 3.0).abs() < 0.012);
        assert!(points.iter().all(|x| (-1.0..1.0).contains(x)));
    }

    #[test]
    fn turned_axes_are_orthonormal() {
        let axes = Random::new(3).turned_axes(5);
        for (i, a) in axes.iter().enumerate() {
            for (j, b) in axes.iter().enumerate() {
                let product: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
                assert!((product - if i == j { 1.0 } else { 0.0 }).abs() < 1e-14);
            }
        }
    }
}
