//! What carries the pendulum, an arm or a cart, as another column of the file tells it: held fast it takes no energy.
//!
//! In: the numbers of such a column, one a sample, and those of the pendulum in the same unit. Out: whether it moves where
//! the pendulum swings. Beside the bearing of a pendulum that of an arm with its motor rubs many times as much, so that
//! little motion of the arm is much of what the swings lose.

use super::limits::HARDLY;
use super::noise::smallest_step;
use std::ops::Range;

/// What rolls before it stands goes so many times as far as it then trembles. Half and twice were not tried.
const FAR: f64 = 5.0;

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

    /// The first sample of a range from which on it stands, where that is within the first samples of the range and it moved before.
    pub(super) fn stands_from(&self, range: &Range<usize>, n_first: usize, angles_rad: &[f64]) -> Option<usize> {
        let (first, behind) = (range.start..range.start + n_first, range.start + n_first..range.end);
        let (low, high) = ends_of_nearly_all(self.values.get(behind.clone())?);
        let (least, most) = ends(&angles_rad[range.clone()]);
        let trembles = high - low + smallest_step(&self.values).unwrap_or(0.0);
        let off = |idx: usize| (low - self.values[idx]).max(self.values[idx] - high);
        let moved = first.clone().map(off).fold(0.0, f64::max);
        let has_moved = moved > (FAR * trembles).max(HARDLY * self.per_rad * (most - least));
        let is_standing = self.within(&behind, &angles_rad[behind.clone()]).is_none();
        first.rev().find(|idx| off(*idx) > trembles).filter(|_| is_standing && has_moved).map(|last| last + 1)
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

    /// Pushed by 25 mm, it stops after a quarter of a second, and trembles by 0.2 mm as the pendulum swings on it.
    #[test]
    fn a_cart_stands_where_it_has_come_to_rest_and_one_that_rolls_on_does_not() {
        let angles_rad: Vec<f64> = (0..1000).map(|idx| 0.8 * (f64::from(idx) / 10.0).cos()).collect();
        let cart = |stops_at: u32| {
            let place = |idx: u32| match idx {
                idx if idx < stops_at => 0.025 * (1.0 - f64::from(idx) / f64::from(stops_at)).powi(2),
                _ => 1e-4 * (f64::from(idx) / 10.0).cos(),
            };
            Carrier::new("3 (CartPos)".to_owned(), (0..1000).map(place).collect(), 1.0)
        };
        let stands = |stops_at: u32| cart(stops_at).stands_from(&(0..1000), 60, &angles_rad);
        // It is nearly there before.
        assert!((20..=26).contains(&stands(26).unwrap()), "{:?}", stands(26));
        assert_eq!([stands(0), stands(900)], [None, None]);
        let (standing, pulled) = (cart(0), |idx: u32| 0.02 * (f64::from(idx) / 10.0).cos());
        assert_eq!(standing.stands_from(&(500..1000), 60, &angles_rad), None);
        let pulled = Carrier::new(String::new(), (0..1000).map(pulled).collect(), 1.0);
        assert_eq!(pulled.stands_from(&(0..1000), 60, &angles_rad), None);
        let by_steps = (0..1000).map(|idx| -0.8204 + 6e-5 * f64::from(3 - (idx / 10).min(3))).collect();
        let by_steps = Carrier::new(String::new(), by_steps, 1.0);
        assert_eq!(by_steps.stands_from(&(0..1000), 60, &angles_rad), None);
    }

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
