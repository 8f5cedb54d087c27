//! Sine, exponential and power: short formulas without branches, so that several lanes share their instructions.
//!
//! The `f32` ones of the board are this sine and the libm crate's exponential and power, which give the same bits on
//! every machine. The `f64` ones are measured against libm in the tests below.

/// Sine by reduction to ±π/2 and an odd polynomial. π is split so that `n·π` is exact in its leading parts (Cody and
/// Waite).
macro_rules! sine {
    ($name:ident, $float:ty, $bits:ty, magic $magic:expr, sign $shift:expr, pi [$($pi:expr),+], odd $odd:path) => {
        #[inline(always)]
        pub(super) fn $name(angle: $float) -> $float {
            // Adding the magic number rounds to the nearest integer and leaves its parity in the lowest bit.
            let shifted = angle * (core::f64::consts::FRAC_1_PI as $float) + $magic;
            let half_turns = shifted - $magic;
            let flip = shifted.to_bits() << $shift;
            let rest = angle $(- half_turns * $pi)+;
            <$float>::from_bits($odd(rest).to_bits() ^ (flip as $bits))
        }
    };
}

/// Minimax coefficients of `(sin x − x)/x³` in x² over ±π/2 for the smallest absolute error of the sine, 1.1e-16, by
/// the Remez algorithm at 60 digits. A Taylor series as good needs ten.
const SINE_F64: [f64; 7] = [
    -0.166_666_666_666_658_1,
    0.008_333_333_333_262_88,
    -0.000_198_412_698_200_942_1,
    2.755_731_607_700_771_6e-6,
    -2.505_185_149_719_714_6e-8,
    1.604_730_119_667_190_3e-10,
    -7.364_646_450_052_459e-13,
];

/// Taylor coefficients −1/3!, 1/5!, …: enough for `f32`.
const SINE_F32: [f32; 5] = [
    (-1.0_f64 / 6.0) as f32,
    (1.0_f64 / 120.0) as f32,
    (-1.0_f64 / 5040.0) as f32,
    (1.0_f64 / 362_880.0) as f32,
    (-1.0_f64 / 39_916_800.0) as f32,
];

/// Terms are paired (Estrin) so that the multiplications overlap: a step waits for its sines, not for their number.
#[inline(always)]
fn odd_f64(x: f64) -> f64 {
    let c = &SINE_F64;
    let x2 = x * x;
    let x4 = x2 * x2;
    let low = (c[0] + c[1] * x2) + (c[2] + c[3] * x2) * x4;
    let high = (c[4] + c[5] * x2) + c[6] * x4;
    x + x * x2 * (low + high * (x4 * x4))
}

#[inline(always)]
fn odd_f32(x: f32) -> f32 {
    let c = &SINE_F32;
    let x2 = x * x;
    let x4 = x2 * x2;
    x + x * x2 * ((c[4] * x4 + (c[2] + c[3] * x2)) * x4 + (c[0] + c[1] * x2))
}

/// The first part has 40 bits: exact times any integer of 13 bits, so up to angles of 2.5e4.
const PI_F64: [f64; 2] = [3.141_592_653_588_304_5, 1.488_709_496_097_324_6e-12];
const PI_F32: [f32; 3] = [3.140_625, 9.675_026e-4, 1.509_958e-7];

sine!(sin_f64, f64, u64, magic MAGIC, sign 63, pi [PI_F64[0], PI_F64[1]], odd odd_f64);
sine!(sin_f32, f32, u32, magic 12_582_912.0, sign 31, pi [PI_F32[0], PI_F32[1], PI_F32[2]], odd odd_f32);

/// ln 2, its first part with 40 bits, so that its product with an exponent is exact.
const LN2: [f64; 2] = [0.693_147_180_559_208_2, 7.371_002_565_167_799e-13];

/// Below this the exponential is taken as zero, from the second on as infinite; the exponent of an `f64` ends there.
const EXP_RANGE: [f64; 2] = [-708.0, 709.7];

/// 1/n!, from n = 2 to 13.
const EXP_TAYLOR: [f64; 12] = [
    0.5,
    1.0 / 6.0,
    1.0 / 24.0,
    1.0 / 120.0,
    1.0 / 720.0,
    1.0 / 5040.0,
    1.0 / 40_320.0,
    1.0 / 362_880.0,
    1.0 / 3_628_800.0,
    1.0 / 39_916_800.0,
    1.0 / 479_001_600.0,
    1.0 / 6_227_020_800.0,
];

/// e^x by reduction to |rest| ≤ ln 2 / 2 and a Taylor series. Relative error below 5e-16.
#[inline(always)]
pub(super) fn exp_f64(x: f64) -> f64 {
    let low = if x < EXP_RANGE[0] { EXP_RANGE[0] } else { x };
    let inside = if low > EXP_RANGE[1] { EXP_RANGE[1] } else { low };
    let shifted = inside * core::f64::consts::LOG2_E + MAGIC;
    let doublings = shifted - MAGIC;
    let r = (inside - doublings * LN2[0]) - doublings * LN2[1];
    let c = &EXP_TAYLOR;
    let r2 = r * r;
    let r4 = r2 * r2;
    let first = (c[0] + c[1] * r) + (c[2] + c[3] * r) * r2;
    let second = (c[4] + c[5] * r) + (c[6] + c[7] * r) * r2;
    let third = (c[8] + c[9] * r) + (c[10] + c[11] * r) * r2;
    let value = 1.0 + (r + r2 * (first + r4 * (second + r4 * third)));
    // The lowest bits of `shifted` are the number of doublings; moved up they are an exponent.
    let power = f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52);
    // A factor, where a choice would become a branch and keep lanes apart.
    let exists = if x < EXP_RANGE[0] { 0.0 } else { 1.0 };
    value * power * exists
}

/// 2/(2n + 1), from n = 1 to 10: the series of ln((1 + s)/(1 − s))/s.
const LN_SERIES: [f64; 10] = [
    2.0 / 3.0,
    2.0 / 5.0,
    2.0 / 7.0,
    2.0 / 9.0,
    2.0 / 11.0,
    2.0 / 13.0,
    2.0 / 15.0,
    2.0 / 17.0,
    2.0 / 19.0,
    2.0 / 21.0,
];

/// The natural logarithm of a positive normal number.
#[inline(always)]
pub(super) fn ln_f64(x: f64) -> f64 {
    let bits = x.to_bits();
    // An integer below 2^52 in the lowest bits of 2^52 is that number plus 2^52.
    let exponent = f64::from_bits((bits >> 52) | TWO_52.to_bits()) - (TWO_52 + 1023.0);
    let mantissa = f64::from_bits((bits & (u64::MAX >> 12)) | 1.0_f64.to_bits());
    let large = mantissa > core::f64::consts::SQRT_2;
    let m = if large { 0.5 * mantissa } else { mantissa };
    let doublings = if large { exponent + 1.0 } else { exponent };
    let s = (m - 1.0) / (m + 1.0);
    let s2 = s * s;
    let s4 = s2 * s2;
    let c = &LN_SERIES;
    let first = (c[0] + c[1] * s2) + (c[2] + c[3] * s2) * s4;
    let second = (c[4] + c[5] * s2) + (c[6] + c[7] * s2) * s4;
    let series = first + (second + (c[8] + c[9] * s2) * (s4 * s4)) * (s4 * s4);
    doublings * LN2[0] + (2.0 * s + (s * s2 * series + doublings * LN2[1]))
}

/// x^exponent = e^(exponent·ln x) of a non-negative number. Relative error below 5e-16·(1 + |exponent·ln x|).
#[inline(always)]
pub(super) fn pow_f64(x: f64, exponent: f64) -> f64 {
    let power = exp_f64(exponent * ln_f64(x));
    let of_zero = if exponent > 0.0 { 0.0 } else { f64::INFINITY };
    // Negative numbers and NaN have no power here.
    let of_rest = if x == 0.0 { of_zero } else { f64::NAN };
    let of_any = if x > 0.0 { power } else { of_rest };
    if exponent == 0.0 { 1.0 } else { of_any }
}

const MAGIC: f64 = 6_755_399_441_055_744.0;
const TWO_52: f64 = 4_503_599_627_370_496.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg_attr(miri, ignore = "too long for an interpreter")]
    fn the_exponential_is_as_precise_as_promised() {
        for i in -700_000..=700_000 {
            let x = f64::from(i) * 1e-3;
            let error = (exp_f64(x) / libm::exp(x) - 1.0).abs();
            assert!(error < 5e-16, "{x}: {error:e}");
        }
        assert_eq!((exp_f64(0.0), exp_f64(-1e9), exp_f64(f64::NEG_INFINITY)), (1.0, 0.0, 0.0));
        assert!(exp_f64(1e9).is_infinite() && exp_f64(f64::NAN).is_nan());
    }

    #[test]
    #[cfg_attr(miri, ignore = "too long for an interpreter")]
    fn the_logarithm_is_as_precise_as_promised() {
        for i in -700_000..=700_000 {
            let x = libm::exp(f64::from(i) * 1e-3);
            let error = (ln_f64(x) - libm::log(x)).abs();
            assert!(error < 5e-16 * (1.0 + libm::log(x).abs()), "{x:e}: {error:e}");
        }
    }

    #[test]
    #[cfg_attr(miri, ignore = "too long for an interpreter")]
    fn the_power_is_as_precise_as_promised() {
        for i in 1..=2000 {
            for exponent in [-1.5, 0.25, 1.0, 2.0, 2.5, 4.0] {
                let x = f64::from(i) * f64::from(i) * 1e-5;
                let error = (pow_f64(x, exponent) / libm::pow(x, exponent) - 1.0).abs();
                let promised = 5e-16 * (1.0 + (exponent * libm::log(x)).abs());
                assert!(error < promised, "{x}^{exponent}: {error:e}");
            }
        }
        assert_eq!((pow_f64(0.0, 0.5), pow_f64(0.0, 0.0), pow_f64(3.0, 0.0)), (0.0, 1.0, 1.0));
        assert!(pow_f64(0.0, -1.0).is_infinite() && pow_f64(f64::NAN, 2.0).is_nan());
    }
}
