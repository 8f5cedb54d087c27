//! A free function of angle and velocity: one number at each knot of a coarse grid, straight lines between them.

use super::response::Path;
use super::ridge::roughness;
use nalgebra::DMatrix;

/// Knots along the angle and, for each direction of motion, along the speed. Measured on 150 simulated rigs: with 5 × 3
/// a detent was seen as a law in 2 of 6 rigs, with 9 × 5 in 5, and with 13 × 5 in 4 or 5, in half as much time again.
const ANGLE_KNOTS: usize = 9;
const SPEED_KNOTS: usize = 5;
/// All of them.
pub const N_KNOTS: usize = 2 * SPEED_KNOTS * ANGLE_KNOTS;

/// The torque itself costs this much of what its bends cost: it keeps knots at zero that no swing passes.
pub(super) const LEVEL: f64 = 1e-4;

/// Knots over the angles and speeds of the swings, straight lines between them; either direction of motion has its own,
/// because friction turns with it.
pub struct Grid {
    angle_rad: f64,
    speed_rad_s: f64,
}

impl Grid {
    /// Over all that some paths pass; `None` where nothing moves.
    pub fn over(paths: &[Path]) -> Option<Self> {
        let largest = |axis: usize| {
            paths.iter().flat_map(Path::at_samples).fold(0.0_f64, |largest, motion| largest.max(motion[axis].abs()))
        };
        let (angle_rad, speed_rad_s) = (largest(0), largest(1));
        let moves = angle_rad > 0.0 && speed_rad_s > 0.0 && angle_rad.is_finite() && speed_rad_s.is_finite();
        moves.then_some(Self { angle_rad, speed_rad_s })
    }

    /// From knot to knot along the angle (rad) and along the speed (rad/s).
    pub fn widths(&self) -> [f64; 2] {
        [2.0 * self.angle_rad / (ANGLE_KNOTS - 1) as f64, self.speed_rad_s / (SPEED_KNOTS - 1) as f64]
    }

    /// The knots around a motion and how much of each counts; none at rest.
    pub fn weights(&self, [angle, velocity]: [f64; 2]) -> Vec<(usize, f64)> {
        if velocity == 0.0 {
            return Vec::new();
        }
        let along_angle = between(0.5 + 0.5 * angle / self.angle_rad, ANGLE_KNOTS);
        let along_speed = between(velocity.abs() / self.speed_rad_s, SPEED_KNOTS);
        let first = if velocity > 0.0 { SPEED_KNOTS } else { 0 };
        let knot =
            |(row, a): (usize, f64)| along_speed.map(|(column, b)| (2 * SPEED_KNOTS * row + first + column, a * b));
        along_angle.into_iter().flat_map(knot).collect()
    }

    /// The weights at the samples of a path, a column a knot.
    pub fn readings(&self, path: &Path) -> Vec<Vec<f64>> {
        let at: Vec<Vec<(usize, f64)>> = path.at_samples().map(|motion| self.weights(motion)).collect();
        let mut columns = vec![vec![0.0; at.len()]; N_KNOTS];
        for (sample, weights) in at.iter().enumerate() {
            weights.iter().for_each(|(knot, weight)| columns[*knot][sample] = *weight);
        }
        columns
    }

    /// How crooked it is along the angle and along the speed, and how large.
    pub fn ridge() -> DMatrix<f64> {
        let knots = |n: usize| (0..n).map(|k| k as f32).collect::<Vec<f32>>();
        let identity = DMatrix::identity;
        let along_angle = roughness(&knots(ANGLE_KNOTS)).kronecker(&identity(2 * SPEED_KNOTS, 2 * SPEED_KNOTS));
        let both_directions = identity(2, 2).kronecker(&roughness(&knots(SPEED_KNOTS)));
        let along_speed = identity(ANGLE_KNOTS, ANGLE_KNOTS).kronecker(&both_directions);
        along_angle + along_speed + LEVEL * identity(N_KNOTS, N_KNOTS)
    }
}

/// The two knots of so many around a share of the way, and their weights.
pub(super) fn between(share: f64, n_knots: usize) -> [(usize, f64); 2] {
    let place = share.clamp(0.0, 1.0) * (n_knots - 1) as f64;
    let first = (place as usize).min(n_knots - 2);
    let behind = place - first as f64;
    [(first, 1.0 - behind), (first + 1, behind)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_weights_of_the_knots_around_a_motion_are_those_of_straight_lines() {
        let grid = Grid { angle_rad: 1.4, speed_rad_s: 9.0 };
        let law = |angle: f64, velocity: f64| 0.3 + angle - 2.0 * velocity + angle * velocity + velocity.signum();
        let at = |knot: usize| {
            let (row, column) = (knot / (2 * SPEED_KNOTS), knot % (2 * SPEED_KNOTS));
            let angle = grid.angle_rad * (2.0 * row as f64 / (ANGLE_KNOTS - 1) as f64 - 1.0);
            let speed = grid.speed_rad_s * (column % SPEED_KNOTS) as f64 / (SPEED_KNOTS - 1) as f64;
            if column < SPEED_KNOTS { law(angle, -speed.max(1e-12)) } else { law(angle, speed.max(1e-12)) }
        };
        for (angle, velocity) in [(0.1, 0.2), (-1.38, 8.9), (0.7, -0.01), (1.4, -4.4), (-1.4, 9.0)] {
            let found: f64 = grid.weights([angle, velocity]).iter().map(|(knot, weight)| weight * at(*knot)).sum();
            assert!((found - law(angle, velocity)).abs() < 1e-9, "{angle} {velocity}: {found}");
        }
        assert!(grid.weights([0.3, 0.0]).is_empty(), "at rest nothing acts");
        assert_eq!(grid.widths(), [0.35, 2.25]);
    }
}
