//! What carries the pendulum, an arm or a cart, as another column of the file tells it: held fast it takes no energy.
//!
//! In: the numbers of such a column, one a sample, and those of the pendulum in the same unit. Out: whether it moves where
//! the pendulum swings. Beside the bearing of a pendulum that of an arm with its motor rubs many times as much, so that
//! little motion of the arm is much of what the swings lose.

use super::limits::HARDLY;
use super::noise::smallest_step;
use std::ops::Range;

/// A column of what carries the pendulum.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Carrier {
    /// What messages call it.
    pub(super) column: String,
    values: Vec<f64>,
    /// Radians of the pendulum are so much in the unit of the column.
    per_rad: f64,
}

impl Carrier {
    /// Of a column of as many numbers as there are samples, NaN where it says none.
    pub(super) fn new(column: String, values: Vec<f64>, per_rad: f64) -> Self {
        Self { column, values, per_rad }
    }

    /// The same of a part of the samples.
    pub(super) fn part(&self, range: Range<usize>) -> Option<Self> {
        Some(Self { values: self.values.get(range)?.to_vec(), column: self.column.clone(), ..*self })
    }

    /// Smallest and largest number within a range in which the pendulum reads these angles; `None` where it hardly moves
    /// beside the pendulum, or trembles by a step of its sensor.
    pub(super) fn within(&self, range: &Range<usize>, angles_rad: &[f64]) -> Option<(f64, f64)> {
        let values = self.values.get(range.clone())?;
        let (low, high) = ends_of_nearly_all(values);
        let (least, most) = ends(angles_rad);
        let moved = high - low - smallest_step(values).unwrap_or(0.0);
        (moved > HARDLY * self.per_rad * (most - least)).then_some((low, high))
    }
}

fn ends(values: &[f64]) -> (f64, f64) {
    let known = values.iter().filter(|value| value.is_finite());
    known.fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(*value), high.max(*value)))
}

/// Without the hundredth at either end: a counter that is set to zero where the motor lets go has moved nothing.
fn ends_of_nearly_all(values: &[f64]) -> (f64, f64) {
    let mut known: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    known.sort_unstable_by(f64::total_cmp);
    let left_out = known.len() / 100;
    ends(&known[left_out..known.len() - left_out])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arm_that_is_held_trembles_by_a_step_and_one_that_is_loose_swings_too() {
        let angles_rad: Vec<f64> = (0..1000).map(|idx| 0.5 * (f64::from(idx) / 20.0).sin()).collect();
        let degrees = |size: f64, step: f64| {
            let values = angles_rad.iter().map(|angle| (size * angle.to_degrees() / step).round() * step).collect();
            Carrier::new("2 (arm_deg)".to_owned(), values, 1f64.to_degrees())
        };
        let moves = |carrier: Carrier| carrier.within(&(0..1000), &angles_rad).is_some();
        assert!(moves(degrees(0.03, 0.01)) && moves(degrees(0.03, 0.1)));
        assert!(!moves(degrees(0.003, 0.01)) && !moves(degrees(0.003, 0.1)) && !moves(degrees(0.0, 0.1)));
        let reset = (0..1000).map(|idx| if idx < 4 { -986.0 } else { 5.5 }).collect();
        assert!(!moves(Carrier::new(String::new(), reset, 1f64.to_degrees())));
        let flicker = (0..1000).map(|idx| if idx % 7 == 0 { 0.4 } else { 0.0 }).collect();
        assert!(!moves(Carrier::new(String::new(), flicker, 1f64.to_degrees())));
        assert!(!moves(Carrier::new(String::new(), vec![f64::NAN; 1000], 1.0)));
        assert_eq!(degrees(0.1, 1.0).part(0..30).unwrap().within(&(0..30), &angles_rad[..30]), Some((0.0, 3.0)));
    }
}
