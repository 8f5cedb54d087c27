//! The grid of the torque map: bins over angle and velocity, and the parabolas between their middles.

use serde::Serialize;
use std::ops::Range;

/// Bins to either side of the middle, in angle and in velocity.
pub(super) const HALF_BINS: usize = 6;

/// Bins along one axis.
pub const N_BINS: usize = 2 * HALF_BINS;

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

    /// The nine bins around a state with their weights: parabolas through three middles each way, because a drag is one.
    /// ω = 0 is not crossed, where friction jumps.
    pub fn neighbours(&self, angle_rad: f64, velocity_rad_s: f64) -> [(usize, f64); 9] {
        let x = (angle_rad / self.angle_rad + 1.0) * HALF_BINS as f64 - 0.5;
        let y = (velocity_rad_s / self.velocity_rad_s + 1.0) * HALF_BINS as f64 - 0.5;
        let rows = if velocity_rad_s < 0.0 { 0..HALF_BINS } else { HALF_BINS..N_BINS };
        let (left, along_angle) = parabola(x, 0..N_BINS);
        let (lowest, along_velocity) = parabola(y, rows);
        std::array::from_fn(|k| {
            let (column, row) = (k % 3, k / 3);
            ((lowest + row) * N_BINS + left + column, along_velocity[row] * along_angle[column])
        })
    }

    /// Angle (rad) and velocity (rad/s) at the middle of a bin.
    pub fn centre(&self, bin: usize) -> (f64, f64) {
        let middle = |k: usize| (k as f64 + 0.5) / HALF_BINS as f64 - 1.0;
        (middle(bin % N_BINS) * self.angle_rad, middle(bin / N_BINS) * self.velocity_rad_s)
    }
}

/// The first of the three places within a range that are nearest to `x`, and their weights (Lagrange).
fn parabola(x: f64, within: Range<usize>) -> (usize, [f64; 3]) {
    let first = (x.round().max(1.0) as usize - 1).clamp(within.start, within.end - 3);
    let u = x - first as f64;
    (first, [0.5 * (u - 1.0) * (u - 2.0), u * (2.0 - u), 0.5 * u * (u - 1.0)])
}
