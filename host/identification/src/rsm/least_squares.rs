//! Ordinary least squares by Householder QR, never through the normal equations, which would square the condition.
//!
//! In: a finite matrix, runs × terms. Out: what every later table needs of it.

use nalgebra::{DMatrix, DVector};

/// A matrix of full column rank, taken apart once and used for every response.
#[derive(Clone, Debug)]
pub struct LeastSquares {
    orthonormal: DMatrix<f64>,
    triangular: DMatrix<f64>,
    condition_number: f64,
}

impl LeastSquares {
    /// Takes a matrix apart; none if its columns cannot be told apart.
    pub fn new(matrix: DMatrix<f64>) -> Option<Self> {
        let condition_number = condition_number(&matrix)?;
        let (orthonormal, triangular) = matrix.qr().unpack();
        Some(Self { orthonormal, triangular, condition_number })
    }

    /// The coefficients, one a column, that come nearest to the responses, one a row.
    pub fn solve(&self, responses: &DVector<f64>) -> DVector<f64> {
        self.back_substituted(self.orthonormal.tr_mul(responses))
    }

    /// How each coefficient depends on each response, terms × runs: (XᵀX)⁻¹Xᵀ.
    pub fn sensitivity(&self) -> DMatrix<f64> {
        let mut sensitivity = self.orthonormal.transpose();
        let solvable = self.triangular.solve_upper_triangular_mut(&mut sensitivity);
        debug_assert!(solvable, "full rank was checked when the matrix was taken apart");
        sensitivity
    }

    /// How strongly each run pulls the surface towards itself: 0 not at all, 1 the surface passes through it.
    pub fn leverages(&self) -> Vec<f64> {
        self.orthonormal.row_iter().map(|row| row.norm_squared().min(1.0)).collect()
    }

    /// Largest over smallest singular value.
    pub fn condition_number(&self) -> f64 {
        self.condition_number
    }

    fn back_substituted(&self, mut right_side: DVector<f64>) -> DVector<f64> {
        let solvable = self.triangular.solve_upper_triangular_mut(&mut right_side);
        debug_assert!(solvable, "full rank was checked when the matrix was taken apart");
        right_side
    }
}

/// Sum of squares left over when the columns have explained what they can.
pub fn residual_sum_of_squares(matrix: DMatrix<f64>, responses: &DVector<f64>) -> f64 {
    if matrix.ncols() == 0 {
        return responses.norm_squared();
    }
    let orthonormal = matrix.qr().q();
    (responses - &orthonormal * orthonormal.tr_mul(responses)).norm_squared()
}

/// Number of columns that can be told apart.
pub fn rank(matrix: &DMatrix<f64>) -> usize {
    let singular = matrix.singular_values();
    singular.iter().filter(|&&value| value > rounding_of(matrix, &singular)).count()
}

/// Largest over smallest singular value; none when there are fewer rows than columns or the rank is short.
pub fn condition_number(matrix: &DMatrix<f64>) -> Option<f64> {
    if matrix.nrows() < matrix.ncols() || matrix.ncols() == 0 {
        return None;
    }
    let singular = matrix.singular_values();
    (singular.min() > rounding_of(matrix, &singular)).then(|| singular.max() / singular.min())
}

/// The size below which a singular value is rounding; the usual bound, as in LAPACK-based rank functions.
fn rounding_of(matrix: &DMatrix<f64>, singular: &DVector<f64>) -> f64 {
    matrix.nrows().max(matrix.ncols()) as f64 * f64::EPSILON * singular.max()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_through_three_points_has_the_known_slope_and_leverages() {
        let line = LeastSquares::new(DMatrix::from_row_slice(3, 2, &[1.0, 0.0, 1.0, 1.0, 1.0, 2.0])).unwrap();
        let coefficients = line.solve(&DVector::from_vec(vec![1.0, 2.0, 6.0]));
        assert!((coefficients[0] - 0.5).abs() < 1e-14 && (coefficients[1] - 2.5).abs() < 1e-14);
        for (leverage, sixths) in line.leverages().iter().zip([5.0, 2.0, 5.0]) {
            assert!((leverage - sixths / 6.0).abs() < 1e-14);
        }
    }

    #[test]
    fn the_sensitivity_times_the_responses_is_the_solution() {
        let line = LeastSquares::new(DMatrix::from_row_slice(3, 2, &[1.0, -1.0, 1.0, 0.5, 1.0, 2.0])).unwrap();
        let responses = DVector::from_vec(vec![0.3, -1.0, 4.0]);
        assert!((line.sensitivity() * &responses - line.solve(&responses)).norm() < 1e-14);
    }

    #[test]
    fn equal_columns_and_too_few_rows_are_noticed() {
        assert!(LeastSquares::new(DMatrix::from_element(4, 2, 1.0)).is_none());
        assert!(LeastSquares::new(DMatrix::identity(1, 2)).is_none());
        assert_eq!(rank(&DMatrix::from_element(4, 2, 1.0)), 1);
    }
}
