//! The paper's five responses on real data: how far a simulated swing is from the measured one.
//!
//! mseA and mseV are mean squares of the errors in angle and velocity; ePM, eNM and eZC count peaks and zero crossings,
//! experiment minus simulation. Velocities of both pass through the same zero-phase filter. Crossings within the noise
//! are not counted.

use crate::swing::{Swing, Window};
use crate::zero_phase;
use serde::Serialize;

/// Cut-off for the velocities: far above the swing, far below the noise.
const VELOCITY_CUTOFF_HZ: f64 = 10.0;

/// A crossing counts once the angle is this many noises beyond zero.
const CROSSING_NOISES: f64 = 4.0;

/// The five responses (paper, section 6).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Responses {
    /// Mean square error of the angle, rad².
    #[serde(rename = "mseA")]
    pub mse_angle: f64,
    /// Mean square error of the velocity, rad²/s².
    #[serde(rename = "mseV")]
    pub mse_velocity: f64,
    /// Positive peaks, experiment minus simulation.
    #[serde(rename = "ePM")]
    pub positive_peaks: f64,
    /// Negative peaks, experiment minus simulation.
    #[serde(rename = "eNM")]
    pub negative_peaks: f64,
    /// Zero crossings, experiment minus simulation.
    #[serde(rename = "eZC")]
    pub zero_crossings: f64,
}

impl Responses {
    /// Names as in the paper, in the order of [`Responses::values`].
    pub const NAMES: [&'static str; 5] = ["mseA", "mseV", "ePM", "eNM", "eZC"];

    /// The five numbers.
    pub fn values(&self) -> [f64; 5] {
        [self.mse_angle, self.mse_velocity, self.positive_peaks, self.negative_peaks, self.zero_crossings]
    }
}

/// Peaks and crossings of a swing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Lobes above zero after the first crossing.
    pub positive: i64,
    /// Lobes below zero after the first crossing.
    pub negative: i64,
}

/// Counts the lobes between sign changes; an angle within `threshold` of zero belongs to the lobe before.
pub fn count_lobes(angles_rad: impl Iterator<Item = f64>, threshold_rad: f64) -> Counts {
    let mut counts = Counts::default();
    let mut side = 0.0;
    for angle in angles_rad.filter(|angle| angle.abs() > threshold_rad) {
        if side * angle < 0.0 {
            *(if angle > 0.0 { &mut counts.positive } else { &mut counts.negative }) += 1;
        }
        side = angle.signum();
    }
    counts
}

/// A measured swing, prepared for many comparisons within one window.
#[derive(Clone, Debug)]
pub struct Measured {
    rate_hz: f64,
    threshold_rad: f64,
    counts: Counts,
}

impl Measured {
    /// Prepares a swing; `offset_rad` is the sensor's zero.
    pub fn new(swing: &Swing, window: Window, offset_rad: f64) -> Self {
        let n_samples = swing.samples_within(window);
        let rate_hz = (swing.len() - 1) as f64 / swing.duration_s();
        let threshold_rad = CROSSING_NOISES * swing.noise_rad;
        let counts = count_lobes(swing.angles_rad[..n_samples].iter().map(|a| a - offset_rad), threshold_rad);
        Self { rate_hz, threshold_rad, counts }
    }

    /// The responses of a simulated swing: its angles (rad) and what the measurement leaves beyond them (rad).
    pub fn compare(&self, simulated_rad: &[f64], residuals_rad: &[f64]) -> Responses {
        let n_samples = residuals_rad.len().max(1) as f64;
        // The filter is linear: the filtered residual is the difference of the filtered angles.
        let smooth = zero_phase::filter(residuals_rad, VELOCITY_CUTOFF_HZ, self.rate_hz);
        let velocities = zero_phase::derivative(&smooth, self.rate_hz);
        let simulated = count_lobes(simulated_rad.iter().copied(), self.threshold_rad);
        let positive_peaks = (self.counts.positive - simulated.positive) as f64;
        let negative_peaks = (self.counts.negative - simulated.negative) as f64;
        Responses {
            mse_angle: residuals_rad.iter().map(|r| r * r).sum::<f64>() / n_samples,
            mse_velocity: velocities.iter().map(|v| v * v).sum::<f64>() / n_samples,
            positive_peaks,
            negative_peaks,
            zero_crossings: positive_peaks + negative_peaks,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lobes_are_counted_after_the_release_lobe_and_noise_is_not() {
        let swing = [1.0, 0.01, -0.01, 0.01, -0.9, -0.02, 0.8, -0.01, 0.02, -0.6];
        assert_eq!(count_lobes(swing.into_iter(), 0.05), Counts { positive: 1, negative: 2 });
    }
}
