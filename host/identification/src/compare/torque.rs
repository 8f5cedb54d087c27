//! Missing torque over the plane of angle and velocity: where in state space does the model lack something, and how
//! much?
//!
//! The windows of [`super::weak`] average over several bins each; which torques at the middles of the bins, parabolas
//! between them, explain the windows best is a linear least-squares problem with the windows' known noise. A
//! smooth torque is preferred: second differences of bins in a row, along the angle and along the velocity on one side
//! of ω = 0, have prior spreads that are chosen by the evidence (D. J. C. MacKay, Neural Comput. 4 (1992) 415).
//! Standard errors are the larger of the posterior's and the scatter between swings.

use super::energy::SIGNIFICANT;
use super::grid::{Grid, HALF_BINS, N_BINS};
use super::weak::Windows;
use nalgebra::{Cholesky, DMatrix, DVector};
use serde::Serialize;

/// Prior spreads of second differences that are tried, as shares of the torque's own prior spread.
const SPREADS: [f64; 6] = [1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3];

/// The torque itself has a prior spread of this many times the size of what the windows show.
const LEVEL: f64 = 5.0;

/// Rounds in which the spreads along both axes and the remaining variance are found.
const ROUNDS: usize = 3;

/// A bin with fewer visits (stretches that pass it) is left blank.
const MIN_VISITS: usize = 2;

/// Fewer visits give no standard error that a claim could rest on.
const VISITS_TO_CLAIM: usize = 5;

/// A torque that is significant is a finding if the map is this much (in nats) more likely than no torque at all …
const EVIDENT: f64 = 10.0;

/// … and explains this share of what is more than noise.
const EXPLAINED: f64 = 0.25;

/// One bin of the map.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bin {
    /// Number in the grid, angle running fastest.
    pub place: usize,
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
        self.bins
            .iter()
            .filter(|bin| bin.is_significant())
            .max_by(|a, b| a.torque_nm.abs().total_cmp(&b.torque_nm.abs()))
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
    let prior = Prior::new(&normal);
    // What a map cannot explain counts as noise too: first found, then used.
    let mut spreads = [SPREADS[2]; 2];
    let mut inflation = 1.0;
    for _ in 0..ROUNDS {
        for axis in 0..2 {
            spreads[axis] = prior.best_spread(&normal, spreads, axis, inflation);
        }
        inflation = Posterior::new(&normal, &prior.precision(spreads), inflation)?.variance_left(&normal).max(1.0);
    }
    let best = Posterior::new(&normal, &prior.precision(spreads), inflation)?;
    let scatter = best.scatter(&normal, stretches);
    let bin = |(k, bin): (usize, &usize)| {
        let (angle_rad, velocity_rad_s) = grid.centre(*bin);
        Bin {
            place: *bin,
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
            self.n_visits[*place] += usize::from(windows.n_samples[i] > 0);
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

/// How smooth a torque is expected to be.
struct Prior {
    /// Second differences along the angle and along the velocity, squared.
    rough: [DMatrix<f64>; 2],
    /// Prior spread of the torque itself, N·m.
    level_nm: f64,
}

impl Prior {
    fn new(normal: &Normal) -> Self {
        let rough = [0, 1].map(|axis| roughness(&normal.bins, axis));
        // The torque that, everywhere alike, would show as much as is seen.
        let level_nm = LEVEL * (normal.square / normal.matrix.trace().max(1e-300)).sqrt();
        Self { rough, level_nm }
    }

    fn precision(&self, spreads: [f64; 2]) -> DMatrix<f64> {
        let size = self.rough[0].nrows();
        let smooth = &self.rough[0] / spreads[0].powi(2) + &self.rough[1] / spreads[1].powi(2);
        (DMatrix::identity(size, size) + smooth) / self.level_nm.powi(2)
    }

    /// The spread along one axis that is most likely while the other stays.
    fn best_spread(&self, normal: &Normal, spreads: [f64; 2], axis: usize, inflation: f64) -> f64 {
        let with = |spread: f64| {
            let mut tried = spreads;
            tried[axis] = spread;
            (spread, evidence(normal, &self.precision(tried), inflation).unwrap_or(f64::NEG_INFINITY))
        };
        let best = SPREADS.into_iter().map(with).max_by(|a, b| a.1.total_cmp(&b.1));
        best.map_or(spreads[axis], |(spread, _)| spread)
    }
}

/// Sum of the squared second differences along an axis (0 angle, 1 velocity), as a matrix. Across ω = 0 friction jumps.
fn roughness(bins: &[usize], axis: usize) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(bins.len(), bins.len());
    let stride = [1, N_BINS][axis];
    let place = |bin: usize| bin / stride % N_BINS;
    for (i, bin) in bins.iter().enumerate() {
        let at = place(*bin);
        let jumps = axis == 1 && (HALF_BINS - 2..HALF_BINS).contains(&at);
        if jumps || at + 2 >= N_BINS {
            continue;
        }
        let others = (bins.binary_search(&(bin + stride)), bins.binary_search(&(bin + 2 * stride)));
        let (Ok(j), Ok(k)) = others else { continue };
        let weights = [(i, 1.0), (j, -2.0), (k, 1.0)];
        for (a, wa) in weights {
            for (b, wb) in weights {
                matrix[(a, b)] += wa * wb;
            }
        }
    }
    matrix
}

/// Logarithm of how much more likely the windows are with a torque of this prior than with none.
fn evidence(normal: &Normal, prior: &DMatrix<f64>, inflation: f64) -> Option<f64> {
    let factor = Cholesky::new(&normal.matrix / inflation + prior)?;
    let right = &normal.right / inflation;
    let gain = right.dot(&factor.solve(&right));
    Some(0.5 * (gain - log_determinant(&factor) + log_determinant(&Cholesky::new(prior.clone())?)))
}

/// The torques for one choice of the prior.
struct Posterior {
    torques: DVector<f64>,
    covariance: DMatrix<f64>,
    inflation: f64,
    evidence: f64,
}

impl Posterior {
    fn new(normal: &Normal, prior: &DMatrix<f64>, inflation: f64) -> Option<Self> {
        let covariance = Cholesky::new(&normal.matrix / inflation + prior)?.inverse();
        let torques = &covariance * &normal.right / inflation;
        Some(Self { torques, covariance, inflation, evidence: evidence(normal, prior, inflation)? })
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
                let shift: f64 =
                    places.iter().zip(score.iter()).map(|(place, s)| self.covariance[(k, *place)] * s).sum();
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
    use crate::random::Noise;

    #[test]
    fn a_parabola_is_met_between_the_bins() {
        let grid = Grid { angle_rad: 1.4, velocity_rad_s: 9.0 };
        let law = |angle: f64, velocity: f64| 0.3 + angle - 2.0 * velocity * velocity.abs() + angle * angle;
        for (angle, velocity) in [(0.1, 0.2), (-1.38, 8.9), (0.7, -0.01), (1.3, -4.4)] {
            let torque_at = |bin: usize| {
                let (angle, velocity) = grid.centre(bin);
                law(angle, velocity)
            };
            let between: f64 =
                grid.neighbours(angle, velocity).iter().map(|(bin, weight)| weight * torque_at(*bin)).sum();
            assert!((between - law(angle, velocity)).abs() < 1e-12, "{angle} {velocity}");
        }
    }

    #[test]
    fn the_middle_of_a_bin_lies_in_it() {
        let grid = Grid { angle_rad: 1.4, velocity_rad_s: 9.0 };
        for bin in 0..N_BINS * N_BINS {
            let (angle_rad, velocity_rad_s) = grid.centre(bin);
            assert_eq!(grid.bin_of(angle_rad, velocity_rad_s), bin);
        }
    }

    const GRID: Grid = Grid { angle_rad: 1.2, velocity_rad_s: 6.0 };

    /// Stretches of twelve windows over three bins that are no neighbours, with unit noise and these torques.
    fn stretches(n_stretches: u64, torques_nm: [f64; 3]) -> Vec<Windows> {
        let stretch = |seed: u64| {
            let mut noise = Noise::new(seed);
            let shares = DMatrix::from_fn(12, 3, |_, _| 1e3 * noise.normal());
            let torques = &shares * DVector::from_row_slice(&torques_nm) + DVector::from_fn(12, |_, _| noise.normal());
            Windows { torques, shares, bins: vec![0, 5, 100], n_samples: vec![7, 0, 9] }
        };
        (0..n_stretches).map(stretch).collect()
    }

    #[test]
    fn what_remains_of_the_windows_is_what_least_squares_leave() {
        let stretches = stretches(2, [1e-3, -2e-3, 5e-4]);
        let normal = Normal::new(&stretches).unwrap();
        let rows = |of: &dyn Fn(&Windows, usize, usize) -> f64, n: usize| {
            DMatrix::from_fn(24, n, |i, j| of(&stretches[i / 12], i % 12, j))
        };
        let (shares, torques) = (rows(&|w, i, j| w.shares[(i, j)], 3), rows(&|w, i, _| w.torques[i], 1));
        let solved = shares.clone().svd(true, true).solve(&torques, 1e-12).unwrap();
        let left = (&torques - &shares * &solved).norm_squared();
        let found = Posterior::new(&normal, &(DMatrix::identity(3, 3) * 1e-6), 1.0).unwrap();
        assert!((&found.torques - solved.column(0)).amax() < 1e-9, "{} {solved}", found.torques);
        assert!((found.square_left(&normal) / left - 1.0).abs() < 1e-6, "{} {left}", found.square_left(&normal));
        // Three torques were fitted to 24 windows.
        assert!((found.variance_left(&normal) / (left / 21.0) - 1.0).abs() < 1e-6);
        assert_eq!((normal.n_windows, normal.n_visits, normal.n_samples), (24, vec![2, 0, 2], vec![14, 0, 18]));
    }

    #[test]
    fn a_torque_in_the_windows_comes_back_and_noise_alone_is_none() {
        let torques_nm = [1e-2, -2e-2, 5e-3];
        let map = torque_map(GRID, &stretches(8, torques_nm), 1e-3).unwrap();
        assert!(map.is_significant && map.explained > 0.95, "{map:?}");
        // The middle bin has no samples.
        assert_eq!(map.bins.iter().map(|bin| (bin.place, bin.n_visits)).collect::<Vec<_>>(), [(0, 8), (100, 8)]);
        for (bin, expected_nm) in map.bins.iter().zip([1e-2, 5e-3]) {
            assert!((bin.torque_nm - expected_nm).abs() < 4.0 * bin.spread_nm, "{bin:?}");
            // 96 windows with shares of 1e3 rms: 1e-3/√96, give or take the scatter between eight stretches.
            assert!((0.5e-4..3e-4).contains(&bin.spread_nm), "{bin:?}");
        }
        let map = torque_map(GRID, &stretches(8, [0.0; 3]), 1e-3).unwrap();
        assert!(!map.is_significant, "{map:?}");
    }

    #[test]
    fn a_field_is_significant_far_beyond_its_error_and_visited_often_enough() {
        let is_significant = |torque_nm: f64, n_visits: usize| {
            let (place, angle_rad, velocity_rad_s, spread_nm, n_samples) = (0, 0.1, 1.0, 1e-4, 50);
            Bin { place, angle_rad, velocity_rad_s, torque_nm, spread_nm, n_visits, n_samples }.is_significant()
        };
        assert!(is_significant(5e-4, 5) && is_significant(-5e-4, 9));
        assert!(!is_significant(5e-4, 4) && !is_significant(4e-4, 9));
    }
}
