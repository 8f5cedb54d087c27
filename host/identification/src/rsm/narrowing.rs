//! The next ranges: re-centred on the optimum first, narrower only where the optimum was found inside.
//!
//! A range whose face carries the optimum has probably shut the truth out, so it moves on with its full width. It also
//! narrows if that face is a hard limit, for there is nothing beyond. No range ever leaves its hard limits.

use super::coding::{CodingError, Factor};
use std::ops::RangeInclusive;

/// An optimum at least this far out, in coded units, counts as standing on the face.
const FACE: f64 = 0.999;
/// A range end within this fraction of the width of a hard limit stands on it.
const LIMIT_TOLERANCE: f64 = 1e-9;

/// Why no next ranges could be chosen.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NarrowingError {
    /// Not one value and one pair of limits a factor.
    #[error("{n_factors} factors, but {n_values} values and {n_limits} pairs of limits; give one of each a factor")]
    Count {
        /// Factors given.
        n_factors: usize,
        /// Values of the optimum given.
        n_values: usize,
        /// Pairs of limits given.
        n_limits: usize,
    },
    /// The optimum is not a point of the box.
    #[error("factor {name}: the optimum {coded} lies outside −1 to +1 coded units")]
    Optimum {
        /// The factor.
        name: String,
        /// The value given.
        coded: f64,
    },
    /// The factor to shrink by makes no sense.
    #[error("ranges cannot shrink to {shrink} of their width; expected more than 0, at most 1")]
    Shrink {
        /// The value given.
        shrink: f64,
    },
    /// The hard limits leave no range, or the range has become too narrow to vary anything.
    #[error("the next range cannot be used: {0}")]
    Range(#[from] CodingError),
}

/// The next ranges. `optimum_coded` in the factors' coded units; `limits` in natural units, infinite for none;
/// `shrink` is next width over present width, above 0 and at most 1.
pub fn narrow(
    factors: &[Factor],
    optimum_coded: &[f64],
    limits: &[RangeInclusive<f64>],
    shrink: f64,
) -> Result<Vec<Factor>, NarrowingError> {
    let (n_factors, n_values, n_limits) = (factors.len(), optimum_coded.len(), limits.len());
    if n_factors != n_values || n_factors != n_limits {
        return Err(NarrowingError::Count { n_factors, n_values, n_limits });
    }
    if !(f64::MIN_POSITIVE..=1.0).contains(&shrink) {
        return Err(NarrowingError::Shrink { shrink });
    }
    let parts = factors.iter().zip(optimum_coded).zip(limits);
    parts.map(|((factor, &coded), limits)| next_range(factor, coded, limits, shrink)).collect()
}

fn next_range(
    factor: &Factor,
    coded: f64,
    limits: &RangeInclusive<f64>,
    shrink: f64,
) -> Result<Factor, NarrowingError> {
    if !(-1.0..=1.0).contains(&coded) {
        return Err(NarrowingError::Optimum { name: factor.name().to_string(), coded });
    }
    let shut_out = coded.abs() >= FACE && !face_is_a_limit(factor, coded, limits);
    let half_range = if shut_out { factor.half_range() } else { shrink * factor.half_range() };
    let (low, high) = within(limits, factor.natural(coded), half_range);
    Ok(Factor::new(factor.name(), low, high)?)
}

fn face_is_a_limit(factor: &Factor, coded: f64, limits: &RangeInclusive<f64>) -> bool {
    let tolerance = LIMIT_TOLERANCE * factor.half_range();
    if coded > 0.0 { factor.high() >= limits.end() - tolerance } else { factor.low() <= limits.start() + tolerance }
}

/// A range about the centre, pushed back between the limits with its width kept if there is room for it.
fn within(limits: &RangeInclusive<f64>, centre: f64, half_range: f64) -> (f64, f64) {
    let (low, high) = (centre - half_range, centre + half_range);
    if low < *limits.start() {
        (*limits.start(), (limits.start() + 2.0 * half_range).min(*limits.end()))
    } else if high > *limits.end() {
        ((limits.end() - 2.0 * half_range).max(*limits.start()), *limits.end())
    } else {
        (low, high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const NO_LIMITS: RangeInclusive<f64> = f64::NEG_INFINITY..=f64::INFINITY;

    fn check(coded: f64, limits: RangeInclusive<f64>, expected: (f64, f64)) {
        let factor = Factor::new("x", 10.0, 20.0).unwrap();
        let next = narrow(&[factor], &[coded], &[limits], 0.5).unwrap().remove(0);
        assert!((next.low() - expected.0).abs() < 1e-9 && (next.high() - expected.1).abs() < 1e-9, "{next:?}");
    }

    #[test]
    fn an_optimum_inside_is_closed_in_on() {
        check(0.2, NO_LIMITS, (13.5, 18.5));
    }

    #[test]
    fn an_optimum_on_a_face_is_followed_with_the_full_width() {
        check(1.0, NO_LIMITS, (15.0, 25.0));
        check(-1.0, NO_LIMITS, (5.0, 15.0));
    }

    #[test]
    fn an_optimum_on_a_hard_limit_is_closed_in_on_from_within() {
        check(-1.0, 10.0..=f64::INFINITY, (10.0, 15.0));
    }

    #[test]
    fn a_range_is_pushed_back_inside_its_limits() {
        check(0.9, 0.0..=21.0, (16.0, 21.0));
        check(1.0, 18.0..=21.0, (18.0, 21.0));
    }

    #[test]
    fn impossible_requests_are_refused() {
        let factor = [Factor::new("x", 10.0, 20.0).unwrap()];
        let refused = |coded: f64, limits: RangeInclusive<f64>, shrink: f64| {
            narrow(&factor, &[coded], &[limits], shrink).unwrap_err()
        };
        assert!(matches!(refused(1.5, NO_LIMITS, 0.5), NarrowingError::Optimum { .. }));
        assert!(matches!(refused(f64::NAN, NO_LIMITS, 0.5), NarrowingError::Optimum { .. }));
        assert!(matches!(refused(0.0, NO_LIMITS, 0.0), NarrowingError::Shrink { .. }));
        assert!(matches!(refused(0.0, NO_LIMITS, f64::NAN), NarrowingError::Shrink { .. }));
        assert!(matches!(refused(0.0, 15.0..=15.0, 0.5), NarrowingError::Range(_)));
        assert!(matches!(refused(0.0, RangeInclusive::new(30.0, 0.0), 0.5), NarrowingError::Range(_)));
        let counted = narrow(&factor, &[0.0, 0.0], &[], 0.5).unwrap_err().to_string();
        assert!(counted.starts_with("1 factors, but 2 values and 0 pairs of limits"), "{counted}");
    }

    proptest! {
        #[test]
        fn the_next_range_stays_within_limits_and_holds_the_optimum(
            coded in -1.0..=1.0, low in -5.0..10.0, high in 20.0..40.0, shrink in 0.1..1.0,
        ) {
            let factor = Factor::new("x", 10.0, 20.0).unwrap();
            let best = factor.natural(coded);
            let next = narrow(&[factor], &[coded], &[low..=high], shrink).unwrap().remove(0);
            prop_assert!(next.low() >= low && next.high() <= high);
            prop_assert!(next.coded(best).abs() <= 1.0 + 1e-9);
            prop_assert!(next.half_range() <= 5.0 + 1e-9);
        }
    }
}
