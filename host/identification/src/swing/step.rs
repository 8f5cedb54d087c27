//! How long an integration step may be: a swing tells how quickly its pendulum moves.

use crate::pace;
use shared::motion::Pendulum;

/// With so many Runge–Kutta steps a period the angle is wrong by less than [`SIMULATED_TO_RAD`] after 50 periods.
const STEPS_A_PERIOD: f64 = 80.0;

/// A simulation is no more accurate than this, rad, and no model can be judged by less.
pub(super) const SIMULATED_TO_RAD: f64 = 2e-5;

/// The pendulum turns by no more in a step.
const LARGEST_STEP_RAD: f64 = 0.15;

/// At the usual pace velocities change too much within a longer one: frictions near zero velocity would be missed.
const LONGEST_STEP_S: f64 = 1e-2;

/// The board's own step.
const SHORTEST_STEP_S: f64 = 1e-3;

/// For effects that change within a few degrees, at the usual pace.
pub(super) const FINE_STEP_S: f64 = 5e-3;

/// The longest step for a swing of this period, in s: so many to a period, and fewer degrees a step where it spins.
pub(super) fn longest_step_s(times_s: &[f64], angles_rad: &[f64], period_s: f64, pace: f64) -> f64 {
    let by_speed_s = LARGEST_STEP_RAD / largest_speed_rad_s(times_s, angles_rad);
    (period_s / STEPS_A_PERIOD).min(by_speed_s).clamp(SHORTEST_STEP_S, LONGEST_STEP_S * pace.max(1.0))
}

/// The same for a pendulum that is known, of whose motion nothing is.
pub fn longest_step_of(pendulum: &Pendulum<f64>) -> f64 {
    let longest_s = LONGEST_STEP_S * pace::of_pendulum(pendulum).max(1.0);
    (pace::small_period_s(pendulum) / STEPS_A_PERIOD).clamp(SHORTEST_STEP_S, longest_s)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pace;
    use crate::recording::turning::half_swing_s;

    /// For angles at 1 kHz over 10 s.
    fn step_s(angle_rad: impl Fn(f64) -> f64) -> f64 {
        let times_s: Vec<f64> = (0..10_000).map(|i| f64::from(i) * 1e-3).collect();
        let angles_rad: Vec<f64> = times_s.iter().map(|time_s| angle_rad(*time_s)).collect();
        let period_s = 2.0 * half_swing_s(&times_s, &angles_rad, 1e-3).unwrap_or(f64::INFINITY);
        longest_step_s(&times_s, &angles_rad, period_s, pace::of_period(period_s))
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
