//! How fast the measured angle changes, beside what the observer believes.
//!
//! While a hand holds the pendulum, the observer expects it to fall and is pulled back with every sample: its velocity
//! is then large and of no pendulum. In: angles in rad at times in s. Out: the slope, in rad/s, of the straight line
//! (least squares) through the last [`SPAN_S`].

use std::collections::VecDeque;

/// The line reaches back so far, s; measured on the simulated rig with 1 mrad of noise, 200 points a second, a swing a
/// second. Its slope is that of half a span ago: twice the span lags by 0.1 s and takes 6 % off a swing's height, half
/// of it has 2.8 times the noise.
const SPAN_S: f64 = 0.1;

/// From here on the observer does not follow the pendulum, rad. On the simulated rig a swing with the first guess of a
/// model stays below a fifth of it, a hand that holds exceeds it several times; half or twice of it lie between, too.
pub(super) const LOST_RAD: f32 = 0.1;

/// The angles of the last moments.
#[derive(Default)]
pub(super) struct Rate {
    angles: VecDeque<(f64, f64)>,
}

impl Rate {
    /// Takes an angle; gives the slope, zero as long as there is only one.
    pub(super) fn take(&mut self, time_s: f64, angle_rad: f32) -> f32 {
        if self.angles.back().is_some_and(|(last_s, _)| *last_s >= time_s) {
            self.angles.clear();
        }
        self.angles.push_back((time_s, f64::from(angle_rad)));
        while self.angles.front().is_some_and(|(first_s, _)| *first_s < time_s - SPAN_S) {
            self.angles.pop_front();
        }
        self.slope()
    }

    fn slope(&self) -> f32 {
        let n = self.angles.len() as f64;
        let mean = |of: fn(&(f64, f64)) -> f64| self.angles.iter().map(of).sum::<f64>() / n;
        let (mean_s, mean_rad) = (mean(|at| at.0), mean(|at| at.1));
        let products = self.angles.iter().map(|(t, angle)| (t - mean_s) * (angle - mean_rad)).sum::<f64>();
        let squares = self.angles.iter().map(|(t, _)| (t - mean_s).powi(2)).sum::<f64>();
        if squares > 0.0 { (products / squares) as f32 } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_line_has_its_slope_and_a_new_stream_begins_anew() {
        let mut rate = Rate::default();
        assert_eq!(rate.take(5.0, 1.0), 0.0);
        let slopes: Vec<f32> = (1..40).map(|k| rate.take(5.0 + 0.005 * f64::from(k), 1.0 - 0.01 * k as f32)).collect();
        assert!(slopes.iter().all(|slope| (slope + 2.0).abs() < 1e-3), "{slopes:?}");
        assert_eq!(rate.take(1.0, 1.0), 0.0);
    }
}
