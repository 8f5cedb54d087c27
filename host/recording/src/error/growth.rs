//! How the period grows with the amplitude, and what speaks against a unit of rates, in words.

use super::Fault;
use crate::limits::FASTEST_MARGIN;
use crate::told::Told;

/// What the period should do and does, to two digits of what it should; beyond half a turn no pendulum swings to and fro.
pub(super) fn growth_in_words(predicted_percent: f64, found_percent: f64) -> String {
    if !predicted_percent.is_finite() {
        return "no pendulum swings to and fro over more than half a turn to either side".to_owned();
    }
    let exponent = predicted_percent.abs().max(1e-6).log10().floor() as i32;
    let decimals = (1 - exponent).clamp(1, 6) as usize;
    // -0.0 is no less than 0.
    let half_digit = 0.5 * 10_f64.powi(-(decimals as i32));
    let found_percent = if found_percent.abs() < half_digit { 0.0 } else { found_percent };
    format!(
        "the period should be {predicted_percent:.decimals$} % longer in the largest swings than in the smallest, but is \
         {found_percent:.decimals$} %"
    )
}

impl Fault {
    /// Rates (rad/s) beyond those of a fall from upright: degrees a second, or where these are too large too, what a chip
    /// gives.
    pub(crate) fn too_fast(largest: f64, fastest: f64, told: Told) -> Self {
        let period_s = 2.0 * std::f64::consts::TAU / fastest;
        let against = format!(
            "a pendulum that takes {period_s:.2} s there and back passes its lowest point with {fastest:.1} rad/s at most"
        );
        let instead = match largest.to_radians() < FASTEST_MARGIN * fastest {
            true => format!("these are degrees a second; say --columns {}", told.rate(":deg/s")),
            false => format!(
                "these are neither that nor degrees a second but, perhaps, what the sensor's chip gives; say what one is \
                 worth, e.g. --columns {} where 131 are a degree a second",
                told.rate(":0.00763deg/s")
            ),
        };
        Self::NotRadiansPerSecond { largest, against, instead }
    }

    /// Rates (rad/s) with which the period does not grow as it should, percent.
    pub(crate) fn too_even(largest: f64, (predicted, found): (f64, f64), is_stated: bool, told: Told) -> Self {
        const SPRING: &str = "or a spring swings it and no gravity, as in a torsion pendulum, which can't be fitted";
        let instead = if is_stated {
            let other = told.rate(":mrad/s");
            format!(
                "these are in another unit (--columns {other}), {SPRING}; if the unit is right all the same, say it so"
            )
        } else {
            let (degrees, radians) = (told.rate(":deg/s"), told.rate(":rad/s"));
            format!(
                "these are degrees a second (say --columns {degrees}), {SPRING}; if they are rad/s all the same, say \
                 --columns {radians}"
            )
        };
        Self::NotRadiansPerSecond { largest, against: growth_in_words(predicted, found), instead }
    }
}

#[cfg(test)]
mod tests {
    use super::growth_in_words;

    #[test]
    fn a_small_growth_has_as_many_digits_as_tell_it_from_none() {
        for (predicted, found, expected) in [
            (60.62, 0.7, "60.6 % longer in the largest swings than in the smallest, but is 0.7 %"),
            (0.0026, 0.0, "0.0026 % longer in the largest swings than in the smallest, but is 0.0000 %"),
            (1.8, -0.01, "1.8 % longer in the largest swings than in the smallest, but is 0.0 %"),
            (0.47, -0.2, "0.47 % longer in the largest swings than in the smallest, but is -0.20 %"),
        ] {
            let words = growth_in_words(predicted, found);
            assert!(words.ends_with(expected), "{words}");
        }
    }
}
