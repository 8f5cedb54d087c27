//! Settings as a rig tells them: judged where they come in, because all behind computes with them. A rate of 0 would be
//! a recording without end, and one of 1e9 Hz a buffer that no memory holds.

use super::LinkError;
use shared::rig::{HIGHEST_BANDWIDTH_RAD_S, HIGHEST_CUTOFF, HIGHEST_RATE_HZ, LOWEST_RATE_HZ};
use shared::wire::Settings;

/// The rate nearest to the lowest or the highest may lie beyond it by this share: boards make rates of whole ticks.
const RATE_SLACK: f32 = 0.01;

/// The settings, if all of them can be computed with.
///
/// # Errors
/// The first that can't.
pub(super) fn judged(settings: Settings) -> Result<Settings, LinkError> {
    rate(&settings)?;
    cutoff(&settings)?;
    bandwidth(&settings)?;
    calibration(&settings)?;
    Ok(settings)
}

fn rate(Settings { rate_hz, .. }: &Settings) -> Result<(), LinkError> {
    let is_good = ((1.0 - RATE_SLACK) * LOWEST_RATE_HZ..=(1.0 + RATE_SLACK) * HIGHEST_RATE_HZ).contains(rate_hz);
    let expected = format!("{LOWEST_RATE_HZ} to {HIGHEST_RATE_HZ} Hz");
    refused_unless(is_good, "sampling rate", format!("{rate_hz} Hz"), expected)
}

fn cutoff(Settings { cutoff_hz, rate_hz, .. }: &Settings) -> Result<(), LinkError> {
    let highest_hz = HIGHEST_CUTOFF * rate_hz;
    let is_good = *cutoff_hz > 0.0 && *cutoff_hz <= highest_hz;
    let expected = format!("more than 0 and at most {highest_hz} Hz");
    refused_unless(is_good, "filter's cut-off", format!("{cutoff_hz} Hz"), expected)
}

fn bandwidth(Settings { bandwidth_rad_s, .. }: &Settings) -> Result<(), LinkError> {
    let is_good = (0.0..=HIGHEST_BANDWIDTH_RAD_S).contains(bandwidth_rad_s);
    let expected = format!("0 to {HIGHEST_BANDWIDTH_RAD_S} rad/s");
    refused_unless(is_good, "observer's bandwidth", format!("{bandwidth_rad_s} rad/s"), expected)
}

fn calibration(Settings { sensor, .. }: &Settings) -> Result<(), LinkError> {
    let expected = sensor.expected().trim_start_matches("expected ").to_owned();
    refused_unless(sensor.is_valid(), "calibration", sensor.to_string(), expected)
}

fn refused_unless(is_good: bool, what: &'static str, told: String, expected: String) -> Result<(), LinkError> {
    if is_good { Ok(()) } else { Err(LinkError::BadSetting { what, told, expected }) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::sensor::{Encoder, Potentiometer, Sensor};

    const GOOD: Settings = Settings {
        rate_hz: 1000.0,
        cutoff_hz: 50.0,
        bandwidth_rad_s: 3.0,
        sensor: Sensor::Potentiometer(Potentiometer::nominal(4095)),
    };

    #[track_caller]
    fn check(settings: Settings, words: &str) {
        let error = judged(settings).unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
        assert!(error.next_step().contains("firmware"), "{}", error.next_step());
    }

    #[test]
    fn settings_that_nobody_can_compute_with_are_named_with_what_was_expected() {
        for rate_hz in [0.0, f32::NAN, f32::INFINITY, -500.0, 1e9, 40.0] {
            check(Settings { rate_hz, ..GOOD }, &format!("sampling rate is {rate_hz} Hz, expected 50 to 10000 Hz"));
        }
        for cutoff_hz in [0.0, f32::NAN, 451.0] {
            check(Settings { cutoff_hz, ..GOOD }, "cut-off");
        }
        for bandwidth_rad_s in [-1.0, f32::NAN, 101.0] {
            check(Settings { bandwidth_rad_s, ..GOOD }, "bandwidth");
        }
        for radian_per_code in [0.0, f32::NAN, 2.0] {
            let sensor = Potentiometer { radian_per_code, ..Potentiometer::nominal(4095) }.into();
            check(Settings { sensor, ..GOOD }, "calibration is zero at code 2048.0 of 4095, ");
        }
        check(Settings { sensor: Encoder::new(0).into(), ..GOOD }, "calibration is 0 counts a turn");
    }

    #[test]
    fn settings_that_a_board_can_make_are_taken_as_they_are() {
        for rate_hz in [49.9, 50.0, 499.998, 10_000.0, 10_003.0] {
            let settings = GOOD.at_rate(rate_hz);
            assert_eq!(judged(settings).unwrap(), settings);
        }
        let encoder = Settings { sensor: Encoder::new(-4096).into(), bandwidth_rad_s: 0.0, ..GOOD };
        assert_eq!(judged(encoder).unwrap(), encoder);
    }
}
