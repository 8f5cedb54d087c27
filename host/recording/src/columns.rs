//! Which column of a table is time, which is angle, and in what unit.
//!
//! By the words of the column names, in five languages (`words.rs`), or as told: `t=0,theta=2`, `t=time,theta=angle`,
//! with units `t=0:ms,theta=2:deg`. A point on the pendulum, followed in a video, is told as `t=0,x=1,y=2`.

use super::units::{AngleUnit, RateUnit, TimeUnit};
use super::words::{self, angle_unit, time_unit};
use std::str::FromStr;
use thiserror::Error;

/// The user's choice of columns; what is not named is looked for.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Columns {
    /// Time column and its unit.
    pub time: Option<(ColumnRef, Option<TimeUnit>)>,
    /// Angle column and its unit.
    pub angle: Option<(ColumnRef, Option<AngleUnit>)>,
    /// Converter code column.
    pub code: Option<ColumnRef>,
    /// Columns of a point on the pendulum: to the right, and up or down.
    pub x: Option<ColumnRef>,
    /// See `x`.
    pub y: Option<ColumnRef>,
    /// Angular velocity column and its unit.
    pub rate: Option<(ColumnRef, Option<RateUnit>)>,
}

/// A column by place or by name.
#[derive(Debug, Clone, PartialEq)]
pub enum ColumnRef {
    /// Counted from 0.
    Index(usize),
    /// As in the column header, upper or lower case.
    Name(String),
}

/// What is wrong with a choice of columns.
#[derive(Debug, Error, PartialEq)]
pub enum ColumnsError {
    /// A part without `=`.
    #[error("--columns: \"{part}\" has no column; expected name=column such as t=0,theta=2")]
    NoColumn {
        /// As written.
        part: String,
    },
    /// A left side that is not known.
    #[error(
        "--columns: \"{role}\" is not known; expected t, theta or code, rate for an angular velocity, or x and y, such as t=0,theta=2"
    )]
    UnknownRole {
        /// As written.
        role: String,
    },
    /// The same left side twice.
    #[error("--columns: {role} is given twice; give it once")]
    Twice {
        /// As written.
        role: String,
    },
    /// One coordinate of a point.
    #[error(
        "--columns: {given} without {other}; a point has both, such as t=0,x=1,y=2, and a column that is the angle itself is told as \
         theta=1"
    )]
    OneCoordinate {
        /// The one that is there.
        given: &'static str,
        /// The one that is not.
        other: &'static str,
    },
    /// A unit that does not fit.
    #[error(
        "--columns: \"{unit}\" is no unit of {role}; expected s, ms, us, ns, min or day for t, rad, deg, mrad, gon or turn for theta, or what one of the column is such as 4096/turn or 0.088deg, rad/s, deg/s, rpm or 0.0076deg/s for rate"
    )]
    UnknownUnit {
        /// Left side.
        role: String,
        /// As written.
        unit: String,
    },
}

impl FromStr for Columns {
    type Err = ColumnsError;

    fn from_str(text: &str) -> Result<Self, ColumnsError> {
        let mut columns = Self::default();
        text.split(',').try_for_each(|part| columns.take(part.trim()))?;
        match (&columns.x, &columns.y) {
            (Some(_), None) => Err(ColumnsError::OneCoordinate { given: "x", other: "y" }),
            (None, Some(_)) => Err(ColumnsError::OneCoordinate { given: "y", other: "x" }),
            _ => Ok(columns),
        }
    }
}

impl Columns {
    fn take(&mut self, part: &str) -> Result<(), ColumnsError> {
        let no_column = || ColumnsError::NoColumn { part: part.to_owned() };
        let (role, column) = part.split_once('=').ok_or_else(no_column)?;
        let (column, unit) = column.rsplit_once(':').map_or((column, None), |(column, unit)| (column, Some(unit)));
        let (role, column) = (role.trim(), column.trim());
        if column.is_empty() {
            return Err(no_column());
        }
        self.place(role, ColumnRef::from(column), unit.map(str::trim))
    }

    fn place(&mut self, role: &str, column: ColumnRef, unit: Option<&str>) -> Result<(), ColumnsError> {
        match role.to_lowercase().as_str() {
            "t" | "time" => put(&mut self.time, role, (column, parse_unit(role, unit, time_unit)?)),
            "theta" | "angle" => put(&mut self.angle, role, (column, parse_unit(role, unit, angle_scale)?)),
            "code" => {
                parse_unit(role, unit, |_| None::<()>)?;
                put(&mut self.code, role, column)
            }
            "x" | "y" => {
                parse_unit(role, unit, |_| None::<()>)?;
                put(if role.eq_ignore_ascii_case("x") { &mut self.x } else { &mut self.y }, role, column)
            }
            "rate" | "omega" => put(&mut self.rate, role, (column, parse_unit(role, unit, rate_scale)?)),
            _ => Err(ColumnsError::UnknownRole { role: role.to_owned() }),
        }
    }
}

fn put<T>(place: &mut Option<T>, role: &str, value: T) -> Result<(), ColumnsError> {
    match place.replace(value) {
        None => Ok(()),
        Some(_) => Err(ColumnsError::Twice { role: role.to_owned() }),
    }
}

fn parse_unit<U>(role: &str, unit: Option<&str>, known: impl Fn(&str) -> Option<U>) -> Result<Option<U>, ColumnsError> {
    let Some(unit) = unit else { return Ok(None) };
    let unknown = || ColumnsError::UnknownUnit { role: role.to_owned(), unit: unit.to_owned() };
    known(&unit.to_lowercase()).map(Some).ok_or_else(unknown)
}

/// A unit, so many of it (`0.088deg`), or so many of the column to a turn (`4096/turn`).
fn angle_scale(unit: &str) -> Option<AngleUnit> {
    if let Some(unit) = angle_unit(unit) {
        return Some(unit);
    }
    let radians = match unit.split_once('/') {
        Some((number, "turn" | "rev")) => std::f64::consts::TAU / number.trim().parse::<f64>().ok()?,
        Some(_) => return None,
        None => {
            let begin = unit.find(|letter: char| letter.is_alphabetic() || letter == '°')?;
            let (number, unit) = unit.split_at(begin);
            number.trim().parse::<f64>().ok()? * angle_unit(unit)?.radians()
        }
    };
    (radians.is_finite() && radians != 0.0).then_some(AngleUnit::Of(radians))
}

/// A unit, or so many of it in a time: `0.0076deg/s`.
fn rate_scale(unit: &str) -> Option<RateUnit> {
    let scaled = || {
        let (angle, time) = unit.rsplit_once('/')?;
        Some(RateUnit { angle: angle_scale(angle.trim())?, time: time_unit(time.trim())? })
    };
    words::rate_unit(unit).or_else(scaled)
}

impl From<&str> for ColumnRef {
    fn from(text: &str) -> Self {
        text.parse().map_or_else(|_| Self::Name(text.to_owned()), Self::Index)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_by_number_name_and_unit_are_parsed() {
        let columns: Columns = "t=0:ms, theta=Pendulum angle:deg,code=2".parse().unwrap();
        assert_eq!(columns.time, Some((ColumnRef::Index(0), Some(TimeUnit::Milliseconds))));
        assert_eq!(columns.angle, Some((ColumnRef::Name("Pendulum angle".to_owned()), Some(AngleUnit::Degrees))));
        assert_eq!(columns.code, Some(ColumnRef::Index(2)));
    }

    #[test]
    fn counts_and_volts_are_told_by_what_one_of_them_is() {
        let unit = |text: &str| text.parse::<Columns>().unwrap().angle.unwrap().1.unwrap().radians();
        assert_eq!(unit("theta=1:4096/turn"), std::f64::consts::TAU / 4096.0);
        assert_eq!(unit("theta=1:-2400/rev"), -std::f64::consts::TAU / 2400.0);
        assert!((unit("theta=volts:54.5 deg") - 54.5_f64.to_radians()).abs() < 1e-15);
        assert_eq!(unit("theta=1:0.25rad"), 0.25);
    }

    #[test]
    fn a_rate_has_the_unit_of_an_angle_in_a_time() {
        let unit = |text: &str| text.parse::<Columns>().unwrap().rate.unwrap().1.map(RateUnit::rad_per_s);
        assert_eq!(unit("t=0,rate=2"), None);
        assert_eq!(unit("rate=2:rad/s"), Some(1.0));
        assert_eq!(unit("rate=gyro z:deg/s"), Some(std::f64::consts::PI / 180.0));
        assert_eq!(unit("omega=2:rpm"), Some(std::f64::consts::TAU / 60.0));
        assert_eq!(unit("rate=2:0.5deg/s"), Some(std::f64::consts::PI / 360.0));
        assert_eq!(unit("rate=2:0.25rad/ms"), Some(250.0));
    }

    #[test]
    fn a_wrong_choice_of_columns_says_what_was_expected() {
        let cases = [
            ("", "has no column"),
            ("t", "has no column"),
            ("t=", "has no column"),
            ("z=1", "expected t, theta or code"),
            ("t=0,t=1", "given twice"),
            ("theta=0:furlong", "expected s, ms"),
            ("theta=0:0/turn", "such as 4096/turn"),
            ("theta=0:4096/s", "such as 4096/turn"),
            ("code=0:deg", "no unit of code"),
            ("t=0,x=1", "x without y"),
            ("t=0,y=1", "theta=1"),
        ];
        for (text, expected) in cases {
            let message = text.parse::<Columns>().unwrap_err().to_string();
            assert!(message.contains(expected), "{text}: {message}");
        }
    }
}
