//! Units of time, angle and angular velocity, in the words of many languages.

use super::limits::LONGEST_STEP_S;

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
    /// ns
    Nanoseconds,
    /// days, as spreadsheets count them
    Days,
}

/// Unit of an angle column.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AngleUnit {
    /// rad
    Radians,
    /// degrees
    Degrees,
    /// thousandths of a radian
    Milliradians,
    /// gon, 400 to a turn
    Gradians,
    /// turns
    Turns,
    /// so many radians: `4096/turn` of an encoder, `54.5deg` of a volt
    Of(f64),
}

/// Unit of an angular velocity: an angle in a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RateUnit {
    /// So large an angle …
    pub angle: AngleUnit,
    /// … in this time.
    pub time: TimeUnit,
}

impl TimeUnit {
    /// How many seconds one unit has.
    pub fn seconds(self) -> f64 {
        match self {
            Self::Seconds => 1.0,
            Self::Milliseconds => 1e-3,
            Self::Microseconds => 1e-6,
            Self::Minutes => 60.0,
            Self::Nanoseconds => 1e-9,
            Self::Days => 86_400.0,
        }
    }
}

/// The largest unit below the second in which a pendulum can be followed by steps of so many, and how `--columns` says it.
pub(crate) fn finer(step: f64) -> (&'static str, &'static str) {
    let units = [
        (TimeUnit::Milliseconds, "milliseconds", ":ms"),
        (TimeUnit::Microseconds, "microseconds", ":us"),
        (TimeUnit::Nanoseconds, "nanoseconds", ":ns"),
    ];
    let found = units.into_iter().find(|(unit, ..)| step * unit.seconds() < LONGEST_STEP_S);
    found.map_or(("another unit", ":ms"), |(_, name, suffix)| (name, suffix))
}

impl AngleUnit {
    /// How many radians one unit has.
    pub fn radians(self) -> f64 {
        match self {
            Self::Radians => 1.0,
            Self::Degrees => 1f64.to_radians(),
            Self::Milliradians => 1e-3,
            Self::Gradians => std::f64::consts::TAU / 400.0,
            Self::Turns => std::f64::consts::TAU,
            Self::Of(radians) => radians,
        }
    }
}

impl RateUnit {
    /// rad/s
    pub const RADIANS_PER_SECOND: Self = Self::per_second(AngleUnit::Radians);

    /// An angle a second.
    pub const fn per_second(angle: AngleUnit) -> Self {
        Self { angle, time: TimeUnit::Seconds }
    }

    /// How many rad/s one unit has.
    pub fn rad_per_s(self) -> f64 {
        self.angle.radians() / self.time.seconds()
    }
}

/// `s`, `sekunden`, `millis`, in lower case.
pub(super) fn time_unit(word: &str) -> Option<TimeUnit> {
    match word {
        "s" | "sec" | "secs" | "second" | "seconds" | "sek" | "sekunde" | "sekunden" | "seconde" | "secondes"
        | "segundo" | "segundos" | "secondo" | "secondi" | "seconden" | "sekunder" | "sekundy" | "saniye" | "сек"
        | "с" | "秒" => Some(TimeUnit::Seconds),
        "ms" | "msec" | "msecs" | "millis" | "millisecond" | "milliseconds" | "millisekunden" | "millisecondes"
        | "milisegundos" | "millisecondi" | "мс" | "毫秒" | "ミリ秒" => Some(TimeUnit::Milliseconds),
        "us" | "µs" | "μs" | "usec" | "usecs" | "micros" | "microsec" | "microsecond" | "microseconds"
        | "mikrosekunden" | "微秒" => Some(TimeUnit::Microseconds),
        "ns" | "nsec" | "nsecs" | "nanosec" | "nanosecs" | "nanoseconds" | "nanosecond" | "nanosekunden" => {
            Some(TimeUnit::Nanoseconds)
        }
        "min" | "minute" | "minutes" | "minuten" | "minuto" | "minutos" | "minuti" => Some(TimeUnit::Minutes),
        "day" | "days" => Some(TimeUnit::Days),
        _ => None,
    }
}

/// `grad` is the German degree; who counts 400 to a turn writes gon or gradians.
pub(super) fn angle_unit(word: &str) -> Option<AngleUnit> {
    match word {
        "rad" | "rads" | "radian" | "radians" | "radiant" | "bogenmaß" | "radianes" | "radianti" | "radián"
        | "弧度" => Some(AngleUnit::Radians),
        "deg" | "degs" | "degree" | "degrees" | "°" | "grad" | "degré" | "degrés" | "degre" | "degres" | "grado"
        | "grados" | "gradi" | "graus" | "graden" | "grader" | "stopnie" | "stupně" | "fok" | "derece" | "град"
        | "度" => Some(AngleUnit::Degrees),
        "mrad" | "milliradian" | "milliradians" => Some(AngleUnit::Milliradians),
        "gon" | "gradian" | "gradians" => Some(AngleUnit::Gradians),
        "turn" | "turns" | "rev" | "revs" | "revolutions" => Some(AngleUnit::Turns),
        _ => None,
    }
}

/// `deg/s`, `rad/min`, `rpm`.
pub(super) fn rate_unit(unit: &str) -> Option<RateUnit> {
    if let Some(unit) = rate_word(unit) {
        return Some(unit);
    }
    let (angle, time) = unit.split_once('/')?;
    Some(RateUnit { angle: angle_unit(angle.trim())?, time: time_unit(time.trim())? })
}

/// Units of angular velocity that are one word.
pub(super) fn rate_word(word: &str) -> Option<RateUnit> {
    match word {
        "rpm" => Some(RateUnit { angle: AngleUnit::Turns, time: TimeUnit::Minutes }),
        "dps" => Some(RateUnit::per_second(AngleUnit::Degrees)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_as_large_as_the_world_has_agreed() {
        use std::f64::consts::PI;
        let angles = [("rad", 1.0), ("°", PI / 180.0), ("mrad", 1e-3), ("gon", PI / 200.0), ("rev", 2.0 * PI)];
        for (word, radians) in angles {
            assert!((angle_unit(word).unwrap().radians() / radians - 1.0).abs() < 1e-12, "{word}");
        }
        let times = [("s", 1.0), ("ms", 1e-3), ("µs", 1e-6), ("ns", 1e-9), ("min", 60.0), ("days", 86_400.0)];
        for (word, seconds) in times {
            assert_eq!(time_unit(word).unwrap().seconds(), seconds, "{word}");
        }
        for (word, rad_per_s) in [("rpm", PI / 30.0), ("dps", PI / 180.0), ("deg/min", PI / 10_800.0)] {
            assert!((rate_unit(word).unwrap().rad_per_s() / rad_per_s - 1.0).abs() < 1e-12, "{word}");
        }
    }
}
