//! A ridge that keeps a friction curve straight where the swings say nothing.
//!
//! Penalised is how far each inner knot lies off the straight line through its neighbours, so that Coulomb and viscous
//! friction cost nothing. The strength is counted per sample: decimated swings give the same curve.
//! Source: P. H. C. Eilers, B. D. Marx, Statist. Sci. 11 (1996) 89, on unequal distances.

use nalgebra::{DMatrix, DVector};

/// What a crooked curve costs.
#[derive(Clone, Debug, PartialEq)]
pub struct Ridge {
    /// rad² a sample for a (N·m)² off the straight line.
    strength: f64,
    /// DᵀD: the squares of all distances off the line, as a quadratic form of the torques.
    matrix: DMatrix<f64>,
}

impl Ridge {
    /// For knots at these speeds.
    pub fn new(speeds_rad_s: &[f32], strength: f64) -> Self {
        Self { strength, matrix: roughness(speeds_rad_s) }
    }

    /// The quadratic form of the torques that it adds to the sum of squares of so many samples, rad²/(N·m)².
    pub fn weighted(&self, n_samples: usize) -> DMatrix<f64> {
        self.strength * n_samples as f64 * &self.matrix
    }

    /// What it adds to it at some torques, rad².
    pub fn penalty(&self, n_samples: usize, torques_nm: &[f64]) -> f64 {
        let torques = DVector::from_column_slice(torques_nm);
        torques.dot(&(self.weighted(n_samples) * &torques))
    }
}

/// The squares of the distances of inner knots off the line through their neighbours, as a matrix.
pub fn roughness(speeds_rad_s: &[f32]) -> DMatrix<f64> {
    let n_knots = speeds_rad_s.len();
    let mut distances = DMatrix::zeros(n_knots.saturating_sub(2), n_knots);
    for (row, around) in speeds_rad_s.windows(3).enumerate() {
        let [before, here, after] = [0, 1, 2].map(|i| f64::from(around[i]));
        let share = (here - before) / (after - before);
        (distances[(row, row)], distances[(row, row + 1)], distances[(row, row + 2)]) = (share - 1.0, 1.0, -share);
    }
    distances.tr_mul(&distances)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_curve_costs_nothing_and_a_knot_off_the_line_its_square() {
        let speeds = [0.0, 0.5, 2.0, 3.0_f32];
        let matrix = roughness(&speeds);
        let cost = |torques: [f64; 4]| {
            let torques = DVector::from_column_slice(&torques);
            torques.dot(&(&matrix * &torques))
        };
        let line = speeds.map(|speed| 1e-3 + 2e-3 * f64::from(speed));
        assert!(cost(line) < 1e-18);
        // The last inner knot lifted by 3e-3: it lies 3e-3 off, and the one before by a quarter of that.
        let bent = [line[0], line[1], line[2] + 3e-3, line[3]];
        assert!((cost(bent) / (9e-6 * (1.0 + 0.0625)) - 1.0).abs() < 1e-9, "{}", cost(bent));
    }
}
