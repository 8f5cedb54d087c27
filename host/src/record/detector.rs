//! Is the pendulum still, was it let go, does it rest? From the measured angle alone, sample by sample.
//!
//! Still means that the angle spreads no more than its own fast noise explains. The noise comes from the differences of
//! neighbours, which a swing hardly changes. A release shows as two passages through the lowest point from well
//! outside: a hand that lifts the pendulum does not do that.

use serde::Serialize;
use std::collections::VecDeque;

/// Stillness is judged over this time.
const STILL_S: f64 = 0.5;

/// Rest is judged over this time: longer than a pendulum dwells where it turns.
const REST_S: f64 = 2.0;

/// The spread of a still pendulum over its fast noise: room for hum and drift.
const SPREAD_OVER_NOISE: f64 = 1.5;

/// Added to that, steps of the converter: room for rounding.
const SPREAD_STEPS: f64 = 1.0;

/// A passage counts if the pendulum was at least so far out since the one before, rad.
const LEAST_AMPLITUDE_RAD: f64 = 0.05;

/// Two passages make a release if not more than so much time lies between them.
const LONGEST_HALF_SWING_S: f64 = 3.0;

/// Passages that make a release.
const RELEASE_PASSAGES: u32 = 2;

/// How far a recording has got.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// Waiting for the pendulum to be still.
    Settling,
    /// Waiting for somebody to let it go.
    Waiting,
    /// It swings.
    Swinging,
    /// It rests again.
    AtRest,
}

/// Follows one recording.
pub(super) struct Detector {
    step_rad: f64,
    still: Window,
    rest: Window,
    stage: Stage,
    passages: Passages,
    n_passages: u32,
    release_rad: f64,
    angle_rad: f64,
    last_amplitude_rad: f64,
}

impl Detector {
    /// For angles at `rate_hz` from a sensor with steps of `step_rad`.
    pub(super) fn new(rate_hz: f64, step_rad: f64) -> Self {
        Self {
            step_rad,
            still: Window::new((STILL_S * rate_hz) as usize),
            rest: Window::new((REST_S * rate_hz) as usize),
            stage: Stage::Settling,
            passages: Passages::new((LONGEST_HALF_SWING_S * rate_hz) as u32),
            n_passages: 0,
            release_rad: 0.0,
            angle_rad: 0.0,
            last_amplitude_rad: 0.0,
        }
    }

    /// Takes one angle; gives the stage that begins with it, if one does.
    pub(super) fn push(&mut self, angle_rad: f64) -> Option<Stage> {
        self.angle_rad = angle_rad;
        self.still.push(angle_rad);
        self.rest.push(angle_rad);
        let passed_from = self.passages.push(angle_rad);
        let next = match self.stage {
            Stage::Settling => self.is_still(&self.still).then_some(Stage::Waiting),
            Stage::Waiting => self.released(passed_from).then_some(Stage::Swinging),
            Stage::Swinging => {
                self.count(passed_from);
                self.is_still(&self.rest).then_some(Stage::AtRest)
            }
            Stage::AtRest => None,
        };
        self.stage = next.unwrap_or(self.stage);
        next
    }

    /// Before anybody lets go, a first passage may be a hand's; the second within a swing's time settles it.
    fn released(&mut self, passed_from: Option<f64>) -> bool {
        if self.passages.is_stale() {
            self.n_passages = 0;
        }
        if self.n_passages == 0 && passed_from.is_some() {
            self.release_rad = passed_from.unwrap_or_default();
        }
        self.count(passed_from);
        self.n_passages >= RELEASE_PASSAGES
    }

    fn count(&mut self, passed_from: Option<f64>) {
        if let Some(amplitude_rad) = passed_from {
            self.n_passages += 1;
            self.last_amplitude_rad = amplitude_rad.abs();
        }
    }

    fn is_still(&self, window: &Window) -> bool {
        let limit_rad = SPREAD_OVER_NOISE * window.noise() + SPREAD_STEPS * self.step_rad;
        window.is_full() && window.spread() < limit_rad
    }

    pub(super) fn stage(&self) -> Stage {
        self.stage
    }

    pub(super) fn angle_rad(&self) -> f64 {
        self.angle_rad
    }

    /// Of the last half swing, or how far out the pendulum is before the first.
    pub(super) fn amplitude_rad(&self) -> f64 {
        if self.n_passages > 0 {
            self.last_amplitude_rad.max(self.passages.outermost().abs())
        } else {
            self.angle_rad.abs()
        }
    }

    pub(super) fn release_rad(&self) -> f64 {
        self.release_rad
    }

    pub(super) fn n_passages(&self) -> u32 {
        self.n_passages
    }

    /// Standard deviation over the stillness window.
    pub(super) fn spread_rad(&self) -> f64 {
        self.still.spread()
    }
}

/// Passages through zero, from at least the least amplitude.
struct Passages {
    outermost_rad: f64,
    since_last: u32,
    patience: u32,
}

impl Passages {
    fn new(patience: u32) -> Self {
        Self { outermost_rad: 0.0, since_last: 0, patience }
    }

    /// The outermost angle of the half swing that ends with this sample, if one does.
    fn push(&mut self, angle_rad: f64) -> Option<f64> {
        self.since_last = self.since_last.saturating_add(1);
        let crosses = angle_rad * self.outermost_rad < 0.0;
        if crosses && self.outermost_rad.abs() >= LEAST_AMPLITUDE_RAD {
            self.since_last = 0;
            return Some(std::mem::replace(&mut self.outermost_rad, angle_rad));
        }
        if crosses || angle_rad.abs() > self.outermost_rad.abs() {
            self.outermost_rad = angle_rad;
        }
        None
    }

    fn outermost(&self) -> f64 {
        self.outermost_rad
    }

    /// Is the last passage too long ago to belong to a swing?
    fn is_stale(&self) -> bool {
        self.since_last > self.patience
    }
}

/// Mean squares over the last samples.
struct Window {
    values: VecDeque<f64>,
    length: usize,
    sum: f64,
    sum_of_squares: f64,
    sum_of_squared_steps: f64,
}

impl Window {
    fn new(length: usize) -> Self {
        let length = length.max(2);
        let values = VecDeque::with_capacity(length);
        Self { values, length, sum: 0.0, sum_of_squares: 0.0, sum_of_squared_steps: 0.0 }
    }

    fn push(&mut self, value: f64) {
        if self.is_full() {
            let oldest = self.values.pop_front().unwrap_or(value);
            self.sum -= oldest;
            self.sum_of_squares -= oldest * oldest;
            self.sum_of_squared_steps -= square(self.values.front().copied().unwrap_or(value) - oldest);
        }
        self.sum_of_squared_steps += self.values.back().map_or(0.0, |last| square(value - last));
        self.sum += value;
        self.sum_of_squares += value * value;
        self.values.push_back(value);
    }

    fn is_full(&self) -> bool {
        self.values.len() == self.length
    }

    /// Standard deviation; rounding of the running sums stays far below a converter step.
    fn spread(&self) -> f64 {
        let n = self.values.len().max(1) as f64;
        (self.sum_of_squares / n - square(self.sum / n)).max(0.0).sqrt()
    }

    /// Standard deviation of white noise with these differences of neighbours.
    fn noise(&self) -> f64 {
        let n_steps = self.values.len().saturating_sub(1).max(1) as f64;
        (self.sum_of_squared_steps / (2.0 * n_steps)).max(0.0).sqrt()
    }
}

fn square(value: f64) -> f64 {
    value * value
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Noise;

    const RATE_HZ: f64 = 1000.0;
    const STEP_RAD: f64 = 1.45e-3;

    /// Feeds `angle_rad` over time with noise, gives the stages with the times at which they began.
    fn stages(seconds: f64, noise_rad: f64, angle_rad: impl Fn(f64) -> f64) -> Vec<(Stage, f64)> {
        let (mut detector, mut noise) = (Detector::new(RATE_HZ, STEP_RAD), Noise::new(5));
        (0..(seconds * RATE_HZ) as usize)
            .filter_map(|sample| {
                let time_s = sample as f64 / RATE_HZ;
                let measured = angle_rad(time_s) + noise_rad * noise.normal();
                detector.push((measured / STEP_RAD).round() * STEP_RAD).map(|stage| (stage, time_s))
            })
            .collect()
    }

    /// Held at 1 rad for 3 s, then a damped swing of 1.3 Hz that is below a step after 20 s.
    fn swing(time_s: f64) -> f64 {
        let since = time_s - 3.0;
        if since < 0.0 { 1.0 } else { (-0.3 * since).exp() * (2.0 * std::f64::consts::PI * 1.3 * since).cos() }
    }

    #[test]
    fn a_swing_is_seen_from_stillness_to_rest_at_any_noise() {
        for noise_rad in [0.0, 1e-3, 1e-2] {
            let stages = stages(30.0, noise_rad, swing);
            let names: Vec<Stage> = stages.iter().map(|(stage, _)| *stage).collect();
            assert_eq!(names, [Stage::Waiting, Stage::Swinging, Stage::AtRest], "noise {noise_rad}");
            assert!(stages[1].1 < 4.0, "released at {}", stages[1].1);
        }
    }

    #[test]
    fn a_slow_swing_of_two_degrees_is_not_rest() {
        let slow = |time_s: f64| if time_s < 1.0 { 1.0 } else { 0.06 * (3.0 * time_s).cos() };
        assert!(stages(60.0, 1e-3, slow).iter().all(|(stage, _)| *stage != Stage::AtRest));
    }

    #[test]
    fn lifting_by_hand_is_no_release() {
        let lift = |time_s: f64| 1.2 * (0.3 * (time_s - 1.0)).clamp(0.0, 1.0) - 0.02;
        let names: Vec<Stage> = stages(20.0, 1e-3, lift).into_iter().map(|(stage, _)| stage).collect();
        assert_eq!(names, [Stage::Waiting]);
    }

    #[test]
    fn what_never_stands_still_never_starts() {
        assert_eq!(stages(20.0, 1e-3, |time_s| 0.5 * (8.0 * time_s).sin()), []);
        // Over a whole period a sine spreads by its amplitude over √2.
        let mut detector = Detector::new(RATE_HZ, STEP_RAD);
        (0..2000).for_each(|sample| {
            detector.push(0.5 * (4.0 * std::f64::consts::PI * f64::from(sample) / RATE_HZ).sin());
        });
        assert!((detector.spread_rad() - 0.5 / 2f64.sqrt()).abs() < 1e-3, "{}", detector.spread_rad());
    }

    /// The swing without noise up to so long after the release.
    fn after(seconds: f64) -> Detector {
        let mut detector = Detector::new(RATE_HZ, STEP_RAD);
        (0..((3.0 + seconds) * RATE_HZ) as usize).for_each(|sample| {
            detector.push(swing(sample as f64 / RATE_HZ));
        });
        detector
    }

    #[test]
    fn the_amplitude_is_how_far_out_it_is_held_then_the_top_of_the_last_half_swing() {
        let held = after(-1.0);
        assert_eq!((held.angle_rad(), held.amplitude_rad(), held.n_passages()), (1.0, 1.0, 0));
        // Half a period after the release it turns at −e^(−0.3 · 0.385) = −0.891, and passes zero at three quarters.
        let period_s = 1.0 / 1.3;
        for periods in [0.8, 0.9, 1.0] {
            let swinging = after(periods * period_s);
            assert_eq!((swinging.stage(), swinging.n_passages()), (Stage::Swinging, 2), "{periods}");
            assert!((swinging.amplitude_rad() - 0.891).abs() < 0.002, "{periods}: {}", swinging.amplitude_rad());
            assert!((swinging.release_rad() - 1.0).abs() < 1e-6, "{periods}: {}", swinging.release_rad());
            let measured_rad = swing(3.0 + periods * period_s);
            assert!((swinging.angle_rad() - measured_rad).abs() < 0.01, "{periods}: {}", swinging.angle_rad());
        }
    }

    #[test]
    fn spread_and_noise_of_a_window_are_those_of_its_last_samples() {
        let mut window = Window::new(4);
        // Of 2, 4, 2, 4 the standard deviation is 1; neighbours differ by 2, as white noise of √2 would.
        [100.0, -50.0, 7.0, 2.0, 4.0, 2.0, 4.0].into_iter().for_each(|value| window.push(value));
        assert!(window.is_full());
        assert!((window.spread() - 1.0).abs() < 1e-9, "{}", window.spread());
        assert!((window.noise() - 2f64.sqrt()).abs() < 1e-9, "{}", window.noise());
    }

    #[test]
    fn two_passages_that_lie_too_far_apart_are_no_release() {
        // A hand carries it from side to side within a tenth of a second, and rests 4 s on each.
        let carried = |time_s: f64| if ((time_s / 4.0) as usize).is_multiple_of(2) { 0.5 } else { -0.5 };
        let names: Vec<Stage> = stages(30.0, 1e-3, carried).into_iter().map(|(stage, _)| stage).collect();
        assert_eq!(names, [Stage::Waiting]);
    }
}
