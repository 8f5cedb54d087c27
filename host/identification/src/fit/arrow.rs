//! Normal equations of numbers that all swings share and of a few of each swing's own.
//!
//! The own numbers of two swings never meet, so that the matrix is block diagonal but for its border, and solving for all
//! takes time in proportion to the swings: each swing's own numbers are eliminated, the shared ones solved for (Schur
//! complement), and the own ones follow.
//! Source: Å. Björck, Numerical Methods for Least Squares Problems (SIAM 1996), section 6.3.

use super::solve::Factor;
use nalgebra::{DMatrix, DVector};

/// JᵀJ: the shared numbers first, then those of each swing.
#[derive(Clone, Debug)]
pub struct Arrow {
    n_shared: usize,
    n_own: usize,
    /// Shared with shared.
    shared: DMatrix<f64>,
    /// Shared (rows) with own (columns), one a swing.
    borders: Vec<DMatrix<f64>>,
    /// Own with own, one a swing.
    own: Vec<DMatrix<f64>>,
}

impl Arrow {
    /// From JᵀJ of each swing, its own numbers last.
    pub fn new(n_shared: usize, n_own: usize, blocks: &[DMatrix<f64>]) -> Self {
        let part = |block: &DMatrix<f64>, at: (usize, usize), size: (usize, usize)| block.view(at, size).into_owned();
        let (u, p) = (n_shared, n_own);
        let zero = DMatrix::zeros(u, u);
        Self {
            n_shared,
            n_own,
            shared: blocks.iter().fold(zero, |sum, block| sum + block.view((0, 0), (u, u))),
            borders: blocks.iter().map(|block| part(block, (0, u), (u, p))).collect(),
            own: blocks.iter().map(|block| part(block, (u, u), (p, p))).collect(),
        }
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.n_shared + self.n_own * self.own.len()
    }

    /// True without any row.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The square of a column of J.
    pub fn square(&self, j: usize) -> f64 {
        match j.checked_sub(self.n_shared) {
            None => self.shared[(j, j)],
            Some(beyond) => self.own[beyond / self.n_own][(beyond % self.n_own, beyond % self.n_own)],
        }
    }

    /// A column: of a shared number, or of one of a swing's own.
    pub fn column(&self, j: usize) -> DVector<f64> {
        if let Some(beyond) = j.checked_sub(self.n_shared) {
            return self.own_column(beyond / self.n_own, beyond % self.n_own);
        }
        let own = self.borders.iter().flat_map(|border| border.row(j).iter().copied().collect::<Vec<f64>>());
        let all: Vec<f64> = self.shared.column(j).iter().copied().chain(own).collect();
        DVector::from_vec(all)
    }

    fn own_column(&self, swing_idx: usize, own_idx: usize) -> DVector<f64> {
        let mut column = DVector::zeros(self.len());
        column.rows_mut(0, self.n_shared).copy_from(&self.borders[swing_idx].column(own_idx));
        let first = self.n_shared + swing_idx * self.n_own;
        column.rows_mut(first, self.n_own).copy_from(&self.own[swing_idx].column(own_idx));
        column
    }

    /// Adds what is known of the shared numbers from elsewhere.
    pub fn add_shared(&mut self, matrix: &DMatrix<f64>) {
        self.shared += matrix;
    }

    /// xᵀ·JᵀJ·x.
    pub fn quadratic(&self, x: &DVector<f64>) -> f64 {
        let shared = x.rows(0, self.n_shared);
        let mut sum = shared.dot(&(&self.shared * shared));
        for (k, (border, own)) in self.borders.iter().zip(&self.own).enumerate() {
            let x_own = x.rows(self.n_shared + k * self.n_own, self.n_own);
            sum += 2.0 * shared.dot(&(border * x_own)) + x_own.dot(&(own * x_own));
        }
        sum
    }

    /// The whole matrix, zeros and all.
    pub fn dense(&self) -> DMatrix<f64> {
        let mut all = DMatrix::zeros(self.len(), self.len());
        let (u, p) = (self.n_shared, self.n_own);
        all.view_mut((0, 0), (u, u)).copy_from(&self.shared);
        for (k, (border, own)) in self.borders.iter().zip(&self.own).enumerate() {
            let at = u + k * p;
            all.view_mut((0, at), (u, p)).copy_from(border);
            all.view_mut((at, 0), (p, u)).copy_from(&border.transpose());
            all.view_mut((at, at), (p, p)).copy_from(own);
        }
        all
    }
}

/// A factorised arrow with damping, for any number of right-hand sides.
pub struct ArrowFactor<'a> {
    arrow: &'a Arrow,
    own: Vec<Factor>,
    shared: Factor,
}

impl<'a> ArrowFactor<'a> {
    /// Of JᵀJ with damping λ, as [`Factor::new`]; numbers that are not `free` stay put.
    pub fn new(arrow: &'a Arrow, damping: f64, free: impl Fn(usize) -> bool) -> Self {
        let first = |k: usize| arrow.n_shared + k * arrow.n_own;
        let factor = |(k, own): (usize, &DMatrix<f64>)| Factor::new(own, damping, |i| free(first(k) + i));
        let own: Vec<Factor> = arrow.own.iter().enumerate().map(factor).collect();
        let mut left = arrow.shared.clone();
        for (border, own) in arrow.borders.iter().zip(&own) {
            left -= border * own.solve_all(&border.transpose());
        }
        let squares: Vec<f64> = (0..arrow.n_shared).map(|j| arrow.square(j)).collect();
        (0..arrow.n_shared).for_each(|j| left[(j, j)] += damping * squares[j]);
        let shared = Factor::of_squares(&left, &squares, free);
        Self { arrow, own, shared }
    }

    /// The step for a right-hand side Jᵀr; zero where a column has none.
    pub fn solve(&self, gradient: &DVector<f64>) -> DVector<f64> {
        let (u, p) = (self.arrow.n_shared, self.arrow.n_own);
        let alone: Vec<DVector<f64>> =
            self.own.iter().enumerate().map(|(k, own)| own.solve(&gradient.rows(u + k * p, p).into_owned())).collect();
        let mut right = gradient.rows(0, u).into_owned();
        for (border, alone) in self.arrow.borders.iter().zip(&alone) {
            right -= border * alone;
        }
        let shared = self.shared.solve(&right);
        let mut step = DVector::zeros(gradient.len());
        step.rows_mut(0, u).copy_from(&shared);
        for (k, (border, own)) in self.arrow.borders.iter().zip(&self.own).enumerate() {
            let answer = own.solve(&border.tr_mul(&shared));
            step.rows_mut(u + k * p, p).copy_from(&(&alone[k] - answer));
        }
        step
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three swings of 40 samples: two shared numbers, and two of each swing's own.
    fn blocks() -> (Vec<DMatrix<f64>>, DVector<f64>) {
        let jacobian = |k: usize| DMatrix::from_fn(40, 4, |i, j| ((1 + i * (j + 2 + k)) as f64 * 0.37).sin());
        let right = DVector::from_fn(8, |i, _| (i as f64 * 0.7).cos());
        ((0..3).map(|k| jacobian(k).transpose() * jacobian(k)).collect(), right)
    }

    #[test]
    fn steps_are_those_of_the_whole_matrix() {
        let (blocks, right) = blocks();
        let arrow = Arrow::new(2, 2, &blocks);
        for damping in [0.0, 0.3] {
            let mut whole = arrow.dense();
            (0..8).for_each(|j| whole[(j, j)] *= 1.0 + damping);
            let theirs = whole.lu().solve(&right).unwrap();
            let ours = ArrowFactor::new(&arrow, damping, |_| true).solve(&right);
            assert!((&ours - &theirs).amax() < 1e-12 * theirs.amax(), "{ours} {theirs}");
        }
    }

    #[test]
    fn what_is_not_free_stays_where_it_is() {
        let (blocks, right) = blocks();
        let arrow = Arrow::new(2, 2, &blocks);
        let ours = ArrowFactor::new(&arrow, 0.0, |j| j != 1 && j != 4).solve(&right);
        let mut whole = arrow.dense();
        for fixed in [1, 4] {
            whole.column_mut(fixed).fill(0.0);
            whole.row_mut(fixed).fill(0.0);
            whole[(fixed, fixed)] = 1.0;
        }
        let mut right = right;
        (right[1], right[4]) = (0.0, 0.0);
        let theirs = whole.lu().solve(&right).unwrap();
        assert!((&ours - &theirs).amax() < 1e-12 * theirs.amax(), "{ours} {theirs}");
    }

    #[test]
    fn products_are_those_of_the_whole_matrix() {
        let (blocks, x) = blocks();
        let arrow = Arrow::new(2, 2, &blocks);
        let whole = arrow.dense();
        assert!((arrow.quadratic(&x) - x.dot(&(&whole * &x))).abs() < 1e-12);
        assert!((0..8).all(|j| arrow.column(j) == whole.column(j)));
        assert!((0..8).all(|j| arrow.square(j) == whole[(j, j)]));
    }

    #[test]
    fn a_shared_number_that_the_own_ones_can_stand_for_gets_no_step() {
        // The second shared column is the sum of the own ones, as a sensor's zero is of the swings' offsets.
        let jacobian = |k: usize| {
            let own = |i: usize| ((1 + i * (3 + k)) as f64 * 0.37).sin();
            DMatrix::from_fn(40, 3, |i, j| if j == 0 { (i as f64 * 0.11).cos() } else { own(i) })
        };
        let blocks: Vec<DMatrix<f64>> = (0..2).map(|k| jacobian(k).transpose() * jacobian(k)).collect();
        let arrow = Arrow::new(2, 1, &blocks);
        let step = ArrowFactor::new(&arrow, 0.0, |_| true).solve(&DVector::from_vec(vec![1.0, 2.0, 1.0, 1.0]));
        assert_eq!(step[1], 0.0);
        assert!(step.iter().all(|x| x.is_finite()));
    }
}
