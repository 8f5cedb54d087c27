//! Units of time, angle and angular velocity, in the words of many languages.

use super::columns::{AngleUnit, RateUnit, TimeUnit};

/// `s`, `sekunden`, `millis`, in lower case.
pub(super) fn time_unit(word: &str) -> Option<TimeUnit> {
    match word {
        "s" | "sec" | "secs" | "second" | "seconds" | "sek" | "sekunde" | "sekunden" | "seconde" | "secondes"
        | "segundo" | "segundos" | "secondo" | "secondi" | "seconden" | "sekunder" | "sekundy" | "saniye" | "сек"
        | "с" | "秒" => Some(TimeUnit::Seconds),
        "ms" | "msec" | "millis" | "millisecond" | "milliseconds" | "millisekunden" | "millisecondes"
        | "milisegundos" | "millisecondi" | "мс" | "毫秒" | "ミリ秒" => Some(TimeUnit::Milliseconds),
        "us" | "µs" | "μs" | "usec" | "micros" | "microsecond" | "microseconds" | "mikrosekunden" => {
            Some(TimeUnit::Microseconds)
        }
        "ns" | "nsec" | "nanoseconds" | "nanosecond" | "nanosekunden" => Some(TimeUnit::Nanoseconds),
        "min" | "minute" | "minutes" | "minuten" | "minuto" | "minutos" | "minuti" => Some(TimeUnit::Minutes),
        "day" | "days" => Some(TimeUnit::Days),
        _ => None,
    }
}

/// `grad` is the German degree; who counts 400 to a turn writes gon or gradians.
pub(super) fn angle_unit(word: &str) -> Option<AngleUnit> {
    match word {
        "rad" | "rads" | "radian" | "radians" | "radiant" | "bogenmaß" | "radianes" | "radianti" | "radián" => {
            Some(AngleUnit::Radians)
        }
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
