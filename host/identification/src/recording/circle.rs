//! The circle on which a point of the pendulum moves, in a video's x and y: its centre is the pivot.
//!
//! An algebraic circle (I. Kåsa, IEEE Trans. Instrum. Meas. 25 (1976) 8) begins, Gauss–Newton on the distances ends.
//! Down is where the points are, so pixels that count from the top are as good as metres that count from below.

use super::error::Fault;
use nalgebra::{Matrix3, Vector3};

/// Points that are used for the circle.
const MOST_POINTS: usize = 5000;

/// Rounds of Gauss–Newton; a few suffice.
const N_ROUNDS: usize = 30;

/// Stretches of the arc over which distances from the circle are averaged.
const N_STRETCHES: usize = 16;

/// A camera that is not square to the swing shows an ellipse; from this share of the radius on the angles are wrong by
/// some percent …
const MOST_OFF: f64 = 0.015;

/// … and from this on it is worth a word.
const NOTED_OFF: f64 = 0.004;

/// The radius, and with it every angle, must be known to this share.
const MOST_SPREAD: f64 = 0.02;

/// A circle through the points.
#[derive(Debug)]
pub(super) struct Circle {
    x: f64,
    y: f64,
    radius: f64,
    /// Typical distance of the averaged points from it, as a share of the radius.
    off: f64,
    /// +1 where y counts upwards, −1 where it counts downwards.
    up: f64,
}

impl Circle {
    /// Fits the circle; with a known pivot only its radius.
    pub(super) fn through(x: &[f64], y: &[f64], pivot: Option<[f64; 2]>) -> Result<Self, Fault> {
        let every = x.len().div_ceil(MOST_POINTS).max(1);
        let points: Vec<[f64; 2]> = x.iter().zip(y).step_by(every).map(|(x, y)| [*x, *y]).collect();
        let (centre, radius, spread) = match pivot {
            Some(pivot) => (pivot, mean_distance(&points, pivot), 0.0),
            None => fitted(&points).ok_or(Fault::ShortArc { spread_percent: 100.0 })?,
        };
        let mean_y = points.iter().map(|point| point[1]).sum::<f64>() / points.len().max(1) as f64;
        let mut circle =
            Self { x: centre[0], y: centre[1], radius, off: 0.0, up: if mean_y < centre[1] { 1.0 } else { -1.0 } };
        circle.off = circle.typical_distance(&points);
        if spread > MOST_SPREAD {
            return Err(Fault::ShortArc { spread_percent: 100.0 * spread });
        }
        if circle.off > MOST_OFF {
            return Err(Fault::NoCircle { off_percent: 100.0 * circle.off });
        }
        Ok(circle)
    }

    /// Angles of the points, rad: 0 straight below the centre, counter-clockwise positive.
    pub(super) fn angles_rad(&self, x: &[f64], y: &[f64]) -> Vec<f64> {
        x.iter().zip(y).map(|(x, y)| self.angle_rad(*x, *y)).collect()
    }

    fn angle_rad(&self, x: f64, y: f64) -> f64 {
        (x - self.x).atan2(self.up * (self.y - y))
    }

    /// What was found, for a person.
    pub(super) fn in_words(&self) -> String {
        let Self { x, y, radius, off, up } = self;
        let way = if *up > 0.0 { "up" } else { "down" };
        let doubt = match *off > NOTED_OFF {
            true => format!(
                "; the points are {:.1} % of it off, as when the camera is not square to the swing",
                100.0 * off
            ),
            false => String::new(),
        };
        format!("angles from x and y, y counting {way}: pivot at ({x:.4}, {y:.4}), radius {radius:.4}{doubt}")
    }

    /// Of the means over stretches of the arc, so that the noise of single points does not count.
    fn typical_distance(&self, points: &[[f64; 2]]) -> f64 {
        let mut by_angle: Vec<(f64, f64)> = points
            .iter()
            .map(|[x, y]| (self.angle_rad(*x, *y), (x - self.x).hypot(y - self.y) - self.radius))
            .collect();
        by_angle.sort_by(|a, b| a.0.total_cmp(&b.0));
        let stretches = by_angle.chunks(by_angle.len().div_ceil(N_STRETCHES).max(1));
        let squares: Vec<f64> =
            stretches.map(|part| (part.iter().map(|(_, off)| off).sum::<f64>() / part.len() as f64).powi(2)).collect();
        (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt() / self.radius
    }
}

fn mean_distance(points: &[[f64; 2]], centre: [f64; 2]) -> f64 {
    points.iter().map(|[x, y]| (x - centre[0]).hypot(y - centre[1])).sum::<f64>() / points.len().max(1) as f64
}

/// Centre, radius, and the radius' relative standard error.
fn fitted(points: &[[f64; 2]]) -> Option<([f64; 2], f64, f64)> {
    let n = points.len() as f64;
    let (mean_x, mean_y) = (points.iter().map(|p| p[0]).sum::<f64>() / n, points.iter().map(|p| p[1]).sum::<f64>() / n);
    let local = || points.iter().map(|[x, y]| (x - mean_x, y - mean_y));
    let (mut normal, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (u, v) in local() {
        let row = Vector3::new(2.0 * u, 2.0 * v, 1.0);
        normal += row * row.transpose();
        right += row * (u * u + v * v);
    }
    let start = normal.lu().solve(&right)?;
    let mut circle = Vector3::new(start[0], start[1], (start[2] + start[0].powi(2) + start[1].powi(2)).sqrt());
    let mut spread = f64::INFINITY;
    for _ in 0..N_ROUNDS {
        let (mut normal, mut right, mut squares) = (Matrix3::zeros(), Vector3::zeros(), 0.0);
        for (u, v) in local() {
            let (du, dv) = (u - circle[0], v - circle[1]);
            let distance = du.hypot(dv);
            let row = Vector3::new(-du / distance, -dv / distance, -1.0);
            let off = distance - circle[2];
            normal += row * row.transpose();
            right -= row * off;
            squares += off * off;
        }
        let inverse = normal.try_inverse()?;
        circle += inverse * right;
        spread = (inverse[(2, 2)].max(0.0) * squares / (n - 3.0).max(1.0)).sqrt() / circle[2].abs();
    }
    let is_sound = circle.iter().all(|value| value.is_finite()) && circle[2] > 0.0 && spread.is_finite();
    is_sound.then_some(([circle[0] + mean_x, circle[1] + mean_y], circle[2], spread))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn arc(half_rad: f64, squeeze: f64, noise: f64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let angles: Vec<f64> = (0..400).map(|idx| half_rad * (f64::from(idx) * 0.1).cos()).collect();
        let random = |idx: usize| f64::from((idx as u32).wrapping_mul(2_654_435_761) >> 16) / 65536.0 - 0.5;
        let x = angles.iter().enumerate().map(|(i, a)| 300.0 + squeeze * 200.0 * a.sin() + noise * random(i)).collect();
        let y = angles.iter().enumerate().map(|(i, a)| 100.0 + 200.0 * a.cos() + noise * random(i + 7919)).collect();
        (angles, x, y)
    }

    #[test]
    fn pixels_from_the_top_give_pivot_and_angles() {
        let (angles, x, y) = arc(0.8, 1.0, 1.0);
        let circle = Circle::through(&x, &y, None).unwrap();
        assert!((circle.x - 300.0).abs() < 0.5 && (circle.y - 100.0).abs() < 1.0 && circle.up < 0.0, "{circle:?}");
        let found = circle.angles_rad(&x, &y);
        assert!(found.iter().zip(&angles).all(|(found, angle)| (found - angle).abs() < 0.01));
    }

    #[test]
    fn a_slanting_view_and_a_short_arc_are_refused() {
        let (_, x, y) = arc(1.4, 0.7, 1.0);
        assert!(matches!(Circle::through(&x, &y, None), Err(Fault::NoCircle { .. })));
        let (angles, x, y) = arc(0.05, 1.0, 2.0);
        assert!(matches!(Circle::through(&x, &y, None), Err(Fault::ShortArc { .. })));
        let circle = Circle::through(&x, &y, Some([300.0, 100.0])).unwrap();
        let found = circle.angles_rad(&x, &y);
        assert!(found.iter().zip(&angles).all(|(found, angle)| (found - angle).abs() < 0.02));
    }
}
