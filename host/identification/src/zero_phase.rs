//! Zero-phase Butterworth filtering: the board's filter run forwards and backwards, so that nothing is delayed.
//!
//! Model and measurement pass through the same filter before their velocities are compared.

use shared::filter::{Butterworth, FilterState};
use shared::real::Real;

/// Filters evenly sampled values; a cut-off the rate does not allow leaves them as they are.
pub fn filter<R: Real>(values: &[R], cutoff_hz: f64, rate_hz: f64) -> Vec<R> {
    let Some(filter) = Butterworth::new(R::of(cutoff_hz), R::of(rate_hz)) else {
        return values.to_vec();
    };
    let Some((first, last)) = values.first().zip(values.last()) else {
        return Vec::new();
    };
    let mut state = FilterState::settled_at(*first);
    let mut out: Vec<R> = values.iter().map(|value| state.step(&filter, *value)).collect();
    let mut state = FilterState::settled_at(*last);
    out.iter_mut().rev().for_each(|value| *value = state.step(&filter, *value));
    out
}

/// Central differences of evenly sampled values, one-sided at the ends; per second.
pub fn derivative<R: Real>(values: &[R], rate_hz: f64) -> impl Iterator<Item = R> {
    let last = values.len().saturating_sub(1);
    let slope = move |i: usize| {
        let (from, to) = (i.saturating_sub(1), (i + 1).min(last));
        if to == from { R::zero() } else { (values[to] - values[from]) * R::of(rate_hz) / R::of((to - from) as f64) }
    };
    (0..values.len()).map(slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slow_sine_passes_without_delay() {
        let sine: Vec<f64> = (0..4000).map(|i| (f64::from(i) * 0.006).sin()).collect();
        let filtered = filter(&sine, 10.0, 1000.0);
        let worst = (500..3500).map(|i| (filtered[i] - sine[i]).abs()).fold(0.0, f64::max);
        assert!(worst < 2e-4, "{worst}");
    }

    #[test]
    fn the_derivative_of_a_line_is_its_slope() {
        let line: Vec<f64> = (0..10).map(|i| f64::from(i) * 0.5).collect();
        assert!(derivative(&line, 4.0).all(|slope: f64| (slope - 2.0).abs() < 1e-12));
        assert_eq!(derivative(&[1.0], 4.0).collect::<Vec<f64>>(), [0.0]);
    }
}
