//! Solves the damped normal equations (JᵀJ + λ·D)·δ = Jᵀr by Cholesky factorisation with pivoting; D is the diagonal of
//! JᵀJ, so that units do not matter.
//!
//! Columns are scaled to length one, then the one with the largest remainder is taken next. A column whose remainder is
//! rounding alone is without effect, or the copy of others: it gets no step, instead of one that rounding decides.
//! Source: N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed. (SIAM 2002), section 10.3.

use nalgebra::{DMatrix, DVector};

/// Damping of first-order answers: enough to keep numbers without any effect in place.
pub const ANSWER_DAMPING: f64 = 1e-6;

/// Squared remainders of columns of length one that are rounding: some hundred times the machine's precision.
pub(super) const RANK: f64 = 1e-13;

/// A factorised matrix, for any number of right-hand sides.
pub struct Factor {
    size: usize,
    /// Original column of each row of `lower`, in the order of the pivots.
    pivots: Vec<usize>,
    scale: Vec<f64>,
    lower: DMatrix<f64>,
}

impl Factor {
    /// Of JᵀJ with damping λ for the columns that `free` allows; the others stay put.
    pub fn new(normal: &DMatrix<f64>, damping: f64, free: impl Fn(usize) -> bool) -> Self {
        let squares: Vec<f64> = normal.diagonal().iter().copied().collect();
        let mut damped = normal.clone();
        (0..squares.len()).for_each(|j| damped[(j, j)] += damping * squares[j]);
        Self::of_squares(&damped, &squares, free)
    }

    /// Of a matrix that is left of JᵀJ; a remainder is measured against the square of its column of J.
    pub fn of_squares(left: &DMatrix<f64>, squares: &[f64], free: impl Fn(usize) -> bool) -> Self {
        let size = left.nrows();
        let mut pivots: Vec<usize> = (0..size).filter(|j| free(*j)).collect();
        let largest = pivots.iter().map(|j| squares[*j]).fold(0.0, f64::max);
        let length = |j: &usize| squares[*j].max(1e-30 * largest).max(1e-300).sqrt();
        let mut scale: Vec<f64> = pivots.iter().map(length).collect();
        let unit = |i: usize, j: usize| left[(pivots[i], pivots[j])] / (scale[i] * scale[j]);
        let mut lower = DMatrix::from_fn(pivots.len(), pivots.len(), unit);
        let mut rank = 0;
        while rank < pivots.len() {
            let remainder = |k: &usize| lower[(*k, *k)];
            let next = (rank..pivots.len()).max_by(|a, b| remainder(a).total_cmp(&remainder(b))).unwrap_or(rank);
            if !(remainder(&next) > RANK && remainder(&next).is_finite()) {
                break;
            }
            swap(&mut lower, rank, next);
            pivots.swap(rank, next);
            scale.swap(rank, next);
            eliminate(&mut lower, rank);
            rank += 1;
        }
        pivots.truncate(rank);
        Self { size, pivots, scale, lower }
    }

    /// The step for a right-hand side Jᵀr; zero where a column has none.
    pub fn solve(&self, gradient: &DVector<f64>) -> DVector<f64> {
        let rank = self.pivots.len();
        let mut x: Vec<f64> = (0..rank).map(|k| gradient[self.pivots[k]] / self.scale[k]).collect();
        for k in 0..rank {
            x[k] /= self.lower[(k, k)];
            for i in k + 1..rank {
                x[i] -= self.lower[(i, k)] * x[k];
            }
        }
        for k in (0..rank).rev() {
            let behind: f64 = (k + 1..rank).map(|i| self.lower[(i, k)] * x[i]).sum();
            x[k] = (x[k] - behind) / self.lower[(k, k)];
        }
        let mut step = DVector::zeros(self.size);
        (0..rank).for_each(|k| step[self.pivots[k]] = x[k] / self.scale[k]);
        step
    }

    /// A step for each column of right-hand sides.
    pub fn solve_all(&self, gradients: &DMatrix<f64>) -> DMatrix<f64> {
        let steps: Vec<DVector<f64>> = gradients.column_iter().map(|column| self.solve(&column.into_owned())).collect();
        DMatrix::from_fn(self.size, steps.len(), |i, j| steps[j][i])
    }

    /// The inverse; zero in rows and columns that have no effect of their own.
    pub fn inverse(&self) -> DMatrix<f64> {
        let unit = |j: usize| DVector::from_fn(self.size, |i, _| f64::from(u8::from(i == j)));
        let columns: Vec<DVector<f64>> = (0..self.size).map(|j| self.solve(&unit(j))).collect();
        DMatrix::from_columns(&columns)
    }

    /// Columns that have an effect of their own.
    pub fn rank(&self) -> usize {
        self.pivots.len()
    }
}

/// Exchanges two rows and columns of the lower triangle, `a` before `b`.
fn swap(lower: &mut DMatrix<f64>, a: usize, b: usize) {
    if a == b {
        return;
    }
    (0..a).for_each(|j| lower.swap((a, j), (b, j)));
    lower.swap((a, a), (b, b));
    (a + 1..b).for_each(|i| lower.swap((i, a), (b, i)));
    (b + 1..lower.nrows()).for_each(|i| lower.swap((i, a), (i, b)));
}

/// One column of the factor, taken out of those behind it.
fn eliminate(lower: &mut DMatrix<f64>, k: usize) {
    let n = lower.nrows();
    let pivot = lower[(k, k)].sqrt();
    lower[(k, k)] = pivot;
    (k + 1..n).for_each(|i| lower[(i, k)] /= pivot);
    for j in k + 1..n {
        let (before, mut behind) = lower.columns_range_pair_mut(k..k + 1, j..j + 1);
        let factor = before[(j, 0)];
        (j..n).for_each(|i| behind[(i, 0)] -= factor * before[(i, 0)]);
    }
}

/// One solution for one right-hand side.
pub fn solve_damped(normal: &DMatrix<f64>, gradient: &DVector<f64>, damping: f64, free: &[bool]) -> DVector<f64> {
    Factor::new(normal, damping, |j| free[j]).solve(gradient)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Any matrix with columns of very different lengths, as angles and torques have them.
    fn columns(n_rows: usize, n_columns: usize) -> DMatrix<f64> {
        let entry =
            |i: usize, j: usize| ((1 + i * (j + 2)) as f64 * 0.37).sin() + 0.3 * (i as f64 / (j + 1) as f64).cos();
        DMatrix::from_fn(n_rows, n_columns, |i, j| 10f64.powi(2 * j as i32 - 4) * entry(i, j))
    }

    fn residuals(n_rows: usize) -> DVector<f64> {
        DVector::from_fn(n_rows, |i, _| (i as f64 * 0.11).cos())
    }

    #[test]
    fn without_damping_it_is_the_least_squares_solution_of_a_singular_value_decomposition() {
        let (j, r) = (columns(60, 5), residuals(60));
        let ours = Factor::new(&(j.transpose() * &j), 0.0, |_| true).solve(&(j.transpose() * &r));
        let theirs = j.svd(true, true).solve(&r, 1e-14).unwrap();
        for k in 0..5 {
            assert!((ours[k] / theirs[k] - 1.0).abs() < 1e-8, "{ours} {theirs}");
        }
    }

    #[test]
    fn damping_is_rows_below_the_matrix() {
        let (j, r) = (columns(60, 4), residuals(60));
        let damping = 0.3_f64;
        let ours = Factor::new(&(j.transpose() * &j), damping, |_| true).solve(&(j.transpose() * &r));
        let rows = DMatrix::from_fn(64, 4, |i, k| match i.checked_sub(60) {
            None => j[(i, k)],
            Some(row) => {
                if row == k {
                    damping.sqrt() * j.column(k).norm()
                } else {
                    0.0
                }
            }
        });
        let theirs = rows.svd(true, true).solve(&DVector::from_fn(64, |i, _| if i < 60 { r[i] } else { 0.0 }), 1e-14);
        assert!((&ours - theirs.unwrap()).component_div(&ours).amax() < 1e-9);
    }

    #[test]
    fn a_copy_of_a_column_and_one_without_effect_get_no_step_and_spoil_nothing() {
        let (full, r) = (columns(60, 3), residuals(60));
        let j = DMatrix::from_fn(60, 5, |i, k| [full[(i, 0)], full[(i, 1)], 7.0 * full[(i, 0)], 0.0, full[(i, 2)]][k]);
        let factor = Factor::new(&(j.transpose() * &j), 0.0, |_| true);
        assert_eq!(factor.rank(), 3);
        let step = factor.solve(&(j.transpose() * &r));
        let best = full.clone().svd(true, true).solve(&r, 1e-14).unwrap();
        assert!((&j * step - full * best).norm() < 1e-9 * r.norm());
    }

    #[test]
    fn what_is_not_free_stays_where_it_is() {
        let (j, r) = (columns(60, 4), residuals(60));
        let step = solve_damped(&(j.transpose() * &j), &(j.transpose() * &r), 0.0, &[true, false, true, true]);
        assert_eq!(step[1], 0.0);
        let rest = j.remove_column(1);
        let theirs = rest.svd(true, true).solve(&r, 1e-14).unwrap();
        assert!((step[0] / theirs[0] - 1.0).abs() < 1e-8 && (step[3] / theirs[2] - 1.0).abs() < 1e-8);
    }
}
