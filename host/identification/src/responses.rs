//! The five responses by which the paper compares an experiment with a simulation: two mean-square errors and three
//! counts. In: both angle series, sampled at the same instants, evenly. Out: [`Responses`].
//!
//! Conventions, found by making all 54 published runs come out:
//! - mseA and mseV are plain means over all samples, in rad² and (rad/s)². The experiment's velocity is its angle's
//!   central difference, one-sided at both ends, unfiltered; the simulation's is treated in the same way.
//! - A zero crossing is a change of the sign of the angle.
//! - Each lobe after a crossing holds one peak, positive or negative; the lobe of the release is not counted. So the
//!   number of crossings is the number of peaks.
//! - Differences of counts are experiment minus simulation.
//!
//! Source: paper, section 4.

/// How far a simulation is from an experiment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Responses {
    /// mseA: mean square error of the angle, rad².
    pub angle_mean_square: f64,
    /// mseV: mean square error of the velocity, rad²/s².
    pub velocity_mean_square: f64,
    /// ePM: positive peaks, experiment minus simulation.
    pub positive_peaks: i32,
    /// eNM: negative peaks, experiment minus simulation.
    pub negative_peaks: i32,
    /// eZC: zero crossings, experiment minus simulation.
    pub zero_crossings: i32,
}

/// How often an angle crosses zero and peaks after its release.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Lobes above zero, without that of the release.
    pub positive_peaks: i32,
    /// Lobes below zero, without that of the release.
    pub negative_peaks: i32,
}

impl Counts {
    /// Changes of sign.
    pub fn zero_crossings(&self) -> i32 {
        self.positive_peaks + self.negative_peaks
    }
}

/// Compares a simulation with an experiment: angles in rad at the same instants, `interval_s` apart. Only as many
/// samples as both have are used; fewer than two say nothing about velocity.
pub fn responses(experiment_rad: &[f64], simulation_rad: &[f64], interval_s: f64) -> Responses {
    let n_samples = experiment_rad.len().min(simulation_rad.len());
    let (experiment, simulation) = (&experiment_rad[..n_samples], &simulation_rad[..n_samples]);
    let difference: Vec<f64> = experiment.iter().zip(simulation).map(|(e, s)| e - s).collect();
    let (of_experiment, of_simulation) = (counts(experiment), counts(simulation));
    Responses {
        angle_mean_square: mean_square(&difference),
        // Differencing is linear: the velocities' difference is the difference's velocity.
        velocity_mean_square: mean_square(&central_differences(&difference, interval_s)),
        positive_peaks: of_experiment.positive_peaks - of_simulation.positive_peaks,
        negative_peaks: of_experiment.negative_peaks - of_simulation.negative_peaks,
        zero_crossings: of_experiment.zero_crossings() - of_simulation.zero_crossings(),
    }
}

/// Counts the lobes of an angle after the first change of sign; a sample of exactly zero belongs to the lobe before.
pub fn counts(angle_rad: &[f64]) -> Counts {
    let mut counts = Counts::default();
    let mut positive_before = None;
    for angle in angle_rad.iter().filter(|angle| **angle != 0.0) {
        let positive = *angle > 0.0;
        match positive_before {
            Some(before) if before != positive && positive => counts.positive_peaks += 1,
            Some(before) if before != positive => counts.negative_peaks += 1,
            _ => {}
        }
        positive_before = Some(positive);
    }
    counts
}

/// Velocities of evenly spaced angles: central differences, one-sided at the ends.
pub fn central_differences(angle_rad: &[f64], interval_s: f64) -> Vec<f64> {
    let last = angle_rad.len().saturating_sub(1);
    (0..angle_rad.len())
        .map(|i| {
            let (before, after) = (i.saturating_sub(1), (i + 1).min(last));
            (angle_rad[after] - angle_rad[before]) / (interval_s * (after - before).max(1) as f64)
        })
        .collect()
}

fn mean_square(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lobe_of_the_release_is_not_counted() {
        let angle = [1.0, 0.5, -0.3, -0.8, 0.0, 0.6, -0.1, -0.05];
        assert_eq!(counts(&angle), Counts { positive_peaks: 1, negative_peaks: 2 });
        assert_eq!(counts(&angle).zero_crossings(), 3);
        assert_eq!(counts(&[]), Counts::default());
    }

    #[test]
    fn differences_are_experiment_minus_simulation() {
        let r = responses(&[1.0, -1.0, 1.0, -1.0], &[1.0, -1.0, -1.0, -1.0], 0.5);
        assert_eq!((r.positive_peaks, r.negative_peaks, r.zero_crossings), (1, 1, 2));
        assert_eq!(r.angle_mean_square, 1.0);
        // The difference is 0, 0, 2, 0 rad: velocities 0, 2, 0, −4 rad/s.
        assert_eq!(r.velocity_mean_square, 5.0);
    }

    #[test]
    fn series_too_short_are_harmless() {
        assert_eq!(responses(&[], &[1.0], 0.1).angle_mean_square, 0.0);
        assert_eq!(responses(&[1.0], &[1.0], 0.1).velocity_mean_square, 0.0);
    }
}
