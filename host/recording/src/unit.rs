//! Is the unit of the angles right? Asked of the free swing alone: a tracker that is lost behind it, or a hand before it, shows
//! periods of its own.

use super::plausible::{Scale, Swings};
use super::told::Told;
use super::units::AngleUnit;

/// The growth of the period, which goes with the square of the unit, tells it to a third. With half of it a unit that fits
/// would not be named where friction bends the growth by a quarter, with twice of it a turn would pass for what is a third
/// larger.
const NEAR: f64 = 0.3;

/// What is known of the unit of a column of angles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Unit {
    /// `None` where nothing says it.
    pub(super) unit: Option<AngleUnit>,
    /// For messages.
    pub(super) told: Told,
}

impl Unit {
    /// That the period of these swings grows as that of much larger ones, in words.
    pub(super) fn doubt(self, times_s: &[f64], angles_rad: &[f64]) -> Option<String> {
        let Scale::TooSmall { factor } = Swings::of(times_s, angles_rad)?.scale() else { return None };
        let read_as = if self.unit.is_none() { "read as radians, but" } else { "with the unit that is stated" };
        let advice = self.that_fits(factor).map_or_else(
            || {
                "no unit fits that: is this column the angle, and what is one in it worth (the scale of the picture, the gain of the \
                 sensor)?"
                    .to_owned()
            },
            |name| format!("say the unit, --columns {}", self.told.angle("", name)),
        );
        Some(format!(
            "doubtful: {read_as} the period grows with the amplitude as for angles {factor:.1} times as large; {advice}"
        ))
    }

    /// The unit that makes the angles so many times as large, as the option takes it.
    fn that_fits(self, factor: f64) -> Option<&'static str> {
        const UNITS: [(AngleUnit, &str); 4] = [
            (AngleUnit::Turns, ":turn"),
            (AngleUnit::Radians, ":rad"),
            (AngleUnit::Degrees, ":deg"),
            (AngleUnit::Gradians, ":gon"),
        ];
        let wanted_rad = factor * self.unit.unwrap_or(AngleUnit::Radians).radians();
        let off = |unit: AngleUnit| ((wanted_rad / unit.radians()).powi(2) - 1.0).abs();
        let (unit, name) = UNITS.into_iter().min_by(|a, b| off(a.0).total_cmp(&off(b.0)))?;
        (off(unit) < NEAR).then_some(name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::measured::Measured;
    use std::f64::consts::TAU;

    /// Thirty seconds of a pendulum of 1 s that is let go at 2 rad, in a unit of so many rad.
    fn swing(unit_rad: f64) -> (Vec<f64>, Vec<f64>) {
        const STEP_S: f64 = 1e-3;
        let (mut angle_rad, mut rate_rad_s) = (2.0_f64, 0.0);
        let row = |idx: u32| {
            for _ in 0..10 {
                rate_rad_s -= STEP_S * (TAU * TAU * angle_rad.sin() + 0.2 * rate_rad_s);
                angle_rad += STEP_S * rate_rad_s;
            }
            (f64::from(idx) * 10.0 * STEP_S, angle_rad / unit_rad)
        };
        (0..3000).map(row).unzip()
    }

    #[test]
    fn turns_that_are_read_as_radians_are_doubted_and_radians_are_not() {
        let told = Told { time: Some(0), reading: 1, measured: Measured::Angle };
        let doubt = |unit_rad: f64| {
            let (times_s, angles) = swing(unit_rad);
            Unit { unit: None, told }.doubt(&times_s, &angles)
        };
        assert!(doubt(TAU).is_some_and(|words| words.contains("--columns t=0,theta=1:turn")), "{:?}", doubt(TAU));
        assert!(doubt(9.0).is_some_and(|words| words.contains("no unit fits")), "{:?}", doubt(9.0));
        assert_eq!(doubt(1.0), None);
    }

    #[test]
    fn a_unit_is_named_where_it_fits_and_none_where_none_does() {
        let told = Told { time: Some(0), reading: 1, measured: Measured::Angle };
        let named = |unit, factor| Unit { unit, told }.that_fits(factor);
        assert_eq!(named(None, 6.0), Some(":turn"));
        assert_eq!(named(None, 8.3), None);
        assert_eq!(named(None, 2.7), None);
        assert_eq!(named(Some(AngleUnit::Milliradians), 17.0), Some(":deg"));
        assert_eq!(named(Some(AngleUnit::Degrees), 55.0), Some(":rad"));
    }
}
