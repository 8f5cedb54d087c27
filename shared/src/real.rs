//! The number the physics is written in: `f32` on the board, `f64` on the PC, several `f64` lanes at once for sweeps.
//!
//! Comparisons give masks and choices are [`Real::select`]s, so that one formula serves one lane or many.
//! The sine is a polynomial of our own: the same bits on board and PC, 20 times faster on the board than libm's and
//! 300 times more precise than micromath's.

use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Neg, Sub};
use functions::{exp_f64, ln_f64, pow_f64, sin_f32, sin_f64};

mod functions;

/// The outcome of a comparison, one truth value a lane.
pub trait Mask: Copy {
    /// Is it true in at least one lane?
    fn any(self) -> bool;
    /// Is it true in every lane?
    fn all(self) -> bool;
    /// True where both are true.
    fn and(self, other: Self) -> Self;
    /// True where at least one is true.
    fn or(self, other: Self) -> Self;
    /// True where this is false.
    fn not(self) -> Self;

    /// May it be true in some lane? Only for leaving out what would change nothing: a formula that is written down
    /// rather than worked out can't know, and says yes.
    #[inline(always)]
    fn may_be(self) -> bool {
        self.any()
    }
    /// True where both are true; the other one is only worked out if it matters.
    #[inline(always)]
    fn and_then(self, other: impl FnOnce() -> Self) -> Self {
        if self.may_be() { self.and(other()) } else { self }
    }
}

impl Mask for bool {
    fn any(self) -> bool {
        self
    }
    fn all(self) -> bool {
        self
    }
    fn and(self, other: bool) -> bool {
        self & other
    }
    fn or(self, other: bool) -> bool {
        self | other
    }
    fn not(self) -> bool {
        !self
    }
}

/// A real number, or several side by side.
pub trait Real:
    Copy
    + Debug
    + PartialEq
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// What a comparison gives.
    type Mask: Mask;

    /// The constant `value` in every lane.
    fn of(value: f64) -> Self;
    /// `self < other`.
    fn lt(self, other: Self) -> Self::Mask;
    /// `yes` where the mask is true, `no` elsewhere.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// The absolute value.
    fn abs(self) -> Self;
    /// The square root; of a non-negative number.
    fn sqrt(self) -> Self;
    /// The sine of an angle in radians, |angle| < 1e4. Absolute error below 2e-7 in `f32`, 5e-16 in `f64`.
    fn sin(self) -> Self;
    /// The exponential function. Relative error below 2e-7 in `f32`, 5e-16 in `f64`.
    fn exp(self) -> Self;
    /// The natural logarithm; of a positive number. Absolute error below 2e-7·(1 + |ln|) in `f32`, 5e-16·(1 + |ln|) in
    /// `f64`.
    fn ln(self) -> Self;
    /// `self` to the power `exponent`; of a non-negative number.
    fn powf(self, exponent: Self) -> Self;

    /// Zero.
    fn zero() -> Self {
        Self::of(0.0)
    }
    /// One.
    fn one() -> Self {
        Self::of(1.0)
    }
    /// The cosine; range and error as for [`Real::sin`].
    fn cos(self) -> Self {
        (self + Self::of(core::f64::consts::FRAC_PI_2)).sin()
    }
    /// `self <= other`, false where one is not a number.
    fn le(self, other: Self) -> Self::Mask {
        self.lt(other).or(other.lt(self).not()).and(self.is_number()).and(other.is_number())
    }
    /// False for NaN.
    fn is_number(self) -> Self::Mask {
        self.lt(Self::zero()).or(Self::zero().lt(self)).or((self * self).lt(Self::one()))
    }
    /// The smaller of two.
    fn min(self, other: Self) -> Self {
        Self::select(other.lt(self), other, self)
    }
    /// The larger of two.
    fn max(self, other: Self) -> Self {
        Self::select(self.lt(other), other, self)
    }
    /// Of rows in the rising order of their first numbers, the last one whose first number is not above this; the first
    /// one if there is none. There must be one.
    fn row<const N: usize>(self, rows: &[[Self; N]]) -> [Self; N] {
        let mut found = rows[0];
        for row in &rows[1..] {
            let reached = row[0].le(self);
            found = core::array::from_fn(|i| Self::select(reached, row[i], found[i]));
        }
        found
    }
    /// −1, 0 or +1.
    fn sign(self) -> Self {
        let negative = Self::select(self.lt(Self::zero()), Self::of(-1.0), Self::zero());
        Self::select(Self::zero().lt(self), Self::one(), negative)
    }
}

macro_rules! scalar {
    ($float:ty, $sin:ident, $sqrt:path, $exp:path, $ln:path, $pow:path) => {
        impl Real for $float {
            type Mask = bool;
            #[inline(always)]
            fn of(value: f64) -> Self {
                value as $float
            }
            #[inline(always)]
            fn lt(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn le(self, other: Self) -> bool {
                self <= other
            }
            #[inline(always)]
            fn select(mask: bool, yes: Self, no: Self) -> Self {
                if mask { yes } else { no }
            }
            #[inline(always)]
            fn abs(self) -> Self {
                <$float>::abs(self)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                $sqrt(self)
            }
            #[inline(always)]
            fn sin(self) -> Self {
                $sin(self)
            }
            #[inline(always)]
            fn exp(self) -> Self {
                $exp(self)
            }
            #[inline(always)]
            fn ln(self) -> Self {
                $ln(self)
            }
            #[inline(always)]
            fn powf(self, exponent: Self) -> Self {
                $pow(self, exponent)
            }
            #[inline]
            fn row<const N: usize>(self, rows: &[[Self; N]]) -> [Self; N] {
                rows[rows.partition_point(|row| row[0] <= self).saturating_sub(1)]
            }
        }
    };
}

scalar!(f64, sin_f64, libm::sqrt, exp_f64, ln_f64, pow_f64);
scalar!(f32, sin_f32, libm::sqrtf, libm::expf, libm::logf, libm::powf);

#[cfg(test)]
mod tests {
    use super::*;

    fn worst_sine_error(range: f64, sine: impl Fn(f64) -> f64) -> f64 {
        (-100_000..=100_000).map(|i| i as f64 * range / 1e5).map(|x| (sine(x) - libm::sin(x)).abs()).fold(0.0, f64::max)
    }

    #[test]
    #[cfg_attr(miri, ignore = "too long for an interpreter")]
    fn the_sine_is_as_precise_as_promised() {
        assert!(worst_sine_error(4.0, Real::sin) < 5e-16);
        assert!(worst_sine_error(1e4, Real::sin) < 1e-15);
        // The f32 sine is compared at the f32 nearest to x, so that only its own error counts.
        let worst = worst_sine_error(4.0, |x| {
            let near = x as f32;
            f64::from(Real::sin(near)) + (x - f64::from(near)) * libm::cos(x)
        });
        assert!(worst < 2e-7, "{worst:e}");
    }

    #[test]
    fn the_cosine_is_the_sine_a_quarter_turn_later() {
        for i in -40..40 {
            let x = f64::from(i) * 0.1;
            assert!((Real::cos(x) - libm::cos(x)).abs() < 1e-15);
        }
    }

    #[test]
    fn comparisons_with_nan_are_false() {
        assert!(!Real::lt(f64::NAN, 1.0) && !Real::le(f64::NAN, 1.0) && !Real::le(1.0, f64::NAN));
        assert!(!f64::NAN.is_number() && 3.0_f64.is_number() && 0.0_f32.is_number() && (-1e30_f32).is_number());
    }
}
