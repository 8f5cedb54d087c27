//! The line from codes to angles through the zero, from angles that somebody set, and what is wrong where there is none.
//!
//! The gain is the least-squares slope. Readings are off it by the track's own bend and by how well an angle was set;
//! one that is off by more than both together belongs to another angle.

use super::CalibrationError;
use shared::potentiometer::{ELECTRICAL_TRAVEL_RAD, LINEARITY};

/// A gain further than this factor from the data sheet's is a mistake.
const GAIN_FACTOR: f64 = 2.0;

/// Somebody who holds a pendulum against a protractor is off by less, rad (5°).
const SETTING_RAD: f64 = 5.0 * std::f64::consts::PI / 180.0;

/// A code at a known angle.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Known {
    /// The angle in rad, as somebody set it.
    pub angle_rad: f64,
    /// The mean code there.
    pub code: f64,
}

/// What known angles tell.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Line {
    /// Angle of a code in rad.
    pub radian_per_code: f64,
    /// Its standard deviation, from two angles on.
    pub std: Option<f64>,
    /// By how much each angle is off the line, rad.
    pub off_rad: Vec<f64>,
}

/// The gain from at least one known angle that is not zero; `nominal` is the data sheet's, rad a code.
///
/// # Errors
/// Readings that are no line, or a gain that can't be.
pub fn line(zero_code: f64, known: &[Known], nominal: f64) -> Result<Line, CalibrationError> {
    let line = through(zero_code, known);
    if !is_line(&line) {
        return Err(no_line(zero_code, known, &line, nominal));
    }
    if !is_possible(&line, nominal) {
        return Err(CalibrationError::Absurd { mrad: 1e3 * line.radian_per_code, nominal_mrad: 1e3 * nominal });
    }
    Ok(line)
}

/// The most that a reading may be off its line, rad: of the track by its data sheet, and of the hand.
fn most_off_rad() -> f64 {
    f64::from(LINEARITY * ELECTRICAL_TRAVEL_RAD) + SETTING_RAD
}

/// Can the data sheet's gain be meant?
fn is_possible(line: &Line, nominal: f64) -> bool {
    (1.0 / GAIN_FACTOR..GAIN_FACTOR).contains(&(line.radian_per_code.abs() / nominal))
}

fn is_line(line: &Line) -> bool {
    line.off_rad.iter().all(|off_rad| off_rad.abs() <= most_off_rad())
}

fn through(zero_code: f64, known: &[Known]) -> Line {
    let codes = |point: &Known| point.code - zero_code;
    let square: f64 = known.iter().map(|point| point.angle_rad.powi(2)).sum();
    let codes_per_rad = known.iter().map(|point| codes(point) * point.angle_rad).sum::<f64>() / square;
    let radian_per_code = 1.0 / codes_per_rad;
    let off_rad: Vec<f64> = known.iter().map(|point| radian_per_code * codes(point) - point.angle_rad).collect();
    let n_spare = known.len().saturating_sub(1);
    let variance = off_rad.iter().map(|off| off * off).sum::<f64>() / n_spare.max(1) as f64;
    let std = (n_spare > 0).then(|| radian_per_code.abs() * (variance / square).sqrt());
    Line { radian_per_code, std, off_rad }
}

/// Which reading is off, by how much (by the `nominal` gain where the slope means nothing), and which angles would be right.
fn no_line(zero_code: f64, known: &[Known], line: &Line, nominal: f64) -> CalibrationError {
    let suggested = [by_size(known), by_side(zero_code, known)].into_iter().find(|angles| {
        let other: Vec<Known> = known.iter().zip(angles).map(|(point, angle_rad)| at(*angle_rad, point)).collect();
        is_line(&through(zero_code, &other))
    });
    let odd = odd_one(zero_code, known).unwrap_or_else(|| worst(line));
    let by_nominal = if is_possible(line, nominal) { 1.0 } else { nominal / line.radian_per_code };
    let off_degrees = (by_nominal * line.off_rad[odd]).abs().to_degrees();
    CalibrationError::NoLine {
        odd_degrees: known[odd].angle_rad.to_degrees(),
        off_degrees,
        most_degrees: most_off_rad().to_degrees(),
        suggested_degrees: suggested.map(|angles| angles.iter().map(|angle| angle.to_degrees()).collect()),
    }
}

fn at(angle_rad: f64, point: &Known) -> Known {
    Known { angle_rad, ..*point }
}

/// The same angles in the order of the codes.
fn by_size(known: &[Known]) -> Vec<f64> {
    let mut angles: Vec<f64> = known.iter().map(|point| point.angle_rad).collect();
    angles.sort_by(f64::total_cmp);
    let rank = |point: &Known| known.iter().filter(|other| other.code < point.code).count();
    known.iter().map(|point| angles[rank(point)]).collect()
}

/// The same angles, each on the side of zero on which its code is.
fn by_side(zero_code: f64, known: &[Known]) -> Vec<f64> {
    known.iter().map(|point| point.angle_rad.abs().copysign(point.code - zero_code)).collect()
}

/// The only reading without which the others are a line.
fn odd_one(zero_code: f64, known: &[Known]) -> Option<usize> {
    let without = |idx: usize| [&known[..idx], &known[idx + 1..]].concat();
    let mut odd = (0..known.len()).filter(|idx| known.len() > 2 && is_line(&through(zero_code, &without(*idx))));
    odd.next().filter(|_| odd.next().is_none())
}

fn worst(line: &Line) -> usize {
    let by_size = |a: &usize, b: &usize| line.off_rad[*a].abs().total_cmp(&line.off_rad[*b].abs());
    (0..line.off_rad.len()).max_by(by_size).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::potentiometer::{FULL_SCALE_12_BIT, Potentiometer};

    const NOMINAL: f64 = Potentiometer::nominal(FULL_SCALE_12_BIT).radian_per_code as f64;

    fn known(angle_rad: f64, code: f64) -> Known {
        Known { angle_rad, code }
    }

    /// Told one angle each while it was held at another, degrees.
    fn held(told_held: &[(f64, f64)]) -> Result<Line, CalibrationError> {
        let point = |(told, held): &(f64, f64)| known(told.to_radians(), 2048.0 + held.to_radians() / NOMINAL);
        line(2048.0, &told_held.iter().map(point).collect::<Vec<_>>(), NOMINAL)
    }

    #[track_caller]
    fn check_refused(told_held: &[(f64, f64)], odd: f64, suggested: Option<&[f64]>) {
        let error = held(told_held).unwrap_err();
        let CalibrationError::NoLine { odd_degrees, suggested_degrees, .. } = &error else { panic!("{error}") };
        assert!((odd_degrees - odd).abs() < 1e-9, "{error}");
        let rounded = suggested_degrees.as_ref().map(|all| all.iter().map(|angle| angle.round()).collect::<Vec<f64>>());
        assert_eq!(rounded.as_deref(), suggested, "{error}");
    }

    #[test]
    fn the_gain_comes_back_from_known_angles_also_a_negative_one() {
        for gain in [1.5e-3, -1.4e-3] {
            let points: Vec<Known> = [0.5, -0.7, 1.2].map(|angle| known(angle, 2000.0 + angle / gain)).to_vec();
            let line = line(2000.0, &points, NOMINAL).unwrap();
            assert!((line.radian_per_code / gain - 1.0).abs() < 1e-12);
            assert!(line.off_rad.iter().all(|off| off.abs() < 1e-12));
        }
    }

    #[test]
    fn a_bent_track_is_off_the_line() {
        let bent = |angle: f64| known(angle, 2048.0 + (angle + 0.02 * angle * angle) / 1.45e-3);
        let line = line(2048.0, &[0.5, 1.0, 1.5].map(bent), NOMINAL).unwrap();
        assert!(line.off_rad.iter().any(|off| off.abs() > 4e-3), "{line:?}");
        assert!(line.std.is_some_and(|std| std > 1e-6));
    }

    #[test]
    fn angles_in_another_order_are_refused_with_the_one_that_would_be_a_line() {
        check_refused(&[(90.0, 45.0), (45.0, 90.0), (-45.0, -45.0)], 45.0, Some(&[45.0, 90.0, -45.0]));
        check_refused(&[(45.0, 60.0), (60.0, 45.0)], 45.0, Some(&[60.0, 45.0]));
    }

    /// Held so, they have next to no slope.
    #[test]
    fn what_is_off_a_line_of_no_slope_is_off_by_what_the_data_sheet_makes_of_its_codes() {
        let error = held(&[(90.0, 90.0), (45.0, -70.0), (-70.0, 45.0)]).unwrap_err();
        let CalibrationError::NoLine { off_degrees, .. } = error else { panic!("{error}") };
        assert!((60.0..95.0).contains(&off_degrees), "{off_degrees}");
    }

    #[test]
    fn a_sign_that_was_left_out_is_named() {
        check_refused(&[(45.0, 45.0), (90.0, 90.0), (45.0, -45.0)], 45.0, Some(&[45.0, 90.0, -45.0]));
    }

    #[test]
    fn of_three_readings_the_one_that_is_off_is_named() {
        check_refused(&[(40.0, 40.0), (80.0, 80.0), (-60.0, -30.0)], -60.0, None);
    }

    #[test]
    fn what_a_track_and_a_hand_may_be_off_is_a_line() {
        let line = held(&[(90.0, 94.0), (45.0, 41.0), (-45.0, -49.0)]).unwrap();
        assert!(line.off_rad.iter().any(|off| off.abs() > 4_f64.to_radians()), "{line:?}");
    }

    #[test]
    fn degrees_taken_for_radians_are_refused() {
        let error = line(2048.0, &[known(45.0, 2590.0)], NOMINAL).unwrap_err();
        assert!(matches!(error, CalibrationError::Absurd { .. }));
    }

    #[test]
    fn the_gain_of_two_angles_is_as_sure_as_they_are_near_its_line() {
        // Off by 10 mrad to either side: one is spare, so that a known angle is good for 14 mrad, and two of them for 10.
        let found = line(0.0, &[known(1.0, 1010.0), known(1.0, 990.0)], 1e-3).unwrap();
        assert!((found.radian_per_code - 1e-3).abs() < 1e-12);
        assert!((found.std.unwrap() - 1e-5).abs() < 1e-9, "{found:?}");
        assert_eq!(line(0.0, &[known(1.0, 1010.0)], 1e-3).unwrap().std, None);
    }
}
