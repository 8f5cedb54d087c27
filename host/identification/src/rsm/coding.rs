//! Coded units: a factor's range, low to high, becomes −1 to +1.
//!
//! Regression is done in coded units only: the paper's five-factor quadratic has a condition number of 9e9 in natural
//! units and of 7 in coded units.

use serde::Serialize;

/// The narrowest range relative to its ends that can still be told from rounding.
const NARROWEST_RELATIVE_RANGE: f64 = 1e-9;

/// One factor with the range it is varied over; the range is known to be usable.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Factor {
    name: String,
    low: f64,
    high: f64,
}

/// Why a range cannot be coded.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CodingError {
    /// A factor needs a name to be told from the others.
    #[error("a factor with range {low} to {high} has no name")]
    NoName {
        /// Low end as given.
        low: f64,
        /// High end as given.
        high: f64,
    },
    /// One end is NaN or infinite, or the ends are too far apart to subtract.
    #[error("factor {name}: the range {low} to {high} is not finite")]
    NotFinite {
        /// The factor.
        name: String,
        /// Low end as given.
        low: f64,
        /// High end as given.
        high: f64,
    },
    /// The low end is above the high end.
    #[error("factor {name}: the range {low} to {high} is reversed; give the low end first")]
    Reversed {
        /// The factor.
        name: String,
        /// Low end as given.
        low: f64,
        /// High end as given.
        high: f64,
    },
    /// The ends are equal or differ by hardly more than rounding.
    #[error("factor {name}: the range {low} to {high} is empty or too narrow; widen it or hold the factor fixed")]
    TooNarrow {
        /// The factor.
        name: String,
        /// Low end as given.
        low: f64,
        /// High end as given.
        high: f64,
    },
}

impl Factor {
    /// A factor varied from `low` to `high`, in the factor's own unit; both finite, `low` below `high`.
    pub fn new(name: impl Into<String>, low: f64, high: f64) -> Result<Self, CodingError> {
        let name = name.into();
        if name.is_empty() {
            return Err(CodingError::NoName { low, high });
        }
        if !(high - low).is_finite() {
            return Err(CodingError::NotFinite { name, low, high });
        }
        if low > high {
            return Err(CodingError::Reversed { name, low, high });
        }
        if !(high - low).is_normal() || high - low < NARROWEST_RELATIVE_RANGE * low.abs().max(high.abs()) {
            return Err(CodingError::TooNarrow { name, low, high });
        }
        Ok(Self { name, low, high })
    }

    /// The name, as in tables and term names.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The natural value at coded −1.
    pub fn low(&self) -> f64 {
        self.low
    }

    /// The natural value at coded +1.
    pub fn high(&self) -> f64 {
        self.high
    }

    /// The natural value at coded 0.
    pub fn centre(&self) -> f64 {
        0.5 * self.low + 0.5 * self.high
    }

    /// Natural units per coded unit; always positive.
    pub fn half_range(&self) -> f64 {
        0.5 * (self.high - self.low)
    }

    /// Natural to coded; exactly ±1 at the ends, beyond ±1 outside the range.
    pub fn coded(&self, natural: f64) -> f64 {
        ((natural - self.low) - (self.high - natural)) / (self.high - self.low)
    }

    /// Coded to natural; exactly `low` and `high` at ∓1.
    pub fn natural(&self, coded: f64) -> f64 {
        0.5 * (1.0 - coded) * self.low + 0.5 * (1.0 + coded) * self.high
    }
}

/// A point of natural values in coded units; one value a factor.
pub fn coded_point(factors: &[Factor], natural: &[f64]) -> Vec<f64> {
    factors.iter().zip(natural).map(|(factor, &value)| factor.coded(value)).collect()
}

/// A point of coded values in natural units; one value a factor.
pub fn natural_point(factors: &[Factor], coded: &[f64]) -> Vec<f64> {
    factors.iter().zip(coded).map(|(factor, &value)| factor.natural(value)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_ends_of_a_range_are_exactly_one_coded_unit_from_its_centre() {
        let viscous = Factor::new("Mw", 0.00052, 0.00056).unwrap();
        assert_eq!(viscous.coded(0.00052), -1.0);
        assert_eq!(viscous.coded(0.00056), 1.0);
        assert_eq!(viscous.natural(-1.0), 0.00052);
        assert_eq!(viscous.natural(1.0), 0.00056);
    }

    #[test]
    fn unusable_ranges_are_refused_with_their_reason() {
        let reversed = Factor::new("Mw", 2.0, 1.0).unwrap_err().to_string();
        assert!(reversed.contains("the range 2 to 1 is reversed"), "{reversed}");
        assert!(matches!(Factor::new("Mw", f64::NAN, 1.0), Err(CodingError::NotFinite { .. })));
        assert!(matches!(Factor::new("Mw", 0.0, f64::INFINITY), Err(CodingError::NotFinite { .. })));
        assert!(matches!(Factor::new("Mw", -f64::MAX, f64::MAX), Err(CodingError::NotFinite { .. })));
        assert!(matches!(Factor::new("Mw", 1.0, 1.0), Err(CodingError::TooNarrow { .. })));
        assert!(matches!(Factor::new("Mw", 0.0, 1e-310), Err(CodingError::TooNarrow { .. })));
        assert!(matches!(Factor::new("", 0.0, 1.0), Err(CodingError::NoName { .. })));
    }

    proptest! {
        #[test]
        fn coding_there_and_back_changes_nothing(low in -1e3..1e3, width in 1e-3..1e3, coded in -1.5..1.5) {
            let factor = Factor::new("x", low, low + width).unwrap();
            let back = factor.coded(factor.natural(coded));
            // One rounding of the natural value is worth eps·|value|/half_range coded units.
            prop_assert!((back - coded).abs() < 1e-8, "{coded} came back as {back}");
        }
    }
}
