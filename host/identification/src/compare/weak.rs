//! The equation of motion in weak form: torque that the model lacks, averaged over short windows, without any
//! derivative of the data.
//!
//! Beside a model that was started anew the measured angle is θ + r, and J·r″ + Mw·r′ + m·g·l·(sin(θ + r) − sin θ) is
//! the missing torque. Multiplied by a bump φ = (1 − x²)³ and integrated by parts, the derivatives stand on φ:
//! ∫φ·τ = J·∫φ″r − Mw·∫φ′r + m·g·l·∫φ·(sin(θ + r) − sin θ). The start that was fitted does not matter: a wrong one
//! leaves an r that satisfies the equation without any torque. The torque is looked for at the measured state, θ + r
//! and ω + r′; between the model's turn and the measured one, dry friction has changed sides in only one of them. First
//! order in r for effects beyond the base model.
//! Weak forms for finding equations: D. A. Messenger, D. M. Bortz, Multiscale Model. Simul. 19 (2021) 1474.

use super::grid::Grid;
use super::restart::Restart;
use crate::verdict::NO_CHANCE_STDS;
use nalgebra::{DMatrix, DVector};
use shared::motion::Pendulum;
use std::f64::consts::SQRT_2;
use std::ops::Range;

/// Half width of a window in half swings: a pendulum's torque changes little meanwhile.
pub const HALF_WIDTH: f64 = 0.2;

/// At least so many samples to either side of a window's centre.
const MIN_BESIDE: f64 = 4.0;

/// Windows follow each other by this share of their half width.
const STRIDE: f64 = 0.5;

/// Added to the diagonal of the noise covariance, as a share: rounding must not make it indefinite.
const RIDGE: f64 = 1e-6;

/// Windows of one stretch, already divided by the square root of their noise covariance.
#[derive(Clone, Debug)]
pub struct Windows {
    /// Missing torque by window, whitened to unit variance.
    pub torques: DVector<f64>,
    /// Share of each bin in each window, whitened likewise; a column for each of `bins`.
    pub shares: DMatrix<f64>,
    /// The bins that these windows touch.
    pub bins: Vec<usize>,
    /// Samples by touched bin.
    pub n_samples: Vec<usize>,
}

/// Half width of the windows, s.
pub fn half_width_s(half_swing_s: f64, step_s: f64) -> f64 {
    (HALF_WIDTH * half_swing_s).max(MIN_BESIDE * step_s)
}

/// The base model that the restarts ran with.
#[derive(Clone, Copy, Debug)]
pub struct Base {
    /// Mass, length, inertia.
    pub pendulum: Pendulum<f64>,
    /// Mw, N·m·s/rad.
    pub viscous: f64,
    /// Mc, N·m.
    pub coulomb_nm: f64,
}

/// A sample of the pendulum as measured.
struct Measured {
    angle_rad: f64,
    velocity_rad_s: f64,
    /// Torque of dry friction in the model less that in the measurement, N·m.
    dry_nm: f64,
}

/// One window before whitening: its torque is Σ weights·r, and what dry friction adds.
struct Window {
    range: Range<usize>,
    weights: Vec<f64>,
    /// φ·Δt over its sum.
    bump: Vec<f64>,
}

/// The windows of a stretch, for torques at the middles of a grid's bins. `None` when there are too few samples.
pub fn windows(
    times_s: &[f64],
    restart: &Restart,
    base: &Base,
    noise_rad: f64,
    width_s: f64,
    grid: &Grid,
) -> Option<Windows> {
    let times_s = &times_s[restart.range.clone()];
    let (first_s, last_s) = (*times_s.first()?, *times_s.last()?);
    let n_windows = ((last_s - first_s - 2.0 * width_s) / (STRIDE * width_s)).floor() as i64 + 1;
    let centre_s = |k: i64| first_s + width_s * (1.0 + STRIDE * k as f64);
    let windows: Vec<Window> =
        (0..n_windows).filter_map(|k| window(times_s, restart, base, centre_s(k), width_s)).collect();
    if windows.is_empty() {
        return None;
    }
    let states = measured(times_s, restart, base.coulomb_nm, noise_rad, width_s);
    let near: Vec<[(usize, f64); 9]> =
        states.iter().map(|state| grid.neighbours(state.angle_rad, state.velocity_rad_s)).collect();
    let mut bins: Vec<usize> = near.iter().flatten().map(|(bin, _)| *bin).collect();
    bins.sort_unstable();
    bins.dedup();
    let mut n_samples = vec![0; bins.len()];
    for state in &states {
        // The bin of a sample is one of its neighbours, so it is there.
        n_samples[bins.binary_search(&grid.bin_of(state.angle_rad, state.velocity_rad_s)).unwrap_or(0)] += 1;
    }
    let torques =
        DVector::from_iterator(windows.len(), windows.iter().map(|w| w.torque(&restart.residuals_rad, &states)));
    let mut shares = DMatrix::zeros(windows.len(), bins.len());
    for (row, window) in windows.iter().enumerate() {
        for (i, share) in window.range.clone().zip(&window.bump) {
            for (bin, weight) in near[i] {
                shares[(row, bins.binary_search(&bin).unwrap_or(0))] += share * weight;
            }
        }
    }
    let root = covariance(&windows, noise_rad).cholesky()?;
    let torques = root.l().solve_lower_triangular(&torques)?;
    let shares = root.l().solve_lower_triangular(&shares)?;
    Some(Windows { torques, shares, bins, n_samples })
}

/// The pendulum at each sample: the model's state, and what the measurement deviates from it. A missing torque drives the
/// deviation beyond the width of a bin within one swing. Its slope is that of a chord as long as half a window, or shorter
/// at the ends.
fn measured(times_s: &[f64], restart: &Restart, coulomb_nm: f64, noise_rad: f64, width_s: f64) -> Vec<Measured> {
    let residuals_rad = &restart.residuals_rad;
    let state = |i: usize| {
        let from = times_s.partition_point(|t| *t < times_s[i] - 0.5 * width_s);
        let to = times_s.partition_point(|t| *t <= times_s[i] + 0.5 * width_s) - 1;
        let (length_s, rise) = (times_s[to] - times_s[from], residuals_rad[to] - residuals_rad[from]);
        let modelled = restart.velocities_rad_s[i];
        let velocity_rad_s = modelled + if length_s > 0.0 { rise / length_s } else { 0.0 };
        // What may be chance shifts no turn.
        let is_sure = rise.abs() > NO_CHANCE_STDS * SQRT_2 * noise_rad;
        let turned = if is_sure { velocity_rad_s.signum() - modelled.signum() } else { 0.0 };
        Measured { angle_rad: restart.angles_rad[i] + residuals_rad[i], velocity_rad_s, dry_nm: coulomb_nm * turned }
    };
    (0..times_s.len()).map(state).collect()
}

impl Window {
    fn torque(&self, residuals_rad: &[f64], states: &[Measured]) -> f64 {
        let terms = self.range.clone().zip(self.weights.iter().zip(&self.bump));
        terms.map(|(i, (weight, share))| weight * residuals_rad[i] + share * states[i].dry_nm).sum()
    }

    /// Product of the weights where two windows overlap.
    fn overlap(&self, other: &Self) -> f64 {
        let from = self.range.start.max(other.range.start);
        let to = self.range.end.min(other.range.end);
        (from..to).map(|i| self.weights[i - self.range.start] * other.weights[i - other.range.start]).sum()
    }
}

fn covariance(windows: &[Window], noise_rad: f64) -> DMatrix<f64> {
    let n = windows.len();
    let mut matrix = DMatrix::zeros(n, n);
    for i in 0..n {
        for j in (0..=i).rev().take_while(|j| windows[*j].range.end > windows[i].range.start) {
            let product = noise_rad.powi(2) * windows[i].overlap(&windows[j]);
            (matrix[(i, j)], matrix[(j, i)]) = (product, product);
        }
        matrix[(i, i)] *= 1.0 + RIDGE;
    }
    matrix
}

fn window(times_s: &[f64], restart: &Restart, base: &Base, centre_s: f64, width_s: f64) -> Option<Window> {
    let range =
        times_s.partition_point(|t| *t <= centre_s - width_s)..times_s.partition_point(|t| *t < centre_s + width_s);
    if range.len() < 5 {
        return None;
    }
    let x: Vec<f64> = times_s[range.clone()].iter().map(|t| (t - centre_s) / width_s).collect();
    // Trapezoids; the bump is zero at the ends.
    let step = |i: usize| {
        let before = if i == 0 { -1.0 } else { x[i - 1] };
        let after = if i + 1 == x.len() { 1.0 } else { x[i + 1] };
        0.5 * (after - before)
    };
    let steps: Vec<f64> = (0..x.len()).map(step).collect();
    let bump: Vec<f64> = x.iter().zip(&steps).map(|(x, step)| (1.0 - x * x).powi(3) * step).collect();
    let slope = x.iter().zip(&steps).map(|(x, step)| -6.0 * x * (1.0 - x * x).powi(2) * step / width_s);
    let area: f64 = bump.iter().sum();
    let curve = curvature_weights(&x, &steps, area)?;
    let (inertia, gravity) = (base.pendulum.pivot_inertia_kg_m2(), base.pendulum.gravity_torque_nm());
    let weights = curve
        .iter()
        .zip(slope)
        .zip(&bump)
        .zip(range.clone())
        .map(|(((curve, slope), bump), i)| {
            let (angle, residual) = (restart.angles_rad[i], restart.residuals_rad[i]);
            // (sin(θ + r) − sin θ)/r, which is smooth where r is zero.
            let stiffness = gravity * (angle + 0.5 * residual).cos() * sinc(0.5 * residual);
            (inertia * curve / width_s.powi(2) - base.viscous * slope + stiffness * bump) / area
        })
        .collect();
    let bump = bump.iter().map(|b| b / area).collect();
    Some(Window { range, weights, bump })
}

fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-4 { 1.0 } else { x.sin() / x }
}

/// Weights of φ″ that give exactly nothing for a constant and a line, and the bump's area for x²/2, however few the
/// samples are.
fn curvature_weights(x: &[f64], steps: &[f64], area: f64) -> Option<Vec<f64>> {
    let raw: Vec<f64> =
        x.iter().zip(steps).map(|(x, step)| -6.0 * (1.0 - x * x) * (1.0 - 5.0 * x * x) * step).collect();
    let moment = |power: i32| steps.iter().zip(x).map(|(step, x)| step * x.powi(power)).sum::<f64>();
    let (s0, s1, s2) = (moment(0), moment(1), moment(2));
    let (r0, r1) = raw.iter().zip(x).fold((0.0, 0.0), |(r0, r1), (raw, x)| (r0 + raw, r1 + raw * x));
    let determinant = s0 * s2 - s1 * s1;
    let (a, b) = ((r0 * s2 - r1 * s1) / determinant, (r1 * s0 - r0 * s1) / determinant);
    let level: Vec<f64> = raw.iter().zip(x).zip(steps).map(|((raw, x), step)| raw - (a + b * x) * step).collect();
    let half_square: f64 = level.iter().zip(x).map(|(weight, x)| 0.5 * weight * x * x).sum();
    let factor = area / half_square;
    factor.is_finite().then(|| level.iter().map(|weight| weight * factor).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    const PENDULUM: Pendulum<f64> =
        Pendulum { mass_kg: 0.15, length_m: 0.16, inertia_kg_m2: 2.7e-3, gravity_m_s2: 9.81 };
    const BASE: Base = Base { pendulum: PENDULUM, viscous: 5e-4, coulomb_nm: 0.0 };

    #[test]
    fn the_torque_that_made_a_deviation_comes_back() {
        let times_s: Vec<f64> = (0..60).map(|i| f64::from(i) * 0.01 + 0.002 * f64::from(i % 2)).collect();
        // Around θ = 0: r = sin(5t)/1000 needs J·r″ + Mw·r′ + mgl·r.
        let residuals_rad: Vec<f64> = times_s.iter().map(|t| 1e-3 * (5.0 * t).sin()).collect();
        let zeros = vec![0.0; 60];
        let restart = Restart {
            range: 0..60,
            angles_rad: zeros.clone(),
            velocities_rad_s: zeros,
            residuals_rad: residuals_rad.clone(),
            ahead_rad: Vec::new(),
        };
        let found = window(&times_s, &restart, &BASE, 0.3, 0.1).unwrap();
        let torque = |t: f64| {
            let (r, slope, curve) = (1e-3 * (5.0 * t).sin(), 5e-3 * (5.0 * t).cos(), -25e-3 * (5.0 * t).sin());
            PENDULUM.pivot_inertia_kg_m2() * curve + 5e-4 * slope + PENDULUM.gravity_torque_nm() * r.sin()
        };
        let expected: f64 = found.range.clone().zip(&found.bump).map(|(i, share)| share * torque(times_s[i])).sum();
        let states = measured(&times_s, &restart, BASE.coulomb_nm, 0.0, 0.1);
        let error = found.torque(&residuals_rad, &states) - expected;
        assert!(error.abs() < 2e-3 * expected.abs(), "{error:e} of {expected:e}");
    }

    /// A restart of 60 samples that stays at an angle, with a deviation that stays too.
    fn resting(angle_rad: f64, residual_rad: f64) -> (Vec<f64>, Restart) {
        let restart = Restart {
            range: 0..60,
            angles_rad: vec![angle_rad; 60],
            velocities_rad_s: vec![0.0; 60],
            residuals_rad: vec![residual_rad; 60],
            ahead_rad: Vec::new(),
        };
        ((0..60).map(|i| f64::from(i) * 0.01).collect(), restart)
    }

    #[test]
    fn a_pendulum_that_hangs_askew_needs_the_torque_of_gravity_that_holds_it() {
        let (times_s, restart) = resting(0.5, 0.3);
        let base = Base { viscous: 0.0, ..BASE };
        let found = window(&times_s, &restart, &base, 0.3, 0.1).unwrap();
        let states = measured(&times_s, &restart, 0.0, 1e-5, 0.1);
        let expected = PENDULUM.gravity_torque_nm() * (0.8_f64.sin() - 0.5_f64.sin());
        let torque = found.torque(&restart.residuals_rad, &states);
        assert!((torque / expected - 1.0).abs() < 1e-9, "{torque} {expected}");
    }

    #[test]
    fn a_torque_alike_everywhere_is_that_of_all_bins_together() {
        let (times_s, restart) = resting(0.0, 1e-3);
        let (base, grid) = (Base { viscous: 0.0, ..BASE }, Grid { angle_rad: 0.1, velocity_rad_s: 1.0 });
        let found = windows(&times_s, &restart, &base, 1e-5, 0.1, &grid).unwrap();
        // Half a width from one to the next, from 0.1 s to at most 0.49 s.
        assert_eq!((found.torques.len(), found.shares.nrows()), (8, 8));
        assert_eq!(found.n_samples.iter().sum::<usize>(), 60);
        let expected = PENDULUM.gravity_torque_nm() * 1e-3_f64.sin() * found.shares.column_sum();
        assert!((&found.torques - &expected).amax() < 1e-6 * expected.amax(), "{} {expected}", found.torques);
    }

    #[test]
    fn windows_vary_together_by_the_samples_they_share() {
        let window = |from: usize, weights: &[f64]| Window {
            range: from..from + weights.len(),
            weights: weights.to_vec(),
            bump: vec![0.0; weights.len()],
        };
        let windows = [window(0, &[1.0, 2.0, 3.0]), window(2, &[4.0, 5.0]), window(4, &[6.0])];
        let rows = [[1.0, 2.0, 3.0, 0.0, 0.0], [0.0, 0.0, 4.0, 5.0, 0.0], [0.0, 0.0, 0.0, 0.0, 6.0]];
        let weights = DMatrix::from_fn(3, 5, |i, j| rows[i][j]);
        let mut expected: DMatrix<f64> = 0.01 * &weights * weights.transpose();
        (0..3).for_each(|i| expected[(i, i)] *= 1.000_001);
        assert!((covariance(&windows, 0.1) - expected).amax() < 1e-12);
    }
}
