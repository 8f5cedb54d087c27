//! Least-squares polynomials over short stretches of uneven samples: value, slope and curvature at a moment.
//!
//! A. Savitzky, M. J. E. Golay, Anal. Chem. 36 (1964) 1627, without their even spacing. The curvature serves to tell a
//! hand from gravity (tens of rad/s²); it is far too noisy to judge friction by.

use std::ops::Range;

use nalgebra::{SMatrix, SVector};

/// A polynomial of `N` coefficients around a moment.
#[derive(Debug, Clone)]
pub struct LocalFit<const N: usize> {
    centre_s: f64,
    half_width_s: f64,
    /// Of powers of x = (t − centre) / half width.
    coefficients: SVector<f64, N>,
    inverse: SMatrix<f64, N, N>,
}

impl<const N: usize> LocalFit<N> {
    /// Fits the samples within `half_width_s` of `centre_s`; `None` with fewer samples than `N + 1`.
    pub fn new(times_s: &[f64], angles_rad: &[f64], centre_s: f64, half_width_s: f64) -> Option<Self> {
        let range = within(times_s, centre_s, half_width_s);
        if range.len() <= N {
            return None;
        }
        let mut normal = SMatrix::<f64, N, N>::zeros();
        let mut right = SVector::<f64, N>::zeros();
        for idx in range {
            let powers = powers::<N>((times_s[idx] - centre_s) / half_width_s);
            normal += powers * powers.transpose();
            right += powers * angles_rad[idx];
        }
        let inverse = normal.try_inverse()?;
        Some(Self { centre_s, half_width_s, coefficients: inverse * right, inverse })
    }

    /// The moment around which it was fitted, s.
    pub fn centre_s(&self) -> f64 {
        self.centre_s
    }

    /// Root mean square of what it leaves of the samples that it was fitted to, over those more than it has coefficients, rad.
    pub fn left_rms_rad(&self, times_s: &[f64], angles_rad: &[f64]) -> f64 {
        let range = within(times_s, self.centre_s, self.half_width_s);
        let left = |idx: usize| (angles_rad[idx] - self.angle_rad(times_s[idx])).powi(2);
        let n_spare = range.len() - N;
        (range.map(left).sum::<f64>() / n_spare as f64).sqrt()
    }

    /// Angle at a time, rad.
    pub fn angle_rad(&self, time_s: f64) -> f64 {
        self.coefficients.dot(&powers(self.x(time_s)))
    }

    /// Velocity at the centre, rad/s.
    pub fn velocity_rad_s(&self) -> f64 {
        self.coefficients[1] / self.half_width_s
    }

    /// Standard deviation of the velocity per unit of white noise, 1/s.
    pub fn velocity_spread(&self) -> f64 {
        self.inverse[(1, 1)].max(0.0).sqrt() / self.half_width_s
    }

    /// Acceleration at the centre, rad/s²; needs `N` ≥ 3.
    pub fn acceleration_rad_s2(&self) -> f64 {
        2.0 * self.coefficients[2] / self.half_width_s.powi(2)
    }

    /// Standard deviation of the angle at a time per unit of white noise in the samples.
    pub fn angle_spread(&self, time_s: f64) -> f64 {
        let powers = powers::<N>(self.x(time_s));
        powers.dot(&(self.inverse * powers)).max(0.0).sqrt()
    }

    /// Standard deviation of the acceleration per unit of white noise, 1/s².
    pub fn acceleration_spread(&self) -> f64 {
        2.0 * self.inverse[(2, 2)].max(0.0).sqrt() / self.half_width_s.powi(2)
    }

    /// Where the slope is zero, within the stretch; `None` when it is not.
    pub fn stationary_s(&self) -> Option<f64> {
        let mut x = 0.0;
        for _ in 0..20 {
            let (slope, curvature) = self.slope_and_curvature(x);
            x -= slope / curvature;
            // Also catches the NaN of a flat polynomial.
            if !(-1.0..=1.0).contains(&x) {
                return None;
            }
        }
        Some(self.centre_s + x * self.half_width_s)
    }

    /// Does it bend down at a time, as where it is highest?
    pub fn bends_down(&self, time_s: f64) -> bool {
        self.slope_and_curvature(self.x(time_s)).1 < 0.0
    }

    fn slope_and_curvature(&self, x: f64) -> (f64, f64) {
        let slope = (1..N).map(|power| power as f64 * self.coefficients[power] * x.powi(power as i32 - 1)).sum();
        let curvature = |power: usize| (power * (power - 1)) as f64 * x.powi(power as i32 - 2);
        (slope, (2..N).map(|power| self.coefficients[power] * curvature(power)).sum())
    }

    fn x(&self, time_s: f64) -> f64 {
        (time_s - self.centre_s) / self.half_width_s
    }
}

/// Indices of the samples within `half_width_s` of `centre_s`.
pub fn within(times_s: &[f64], centre_s: f64, half_width_s: f64) -> Range<usize> {
    let start = times_s.partition_point(|time_s| *time_s < centre_s - half_width_s);
    let end = times_s.partition_point(|time_s| *time_s <= centre_s + half_width_s);
    start..end.max(start)
}

fn powers<const N: usize>(x: f64) -> SVector<f64, N> {
    SVector::from_fn(|power, _| x.powi(power as i32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polynomial_of_uneven_samples_comes_back_exactly() {
        let times_s: Vec<f64> = (0..40).map(|idx| f64::from(idx) * 0.01 + 0.003 * f64::from(idx % 3)).collect();
        let angles_rad: Vec<f64> = times_s.iter().map(|t| 0.3 + 2.0 * (t - 0.2) - 5.0 * (t - 0.2).powi(2)).collect();
        let fit = LocalFit::<5>::new(&times_s, &angles_rad, 0.2, 0.1).unwrap();
        assert!((fit.angle_rad(0.2) - 0.3).abs() < 1e-12);
        assert!((fit.velocity_rad_s() - 2.0).abs() < 1e-10);
        assert!((fit.acceleration_rad_s2() + 10.0).abs() < 1e-8);
    }
}
