//! A clock that goes wrong alike in each release: by how many seconds, one number at each knot of the time since it began,
//! straight lines between them. Where it is s too late, a reading is off by s times the angular velocity.

use super::response::Path;
use super::ridge::roughness;
use super::state_grid::{LEVEL, N_KNOTS, between};
use nalgebra::DMatrix;

/// Knots along the time; of the columns those behind stay empty. Not tuned: as many as a grid has along angle and speed together.
const KNOTS: usize = 14;

/// The columns of a swing that a path follows, at its times: by how much the readings answer each knot.
pub(super) fn readings(path: &Path, times_s: &[f64], longest_s: f64) -> Vec<Vec<f64>> {
    let mut columns = vec![vec![0.0; times_s.len()]; N_KNOTS];
    let began_s = times_s.first().copied().unwrap_or(0.0);
    for (sample, ([_, velocity], time_s)) in path.at_samples().zip(times_s).enumerate() {
        for (knot, weight) in between((time_s - began_s) / longest_s, KNOTS) {
            columns[knot][sample] += weight * velocity;
        }
    }
    columns
}

/// How crooked it is, and how large.
pub(super) fn ridge() -> DMatrix<f64> {
    let knots: Vec<f32> = (0..KNOTS).map(|k| k as f32).collect();
    let mut ridge = LEVEL * DMatrix::identity(N_KNOTS, N_KNOTS);
    let mut corner = ridge.view_mut((0, 0), (KNOTS, KNOTS));
    corner += roughness(&knots);
    ridge
}
