//! The paper's five responses on real data: how far a simulated swing is from the measured one.
//!
//! mseA and mseV are mean squares of the errors in angle and velocity; ePM, eNM and eZC count peaks and zero crossings,
//! experiment minus simulation. Velocities of both pass through the same zero-phase filter. Crossings within the noise
//! are not counted.

use crate::swing::{Swing, Window};
use crate::verdict::SEEN_NOISES;
use crate::zero_phase;
use serde::Serialize;
use shared::real::Real;
use simulation::LANES;
use simulation::lanes::Lanes;

/// Cut-off for the velocities: far above the swing, far below the noise.
pub const VELOCITY_CUTOFF_HZ: f64 = 10.0;

/// How much of new runs a surface predicts, in words: one that is worse than their mean predicts none of them.
pub fn predicted(r_squared: f64, digits: usize) -> String {
    if r_squared <= 0.0 {
        return "none of the new runs".to_owned();
    }
    let only = if r_squared < 0.5 { "only " } else { "" };
    format!("{only}{:.digits$} % of new runs", 100.0 * r_squared)
}

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

/// A simulated swing beside the measured one.
#[derive(Clone, Debug)]
pub struct Simulated {
    /// Its angles, rad.
    pub angles_rad: Vec<f64>,
    /// What the measurement leaves beyond them, rad.
    pub residuals_rad: Vec<f64>,
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
        let threshold_rad = SEEN_NOISES * swing.noise_rad;
        let counts = count_lobes(swing.angles_rad[..n_samples].iter().map(|a| a - offset_rad), threshold_rad);
        Self { rate_hz, threshold_rad, counts }
    }

    /// The responses of a simulated swing.
    pub fn compare(&self, swing: &Simulated) -> Responses {
        self.with_velocity(swing, self.velocity_errors::<1>(&[swing])[0])
    }

    /// The same of several, whose velocities share their instructions: a filter waits for each of its own values.
    pub fn compare_each(&self, swings: &[Simulated]) -> Vec<Responses> {
        let compare = |batch: &[Simulated]| -> Vec<Responses> {
            let lanes: [&Simulated; LANES] = std::array::from_fn(|lane| &batch[lane.min(batch.len() - 1)]);
            let errors = self.velocity_errors(&lanes);
            batch.iter().zip(errors).map(|(swing, error)| self.with_velocity(swing, error)).collect()
        };
        swings.chunks(LANES).flat_map(compare).collect()
    }

    fn with_velocity(&self, swing: &Simulated, mse_velocity: f64) -> Responses {
        let n_samples = swing.residuals_rad.len().max(1) as f64;
        let simulated = count_lobes(swing.angles_rad.iter().copied(), self.threshold_rad);
        let positive_peaks = (self.counts.positive - simulated.positive) as f64;
        let negative_peaks = (self.counts.negative - simulated.negative) as f64;
        Responses {
            mse_angle: swing.residuals_rad.iter().map(|r| r * r).sum::<f64>() / n_samples,
            mse_velocity,
            positive_peaks,
            negative_peaks,
            zero_crossings: positive_peaks + negative_peaks,
        }
    }

    /// Mean squares of the errors in velocity, a lane a swing; all are equally long.
    fn velocity_errors<const N: usize>(&self, swings: &[&Simulated; N]) -> [f64; N] {
        let n_samples = swings[0].residuals_rad.len();
        let residuals = (0..n_samples).map(|i| Lanes(std::array::from_fn(|lane| swings[lane].residuals_rad[i])));
        let residuals: Vec<Lanes<N>> = residuals.collect();
        // The filter is linear: the filtered residual is the difference of the filtered angles.
        let smooth = zero_phase::filter(&residuals, VELOCITY_CUTOFF_HZ, self.rate_hz);
        let velocities = zero_phase::derivative(&smooth, self.rate_hz);
        let squares = velocities.fold(Lanes::zero(), |sum, velocity| sum + velocity * velocity);
        (squares / Lanes::of(n_samples.max(1) as f64)).0
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

    #[test]
    fn several_swings_compared_together_give_what_each_gives_alone() {
        let angle = |decay: f64, i: usize| (-decay * i as f64).exp() * (0.07 * i as f64).cos();
        let times_s: Vec<f64> = (0..900).map(|i| i as f64 * 0.01).collect();
        let measured_rad: Vec<f64> = (0..900).map(|i| angle(1e-3, i)).collect();
        let measured = Measured::new(&Swing::new("decay", &times_s, &measured_rad, 1e-3), Window::Whole, 0.0);
        // One more than two batches of lanes.
        let swings: Vec<Simulated> = (0..=2 * LANES)
            .map(|run| {
                let angles_rad: Vec<f64> = (0..900).map(|i| angle(1e-3 + 2e-4 * run as f64, i)).collect();
                let residuals_rad = measured_rad.iter().zip(&angles_rad).map(|(m, s)| m - s).collect();
                Simulated { angles_rad, residuals_rad }
            })
            .collect();
        let alone: Vec<Responses> = swings.iter().map(|swing| measured.compare(swing)).collect();
        assert_eq!(measured.compare_each(&swings), alone);
        assert!(alone.windows(2).all(|pair| pair[0].mse_velocity < pair[1].mse_velocity), "{alone:?}");
        assert_eq!(measured.compare_each(&[]), []);
    }

    #[test]
    fn the_error_in_velocity_of_a_slow_sine_is_its_own() {
        // At 0.5 Hz the filter at 10 Hz takes nothing: (aω)²/2, over whole waves but for the ends.
        let (size, angular) = (1e-2, std::f64::consts::PI);
        let times_s: Vec<f64> = (0..4000).map(|i| f64::from(i) * 5e-3).collect();
        let angles_rad: Vec<f64> = times_s.iter().map(|t| (6.0 * t).cos()).collect();
        let residuals_rad: Vec<f64> = times_s.iter().map(|t| size * (angular * t).sin()).collect();
        let measured = Measured::new(&Swing::new("sine", &times_s, &angles_rad, 1e-3), Window::Whole, 0.0);
        let found = measured.compare(&Simulated { angles_rad, residuals_rad });
        assert!((found.mse_velocity / (size * angular).powi(2) * 2.0 - 1.0).abs() < 0.02, "{found:?}");
        assert!((found.mse_angle / size.powi(2) * 2.0 - 1.0).abs() < 0.02, "{found:?}");
    }
}
