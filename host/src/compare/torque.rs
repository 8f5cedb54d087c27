//! Missing torque over the plane of angle and velocity: where in state space does the model lack something, and how
//! much?
//!
//! The windows of [`super::weak`] average over several bins each; which torque by bin explains them best is a linear
//! least-squares problem with the windows' known noise. A smooth torque is preferred: differences of neighbouring bins
//! on the same side of ω = 0 have a prior spread, chosen by the evidence (D. J. C. MacKay, Neural Comput. 4 (1992) 415).
//! Standard errors are the larger of the posterior's and the scatter between swings.

use super::weak::Windows;
use nalgebra::{Cholesky, DMatrix, DVector};
use serde::Serialize;

/// Bins to either side of the middle, in angle and in velocity.
const HALF_BINS: usize = 6;

/// Bins along one axis.
pub const N_BINS: usize = 2 * HALF_BINS;

/// Prior spreads of neighbours' differences that are tried, as shares of the largest window-by-window signal.
const SPREADS: [f64; 7] = [0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0];

/// The torque itself is held to zero this much more weakly than to its neighbours.
const LEVEL_SHARE: f64 = 0.02;

/// A bin with fewer visits (stretches that pass it) is left blank.
const MIN_VISITS: usize = 2;

/// Fewer visits give no standard error that a claim could rest on.
const VISITS_TO_CLAIM: usize = 5;

/// A torque this many standard errors from zero is a finding …
const SIGNIFICANT: f64 = 4.5;

/// … if the map is this much (in nats) more likely than no torque at all …
const EVIDENT: f64 = 10.0;

/// … and explains this share of what is more than noise.
const EXPLAINED: f64 = 0.25;

/// The grid over the plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Grid {
    /// Angles go from minus this to this, rad.
    pub angle_rad: f64,
    /// Velocities likewise, rad/s.
    pub velocity_rad_s: f64,
}

impl Grid {
    /// The bin of a state; beyond the grid its outermost ones.
    pub fn bin_of(&self, angle_rad: f64, velocity_rad_s: f64) -> usize {
        let place = |share: f64| ((share + 1.0) * HALF_BINS as f64).floor().clamp(0.0, (N_BINS - 1) as f64) as usize;
        place(velocity_rad_s / self.velocity_rad_s) * N_BINS + place(angle_rad / self.angle_rad)
    }

    /// Angle (rad) and velocity (rad/s) at the middle of a bin.
    pub fn centre(&self, bin: usize) -> (f64, f64) {
        let middle = |k: usize| (k as f64 + 0.5) / HALF_BINS as f64 - 1.0;
        (middle(bin % N_BINS) * self.angle_rad, middle(bin / N_BINS) * self.velocity_rad_s)
    }
}

/// One bin of the map.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bin {
    /// θ at its middle, rad.
    pub angle_rad: f64,
    /// ω at its middle, rad/s.
    pub velocity_rad_s: f64,
    /// Torque that the model lacks, N·m, counter-clockwise positive.
    pub torque_nm: f64,
    /// Its standard error, N·m.
    pub spread_nm: f64,
    /// Swings that passed it.
    pub n_visits: usize,
    /// Samples in it.
    pub n_samples: usize,
}

/// Missing torque over the plane.
#[derive(Clone, Debug, Serialize)]
pub struct TorqueMap {
    /// The grid.
    pub grid: Grid,
    /// Bins with data, in the order of the grid, angle running fastest.
    pub bins: Vec<Bin>,
    /// Mc, to compare with, N·m.
    pub coulomb_nm: f64,
    /// How much more likely the map is than no missing torque, in nats.
    pub evidence: f64,
    /// Share of what is more than noise that a torque of angle and velocity explains.
    pub explained: f64,
    /// Is there anything in it beyond chance?
    pub is_significant: bool,
}

impl TorqueMap {
    /// The bin farthest from zero in standard errors, if it is significant.
    pub fn strongest(&self) -> Option<&Bin> {
        self.bins.iter().filter(|bin| bin.is_significant()).max_by(|a, b| a.torque_nm.abs().total_cmp(&b.torque_nm.abs()))
    }

    /// Largest torque of all bins, N·m.
    pub fn largest_nm(&self) -> f64 {
        self.bins.iter().fold(0.0, |largest, bin| largest.max(bin.torque_nm.abs()))
    }
}

impl Bin {
    /// Far beyond its standard error?
    pub fn is_significant(&self) -> bool {
        self.n_visits >= VISITS_TO_CLAIM && self.torque_nm.abs() > SIGNIFICANT * self.spread_nm
    }
}

/// Normal equations of all windows for the bins that have data.
struct Normal {
    /// Bins with data.
    bins: Vec<usize>,
    matrix: DMatrix<f64>,
    right: DVector<f64>,
    square: f64,
    n_windows: usize,
    n_visits: Vec<usize>,
    n_samples: Vec<usize>,
}

/// Finds the torque map from the windows of all stretches; `None` without data.
pub fn torque_map(grid: Grid, stretches: &[Windows], coulomb_nm: f64) -> Option<TorqueMap> {
    let normal = Normal::new(stretches)?;
    let shape = smoothness(&normal.bins);
    let unit = (normal.square / normal.matrix.trace().max(1e-300)).sqrt();
    // What a map cannot explain counts as noise too: first found, then used.
    let mut inflation = 1.0;
    let mut best = None;
    for _ in 0..3 {
        let fits = SPREADS.iter().filter_map(|spread| Posterior::new(&normal, &shape, spread * unit, inflation));
        let chosen = fits.max_by(|a, b| a.evidence.total_cmp(&b.evidence))?;
        inflation = chosen.variance_left(&normal).max(1.0);
        best = Some(chosen);
    }
    let best = best?;
    let scatter = best.scatter(&normal, stretches);
    let bin = |(k, bin): (usize, &usize)| {
        let (angle_rad, velocity_rad_s) = grid.centre(*bin);
        Bin {
            angle_rad,
            velocity_rad_s,
            torque_nm: best.torques[k],
            spread_nm: best.covariance[(k, k)].max(scatter[k]).sqrt(),
            n_visits: normal.n_visits[k],
            n_samples: normal.n_samples[k],
        }
    };
    let bins: Vec<Bin> = normal.bins.iter().enumerate().map(bin).filter(|bin| bin.n_visits >= MIN_VISITS).collect();
    let excess = normal.square / normal.n_windows as f64 - 1.0;
    let unexplained = best.variance_left(&normal) - 1.0;
    let explained = if excess > 0.0 { (1.0 - unexplained / excess).clamp(0.0, 1.0) } else { 0.0 };
    let evident = best.evidence > EVIDENT && explained > EXPLAINED;
    let is_significant = evident && bins.iter().any(Bin::is_significant);
    Some(TorqueMap { grid, bins, coulomb_nm, evidence: best.evidence, explained, is_significant })
}

impl Normal {
    fn new(stretches: &[Windows]) -> Option<Self> {
        let mut bins: Vec<usize> = stretches.iter().flat_map(|windows| windows.bins.iter().copied()).collect();
        bins.sort_unstable();
        bins.dedup();
        let size = bins.len();
        let mut normal = Self {
            matrix: DMatrix::zeros(size, size),
            right: DVector::zeros(size),
            square: 0.0,
            n_windows: 0,
            n_visits: vec![0; size],
            n_samples: vec![0; size],
            bins,
        };
        stretches.iter().for_each(|windows| normal.add(windows));
        (normal.n_windows > 0).then_some(normal)
    }

    fn add(&mut self, windows: &Windows) {
        let places = self.places(windows);
        let product = windows.shares.transpose() * &windows.shares;
        let right = windows.shares.transpose() * &windows.torques;
        for (i, place) in places.iter().enumerate() {
            self.right[*place] += right[i];
            self.n_visits[*place] += 1;
            self.n_samples[*place] += windows.n_samples[i];
            for (j, other) in places.iter().enumerate() {
                self.matrix[(*place, *other)] += product[(i, j)];
            }
        }
        self.square += windows.torques.norm_squared();
        self.n_windows += windows.torques.len();
    }

    fn places(&self, windows: &Windows) -> Vec<usize> {
        windows.bins.iter().filter_map(|bin| self.bins.binary_search(bin).ok()).collect()
    }
}

/// Precision of a smooth torque: neighbours along the angle and along the velocity are alike, except across ω = 0.
fn smoothness(bins: &[usize]) -> DMatrix<f64> {
    let size = bins.len();
    let mut matrix = DMatrix::identity(size, size) * LEVEL_SHARE;
    let mut join = |i: usize, j: usize| {
        matrix[(i, i)] += 1.0;
        matrix[(j, j)] += 1.0;
        matrix[(i, j)] -= 1.0;
        matrix[(j, i)] -= 1.0;
    };
    for (i, bin) in bins.iter().enumerate() {
        let beside = (bin % N_BINS + 1 < N_BINS).then_some(bin + 1);
        let above = (bin / N_BINS + 1 != HALF_BINS).then_some(bin + N_BINS);
        for neighbour in [beside, above].into_iter().flatten() {
            if let Ok(j) = bins.binary_search(&neighbour) {
                join(i, j);
            }
        }
    }
    matrix
}

/// The torques for one choice of the prior's spread.
struct Posterior {
    torques: DVector<f64>,
    covariance: DMatrix<f64>,
    inflation: f64,
    evidence: f64,
}

impl Posterior {
    fn new(normal: &Normal, shape: &DMatrix<f64>, spread: f64, inflation: f64) -> Option<Self> {
        let prior = shape / spread.powi(2);
        let factor = Cholesky::new(&normal.matrix / inflation + &prior)?;
        let right = &normal.right / inflation;
        let torques = factor.solve(&right);
        let evidence = 0.5 * (right.dot(&torques) - log_determinant(&factor) + log_determinant(&Cholesky::new(prior)?));
        Some(Self { covariance: factor.inverse(), torques, inflation, evidence })
    }

    /// Variance of the whitened windows that remains, a unit for pure noise; what the map itself used up is counted.
    fn variance_left(&self, normal: &Normal) -> f64 {
        let used = (&normal.matrix * &self.covariance).trace() / self.inflation;
        self.square_left(normal) / (normal.n_windows as f64 - used).max(1.0)
    }

    /// Sum of squares of the whitened windows that remains.
    fn square_left(&self, normal: &Normal) -> f64 {
        let fitted = &normal.matrix * &self.torques;
        normal.square - 2.0 * self.torques.dot(&normal.right) + self.torques.dot(&fitted)
    }

    /// Variances of the torques from the scatter between stretches, N²·m².
    fn scatter(&self, normal: &Normal, stretches: &[Windows]) -> Vec<f64> {
        let mut variances = vec![0.0; self.torques.len()];
        for windows in stretches {
            let places = normal.places(windows);
            let here = DVector::from_iterator(places.len(), places.iter().map(|place| self.torques[*place]));
            let score = windows.shares.transpose() * (&windows.torques - &windows.shares * here) / self.inflation;
            for (k, variance) in variances.iter_mut().enumerate() {
                let shift: f64 = places.iter().zip(score.iter()).map(|(place, s)| self.covariance[(k, *place)] * s).sum();
                *variance += shift * shift;
            }
        }
        variances
    }
}

/// Logarithm of a determinant.
fn log_determinant(factor: &Cholesky<f64, nalgebra::Dyn>) -> f64 {
    2.0 * factor.l_dirty().diagonal().iter().map(|d| d.ln()).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_a_bin_lies_in_it() {
        let grid = Grid { angle_rad: 1.4, velocity_rad_s: 9.0 };
        for bin in 0..N_BINS * N_BINS {
            let (angle_rad, velocity_rad_s) = grid.centre(bin);
            assert_eq!(grid.bin_of(angle_rad, velocity_rad_s), bin);
        }
    }
}
