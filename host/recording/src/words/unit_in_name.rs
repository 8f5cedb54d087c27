//! The units in a column name: which of them are its own, and which are one of an angle per time.

use super::split::Piece;
use crate::units::{AngleUnit, RateUnit, TimeUnit, angle_unit, time_unit};

/// A unit that stands in a name.
pub(super) struct InName<T> {
    pub(super) unit: T,
    is_amount: bool,
    place: usize,
}

impl<T> InName<T> {
    /// Of several units the one of the column is the last that is no amount: `after 10 s (deg)`.
    pub(super) fn rank(&self) -> (bool, usize) {
        (!self.is_amount, self.place)
    }
}

/// The unit of one kind that may be the column's.
pub(super) fn unit_in<T>(pieces: &[Piece], of: impl Fn(&str) -> Option<T>) -> Option<InName<T>> {
    let found = pieces.iter().enumerate().filter_map(|(place, piece)| {
        let unit = of(piece.word.trim_end_matches(|letter: char| letter.is_ascii_digit()))
            .filter(|_| !is_value(piece, pieces.get(place + 1)))?;
        Some(InName { unit, is_amount: is_amount(&pieces[..=place]), place })
    });
    found.max_by_key(InName::rank)
}

/// Does a number with decimals begin at the end of a word? `pink_s0.05` is noise of that strength and counts no seconds.
fn is_value(piece: &Piece, behind: Option<&Piece>) -> bool {
    let is_digit = |letter: char| letter.is_ascii_digit();
    piece.word.ends_with(is_digit) && behind.is_some_and(|next| next.gap == "." && next.word.starts_with(is_digit))
}

/// Does a number stand right before the last word?
fn is_amount(pieces: &[Piece]) -> bool {
    let [.., number, unit] = pieces else { return false };
    let is_number =
        number.word.starts_with(|letter: char| letter.is_ascii_digit()) && number.word.parse::<f64>().is_ok();
    is_number && matches!(unit.gap.as_str(), " " | "_")
}

/// `deg/s`, `rad s^-1`, `°·s⁻¹`, `gyro_x_deg_s`, `degrees per second`; with s² it is one of an acceleration.
pub(super) struct PerTime {
    pub(super) unit: RateUnit,
    pub(super) is_squared: bool,
}

/// An angle's unit and right behind it a time's. That a time stands anywhere in the name tells no rate.
pub(super) fn per_time(pieces: &[Piece]) -> Option<PerTime> {
    (0..pieces.len()).rev().find_map(|idx| at_the_beginning(&pieces[idx..]))
}

fn at_the_beginning(pieces: &[Piece]) -> Option<PerTime> {
    let (first, behind) = pieces.split_first()?;
    let angle = angle_unit(&first.word)?;
    let says_per = behind.first().is_some_and(|piece| PER.contains(&piece.word.as_str()));
    let behind = &behind[usize::from(says_per)..];
    let (second, behind) = behind.split_first()?;
    let time = time_unit(without_power(&second.word))?;
    let is_joined = says_per || divides(&second.gap) || (joins(&second.gap) && !may_be_least(angle, time));
    is_joined.then(|| PerTime { unit: RateUnit { angle, time }, is_squared: is_squared(second, behind) })
}

/// `theta_deg_min` is the least of the angles; `rev_min` are turns a minute.
fn may_be_least(angle: AngleUnit, time: TimeUnit) -> bool {
    time == TimeUnit::Minutes && angle != AngleUnit::Turns
}

/// Words between a unit and the time that it is divided by.
const PER: &[&str] = &["per", "pro", "je", "par", "por", "al", "na"];

fn divides(gap: &str) -> bool {
    gap.contains(['/', '÷', '∕', '⁄', '／'])
}

/// Signs of a product, those that stand in a name for others, or none at all.
fn joins(gap: &str) -> bool {
    gap == "-" || gap.chars().all(|sign| matches!(sign, ' ' | '_' | '.' | '·' | '⋅' | '∙' | '*' | '×'))
}

fn without_power(word: &str) -> &str {
    word.trim_end_matches(|letter: char| letter.is_ascii_digit() || matches!(letter, '¹' | '²'))
}

/// Is the time squared, by a digit at its end or by a power behind it?
fn is_squared(time: &Piece, behind: &[Piece]) -> bool {
    let is_two = |power: &str| matches!(power, "2" | "²");
    let is_power = |gap: &str| gap.contains(['^', '*', '⁻', '-', '−']) && !gap.contains(' ');
    is_two(&time.word[without_power(&time.word).len()..])
        || behind.first().is_some_and(|next| is_power(&next.gap) && is_two(&next.word))
}

#[cfg(test)]
mod tests {
    use super::super::split::pieces;
    use super::*;

    #[test]
    fn a_rate_is_an_angle_per_time_and_no_time_anywhere_in_the_name() {
        for name in [
            "deg/s",
            "(°)/(s)",
            "x [rad/sec]",
            "rad s^-1",
            "rad·s⁻¹",
            "rad s-1",
            "Gyroscope.x..rad.s.",
            "gx_deg_s",
            "wz-rad-s",
            "degPerSec",
            "degrees per second",
            "Grad pro Sekunde",
            "gradi al secondo",
            "度/秒",
            "rev_min",
        ] {
            assert!(per_time(&pieces(name)).is_some_and(|rate| !rate.is_squared), "{name}");
        }
        for name in ["rad/s²", "rad/s^2", "deg/s2", "rad s^-2", "rad·s⁻²", "rad/s**2", "gx_rad_s2"] {
            assert!(per_time(&pieces(name)).is_some_and(|rate| rate.is_squared), "{name}");
        }
        for name in [
            "Angle after 10 s (deg)",
            "Time (s) and angle (deg)",
            "Angle [deg] - 4 s",
            "Angle [deg] / t [s]",
            "angle (deg), s",
            "s/deg",
            "theta_deg_min",
        ] {
            assert!(per_time(&pieces(name)).is_none(), "{name}");
        }
    }

    #[test]
    fn an_amount_in_a_name_is_not_the_unit_of_the_column() {
        let unit = |name: &str| unit_in(&pieces(name), angle_unit).map(|found| found.unit);
        assert_eq!(unit("Angle (rad), released at 30 deg"), Some(AngleUnit::Radians));
        assert_eq!(unit("Angle 1 deg"), Some(AngleUnit::Degrees));
        let (time, angle) = (unit_in(&pieces("4 s [°]"), time_unit), unit_in(&pieces("4 s [°]"), angle_unit));
        assert!(angle.unwrap().rank() > time.unwrap().rank());
    }
}
