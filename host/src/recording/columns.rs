//! Which column of a table is time, which is angle, and in what unit.
//!
//! By the words of the column names, or as told: `t=0,theta=2`, `t=time,theta=angle`, with units `t=0:ms,theta=2:deg`.

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
}

/// A column by place or by name.
#[derive(Debug, Clone, PartialEq)]
pub enum ColumnRef {
    /// Counted from 0.
    Index(usize),
    /// As in the column header, upper or lower case.
    Name(String),
}

/// Unit of a time column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeUnit {
    /// s
    Seconds,
    /// ms
    Milliseconds,
    /// µs
    Microseconds,
    /// min
    Minutes,
}

/// Unit of an angle column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AngleUnit {
    /// rad
    Radians,
    /// degrees
    Degrees,
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
    #[error("--columns: \"{role}\" is not known; expected t, theta or code, such as t=0,theta=2")]
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
    /// A unit that does not fit.
    #[error("--columns: \"{unit}\" is no unit of {role}; expected s, ms, us or min for t, rad or deg for theta")]
    UnknownUnit {
        /// Left side.
        role: String,
        /// As written.
        unit: String,
    },
}

impl TimeUnit {
    /// How many seconds one unit has.
    pub fn seconds(self) -> f64 {
        match self {
            Self::Seconds => 1.0,
            Self::Milliseconds => 1e-3,
            Self::Microseconds => 1e-6,
            Self::Minutes => 60.0,
        }
    }
}

impl AngleUnit {
    /// How many radians one unit has.
    pub fn radians(self) -> f64 {
        match self {
            Self::Radians => 1.0,
            Self::Degrees => 1f64.to_radians(),
        }
    }
}

impl FromStr for Columns {
    type Err = ColumnsError;

    fn from_str(text: &str) -> Result<Self, ColumnsError> {
        let mut columns = Self::default();
        text.split(',').try_for_each(|part| columns.take(part.trim()))?;
        Ok(columns)
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
            "theta" | "angle" => put(&mut self.angle, role, (column, parse_unit(role, unit, angle_unit)?)),
            "code" => {
                parse_unit(role, unit, |_| None::<()>)?;
                put(&mut self.code, role, column)
            }
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

impl From<&str> for ColumnRef {
    fn from(text: &str) -> Self {
        text.parse().map_or_else(|_| Self::Name(text.to_owned()), Self::Index)
    }
}

/// What a column name says about its content.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Meaning {
    /// Time, with the unit if the name has one; `strength` orders several candidates.
    Time { unit: Option<TimeUnit>, strength: u8 },
    /// Angle, likewise.
    Angle { unit: Option<AngleUnit>, strength: u8 },
    /// Converter code.
    Code,
    /// Something else, such as a velocity.
    Other,
}

const NAMES_THE_THING: u8 = 2;
const NAMES_A_UNIT: u8 = 1;

/// Words after which a column is not the angle itself, whatever else it says.
const DERIVED: &[&str] = &[
    "omega",
    "velocity",
    "vel",
    "speed",
    "acceleration",
    "acc",
    "accel",
    "alpha",
    "rate",
    "dot",
    "target",
    "setpoint",
];
const TIME: &[&str] = &["t", "time", "times", "timestamp", "zeit", "elapsed"];
const ANGLE: &[&str] = &["theta", "angle", "position", "pos", "phi", "winkel", "θ", "φ"];
const CODE: &[&str] = &["code", "codes", "adc"];

/// Reads the words of a column name: `Time [s]`, `time_ms`, `angle (deg)`, `thetaRad`, `Winkel / °`.
pub(super) fn meaning(name: &str) -> Meaning {
    let words = words(name);
    let has = |list: &[&str]| words.iter().any(|word| list.contains(&word.as_str()));
    let time = words.iter().rev().find_map(|word| time_unit(word));
    let angle = words.iter().rev().find_map(|word| angle_unit(word));
    // rad/s, deg/s: an angle and a time unit in one name is a velocity.
    if has(DERIVED) || (angle.is_some() && time.is_some()) {
        return Meaning::Other;
    }
    if has(TIME) {
        return Meaning::Time { unit: time, strength: NAMES_THE_THING };
    }
    if has(ANGLE) {
        return Meaning::Angle { unit: angle, strength: NAMES_THE_THING };
    }
    match (has(CODE), time, angle) {
        (true, ..) => Meaning::Code,
        (_, Some(_), _) => Meaning::Time { unit: time, strength: NAMES_A_UNIT },
        (.., Some(_)) => Meaning::Angle { unit: angle, strength: NAMES_A_UNIT },
        _ => Meaning::Other,
    }
}

/// Whether a cell is nothing but a unit, as in a second header line.
pub(super) fn is_unit(cell: &str) -> bool {
    let cell = cell.trim_matches(['[', ']', '(', ')', ' ']).to_lowercase();
    time_unit(&cell).is_some() || angle_unit(&cell).is_some() || matches!(cell.as_str(), "rad/s" | "deg/s" | "°/s")
}

fn time_unit(word: &str) -> Option<TimeUnit> {
    match word {
        "s" | "sec" | "secs" | "second" | "seconds" => Some(TimeUnit::Seconds),
        "ms" | "msec" | "millis" | "millisecond" | "milliseconds" => Some(TimeUnit::Milliseconds),
        "us" | "µs" | "μs" | "usec" | "micros" | "microsecond" | "microseconds" => Some(TimeUnit::Microseconds),
        "min" | "minute" | "minutes" => Some(TimeUnit::Minutes),
        _ => None,
    }
}

fn angle_unit(word: &str) -> Option<AngleUnit> {
    match word {
        "rad" | "rads" | "radian" | "radians" => Some(AngleUnit::Radians),
        "deg" | "degs" | "degree" | "degrees" | "°" => Some(AngleUnit::Degrees),
        _ => None,
    }
}

/// Lower-case words of a name, split at signs and where a small letter meets a capital; digits at the end fall off.
fn words(name: &str) -> Vec<String> {
    let mut spaced = String::new();
    let mut before_is_small = false;
    for letter in name.chars() {
        if before_is_small && letter.is_uppercase() {
            spaced.push(' ');
        }
        before_is_small = letter.is_lowercase();
        spaced.push(letter);
    }
    spaced
        .to_lowercase()
        .split(|letter: char| !letter.is_alphanumeric() && letter != '°')
        .map(|word| word.trim_end_matches(|letter: char| letter.is_ascii_digit()).to_owned())
        .filter(|word| !word.is_empty())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_many_labs_are_understood() {
        let time = |unit| Meaning::Time { unit, strength: NAMES_THE_THING };
        let angle = |unit| Meaning::Angle { unit, strength: NAMES_THE_THING };
        let cases = [
            ("t", time(None)),
            ("Time [s]", time(Some(TimeUnit::Seconds))),
            ("time_ms", time(Some(TimeUnit::Milliseconds))),
            ("timestamp_us", time(Some(TimeUnit::Microseconds))),
            ("timeMs", time(Some(TimeUnit::Milliseconds))),
            ("ms", Meaning::Time { unit: Some(TimeUnit::Milliseconds), strength: NAMES_A_UNIT }),
            ("seconds", Meaning::Time { unit: Some(TimeUnit::Seconds), strength: NAMES_A_UNIT }),
            ("theta", angle(None)),
            ("THETA1", angle(None)),
            ("angle (deg)", angle(Some(AngleUnit::Degrees))),
            ("Winkel / °", angle(Some(AngleUnit::Degrees))),
            ("position_rad", angle(Some(AngleUnit::Radians))),
            ("deg", Meaning::Angle { unit: Some(AngleUnit::Degrees), strength: NAMES_A_UNIT }),
            ("omega", Meaning::Other),
            ("angle rate", Meaning::Other),
            ("theta_dot", Meaning::Other),
            ("v (rad/s)", Meaning::Other),
            ("adc_code", Meaning::Code),
            ("voltage", Meaning::Other),
        ];
        for (name, expected) in cases {
            assert_eq!(meaning(name), expected, "{name}");
        }
    }

    #[test]
    fn columns_by_number_name_and_unit_are_parsed() {
        let columns: Columns = "t=0:ms, theta=Pendulum angle:deg,code=2".parse().unwrap();
        assert_eq!(columns.time, Some((ColumnRef::Index(0), Some(TimeUnit::Milliseconds))));
        assert_eq!(columns.angle, Some((ColumnRef::Name("Pendulum angle".to_owned()), Some(AngleUnit::Degrees))));
        assert_eq!(columns.code, Some(ColumnRef::Index(2)));
    }

    #[test]
    fn a_wrong_choice_of_columns_says_what_was_expected() {
        let cases = [
            ("", "has no column"),
            ("t", "has no column"),
            ("t=", "has no column"),
            ("x=1", "expected t, theta or code"),
            ("t=0,t=1", "given twice"),
            ("theta=0:furlong", "expected s, ms"),
            ("code=0:deg", "no unit of code"),
        ];
        for (text, expected) in cases {
            let message = text.parse::<Columns>().unwrap_err().to_string();
            assert!(message.contains(expected), "{text}: {message}");
        }
    }
}
