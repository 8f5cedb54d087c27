//! Which column is the time, or what tells it; and in what unit it counts.

use super::super::cell;
use super::super::chosen::TimeSource;
use super::super::clock;
use super::super::columns::Columns;
use super::super::error::Fault;
use super::super::header::Header;
use super::super::limits::{LONGEST_STEP_S, MIN_SAMPLES};
use super::super::median_step_s;
use super::super::options::ReadOptions;
use super::super::plausible::{LONGEST_PERIOD_S, SHORTEST_PERIOD_S, Swings};
use super::super::samples::Samples;
use super::super::table::Table;
use super::super::ticks;
use super::super::told::Told;
use super::super::units::TimeUnit;
use super::super::words::{self, Meaning, meaning};
use super::names::{all_best, ambiguous, find, named_times, the_one};
use super::parted::parted;
use super::standing::{has_words_and_no_time, rises_evenly, time_without_name, unnamed_time};

/// Times of unstated unit beyond this many seconds count from 1970, in the unit that puts them within a century of it.
const EPOCH_BEGINS_S: f64 = 1e8;

/// A gate on slightly leaning hinges takes that long, and Foucault's pendulum under the dome of the Panthéon, 67 m long, 16.4 s.
const LONGEST_SEEN_S: f64 = 17.0;

/// That and what large swings add, 18 % at 90°: whole numbers of which a swing takes longer count rows.
const LONGEST_COUNTED_S: f64 = 1.18 * LONGEST_SEEN_S;

impl TimeSource {
    /// Times in s from the numbers that were read.
    pub(crate) fn times_s(&self, samples: &Samples, told: Told, notes: &mut Vec<String>) -> Result<Vec<f64>, Fault> {
        let unit = match *self {
            Self::Rate(rate_hz) => return times_of_rows(rate_hz, samples),
            Self::Clock { .. } => return Ok(samples.times.clone()),
            Self::Counter { rate_hz, .. } => return times_of_counts(rate_hz, &samples.times),
            Self::Column { unit, .. } => unit,
        };
        let first = samples.times.first().copied().unwrap_or_default();
        let step = median_step_s(&samples.times);
        let epoch = match unit {
            None => epoch_unit(first).filter(|unit| step * unit.seconds() < LONGEST_PERIOD_S),
            Some(unit) => (first * unit.seconds() > EPOCH_BEGINS_S).then_some(unit),
        };
        if let Some(unit) = epoch {
            notes.push(format!("times count from 1970, in units of {} s: the first one taken off", unit.seconds()));
            return Ok(samples.times.iter().map(|time| (time - first) * unit.seconds()).collect());
        }
        let is_doubtful = unit.is_none() && samples.times.len() >= MIN_SAMPLES;
        let unit = match unit {
            None if is_doubtful && (step > LONGEST_STEP_S || is_spreadsheet_date(first)) => {
                unit_by_period(samples, told, notes)?.ok_or(Fault::StepTooLong { step, told })?
            }
            unit => unit.unwrap_or(TimeUnit::Seconds),
        };
        let begin = if unit == TimeUnit::Days { first } else { 0.0 };
        Ok(samples.times.iter().map(|time| (time - begin) * unit.seconds()).collect())
    }
}

/// The unit in which a time lies between 1973 and 2100, if it is large enough to count from 1970.
fn epoch_unit(first: f64) -> Option<TimeUnit> {
    let units = [TimeUnit::Seconds, TimeUnit::Milliseconds, TimeUnit::Microseconds, TimeUnit::Nanoseconds];
    units.into_iter().find(|unit| (EPOCH_BEGINS_S..4.1e9).contains(&(first * unit.seconds())))
}

/// Days since 1900 of a moment between 1954 and 2119, with a time of the day.
fn is_spreadsheet_date(first: f64) -> bool {
    (20_000.0..80_000.0).contains(&first) && first.fract() != 0.0
}

/// The one unit in which the swings take as long as those of a pendulum: longest and shortest periods are less than a
/// thousand apart, as seconds and milliseconds are.
fn unit_by_period(samples: &Samples, told: Told, notes: &mut Vec<String>) -> Result<Option<TimeUnit>, Fault> {
    let Some((unit, name, period_s)) = possible_unit(samples) else { return Ok(None) };
    let is_counted = are_counted(&samples.times);
    if is_counted && period_s > LONGEST_COUNTED_S {
        return Err(Fault::CountsRows { unit: name, period_s, told });
    }
    notes.push(match is_counted {
        true if period_s > LONGEST_SEEN_S => format!(
            "doubtful: nothing states the unit of the time, and in {name} it would swing there and back in {period_s:.1} s; \
             it seems to count frames or samples: say --rate, how many rows a second there are"
        ),
        _ => format!(
            "the unit of the time is not stated: in {name} it swings there and back in {period_s:.3} s, as a pendulum does, \
             in any other unit it would not{}",
            if is_counted { "; if it counts frames or samples, --rate says how many rows a second there are" } else { "" }
        ),
    });
    Ok(Some(unit))
}

/// That unit, its name, and the period in it, s.
fn possible_unit(samples: &Samples) -> Option<(TimeUnit, &'static str, f64)> {
    let range = |readings: &Vec<f64>| {
        let (low, high) = readings.iter().fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
        high - low
    };
    let readings = samples.readings.iter().max_by(|a, b| range(a).total_cmp(&range(b)))?;
    let period = Swings::of(&samples.times, readings)?.period_s;
    let units = [
        (TimeUnit::Seconds, "seconds"),
        (TimeUnit::Milliseconds, "milliseconds"),
        (TimeUnit::Microseconds, "microseconds"),
        (TimeUnit::Nanoseconds, "nanoseconds"),
        (TimeUnit::Days, "days"),
    ];
    let is_possible = |unit: TimeUnit| (SHORTEST_PERIOD_S..LONGEST_PERIOD_S).contains(&(period * unit.seconds()));
    let (unit, name) = units.into_iter().find(|(unit, _)| is_possible(*unit))?;
    Some((unit, name, period * unit.seconds()))
}

/// Whole numbers with the very same step throughout may be frames of a video, of which every tenth was looked at.
fn are_counted(times: &[f64]) -> bool {
    let step = times.get(1).zip(times.first()).map_or(0.0, |(second, first)| second - first);
    times.iter().all(|time| time.fract() == 0.0) && times.windows(2).all(|pair| pair[1] - pair[0] == step)
}

/// One step of the counter is a sample, or its usual step where it counts frames of which every third one is there.
fn times_of_counts(rate_hz: f64, counts: &[f64]) -> Result<Vec<f64>, Fault> {
    if !(rate_hz.is_finite() && rate_hz > 0.0) {
        return Err(Fault::BadRate { rate_hz });
    }
    let step = median_step_s(counts);
    let first = counts.first().copied().unwrap_or_default();
    Ok(counts.iter().map(|count| (count - first) / step / rate_hz).collect())
}

/// A column that is named after frames, samples or rows, and counts them.
fn counter(table: &Table) -> Option<usize> {
    let counts = |idx: &usize| {
        let numbers = table.first_numbers(*idx);
        numbers.len() >= MIN_SAMPLES
            && numbers.iter().all(|number| number.fract() == 0.0)
            && numbers.windows(2).all(|pair| pair[1] > pair[0])
    };
    let names = table.names.as_deref()?;
    (0..names.len()).filter(|idx| words::is_counter(&names[*idx])).find(counts)
}

fn times_of_rows(rate_hz: f64, samples: &Samples) -> Result<Vec<f64>, Fault> {
    if !(rate_hz.is_finite() && rate_hz > 0.0) {
        return Err(Fault::BadRate { rate_hz });
    }
    Ok(samples.rows.iter().map(|row| f64::from(*row) / rate_hz).collect())
}

/// A column that is named or told; of several the one before the angle, where each quantity has times of its own; else
/// one of clock times, the rate, or the first column.
pub(super) fn choose_time(
    table: &Table,
    header: &Header,
    options: &ReadOptions,
    asked: &Columns,
    reading_idx: Option<usize>,
    notes: &mut Vec<String>,
) -> Result<TimeSource, Fault> {
    let named = match &asked.time {
        Some((column, unit)) => Some((find(table, column)?, *unit)),
        None => named_time(table, reading_idx, notes)?,
    };
    if let Some(rate_hz) = options.rate_hz {
        if let Some(idx) = counter(table).filter(|_| asked.time.is_none()) {
            notes.push(format!("{} counts the samples, {rate_hz} a second", table.column_name(idx)));
            return Ok(TimeSource::Counter { idx, rate_hz });
        }
        if let Some((idx, _)) = named {
            notes.push(format!("time column {} ignored, the given rate of {rate_hz} Hz used", table.column_name(idx)));
        }
        return Ok(TimeSource::Rate(rate_hz));
    }
    let fields = table.first_fields();
    let is_clock = |idx: &usize| fields.get(*idx).is_some_and(|field| clock::read(field).is_some());
    let clock_idx = named.map(|(idx, _)| idx).or_else(|| (0..table.n_columns).find(is_clock)).filter(is_clock);
    match (clock_idx, named, header.rate_hz) {
        (Some(idx), ..) => Ok(TimeSource::Clock { idx }),
        (_, Some((idx, unit)), _) => {
            let unit = unit.or(unit_in_name(table, idx)).or_else(|| unit_in_cell(table, idx, words::time_unit));
            Ok(TimeSource::Column { idx, unit })
        }
        (_, None, Some(rate_hz)) => {
            if header.version.is_none() && table.settings.is_none() {
                notes.push(format!("{rate_hz} samples a second, as a line above the table says"));
            }
            Ok(match counter(table) {
                Some(idx) => TimeSource::Counter { idx, rate_hz },
                None => TimeSource::Rate(rate_hz),
            })
        }
        (None, None, None)
            if table.names.is_none()
                && table.n_columns >= 2
                && reading_idx != Some(unnamed_time(table))
                && !has_words_and_no_time(table) =>
        {
            let idx = unnamed_time(table);
            notes.push(format!("no column names: column {idx} read as time"));
            Ok(TimeSource::Column { idx, unit: unit_in_cell(table, idx, words::time_unit) })
        }
        (None, None, None) => {
            let idx = alone_rising(table).ok_or_else(|| Fault::NoTimeColumn { available: table.available() })?;
            notes.push(format!("{} is the only column that goes on evenly: read as the time", table.column_name(idx)));
            Ok(TimeSource::Column { idx, unit: unit_in_cell(table, idx, words::time_unit) })
        }
    }
}

/// The only column that goes on evenly, by steps that are no whole numbers of rows, where its name says nothing.
fn alone_rising(table: &Table) -> Option<usize> {
    let names = table.names.as_deref()?;
    let rises = |idx: &usize| {
        let numbers = table.first_numbers(*idx);
        numbers.len() >= MIN_SAMPLES && rises_evenly(&numbers) && numbers.iter().any(|number| number.fract() != 0.0)
    };
    let mut rising = (0..names.len()).filter(|idx| meaning(&names[*idx]) == Meaning::Other).filter(rises);
    rising.next().filter(|_| rising.next().is_none())
}

/// Time and reading where x and y are a plot's: one of them, mostly x, goes on by even steps, which a point that swings
/// does not, and nothing else is the time.
pub(super) fn plotted_axes(table: &Table, asked: &Columns) -> Option<(usize, usize)> {
    let is_time = |name: &String| matches!(meaning(name), Meaning::Time { .. });
    let is_told = *asked != Columns::default();
    if is_told || table.names.iter().flatten().any(is_time) {
        return None;
    }
    let (x, y) = the_one(table, Meaning::X).zip(the_one(table, Meaning::Y))?;
    [(x, y), (y, x)].into_iter().find(|(time, _)| {
        let times = table.first_numbers(*time);
        times.len() > MIN_SAMPLES && (rises_evenly(&times) || ticks::is_even(&times) || ticks::is_straight(&times))
    })
}

/// What stands behind the number in the first row: `57.3 deg`.
pub(super) fn unit_in_cell<U>(table: &Table, idx: usize, known: impl Fn(&str) -> Option<U>) -> Option<U> {
    let fields = table.first_fields();
    let (_, unit) = cell::number_and_unit(fields.get(idx)?)?;
    known(&unit.to_lowercase())
}

type NamedTime = Option<(usize, Option<TimeUnit>)>;

pub(super) fn as_time(meaning: Meaning) -> Option<(Option<TimeUnit>, u8)> {
    match meaning {
        Meaning::Time { unit, strength } => Some((unit, strength)),
        _ => None,
    }
}

fn named_time(table: &Table, angle_idx: Option<usize>, notes: &mut Vec<String>) -> Result<NamedTime, Fault> {
    let all = all_best(table, as_time);
    let names = table.names.as_deref().unwrap_or_default();
    let parted = parted(table);
    let is_part = |idx: usize| parted.is_some_and(|parted| idx == parted.seconds || idx == parted.rest);
    if let Some(parted) = parted.filter(|_| all.iter().all(|(idx, _)| is_part(*idx))) {
        return Ok(Some((parted.seconds, Some(TimeUnit::Seconds))));
    }
    let made = names.iter().position(|name| words::is_stamp(name));
    if let Some(idx) = made.filter(|idx| is_part(*idx) || rises_evenly(&table.first_numbers(*idx))) {
        let is_other = |(other, _): &&(usize, _)| *other != idx && !is_part(*other);
        let others = all.iter().filter(is_other).map(|(other, _)| table.column_name(*other));
        let others = others.collect::<Vec<_>>().join(", ");
        if !others.is_empty() {
            let made = table.column_name(idx);
            notes.push(format!("{made} taken as the time, when it was measured, and not {others}, when it arrived"));
        }
        return Ok(Some((idx, unit_in_name(table, idx))));
    }
    let may_be = named_times(table);
    if let Some(time) = time_without_name(table, &all.iter().map(|(idx, _)| *idx).collect::<Vec<usize>>()) {
        let counts = all.iter().map(|(idx, _)| table.column_name(*idx)).collect::<Vec<_>>().join(", ");
        notes.push(format!("column {time} without a name rises evenly and is the time: {counts} counts rows"));
        return Ok(Some((time, None)));
    }
    let all: Vec<_> = all.into_iter().filter(|(idx, _)| may_be.contains(idx)).collect();
    if all.len() < 2 {
        return Ok(all.first().copied());
    }
    let columns: Vec<usize> = all.iter().map(|(idx, _)| *idx).collect();
    let before = angle_idx.and_then(|angle_idx| may_be.iter().copied().rfind(|idx| *idx < angle_idx));
    if let Some((idx, angle_idx)) = before.zip(angle_idx) {
        let (name, angle) = (table.column_name(idx), table.column_name(angle_idx));
        notes.push(format!("several columns of times: {name} taken, which stands before {angle}"));
        return Ok(Some((idx, unit_in_name(table, idx))));
    }
    if are_one_clock(table, &columns) {
        return Ok(all.iter().find(|(_, unit)| unit.is_some()).or(all.first()).copied());
    }
    Err(ambiguous(table, "time", &columns))
}

/// Do these columns count the same moments, in whatever units and from whenever?
fn are_one_clock(table: &Table, columns: &[usize]) -> bool {
    let all: Vec<Vec<f64>> = columns.iter().map(|idx| table.first_numbers(*idx)).collect();
    let first = &all[0];
    let span = |numbers: &[f64]| numbers.last().zip(numbers.first()).map_or(0.0, |(last, first)| last - first);
    // Half a step apart they are still the same rows.
    let near = 0.5 / first.len().max(1) as f64;
    let is_same = |numbers: &Vec<f64>| {
        let shares = |of: &[f64]| of.iter().map(|time| (time - of[0]) / span(of)).collect::<Vec<f64>>();
        numbers.len() == first.len()
            && span(numbers) > 0.0
            && shares(numbers).iter().zip(shares(first)).all(|(a, b)| (a - b).abs() < near)
    };
    first.len() >= MIN_SAMPLES && span(first) > 0.0 && all[1..].iter().all(is_same)
}

fn unit_in_name(table: &Table, idx: usize) -> Option<TimeUnit> {
    match meaning(table.names.as_ref()?.get(idx)?) {
        Meaning::Time { unit, .. } => unit,
        _ => None,
    }
}
