//! Numbers for a person: as many digits as mean something.

/// Numbers outside these powers of ten are written with an exponent.
const PLAIN_EXPONENTS: std::ops::RangeInclusive<i32> = -2..=3;

/// Without a spread so many digits are shown.
const USUAL_DIGITS: i32 = 4;

/// Beyond that nobody counts noises: readings as smooth as that were filtered.
const MOST_NOISES: f64 = 1000.0;

/// Of a smaller angle two decimals are less than two digits, rad.
const SMALL_RAD: f64 = 0.1;

/// An error as a multiple of the noise: `1.03`, `25.4`, `852`, `more than 1000`.
pub fn noises(ratio: f64) -> String {
    match ratio {
        _ if ratio > MOST_NOISES => format!("more than {MOST_NOISES:.0}"),
        _ if ratio >= 100.0 => format!("{ratio:.0}"),
        _ if ratio >= 10.0 => format!("{ratio:.1}"),
        _ => format!("{ratio:.2}"),
    }
}

/// `(5.40041 ± 0.00032)e-4`: two digits of the standard deviation, and the value as far; `5.400e-4` without one.
pub fn with_spread(value: f64, std: Option<f64>) -> String {
    let std = std.filter(|std| std.is_finite() && *std > 0.0);
    let size = value.abs().max(std.unwrap_or(0.0));
    if size == 0.0 || !size.is_finite() {
        return format!("{value}");
    }
    let exponent = exponent_of(size);
    let shown = if PLAIN_EXPONENTS.contains(&exponent) { 0 } else { exponent };
    let power = 10.0_f64.powi(shown);
    let last_digit = std.map_or(exponent - USUAL_DIGITS + 1, |std| exponent_of(std) - 1);
    let decimals = (shown - last_digit).clamp(0, 12) as usize;
    let number = match std {
        Some(std) => format!("{:.decimals$} ± {:.decimals$}", value / power, std / power),
        None => format!("{:.decimals$}", value / power),
    };
    match (shown, std) {
        (0, _) => number,
        (_, Some(_)) => format!("({number})e{shown}"),
        (_, None) => format!("{number}e{shown}"),
    }
}

/// `1.165e-4`, `0.0465`: so many significant digits.
pub fn significant(value: f64, n_digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let exponent = exponent_of(value.abs());
    if PLAIN_EXPONENTS.contains(&exponent) {
        format!("{value:.*}", (n_digits as i32 - 1 - exponent).max(0) as usize)
    } else {
        format!("{value:.*e}", n_digits - 1)
    }
}

/// An angle (rad): two decimals, and two digits of a small one, which these would not show.
pub fn angle(angle_rad: f64) -> String {
    if angle_rad.abs() < SMALL_RAD { significant(angle_rad, 2) } else { format!("{angle_rad:.2}") }
}

/// A count with its sign only where it is negative; halves and the like with two decimals.
pub fn count(value: f64) -> String {
    // Adding zero takes the sign from a zero.
    let hundredths = (100.0 * value).round() / 100.0 + 0.0;
    if value == value.round() { format!("{hundredths:.0}") } else { format!("{hundredths:.2}") }
}

fn exponent_of(size: f64) -> i32 {
    size.log10().floor() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noises_have_as_many_digits_as_mean_something() {
        assert_eq!([1.034, 9.56, 25.44, 851.55, 1e5].map(noises), ["1.03", "9.56", "25.4", "852", "more than 1000"]);
    }

    #[test]
    fn the_spread_decides_the_digits() {
        let check = |value, std, expected: &str| assert_eq!(with_spread(value, std), expected);
        check(5.400_412e-4, Some(3.2e-8), "(5.40041 ± 0.00032)e-4");
        check(0.002_706_768_7, Some(1.26e-7), "(2.70677 ± 0.00013)e-3");
        check(0.055_012, Some(0.001_04), "0.0550 ± 0.0010");
        check(12.345, Some(2.0), "12.3 ± 2.0");
        check(1e-5, Some(2e-4), "(0.1 ± 2.0)e-4");
        check(5.4e-4, None, "5.400e-4");
        check(0.0, None, "0");
        check(0.0, Some(1e-3), "(0.0 ± 1.0)e-3");
        check(-0.25, None, "-0.2500");
    }

    #[test]
    fn an_angle_is_never_shown_as_nothing() {
        assert_eq!([1.234, -0.35, 0.0345, 0.0012, 0.0].map(angle), ["1.23", "-0.35", "0.035", "1.2e-3", "0"]);
    }

    #[test]
    fn significant_digits_and_counts() {
        assert_eq!(significant(1.165_269e-4, 4), "1.165e-4");
        assert_eq!(significant(0.0465, 3), "0.0465");
        assert_eq!(significant(24.5198, 5), "24.520");
        assert_eq!([-1.0, 0.2817, -0.0, -1e-9].map(count), ["-1", "0.28", "0", "0.00"]);
    }
}
