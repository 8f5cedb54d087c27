//! A recording made ready for the fit: the free swing alone, its time counted from its first sample.

use crate::fit::quality::count_lobes;
use crate::recording::segment::{SegmentError, SegmentOptions, Segments, segment};
use crate::recording::{Fault, Recording};
use crate::trajectory::Schedule;
use shared::effect::Effect;
use shared::parameters::Parameters;

/// Why a recording has no swing to fit.
#[derive(Debug, thiserror::Error)]
pub enum SwingError {
    /// No free motion was found.
    #[error(transparent)]
    Segment(#[from] SegmentError),
    /// What is left can't be used.
    #[error(transparent)]
    Fault(#[from] Fault),
}

/// Seconds of rest that are kept behind a swing.
const KEPT_REST_S: f64 = 0.5;

/// A free swing.
#[derive(Clone, Debug)]
pub struct Swing {
    /// What people call it: the file's name.
    pub name: String,
    /// Seconds since the first sample, rising strictly.
    pub times_s: Vec<f64>,
    /// Measured angle in rad, unfiltered.
    pub angles_rad: Vec<f64>,
    /// Total rms noise of the angle, rad.
    pub noise_rad: f64,
    /// How to step through the times, usually and with effects that change within a few degrees.
    schedules: [Schedule; 2],
    /// Number of samples before the last swings, in which stiction decides.
    n_lively: usize,
}

/// How much of the swings a fit looks at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Window {
    /// The first so many seconds, without the last swings before rest.
    First(f64),
    /// All but the last swings before rest.
    Lively,
    /// And this share (0 … 1) of the last swings.
    Calming(f64),
    /// Everything.
    Whole,
}

impl Swing {
    /// From times and angles of the free motion, noise in rad. At least three samples, times rising strictly.
    pub fn new(name: &str, times_s: &[f64], angles_rad: &[f64], noise_rad: f64) -> Self {
        let times_s: Vec<f64> = times_s.iter().map(|t| t - times_s[0]).collect();
        let n_lively = n_lively(angles_rad);
        let longest_s = longest_step_s(&times_s, &angles_rad[..n_lively], noise_rad);
        let schedules = [longest_s, longest_s.min(FINE_STEP_S)].map(|step_s| Schedule::new(&times_s, step_s));
        Self { name: name.to_owned(), times_s, angles_rad: angles_rad.to_vec(), noise_rad, schedules, n_lively }
    }

    /// The free swing of a recording and what was cut off. Of the rest at the end only the beginning is kept: it tells
    /// where the pendulum stopped, more of it tells nothing.
    pub fn from_recording(
        name: &str,
        recording: &Recording,
        options: &SegmentOptions,
    ) -> Result<(Self, Segments), SwingError> {
        let segments = segment(recording, options)?;
        let times_s = recording.times_s();
        let rest_s = segments.rest.as_ref().map_or(f64::INFINITY, |rest| times_s[rest.start] + KEPT_REST_S);
        let range = match options.to_s {
            Some(_) => segments.free.clone(),
            None => {
                let end = segments.rest.as_ref().map_or(segments.free.end, |rest| rest.end);
                segments.free.start..times_s[..end].partition_point(|t| *t <= rest_s)
            }
        };
        let part = recording.part(range)?;
        Ok((Self::new(name, part.times_s(), part.angles_rad(), segments.noise.total_rms), segments))
    }

    /// How to step through the times with this model.
    pub fn schedule<R>(&self, parameters: &Parameters<R>) -> &Schedule {
        let is_fine = |id: u16| Effect::<f64>::by_id(id).is_none_or(|effect| effect.is_fine);
        &self.schedules[usize::from(parameters.effects.iter().any(|effect| is_fine(effect.id)))]
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.times_s.len()
    }

    /// True without any sample.
    pub fn is_empty(&self) -> bool {
        self.times_s.is_empty()
    }

    /// Length in seconds.
    pub fn duration_s(&self) -> f64 {
        self.times_s.last().copied().unwrap_or(0.0)
    }

    /// Every k-th sample, so that about `rate_hz` remain; unchanged if there are no more than that.
    pub fn thinned(&self, rate_hz: f64) -> Self {
        let every = ((self.len() as f64 / self.duration_s() / rate_hz) as usize).max(1);
        let pick = |values: &[f64]| values.iter().step_by(every).copied().collect::<Vec<f64>>();
        Self::new(&self.name, &pick(&self.times_s), &pick(&self.angles_rad), self.noise_rad)
    }

    /// Number of samples in a window.
    pub fn samples_within(&self, window: Window) -> usize {
        match window {
            Window::First(seconds) => self.times_s.partition_point(|t| *t <= seconds).min(self.n_lively),
            Window::Lively => self.n_lively,
            Window::Calming(share) => self.n_lively + (share * (self.len() - self.n_lively) as f64) as usize,
            Window::Whole => self.len(),
        }
    }

    /// Angle (rad) and velocity (rad/s) at the first sample, by a parabola through the first samples.
    pub fn start_guess(&self) -> (f64, f64) {
        let n_samples =
            self.samples_within(Window::First(START_FIT_S)).clamp(MIN_START_SAMPLES.min(self.len()), self.len());
        let rows = nalgebra::DMatrix::from_fn(n_samples, 3, |i, j| self.times_s[i].powi(j as i32));
        let angles = nalgebra::DVector::from_column_slice(&self.angles_rad[..n_samples]);
        match rows.svd(true, true).solve(&angles, 1e-12) {
            Ok(fit) => (fit[0], fit[1]),
            Err(_) => (self.angles_rad[0], 0.0),
        }
    }
}

/// Samples up to the last one at which the pendulum is still far from its middle.
fn n_lively(angles_rad: &[f64]) -> usize {
    let (low, high) = angles_rad.iter().fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
    let amplitude = low.abs().max(high.abs());
    let threshold = LIVELY_RAD.max(LIVELY_SHARE * amplitude).min(0.5 * amplitude);
    angles_rad.iter().rposition(|x| x.abs() > threshold).map_or(angles_rad.len(), |last| last + 1)
}

/// The longest integration step for a swing, in s: so many to a period, and fewer degrees a step where it spins.
fn longest_step_s(times_s: &[f64], angles_rad: &[f64], noise_rad: f64) -> f64 {
    let middle_rad = angles_rad.iter().sum::<f64>() / angles_rad.len() as f64;
    let lobes = count_lobes(angles_rad.iter().map(|angle| angle - middle_rad), LOBE_NOISES * noise_rad);
    let n_lobes = (lobes.positive + lobes.negative).max(1) as f64;
    let period_s = 2.0 * times_s[angles_rad.len() - 1] / n_lobes;
    let by_speed_s = LARGEST_STEP_RAD / largest_speed_rad_s(times_s, angles_rad);
    (period_s / STEPS_A_PERIOD).min(by_speed_s).clamp(SHORTEST_STEP_S, LONGEST_STEP_S)
}

/// Over stretches of the longest step, so that noise does not count.
fn largest_speed_rad_s(times_s: &[f64], angles_rad: &[f64]) -> f64 {
    let mut from = 0;
    let mut largest = 0.0_f64;
    for to in 1..angles_rad.len() {
        while times_s[to] - times_s[from + 1] >= LONGEST_STEP_S {
            from += 1;
        }
        let seconds = times_s[to] - times_s[from];
        if seconds >= LONGEST_STEP_S {
            largest = largest.max((angles_rad[to] - angles_rad[from]).abs() / seconds);
        }
    }
    largest
}

/// With so many Runge–Kutta steps a period the angle is wrong by less than 2e-5 rad after 50 periods.
const STEPS_A_PERIOD: f64 = 80.0;

/// The pendulum turns by no more in a step.
const LARGEST_STEP_RAD: f64 = 0.15;

/// Velocities change too much within a longer one: frictions near zero velocity would be missed.
const LONGEST_STEP_S: f64 = 1e-2;

/// The board's own step.
const SHORTEST_STEP_S: f64 = 1e-3;

/// For effects that change within a few degrees.
const FINE_STEP_S: f64 = 5e-3;

/// A lobe rises above so many noises.
const LOBE_NOISES: f64 = 4.0;

/// Below this angle, and below this share of the largest, stiction may decide.
const LIVELY_RAD: f64 = 0.12;
const LIVELY_SHARE: f64 = 0.1;

/// A parabola follows the pendulum this long.
const START_FIT_S: f64 = 0.06;

/// Fewer would not tell noise from velocity.
const MIN_START_SAMPLES: usize = 5;

#[cfg(test)]
mod tests {
    use super::*;

    /// For angles at 1 kHz over 10 s.
    fn step_s(angle_rad: impl Fn(f64) -> f64) -> f64 {
        let times_s: Vec<f64> = (0..10_000).map(|i| f64::from(i) * 1e-3).collect();
        let angles_rad: Vec<f64> = times_s.iter().map(|time_s| angle_rad(*time_s)).collect();
        longest_step_s(&times_s, &angles_rad, 1e-3)
    }

    #[test]
    fn a_step_is_a_share_of_the_period_wherever_the_sensors_zero_lies() {
        assert_eq!(step_s(|time_s| 0.5 * (std::f64::consts::TAU * time_s).cos()), LONGEST_STEP_S);
        let quick = step_s(|time_s| 0.4 + 0.1 * (std::f64::consts::TAU * time_s / 0.3).cos());
        assert!((quick / (0.3 / STEPS_A_PERIOD) - 1.0).abs() < 0.05, "{quick}");
    }

    #[test]
    fn a_pendulum_that_spins_is_followed_in_short_steps() {
        assert!((step_s(|time_s| 30.0 * time_s) - LARGEST_STEP_RAD / 30.0).abs() < 1e-6);
    }

    #[test]
    fn noise_alone_does_not_make_steps_shorter_than_the_boards() {
        assert_eq!(step_s(|time_s| (1e6 * time_s).sin()), SHORTEST_STEP_S);
    }
}
