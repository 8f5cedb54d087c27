//! Does an effect hold on every part of the swings? The windowed, cluster-robust score test.
//!
//! A recording is cut into windows, each with a start of its own, so that what a wrong model has gathered in one is
//! not held against the next. In every window residuals r and derivatives Z of the reading are gathered into normal
//! equations ([`Normal`]); the window's own numbers (start angle, start velocity, zero) are eliminated from them. What
//! is left of each window is one cluster: within it residuals may be correlated in any way, which after a
//! missing effect they are. With A = Σ Zₖᵀ Zₖ and β = A⁻¹ Σ Zₖᵀ rₖ, one step from the fitted model towards one with the
//! added effect, the scores after the step sₖ = Zₖᵀ (rₖ − Zₖ β) spread as V = K/(K−1)·A⁻¹ (Σ sₖ sₖᵀ) A⁻¹, and the
//! numbers of the added effect are tested by F = βᵀ V⁻¹ β·(K−q)/(q·(K−1)), which is F(q, K−q) distributed where the
//! effect is absent.
//! Source: A. C. Cameron, D. L. Miller, J. Human Resources 50 (2015) 317, sections II.C and VI; the transformation to
//! F as for Hotelling's T².

use crate::real::{Mask, Real};

/// Normal equations of the residuals in a window, over at most `N` columns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Normal<R, const N: usize> {
    /// ZᵀZ, symmetric.
    pub matrix: [[R; N]; N],
    /// Zᵀr.
    pub gradient: [R; N],
}

/// The numbers that were tested, and whether they hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Score<R, const N: usize> {
    /// One step from the model towards one with the added numbers; the added ones stand last.
    pub step: [R; N],
    /// Their covariance, from how the clusters scatter.
    pub covariance: [[R; N]; N],
    /// Large where the added numbers are not zero; F(q, K−q) distributed where they are.
    pub f: R,
    /// K, how many clusters there were.
    pub n_clusters: usize,
    /// q, how many numbers were tested: the added columns that change the reading at all.
    pub n_tested: usize,
}

impl<R: Real, const N: usize> Default for Normal<R, N> {
    fn default() -> Self {
        Self { matrix: [[R::zero(); N]; N], gradient: [R::zero(); N] }
    }
}

impl<R: Real, const N: usize> Normal<R, N> {
    /// Takes in one reading: measured minus predicted, and the derivatives of the prediction.
    #[inline]
    pub fn add_reading(&mut self, residual: R, derivatives: &[R; N]) {
        for i in 0..N {
            self.gradient[i] = self.gradient[i] + derivatives[i] * residual;
            for j in 0..=i {
                self.matrix[i][j] = self.matrix[i][j] + derivatives[i] * derivatives[j];
                self.matrix[j][i] = self.matrix[i][j];
            }
        }
    }

    /// Takes in all readings of another window; the two are one cluster then.
    pub fn add(&mut self, other: &Self) {
        for i in 0..N {
            self.gradient[i] = self.gradient[i] + other.gradient[i];
            for j in 0..N {
                self.matrix[i][j] = self.matrix[i][j] + other.matrix[i][j];
            }
        }
    }

    /// Lets the first `n_own` columns answer freely: what is left of the others is what these can't explain. Columns
    /// that are no different from those before them are left out.
    pub fn eliminate(&mut self, n_own: usize) {
        for pivot in 0..n_own {
            let weight = self.matrix[pivot][pivot];
            let row = self.matrix[pivot];
            let counts = R::zero().lt(weight);
            let inverse = R::select(counts, R::one() / weight, R::zero());
            for i in 0..N {
                let share = row[i] * inverse;
                if i == pivot {
                    continue;
                }
                self.gradient[i] = self.gradient[i] - share * self.gradient[pivot];
                for j in 0..N {
                    self.matrix[i][j] = self.matrix[i][j] - share * row[j];
                }
            }
            self.gradient[pivot] = R::zero();
            (0..N).for_each(|i| (self.matrix[pivot][i], self.matrix[i][pivot]) = (R::zero(), R::zero()));
        }
    }
}

/// Tests the last `n_added` of the columns from `n_own` on, over clusters whose first `n_own` columns are eliminated.
/// `None` where there are too few clusters, or the columns can't be told apart.
pub fn score<'a, R: Real, const N: usize>(
    clusters: impl Iterator<Item = &'a Normal<R, N>> + Clone,
    n_own: usize,
    n_added: usize,
) -> Option<Score<R, N>> {
    let found = score_of_few(clusters, n_own, n_added)?;
    (found.n_clusters >= found.n_tested + MIN_SPARE_CLUSTERS).then_some(found)
}

/// The same of as few clusters as can be, for what was found on more of them already.
pub fn score_of_few<'a, R: Real, const N: usize>(
    clusters: impl Iterator<Item = &'a Normal<R, N>> + Clone,
    n_own: usize,
    n_added: usize,
) -> Option<Score<R, N>> {
    let n_clusters = clusters.clone().count();
    let mut all = Normal::default();
    clusters.clone().for_each(|cluster| all.add(cluster));
    let n_tested = (N - n_added..N).filter(|i| changes(&all.matrix, *i)).count();
    if n_tested == 0 || n_clusters <= n_tested {
        return None;
    }
    let inverse = inverted(&all.matrix, n_own, N)?;
    let step = times(&inverse, &all.gradient);

    let count = R::of(n_clusters as f64);
    let correction = count / (count - R::one());
    let mut covariance = [[R::zero(); N]; N];
    for cluster in clusters {
        let explained = times(&cluster.matrix, &step);
        let left = core::array::from_fn(|i| cluster.gradient[i] - explained[i]);
        let moved = times(&inverse, &left);
        for i in 0..N {
            for j in 0..N {
                covariance[i][j] = covariance[i][j] + correction * moved[i] * moved[j];
            }
        }
    }
    let precision = inverted(&covariance, N - n_added, N)?;
    let weighted = times(&precision, &step);
    let quadratic = (N - n_added..N).fold(R::zero(), |sum, i| sum + step[i] * weighted[i]);
    let q = R::of(n_tested as f64);
    let f = quadratic * (count - q) / (q * (count - R::one()));
    Some(Score { step, covariance, f, n_clusters, n_tested })
}

/// K − q must be at least this: with fewer the spread of the clusters is itself not known.
pub const MIN_SPARE_CLUSTERS: usize = 6;

/// A pivot that falls below this share of its column is rounding: the column depends on those before it.
const DEPENDENT: f64 = 1e-9;

fn times<R: Real, const N: usize>(matrix: &[[R; N]; N], vector: &[R; N]) -> [R; N] {
    core::array::from_fn(|i| (0..N).fold(R::zero(), |sum, j| sum + matrix[i][j] * vector[j]))
}

/// Does a column change the reading at all?
fn changes<R: Real, const N: usize>(matrix: &[[R; N]; N], column: usize) -> bool {
    R::zero().lt(matrix[column][column]).any()
}

/// The inverse of the symmetric, positive definite block from `from` to `to` but for columns that change nothing; zero
/// elsewhere. `None` if a column depends on the others. By Gauss–Jordan steps on
/// the matrix scaled to a diagonal of one, so that units do not matter.
pub(crate) fn inverted<R: Real, const N: usize>(matrix: &[[R; N]; N], from: usize, to: usize) -> Option<[[R; N]; N]> {
    let mut inverse = [[R::zero(); N]; N];
    invert(matrix, from, to, &mut inverse).then_some(inverse)
}

/// The same where there is a place for it already; true if there is an inverse.
#[inline(never)]
pub(crate) fn invert<R: Real, const N: usize>(
    matrix: &[[R; N]; N],
    from: usize,
    to: usize,
    inverse: &mut [[R; N]; N],
) -> bool {
    let live = |i: &usize| changes(matrix, *i);
    let scale: [R; N] = core::array::from_fn(|i| if live(&i) { R::one() / matrix[i][i].sqrt() } else { R::zero() });
    let mut rest: [[R; N]; N] = core::array::from_fn(|i| core::array::from_fn(|j| matrix[i][j] * scale[i] * scale[j]));
    inverse.as_flattened_mut().fill(R::zero());
    (from..to).filter(live).for_each(|i| inverse[i][i] = R::one());
    for pivot in (from..to).filter(live) {
        let weight = rest[pivot][pivot];
        if !R::of(DEPENDENT).lt(weight).all() {
            return false;
        }
        for j in from..to {
            rest[pivot][j] = rest[pivot][j] / weight;
            inverse[pivot][j] = inverse[pivot][j] / weight;
        }
        for i in (from..to).filter(|i| *i != pivot) {
            let share = rest[i][pivot];
            for j in from..to {
                rest[i][j] = rest[i][j] - share * rest[pivot][j];
                inverse[i][j] = inverse[i][j] - share * inverse[pivot][j];
            }
        }
    }
    for i in from..to {
        (from..to).for_each(|j| inverse[i][j] = inverse[i][j] * scale[i] * scale[j]);
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    /// Pseudo-random numbers of mean zero and variance one, nearly normal: the sum of twelve even ones.
    struct Chance(u64);

    impl Chance {
        fn even(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        }
        fn normal(&mut self) -> f64 {
            (0..12).map(|_| self.even()).sum::<f64>() - 6.0
        }
    }

    /// Windows of readings with an own level, one base column, one added column of this true size, and residuals that
    /// are the same throughout a window but for a little noise: as coherent as a missing effect's.
    fn windows(chance: &mut Chance, n_windows: usize, size: f64) -> Vec<Normal<f64, 3>> {
        let window = |_| {
            let (bend, level) = (chance.normal(), chance.normal());
            let mut normal = Normal::default();
            for i in 0..40 {
                let t = f64::from(i) / 40.0;
                let columns = [1.0, t, libm::cos(6.0 * t)];
                let noise = 0.1 * chance.normal();
                normal.add_reading(level + 0.3 * t + size * columns[2] + bend * libm::sin(9.0 * t) + noise, &columns);
            }
            normal.eliminate(1);
            normal
        };
        (0..n_windows).map(window).collect()
    }

    #[test]
    fn with_one_number_it_is_students_test_of_the_windows_own_estimates() {
        let estimates = [0.9, 1.4, 0.2, 1.1, 0.7, 1.3, 0.8, 1.6];
        let clusters = estimates.map(|estimate| Normal { matrix: [[2.0]], gradient: [2.0 * estimate] });
        let score = score(clusters.iter(), 0, 1).unwrap();
        let mean = estimates.iter().sum::<f64>() / 8.0;
        let variance = estimates.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / 7.0;
        assert!((score.step[0] - mean).abs() < 1e-12);
        assert!((score.covariance[0][0] - variance / 8.0).abs() < 1e-12);
        assert!((score.f - mean * mean / (variance / 8.0)).abs() < 1e-9);
    }

    #[test]
    fn an_absent_effect_is_accused_as_seldom_as_f_says_however_coherent_the_residuals() {
        let mut chance = Chance(7);
        // The upper 5 % and 1 % of F(1, 11).
        let runs = 4000;
        let mut beyond = [0, 0];
        for _ in 0..runs {
            let f = score(windows(&mut chance, 12, 0.0).iter(), 1, 1).unwrap().f;
            beyond[0] += i32::from(f > 4.844);
            beyond[1] += i32::from(f > 9.646);
        }
        let shares = beyond.map(|n| f64::from(n) / f64::from(runs));
        assert!((0.035..0.065).contains(&shares[0]) && (0.004..0.016).contains(&shares[1]), "{shares:?}");
    }

    #[test]
    fn a_true_effect_is_found_with_its_size_and_the_base_column_is_allowed_for() {
        let mut chance = Chance(3);
        let score = score(windows(&mut chance, 16, 1.5).iter(), 1, 1).unwrap();
        let std = score.covariance[2][2].sqrt();
        assert!((score.step[2] - 1.5).abs() < 3.0 * std && std < 0.3, "{} ± {std}", score.step[2]);
        assert!(score.f > 30.0, "{}", score.f);
    }

    #[test]
    fn too_few_windows_and_columns_that_are_one_give_no_score() {
        let mut chance = Chance(5);
        assert!(score(windows(&mut chance, 6, 1.0).iter(), 1, 1).is_none());
        let mut twice = Normal::<f64, 2>::default();
        (0..20).for_each(|i| twice.add_reading(f64::from(i), &[f64::from(i), 2.0 * f64::from(i)]));
        assert!(score([twice; 9].iter(), 0, 1).is_none());
    }

    #[test]
    fn own_columns_take_what_they_can() {
        let mut normal = Normal::<f64, 2>::default();
        [1.0, 2.0, 3.0].iter().for_each(|x| normal.add_reading(5.0 + 2.0 * x, &[1.0, *x]));
        normal.eliminate(1);
        assert!((normal.gradient[1] / normal.matrix[1][1] - 2.0).abs() < 1e-12);
        assert_eq!(normal.matrix[0], [0.0; 2]);
    }
}
