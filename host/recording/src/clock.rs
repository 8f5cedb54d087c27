//! Dates and clock times as seconds: `2026-03-01T12:00:00.005Z`, `01.03.2026 12:00:00,005`, `12:00:00.005 PM`, `00:01.25`,
//! `12:00:00:005`, `03-01-2026_12:00:00`, with the month by its name as C, MATLAB and browsers write it (`Sun Mar  1 12:00:00
//! 2026`, `01-Mar-2026 12:00:00`, `Sun Mar 01 2026 12:00:00 GMT+0100`), and how long ago something was: `0 days 00:00:01.25`.
//!
//! Only differences matter: zones are left out, and of a date without a clear order month and day are taken as they come.

use super::cell::without_mark_of_text;
use std::ops::RangeInclusive;

/// A moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Moment {
    /// Days since 1970, when there is a date.
    pub(super) day: Option<i64>,
    /// Seconds of the day.
    pub(super) second: f64,
}

/// Seconds of a day.
pub(super) const DAY_S: f64 = 86_400.0;

/// Day of the week, month, day, clock, noon, zone in two words, and year.
const MOST_WORDS: usize = 8;

const MONTHS: &str = "january february march april may june july august september october november december";

impl Moment {
    /// Seconds since 1970, or since midnight where there is no date.
    pub(super) fn seconds(self) -> f64 {
        self.day.unwrap_or(0) as f64 * DAY_S + self.second
    }
}

/// Reads a clock time, with or without a date; `None` for anything else.
pub(super) fn read(text: &str) -> Option<Moment> {
    let text = without_mark_of_text(text.trim());
    of_numbers(text).or_else(|| with_name_of_month(text))
}

fn of_numbers(text: &str) -> Option<Moment> {
    if let Some((days, clock)) = text.split_once(" days ") {
        let (day, second) = (days.parse().ok()?, read_clock(clock.trim())?);
        return Some(Moment { day: Some(day), second });
    }
    let (date, clock) = match text.split_once(['T', ' ', '_']) {
        Some((date, clock)) if date.contains(['-', '/', '.']) && !date.contains(':') => (Some(date), clock.trim()),
        _ => (None, text),
    };
    let day = match date {
        Some(date) => Some(read_date(date)?),
        None => None,
    };
    Some(Moment { day, second: read_clock(without_zone(clock))? })
}

/// A day of the week may stand before, a zone behind; more words are a sentence.
fn with_name_of_month(text: &str) -> Option<Moment> {
    if !text.contains(':') || !text.contains(char::is_alphabetic) {
        return None;
    }
    // What a browser calls the zone stands in brackets.
    let moment = text.split_once(" (").map_or(text, |(moment, _)| moment);
    let words = moment.split([' ', '-', '/']).map(|word| word.trim_end_matches(','));
    let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
    let clock = words.iter().find(|word| word.contains(':'))?;
    let noon = words.iter().find(|word| word.eq_ignore_ascii_case("am") || word.eq_ignore_ascii_case("pm"));
    let month = words.iter().find_map(|word| month_of(word))?;
    let number = |n_digits: RangeInclusive<usize>| {
        let is_number = |word: &&&str| n_digits.contains(&word.len()) && word.bytes().all(|byte| byte.is_ascii_digit());
        words.iter().find(is_number)?.parse::<i64>().ok()
    };
    let (day, year) = (number(1..=2)?, number(4..=4)?);
    let second = read_clock(&format!("{clock}{}", noon.copied().unwrap_or_default()))?;
    let is_date = (1..=31).contains(&day) && year >= 1900 && words.len() <= MOST_WORDS;
    is_date.then(|| Moment { day: Some(days_since_1970(year, month, day)), second })
}

/// From 1, by its first three letters or more.
fn month_of(word: &str) -> Option<i64> {
    let word = word.to_ascii_lowercase();
    let place = MONTHS.split(' ').position(|month| word.len() >= 3 && month.starts_with(word.as_str()))?;
    Some(place as i64 + 1)
}

fn without_zone(clock: &str) -> &str {
    let clock = clock.trim_end_matches(['Z', 'z']).trim_end();
    // A sign behind the clock begins the zone.
    let zone = clock.rfind(['+', '-']).filter(|at| *at >= 4);
    zone.map_or(clock, |at| clock[..at].trim_end())
}

fn read_clock(clock: &str) -> Option<f64> {
    let lower = clock.to_lowercase();
    let (clock, noon) = match (lower.strip_suffix("pm"), lower.strip_suffix("am")) {
        (Some(clock), _) => (clock.trim(), Some(12.0)),
        (_, Some(clock)) => (clock.trim(), Some(0.0)),
        _ => (lower.as_str(), None),
    };
    let parts: Vec<&str> = clock.split(':').collect();
    let whole = |text: &str| (text.len() <= 2).then(|| text.parse::<u8>().ok()).flatten().map(f64::from);
    let second = |text: &str| {
        let is_plain = text.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.' || byte == b',');
        text.replace(',', ".").parse::<f64>().ok().filter(|second| is_plain && (0.0..61.0).contains(second))
    };
    let (hours, minutes, seconds) = match parts[..] {
        // Milliseconds behind a colon have three digits; two would be frames of a video.
        [hours, minutes, seconds, thousandths] if thousandths.len() == 3 => {
            let thousandths: u16 = thousandths.parse().ok()?;
            (whole(hours)?, whole(minutes)?, whole(seconds)? + f64::from(thousandths) / 1000.0)
        }
        [hours, minutes, seconds] => (whole(hours)?, whole(minutes)?, second(seconds)?),
        [minutes, seconds] if seconds.contains(['.', ',']) => (0.0, whole(minutes)?, second(seconds)?),
        [hours, minutes] => (whole(hours)?, whole(minutes)?, 0.0),
        _ => return None,
    };
    let hours = noon.map_or(hours, |noon| hours % 12.0 + noon);
    (minutes < 60.0 && hours <= 24.0).then_some(3600.0 * hours + 60.0 * minutes + seconds)
}

fn read_date(date: &str) -> Option<i64> {
    let parts: Vec<i64> = date.split(['-', '/', '.']).map(|part| part.parse().ok()).collect::<Option<_>>()?;
    let [a, b, c] = parts[..] else { return None };
    let (year, month, day) = match (a, c) {
        (1000.., _) => (a, b, c),
        (_, 1000..) if date.contains('.') || a > 12 => (c, b, a),
        (_, 1000..) => (c, a, b),
        _ => return None,
    };
    let is_date = (1..=12).contains(&month) && (1..=31).contains(&day) && year < 10_000;
    is_date.then(|| days_since_1970(year, month, day))
}

/// Count of days in the Gregorian calendar, by the months from March on.
fn days_since_1970(year: i64, month: i64, day: i64) -> i64 {
    let (year, month) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    let leap_days = year / 4 - year / 100 + year / 400;
    365 * year + leap_days + (153 * month + 2) / 5 + day - 1 - 719_468
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clocks_and_dates_of_many_countries_are_read() {
        // 1 March 2026 is day 20513 (date -d 2026-03-01 +%s / 86400).
        let noon = |second: f64| Some(Moment { day: Some(20_513), second: 43_200.0 + second });
        let bare = |second: f64| Some(Moment { day: None, second });
        let cases = [
            ("2026-03-01T12:00:00.005Z", noon(0.005)),
            ("2026-03-01 12:00:00,005", noon(0.005)),
            ("2026-03-01T12:00:00.5+01:00", noon(0.5)),
            ("2026/03/01 12:00:01", noon(1.0)),
            ("01.03.2026 12:00:00,25", noon(0.25)),
            ("3/1/2026 12:00:00.5 PM", noon(0.5)),
            ("03-01-2026_12:00:00.5", noon(0.5)),
            ("Sun Mar  1 12:00:00 2026", noon(0.0)),
            ("Sun Mar  1 12:00:01 CET 2026", noon(1.0)),
            ("Sun Mar 01 2026 12:00:02 GMT+0100 (Central European Standard Time)", noon(2.0)),
            ("Sun, 01 Mar 2026 12:00:00 -1000", noon(0.0)),
            ("01-Mar-2026 12:00:00.250", noon(0.25)),
            ("1 March 2026 12:00:00,5 PM", noon(0.5)),
            ("12:00:00.005", bare(43_200.005)),
            ("11:59:59 pm", bare(86_399.0)),
            ("12:00:00 AM", bare(0.0)),
            ("00:01.25", bare(1.25)),
            ("12:30", bare(45_000.0)),
            ("12:00:00:005", bare(43_200.005)),
            ("1 days 00:00:01.250000", Some(Moment { day: Some(1), second: 1.25 })),
        ];
        for (text, expected) in cases {
            assert_eq!(read(text), expected, "{text}");
        }
        for text in [
            "",
            "1.5",
            "2026-03-01",
            "12:61:00",
            "a:b",
            "1:2:3:04",
            "12:00:00.1.2",
            "::",
            "Mar 2026",
            "Sun Mar 12:00:00 2026",
            "Mar 1 12:61:00 2026",
        ] {
            assert_eq!(read(text), None, "{text}");
        }
    }

    #[test]
    fn days_are_counted_over_the_ends_of_months_leap_years_and_centuries() {
        // date -u -d DATE +%s / 86400
        let days = [
            ("1970-01-01", 0),
            ("1999-12-31", 10_956),
            ("2000-02-29", 11_016),
            ("2024-07-15", 19_919),
            ("2025-12-31", 20_453),
            ("2026-08-31", 20_696),
            ("2100-03-01", 47_541),
        ];
        for (date, day) in days {
            assert_eq!(read(&format!("{date} 00:00:00")), Some(Moment { day: Some(day), second: 0.0 }), "{date}");
        }
    }
}
