//! Where the zero of the sensor of a swing can lie.
//!
//! Angles that are whole turns apart are one to a pendulum, so that a search may leave for another turn and find there what it
//! would have found here. But a pendulum swings about the lowest point, or less than a quarter turn beside it: where a spring or
//! another constant torque holds it further off, gravity does not pull it back. Where it swings in the end, after it may have
//! gone over the top, tells the turn.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The lowest and the highest zero that readings in rad allow which swing in their last part; all where they whirl there.
pub(super) fn range_rad(last_rad: &[f64]) -> (f64, f64) {
    let (low, high) = last_rad.iter().fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
    let middle_rad = 0.5 * (low + high);
    let swings = 0.5 * (high - low) < PI;
    if swings { (middle_rad - FRAC_PI_2, middle_rad + FRAC_PI_2) } else { ANYWHERE }
}

/// Nothing is known of it.
pub(super) const ANYWHERE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// Nothing off where that may be, else as far as the middle of what may be.
pub(super) fn first_rad((low, high): (f64, f64)) -> f64 {
    if low <= 0.0 && 0.0 <= high { 0.0 } else { 0.5 * (low + high) }
}

/// The same zero without whole turns, within half a turn, rad.
pub fn within_half_a_turn(offset_rad: f64) -> f64 {
    offset_rad - TAU * (offset_rad / TAU).round()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zero_lies_a_quarter_turn_beside_the_middle_of_the_swings_or_nearer() {
        let (low, high) = range_rad(&[24.0, 26.0, 25.5]);
        assert!((low - (25.0 - FRAC_PI_2)).abs() < 1e-12 && (high - (25.0 + FRAC_PI_2)).abs() < 1e-12);
        assert_eq!(first_rad((low, high)), 25.0);
        assert_eq!(first_rad(range_rad(&[-1.4, 1.5])), 0.0);
        // Over the top and on.
        assert_eq!(range_rad(&[0.0, 3.0, 6.0, 9.0]), ANYWHERE);
        assert_eq!(first_rad(ANYWHERE), 0.0);
    }

    #[test]
    fn whole_turns_are_no_error_of_a_zero() {
        assert!((within_half_a_turn(-8.0 * PI + 0.1) - 0.1).abs() < 1e-12);
        assert_eq!([0.3, -3.0].map(within_half_a_turn), [0.3, -3.0]);
    }
}
