//! Numbers that carry their derivatives: the physics run with them gives its sensitivities beside its result.
//!
//! A dual number is a value and its derivatives by up to `N` quantities; every operation follows the chain rule. Since
//! the physics is generic over its number, `Model<Dual<_, N>>` solves the variational equations δx' = ∂f/∂x·δx + ∂f/∂p
//! without being written twice. Where sliding begins or ends, the step is cut at an instant that is itself a dual
//! number; the jump of the sensitivities there, δx⁺ = δx⁻ + (f⁺ − f⁻)·(∇g·δx⁻ + ∂g/∂p)/(∇g·f⁻) with the sign of δt,
//! comes out by itself. At rest the velocity is the constant zero, and so are its derivatives.
//!
//! Choices follow the value alone. A derivative is that of the branch taken, and exists where the branch does not
//! change; where a swing just misses an event (∇g·f⁻ → 0) it grows without bound, as the truth does. Divisions by zero
//! give derivatives of zero instead of no numbers.
//! Source: A. Griewank, A. Walther, Evaluating Derivatives (SIAM, 2008), chapter 3; events: I. A. Hiskens, M. A. Pai,
//! IEEE Trans. Circuits Syst. I 47 (2000) 204.

use crate::real::{Mask as _, Real};
use core::array;
use core::ops::{Add, Div, Mul, Neg, Sub};

/// A value with its derivatives by `N` quantities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<R, const N: usize> {
    /// The value.
    pub value: R,
    /// Its derivatives, in the value's unit over that of each quantity.
    pub slopes: [R; N],
}

impl<R: Real, const N: usize> Dual<R, N> {
    /// A value that depends on none of the quantities.
    #[cfg_attr(not(target_os = "none"), inline(always))]
    pub fn constant(value: R) -> Self {
        Self { value, slopes: [R::zero(); N] }
    }

    /// The quantity with this index, below `N`, itself: its derivative by itself is one.
    pub fn variable(value: R, index: usize) -> Self {
        let slope = |i| if i == index { R::one() } else { R::zero() };
        Self { value, slopes: array::from_fn(slope) }
    }

    /// f(self), given the value and the derivative of f there.
    #[cfg_attr(not(target_os = "none"), inline(always))]
    fn chain(self, value: R, slope: R) -> Self {
        Self { value, slopes: self.slopes.map(|own| slope * own) }
    }

    #[cfg_attr(not(target_os = "none"), inline(always))]
    fn zip(self, other: Self, value: R, slope: impl Fn(R, R) -> R) -> Self {
        Self { value, slopes: array::from_fn(|i| slope(self.slopes[i], other.slopes[i])) }
    }
}

impl<R: Real, const N: usize> Add for Dual<R, N> {
    type Output = Self;
    #[cfg_attr(not(target_os = "none"), inline(always))]
    fn add(self, other: Self) -> Self {
        self.zip(other, self.value + other.value, |a, b| a + b)
    }
}

impl<R: Real, const N: usize> Sub for Dual<R, N> {
    type Output = Self;
    #[cfg_attr(not(target_os = "none"), inline(always))]
    fn sub(self, other: Self) -> Self {
        self.zip(other, self.value - other.value, |a, b| a - b)
    }
}

impl<R: Real, const N: usize> Mul for Dual<R, N> {
    type Output = Self;
    #[cfg_attr(not(target_os = "none"), inline(always))]
    #[allow(clippy::suspicious_arithmetic_impl, reason = "the product rule is a sum")]
    fn mul(self, other: Self) -> Self {
        self.zip(other, self.value * other.value, |a, b| a * other.value + b * self.value)
    }
}

impl<R: Real, const N: usize> Div for Dual<R, N> {
    type Output = Self;
    #[cfg_attr(not(target_os = "none"), inline(always))]
    fn div(self, other: Self) -> Self {
        let ratio = self.value / other.value;
        let inverse = R::one() / other.value;
        let regular = R::zero().lt(other.value.abs());
        self.zip(other, ratio, |a, b| R::select(regular, (a - ratio * b) * inverse, R::zero()))
    }
}

impl<R: Real, const N: usize> Neg for Dual<R, N> {
    type Output = Self;
    #[cfg_attr(not(target_os = "none"), inline(always))]
    fn neg(self) -> Self {
        Self { value: -self.value, slopes: self.slopes.map(|slope| -slope) }
    }
}

impl<R: Real, const N: usize> Real for Dual<R, N> {
    type Mask = R::Mask;

    #[cfg_attr(not(target_os = "none"), inline(always))]
    fn of(value: f64) -> Self {
        Self::constant(R::of(value))
    }
    #[cfg_attr(not(target_os = "none"), inline(always))]
    fn lt(self, other: Self) -> R::Mask {
        self.value.lt(other.value)
    }
    #[cfg_attr(not(target_os = "none"), inline(always))]
    fn le(self, other: Self) -> R::Mask {
        self.value.le(other.value)
    }
    #[cfg_attr(not(target_os = "none"), inline(always))]
    fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        yes.zip(no, R::select(mask, yes.value, no.value), |a, b| R::select(mask, a, b))
    }
    #[cfg_attr(not(target_os = "none"), inline(always))]
    fn abs(self) -> Self {
        Self::select(self.value.lt(R::zero()), -self, self)
    }
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, R::select(R::zero().lt(root), R::of(0.5) / root, R::zero()))
    }
    #[cfg_attr(not(target_os = "none"), inline(always))]
    fn sin(self) -> Self {
        self.chain(self.value.sin(), self.value.cos())
    }
    #[cfg_attr(not(target_os = "none"), inline(always))]
    fn cos(self) -> Self {
        self.chain(self.value.cos(), -self.value.sin())
    }
    #[cfg_attr(not(target_os = "none"), inline(always))]
    fn exp(self) -> Self {
        let value = self.value.exp();
        self.chain(value, value)
    }
    fn ln(self) -> Self {
        let positive = R::zero().lt(self.value);
        self.chain(self.value.ln(), R::select(positive, R::one() / self.value, R::zero()))
    }
    fn powf(self, exponent: Self) -> Self {
        let value = self.value.powf(exponent.value);
        // At zero a power below one rises without bound, and the logarithm falls without bound.
        let positive = R::zero().lt(self.value);
        let bounded = positive.or(R::one().le(exponent.value));
        let by_base = exponent.value * self.value.powf(exponent.value - R::one());
        let by_base = R::select(bounded, by_base, R::zero());
        let by_exponent = R::select(positive, value * self.value.ln(), R::zero());
        self.zip(exponent, value, |a, b| by_base * a + by_exponent * b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// f at (0.7, 1.9), its derivatives against central differences of the same f.
    fn check(name: &str, f: impl Fn(Dual<f64, 2>, Dual<f64, 2>) -> Dual<f64, 2>) {
        const AT: [f64; 2] = [0.7, 1.9];
        const STEP: f64 = 1e-6;
        let dual = f(Dual::variable(AT[0], 0), Dual::variable(AT[1], 1));
        let plain = |x: f64, y: f64| f(Dual::constant(x), Dual::constant(y)).value;
        assert_eq!(dual.value, plain(AT[0], AT[1]), "{name}");
        let by_x = (plain(AT[0] + STEP, AT[1]) - plain(AT[0] - STEP, AT[1])) / (2.0 * STEP);
        let by_y = (plain(AT[0], AT[1] + STEP) - plain(AT[0], AT[1] - STEP)) / (2.0 * STEP);
        for (own, difference) in dual.slopes.iter().zip([by_x, by_y]) {
            assert!((own - difference).abs() < 1e-8, "{name}: {own} {difference}");
        }
    }

    #[test]
    fn every_operation_follows_the_chain_rule() {
        check("sum", |x, y| x + y * y);
        check("difference", |x, y| x * x - y);
        check("ratio", |x, y| x / (y * y));
        check("negative", |x, y| -(x * y));
        check("absolute value", |x, y| (x - y).abs() * x);
        check("square root", |x, y| (x * y).sqrt());
        check("sine", |x, y| (x * y).sin());
        check("cosine", |x, y| (x * y).cos());
        check("exponential", |x, y| (x / y).exp());
        check("logarithm", |x, y| (x / y).ln());
        check("power", |x, y| x.powf(y));
        check("smaller", |x, y| x.min(y) * y);
        check("larger", |x, y| x.max(y) * x);
        check("sign", |x, y| x.sign() * y);
    }

    #[test]
    fn where_a_derivative_does_not_exist_it_is_zero() {
        let zero = Dual::<f64, 1>::variable(0.0, 0);
        let half = Dual::of(0.5);
        for number in [zero.sqrt(), zero.powf(half), zero.ln(), Dual::of(1.0) / zero] {
            assert_eq!(number.slopes, [0.0]);
        }
        assert_eq!(zero.powf(Dual::of(1.0)).slopes, [1.0]);
        assert_eq!(zero.powf(Dual::of(2.0)).slopes, [0.0]);
    }
}
