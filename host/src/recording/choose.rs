//! Which column is what: by what the user said, the header, the names, and at last the place.

use super::angle::Angles;
use super::circle::Circle;
use super::columns::{AngleUnit, ColumnRef, Columns, RateUnit, TimeUnit};
use super::error::Fault;
use super::header::Header;
use super::measured::Measured;
use super::number::{Cell, Numerals};
use super::rate::Rates;
use super::read::ReadOptions;
use super::samples::{MOST_COLUMNS, Samples};
use super::table::Table;
use super::words::{Meaning, is_size, meaning};
use super::{MIN_SAMPLES, clock, median_step_s};
use std::f64::consts::FRAC_PI_2;

/// Steps of unstated unit beyond this are refused: at 2 Hz a laboratory pendulum cannot be followed.
pub(super) const LONGEST_STEP_S: f64 = 0.5;

/// Times of unstated unit beyond this many seconds count from 1970, in the unit that puts them within a century of it.
const EPOCH_BEGINS_S: f64 = 1e8;

/// Where each quantity comes from.
pub(super) struct Sources {
    pub(super) time: TimeSource,
    pub(super) reading: ReadingSource,
    pub(super) code: Option<usize>,
}

/// Where time comes from.
#[derive(Debug)]
pub(super) enum TimeSource {
    Column {
        idx: usize,
        unit: Option<TimeUnit>,
    },
    /// Clock times, with or without a date.
    Clock {
        idx: usize,
    },
    Rate(f64),
}

/// Where what was measured comes from.
#[derive(Debug)]
pub(super) enum ReadingSource {
    /// Angles.
    Angle {
        idx: usize,
        unit: Option<AngleUnit>,
    },
    /// Angular velocities; of several axes the one that moves most counts.
    Rates {
        columns: Vec<usize>,
        unit: Option<RateUnit>,
    },
    /// Of a point on the pendulum.
    Point {
        x: usize,
        y: usize,
    },
    Codes,
}

impl TimeSource {
    fn column(&self) -> Option<usize> {
        match self {
            Self::Column { idx, .. } | Self::Clock { idx } => Some(*idx),
            Self::Rate(_) => None,
        }
    }

    /// Seconds of one unit as far as it is known while rows are read.
    pub(super) fn scale(&self) -> f64 {
        match self {
            Self::Column { unit, .. } => unit.unwrap_or(TimeUnit::Seconds).seconds(),
            _ => 1.0,
        }
    }
}

impl ReadingSource {
    /// The columns whose numbers are needed.
    pub(super) fn columns(&self) -> Vec<usize> {
        match self {
            Self::Angle { idx, .. } => vec![*idx],
            Self::Rates { columns, .. } => columns.clone(),
            Self::Point { x, y } => vec![*x, *y],
            Self::Codes => Vec::new(),
        }
    }

    /// The column before which its own time is looked for.
    fn first_idx(&self) -> Option<usize> {
        match self {
            Self::Angle { idx, .. } => Some(*idx),
            Self::Rates { columns, .. } => columns.first().copied(),
            Self::Point { .. } | Self::Codes => None,
        }
    }
}

impl Sources {
    /// Chooses the columns of a table; what is assumed is noted.
    pub(super) fn choose(
        table: &Table,
        header: &Header,
        options: &ReadOptions,
        notes: &mut Vec<String>,
    ) -> Result<Self, Fault> {
        let asked = options.columns.clone().unwrap_or_default();
        let code = choose_code(table, &asked)?;
        let reading = choose_reading(table, header, options, &asked, code);
        let reading_idx = reading.as_ref().ok().and_then(ReadingSource::first_idx);
        let time = choose_time(table, header, options, &asked, reading_idx, notes)?;
        let reading = reading?;
        if let (ReadingSource::Point { x, y }, None, None) = (&reading, &asked.x, &table.names) {
            notes.push(format!("columns {x} and {y} lie on a circle: read as x and y of a point"));
        }
        if time.column().is_some_and(|idx| reading.first_idx() == Some(idx)) {
            return Err(Fault::NoAngleColumn { available: table.available() });
        }
        log::debug!("columns: time from {time:?}, readings from {reading:?}, code from {code:?}");
        Ok(Self { time, reading, code })
    }

    /// What the readings are.
    pub(super) fn measured(&self) -> Measured {
        match self.reading {
            ReadingSource::Rates { .. } => Measured::Rate,
            _ => Measured::Angle,
        }
    }

    /// Do rows that are left out leave their time behind?
    pub(super) fn counts_rows(&self) -> bool {
        matches!(self.time, TimeSource::Rate(_))
    }

    /// Times in s from the numbers that were read.
    pub(super) fn times_s(&self, samples: &Samples, notes: &mut Vec<String>) -> Result<Vec<f64>, Fault> {
        let unit = match self.time {
            TimeSource::Rate(rate_hz) => return times_of_rows(rate_hz, samples),
            TimeSource::Clock { .. } => return Ok(samples.times.clone()),
            TimeSource::Column { unit, .. } => unit,
        };
        let first = samples.times.first().copied().unwrap_or_default();
        let epoch =
            unit.map_or_else(|| epoch_unit(first), |unit| (first * unit.seconds() > EPOCH_BEGINS_S).then_some(unit));
        if let Some(unit) = epoch {
            notes.push(format!("times count from 1970, in units of {} s: the first one taken off", unit.seconds()));
            return Ok(samples.times.iter().map(|time| (time - first) * unit.seconds()).collect());
        }
        let scale = unit.unwrap_or(TimeUnit::Seconds).seconds();
        let times_s: Vec<f64> = samples.times.iter().map(|time| time * scale).collect();
        let step = median_step_s(&times_s);
        if unit.is_none() && times_s.len() >= MIN_SAMPLES && step > LONGEST_STEP_S {
            return Err(Fault::StepTooLong { step });
        }
        Ok(times_s)
    }

    /// Angles (rad) or rates (rad/s) from the numbers that were read.
    pub(super) fn readings(
        &self,
        table: &Table,
        samples: &Samples,
        times_s: &[f64],
        header: &Header,
        options: &ReadOptions,
        notes: &mut Vec<String>,
    ) -> Result<Vec<f64>, Fault> {
        let is_ours = header.version.is_some();
        match &self.reading {
            ReadingSource::Codes => {
                let calibration = header.calibration.ok_or(Fault::NoCalibration)?;
                Ok(samples.codes.iter().map(|code| calibration.angle_rad(*code)).collect())
            }
            ReadingSource::Angle { unit, .. } => {
                Angles { times_s, is_ours, options, notes }.of_column(&samples.readings[0], *unit)
            }
            ReadingSource::Point { .. } => {
                Angles { times_s, is_ours, options, notes }.of_point(&samples.readings[0], &samples.readings[1])
            }
            ReadingSource::Rates { columns, unit } => {
                let names = columns.iter().map(|idx| table.column_name(*idx)).collect();
                Rates { times_s, is_ours, options, names, notes }.of_columns(&samples.readings, *unit)
            }
        }
    }
}

/// The unit in which a time lies between 1973 and 2100, if it is large enough to count from 1970.
fn epoch_unit(first: f64) -> Option<TimeUnit> {
    let units = [TimeUnit::Seconds, TimeUnit::Milliseconds, TimeUnit::Microseconds, TimeUnit::Nanoseconds];
    units.into_iter().find(|unit| (EPOCH_BEGINS_S..4.1e9).contains(&(first * unit.seconds())))
}

fn times_of_rows(rate_hz: f64, samples: &Samples) -> Result<Vec<f64>, Fault> {
    if !(rate_hz.is_finite() && rate_hz > 0.0) {
        return Err(Fault::BadRate { rate_hz });
    }
    Ok(samples.rows.iter().map(|row| f64::from(*row) / rate_hz).collect())
}

fn choose_code(table: &Table, asked: &Columns) -> Result<Option<usize>, Fault> {
    match &asked.code {
        Some(column) => find(table, column).map(Some),
        None => Ok(table.names.iter().flatten().position(|name| meaning(name) == Meaning::Code)),
    }
}

/// A column that is named or told; of several the one before the angle, where each quantity has times of its own; else
/// one of clock times, the rate, or the first column.
fn choose_time(
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
        (_, Some((idx, unit)), _) => Ok(TimeSource::Column { idx, unit: unit.or(unit_in_name(table, idx)) }),
        (_, None, Some(rate_hz)) => Ok(TimeSource::Rate(rate_hz)),
        (None, None, None) if table.names.is_none() && table.n_columns >= 2 && reading_idx != Some(0) => {
            notes.push("no column names: column 0 read as time".to_owned());
            Ok(TimeSource::Column { idx: 0, unit: None })
        }
        (None, None, None) => Err(Fault::NoTimeColumn { available: table.available() }),
    }
}

type NamedTime = Option<(usize, Option<TimeUnit>)>;

fn named_time(table: &Table, angle_idx: Option<usize>, notes: &mut Vec<String>) -> Result<NamedTime, Fault> {
    let is_time = |meaning| match meaning {
        Meaning::Time { unit, strength } => Some((unit, strength)),
        _ => None,
    };
    let found = best(table, "time", is_time);
    let (Err(Fault::AmbiguousColumn { .. }), Some(angle_idx)) = (&found, angle_idx) else { return found };
    let names = table.names.as_deref().unwrap_or_default();
    let before = names[..angle_idx].iter().rposition(|name| is_time(meaning(name)).is_some());
    let Some(idx) = before else { return found };
    let (name, angle) = (table.column_name(idx), table.column_name(angle_idx));
    notes.push(format!("several columns of times: {name} taken, which stands before {angle}"));
    Ok(Some((idx, unit_in_name(table, idx))))
}

fn unit_in_name(table: &Table, idx: usize) -> Option<TimeUnit> {
    match meaning(table.names.as_ref()?.get(idx)?) {
        Meaning::Time { unit, .. } => unit,
        _ => None,
    }
}

/// Rates where the user, the header or the names say so, else angles.
fn choose_reading(
    table: &Table,
    header: &Header,
    options: &ReadOptions,
    asked: &Columns,
    code_idx: Option<usize>,
) -> Result<ReadingSource, Fault> {
    if let Some((column, unit)) = &asked.rate {
        let idx = find(table, column)?;
        return Ok(rates(table, options, vec![idx], *unit));
    }
    let is_told = asked.angle.is_some() || asked.x.is_some();
    let measured =
        (!is_told).then(|| header.measured.or(options.measured.filter(|_| header.version.is_none()))).flatten();
    let has_rate = options.rate_hz.or(header.rate_hz).is_some();
    let angle = choose_angle(table, asked, code_idx, has_rate);
    match (measured, angle) {
        (Some(Measured::Rate), angle) => match (rate_columns(table), angle) {
            (columns, _) if !columns.is_empty() => Ok(rates(table, options, columns, None)),
            // The header says what a column without a word, or one that is named after the angle, holds.
            (_, Ok(ReadingSource::Angle { idx, unit })) => {
                Ok(rates(table, options, vec![idx], unit.map(RateUnit::per_second)))
            }
            _ => Err(Fault::NoAngleColumn { available: table.available() }),
        },
        (None, Err(Fault::NoAngleColumn { available })) => match rate_columns(table) {
            columns if columns.is_empty() => Err(Fault::NoAngleColumn { available }),
            columns => Ok(rates(table, options, columns, None)),
        },
        (_, Ok(ReadingSource::Angle { idx, unit })) => {
            Ok(ReadingSource::Angle { idx, unit: options.angle_unit.or(unit) })
        }
        (_, angle) => angle,
    }
}

/// Columns of rates with the unit that was told, or that their names have.
fn rates(table: &Table, options: &ReadOptions, columns: Vec<usize>, told: Option<RateUnit>) -> ReadingSource {
    let in_name = |idx: &usize| match meaning(table.names.as_ref()?.get(*idx)?) {
        Meaning::Rate { unit } => unit,
        _ => None,
    };
    let unit = options.angle_unit.map(RateUnit::per_second).or(told).or(columns.first().and_then(in_name));
    ReadingSource::Rates { columns, unit }
}

/// Columns that are named as angular velocities, without the size of all axes together, which has no sign.
fn rate_columns(table: &Table) -> Vec<usize> {
    let is_rate = |name: &String| matches!(meaning(name), Meaning::Rate { .. }) && !is_size(name);
    table
        .names
        .iter()
        .flatten()
        .enumerate()
        .filter(|(_, name)| is_rate(name))
        .map(|(idx, _)| idx)
        .take(MOST_COLUMNS)
        .collect()
}

/// A named angle column, or x and y of a point; without names the first one that is not taken, and the next one with it
/// where both lie on a circle; none at all is fine when there are codes.
fn choose_angle(
    table: &Table,
    asked: &Columns,
    code_idx: Option<usize>,
    has_rate: bool,
) -> Result<ReadingSource, Fault> {
    if let Some((column, unit)) = &asked.angle {
        let idx = find(table, column)?;
        return Ok(ReadingSource::Angle { idx, unit: unit.or(angle_unit_in_name(table, idx)) });
    }
    if let (Some(x), Some(y)) = (&asked.x, &asked.y) {
        return Ok(ReadingSource::Point { x: find(table, x)?, y: find(table, y)? });
    }
    let named = best(table, "angle", |meaning| match meaning {
        Meaning::Angle { unit, strength } => Some((unit, strength)),
        _ => None,
    })?;
    let named_so = |wanted: Meaning| {
        let mut all = table.names.iter().flatten().enumerate().filter(|(_, name)| meaning(name) == wanted);
        all.next().map(|(idx, _)| idx).filter(|_| all.next().is_none())
    };
    let time_idx = asked.time.as_ref().and_then(|(column, _)| find(table, column).ok());
    let fields = table.first_fields();
    let is_clock = |idx: &usize| fields.get(*idx).is_some_and(|field| clock::read(field).is_some());
    let first = (table.n_columns > 1 && !has_rate).then_some(0);
    let time_idx = time_idx.or((0..table.n_columns).find(is_clock)).or(first);
    let is_free = |idx: &usize| Some(*idx) != time_idx && Some(*idx) != code_idx;
    let is_number = |idx: &usize| fields.get(*idx).is_some_and(|field| Numerals::new().read(field) != Cell::Text);
    let mut unnamed = (0..table.n_columns).filter(|idx| is_free(idx) && is_number(idx));
    let (unnamed, next) = (unnamed.next(), unnamed.next());
    match (named, named_so(Meaning::X), named_so(Meaning::Y), unnamed) {
        (Some((idx, unit)), ..) => Ok(ReadingSource::Angle { idx, unit }),
        (None, Some(x), Some(y), _) => Ok(ReadingSource::Point { x, y }),
        (None, ..) if code_idx.is_some() => Ok(ReadingSource::Codes),
        (None, _, _, Some(idx)) if table.names.is_none() || table.n_columns == 1 => {
            let y = next.filter(|y| table.names.is_none() && lie_on_circle(table, idx, *y));
            Ok(y.map_or(ReadingSource::Angle { idx, unit: None }, |y| ReadingSource::Point { x: idx, y }))
        }
        _ => Err(Fault::NoAngleColumn { available: table.available() }),
    }
}

/// Are two columns x and y of a point that swings? Angle and rate of a slow pendulum may lie on a circle too, but they go
/// round it.
fn lie_on_circle(table: &Table, x: usize, y: usize) -> bool {
    let (x, y) = (table.first_numbers(x), table.first_numbers(y));
    let n = x.len().min(y.len());
    let Some(circle) = Circle::through(&x[..n], &y[..n], None).ok().filter(|_| n >= MIN_SAMPLES) else { return false };
    let angles_rad = circle.angles_rad(&x[..n], &y[..n]);
    angles_rad.iter().all(|angle_rad| angle_rad.abs() < FRAC_PI_2)
}

fn angle_unit_in_name(table: &Table, idx: usize) -> Option<AngleUnit> {
    match meaning(table.names.as_ref()?.get(idx)?) {
        Meaning::Angle { unit, .. } => unit,
        _ => None,
    }
}

/// The one column whose name fits best; an error when two fit equally.
fn best<U: Copy>(
    table: &Table,
    role: &'static str,
    fits: impl Fn(Meaning) -> Option<(Option<U>, u8)>,
) -> Result<Option<(usize, Option<U>)>, Fault> {
    let names = table.names.as_deref().unwrap_or_default();
    let fitting = || names.iter().enumerate().filter_map(|(idx, name)| fits(meaning(name)).map(|fit| (idx, fit)));
    let strongest = fitting().map(|(_, (_, strength))| strength).max();
    let mut winners = fitting().filter(|(_, (_, strength))| Some(*strength) == strongest);
    let first = winners.next().map(|(idx, (unit, _))| (idx, unit));
    if let (Some((first_idx, _)), Some((second_idx, _))) = (first, winners.next()) {
        let candidates = format!("{}, {}", table.column_name(first_idx), table.column_name(second_idx));
        return Err(Fault::AmbiguousColumn { role, candidates });
    }
    Ok(first)
}

fn find(table: &Table, column: &ColumnRef) -> Result<usize, Fault> {
    let n_columns = table.names.as_ref().map_or(table.n_columns, |names| names.len().max(table.n_columns));
    let (found, wanted) = match column {
        ColumnRef::Index(idx) => ((*idx < n_columns).then_some(*idx), idx.to_string()),
        ColumnRef::Name(wanted) => (position_of_name(table, wanted), format!("\"{wanted}\"")),
    };
    found.ok_or_else(|| Fault::UnknownColumn { wanted, available: table.available() })
}

/// The whole name first, else the only name that begins so (`angle` for `angle (deg)`).
fn position_of_name(table: &Table, wanted: &str) -> Option<usize> {
    let wanted = wanted.to_lowercase();
    let names: Vec<String> = table.names.iter().flatten().map(|name| name.to_lowercase()).collect();
    let mut beginning = names.iter().enumerate().filter(|(_, name)| name.starts_with(&wanted)).map(|(idx, _)| idx);
    let only = beginning.next().filter(|_| beginning.next().is_none());
    names.iter().position(|name| *name == wanted).or(only)
}
