//! Reading a recording: our own format or anybody's CSV.
//!
//! Nothing is repaired silently: what is dropped or assumed is told in the notes, what cannot be understood is an error
//! that names line, column and value. No bytes whatever make it panic.

use std::fs;
use std::io;
use std::path::Path;

use super::columns::{AngleUnit, ColumnRef, Columns, Meaning, TimeUnit, meaning};
use super::error::{Fault, ReadError, check_step};
use super::header::{Header, HeaderReader};
use super::table::{Row, Table};
use super::{MIN_SAMPLES, Recording, median_step_s, uniform_times};

/// Angles of unstated unit beyond this are refused: a pendulum that only swings stays within a turn (2π), with margin.
pub(super) const LARGEST_UNSTATED_RAD: f64 = 7.0;

/// Angles of unstated unit beyond this leave a note: more than half a turn is rare.
const NOTED_UNSTATED_RAD: f64 = 3.3;

/// Steps of unstated unit beyond this are refused: at 2 Hz a laboratory pendulum cannot be followed.
pub(super) const LONGEST_STEP_S: f64 = 0.5;

/// What the user says about the file; what is left out is found.
#[derive(Debug, Clone, Default)]
pub struct ReadOptions {
    /// `--columns`
    pub columns: Option<Columns>,
    /// `--rate`, Hz: for files without a time column; a time column is then ignored.
    pub rate_hz: Option<f64>,
    /// `--degrees` or `--radians`.
    pub angle_unit: Option<AngleUnit>,
}

/// Reads the recording at `path`.
///
/// # Errors
/// Everything in [`Fault`], with the file's name.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Recording, ReadError> {
    let with_name = |fault| ReadError { file: path.display().to_string(), fault };
    let bytes = load(path).map_err(with_name)?;
    parse(&bytes, options).map_err(with_name)
}

/// Reads a recording from the bytes of a file; `file` is what messages call it.
///
/// # Errors
/// Everything in [`Fault`], with the file's name.
pub fn read_bytes(file: &str, bytes: &[u8], options: &ReadOptions) -> Result<Recording, ReadError> {
    parse(bytes, options).map_err(|fault| ReadError { file: file.to_owned(), fault })
}

fn load(path: &Path) -> Result<Vec<u8>, Fault> {
    if path.is_dir() {
        return Err(Fault::Directory);
    }
    fs::read(path).map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => Fault::Missing,
        _ => Fault::Unreadable(error),
    })
}

fn parse(bytes: &[u8], options: &ReadOptions) -> Result<Recording, Fault> {
    let table = Table::new(bytes)?;
    let header = read_header(&table)?;
    let mut notes = Vec::new();
    let sources = Sources::choose(&table, &header, options, &mut notes)?;
    let is_ours = header.version.is_some();
    let samples = Samples::collect(&table, &sources, is_ours, &mut notes)?;
    let angles_rad = sources.angles_rad(&samples, &header, &mut notes)?;
    let times_s = sources.times_s(&samples)?;
    let codes = (!samples.codes.is_empty()).then_some(samples.codes);
    Ok(Recording::new(header, times_s, angles_rad, codes)?.with_notes(notes))
}

fn read_header(table: &Table) -> Result<Header, Fault> {
    let mut reader = HeaderReader::default();
    table.comments().try_for_each(|(line, text)| reader.take(line, text))?;
    Ok(reader.finish())
}

/// Where each quantity comes from.
struct Sources {
    time: TimeSource,
    /// Column of the angle and its unit; `None`: from the codes.
    angle: Option<(usize, Option<AngleUnit>)>,
    code: Option<usize>,
}

#[derive(Debug)]
enum TimeSource {
    Column { idx: usize, unit: Option<TimeUnit> },
    Rate(f64),
}

/// The needed columns as read, in the file's units.
#[derive(Default)]
struct Samples {
    lines: Vec<usize>,
    times: Vec<f64>,
    angles: Vec<f64>,
    codes: Vec<u16>,
}

impl Sources {
    fn choose(table: &Table, header: &Header, options: &ReadOptions, notes: &mut Vec<String>) -> Result<Self, Fault> {
        let asked = options.columns.clone().unwrap_or_default();
        let code = choose_code(table, &asked)?;
        let time = choose_time(table, header, options, &asked, notes)?;
        let time_idx = match time {
            TimeSource::Column { idx, .. } => Some(idx),
            TimeSource::Rate(_) => None,
        };
        let mut angle = choose_angle(table, &asked, time_idx, code)?;
        if let Some((_, unit)) = &mut angle {
            *unit = options.angle_unit.or(*unit);
        }
        log::debug!("columns: time from {time:?}, angle from {angle:?}, code from {code:?}");
        Ok(Self { time, angle, code })
    }

    fn times_s(&self, samples: &Samples) -> Result<Vec<f64>, Fault> {
        let (idx_unit, scale) = match self.time {
            TimeSource::Rate(rate_hz) => return uniform_times(rate_hz, samples.lines.len()),
            TimeSource::Column { unit, .. } => (unit, unit.unwrap_or(TimeUnit::Seconds).seconds()),
        };
        let times_s: Vec<f64> = samples.times.iter().map(|time| time * scale).collect();
        for (idx, pair) in times_s.windows(2).enumerate() {
            check_step(&format!("line {}", samples.lines[idx + 1]), pair[0], pair[1])?;
        }
        let step = median_step_s(&times_s);
        if idx_unit.is_none() && times_s.len() >= MIN_SAMPLES && step > LONGEST_STEP_S {
            return Err(Fault::StepTooLong { step });
        }
        Ok(times_s)
    }

    fn angles_rad(&self, samples: &Samples, header: &Header, notes: &mut Vec<String>) -> Result<Vec<f64>, Fault> {
        let Some((_, unit)) = self.angle else {
            let calibration = header.calibration.ok_or(Fault::NoCalibration)?;
            return Ok(samples.codes.iter().map(|code| calibration.angle_rad(*code)).collect());
        };
        if unit.is_none() && header.version.is_none() {
            judge_unstated_unit(&samples.angles, notes)?;
        }
        let scale = unit.unwrap_or(AngleUnit::Radians).radians();
        Ok(samples.angles.iter().map(|angle| angle * scale).collect())
    }
}

fn judge_unstated_unit(angles: &[f64], notes: &mut Vec<String>) -> Result<(), Fault> {
    let largest = angles.iter().fold(0.0_f64, |largest, angle| largest.max(angle.abs()));
    if largest > LARGEST_UNSTATED_RAD {
        return Err(Fault::LooksLikeDegrees { largest });
    }
    if largest > NOTED_UNSTATED_RAD {
        notes.push(format!("angles reach {largest:.2}, read as radians; if they are degrees say --degrees"));
    }
    Ok(())
}

fn choose_code(table: &Table, asked: &Columns) -> Result<Option<usize>, Fault> {
    match &asked.code {
        Some(column) => find(table, column).map(Some),
        None => Ok(table.names.iter().flatten().position(|name| meaning(name) == Meaning::Code)),
    }
}

fn choose_time(
    table: &Table,
    header: &Header,
    options: &ReadOptions,
    asked: &Columns,
    notes: &mut Vec<String>,
) -> Result<TimeSource, Fault> {
    let named = match &asked.time {
        Some((column, unit)) => Some((find(table, column)?, *unit)),
        None => best(table, "time", |meaning| match meaning {
            Meaning::Time { unit, strength } => Some((unit, strength)),
            _ => None,
        })?,
    };
    if let Some(rate_hz) = options.rate_hz {
        if let Some((idx, _)) = named {
            notes.push(format!("time column {} ignored, the given rate of {rate_hz} Hz used", table.column_name(idx)));
        }
        return Ok(TimeSource::Rate(rate_hz));
    }
    match (named, header.rate_hz) {
        (Some((idx, unit)), _) => Ok(TimeSource::Column { idx, unit: unit.or(unit_in_name(table, idx)) }),
        (None, Some(rate_hz)) => Ok(TimeSource::Rate(rate_hz)),
        (None, None) if table.names.is_none() && table.n_columns >= 2 => {
            notes.push("no column names: column 0 read as time".to_owned());
            Ok(TimeSource::Column { idx: 0, unit: None })
        }
        (None, None) => Err(Fault::NoTimeColumn { available: table.available() }),
    }
}

fn unit_in_name(table: &Table, idx: usize) -> Option<TimeUnit> {
    match meaning(table.names.as_ref()?.get(idx)?) {
        Meaning::Time { unit, .. } => unit,
        _ => None,
    }
}

/// A named angle column; without names the first one that is not taken; none at all is fine when there are codes.
fn choose_angle(
    table: &Table,
    asked: &Columns,
    time_idx: Option<usize>,
    code_idx: Option<usize>,
) -> Result<Option<(usize, Option<AngleUnit>)>, Fault> {
    if let Some((column, unit)) = &asked.angle {
        return Ok(
            Some((find(table, column)?, *unit)).map(|(idx, unit)| (idx, unit.or(angle_unit_in_name(table, idx))))
        );
    }
    let named = best(table, "angle", |meaning| match meaning {
        Meaning::Angle { unit, strength } => Some((unit, strength)),
        _ => None,
    })?;
    let unnamed = (0..table.n_columns).find(|idx| Some(*idx) != time_idx && Some(*idx) != code_idx);
    match (named, unnamed) {
        (Some(found), _) => Ok(Some(found)),
        (None, _) if code_idx.is_some() => Ok(None),
        (None, Some(idx)) if table.names.is_none() || table.n_columns == 1 => Ok(Some((idx, None))),
        _ => Err(Fault::NoAngleColumn { available: table.available() }),
    }
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

impl Samples {
    fn collect(table: &Table, sources: &Sources, is_ours: bool, notes: &mut Vec<String>) -> Result<Self, Fault> {
        let mut samples = Self::default();
        let mut n_doubled = 0_usize;
        for row in table.rows() {
            // Our own writer ends every line: in a row without an end, even what looks like a number may be the
            // beginning of one. The writers of others often leave out the last end.
            let may_be_whole = row.is_complete || !is_ours;
            match may_be_whole.then(|| samples.take(table, sources, &row)) {
                Some(Ok(())) => {}
                Some(Err(fault)) if row.is_complete => return Err(fault),
                _ => {
                    notes.push(format!("line {}: cut off while it was written, left out", row.line));
                    continue;
                }
            }
            n_doubled += usize::from(samples.drop_doubled());
        }
        if n_doubled > 0 {
            notes.push(format!("{n_doubled} rows stood there twice (same time, same angle), left out once each"));
        }
        Ok(samples)
    }

    fn take(&mut self, table: &Table, sources: &Sources, row: &Row) -> Result<(), Fault> {
        let time = match sources.time {
            TimeSource::Column { idx, .. } => Some(finite(table, row, idx)?),
            TimeSource::Rate(_) => None,
        };
        let angle = sources.angle.map(|(idx, _)| finite(table, row, idx)).transpose()?;
        let code = sources.code.map(|idx| code(table, row, idx)).transpose()?;
        self.lines.push(row.line);
        self.times.extend(time);
        self.angles.extend(angle);
        self.codes.extend(code);
        Ok(())
    }

    /// Removes the last sample when it repeats time and angle of the one before.
    fn drop_doubled(&mut self) -> bool {
        let repeats = |values: &[f64]| matches!(values, [.., before, last] if before == last);
        let is_doubled = repeats(&self.times) && (repeats(&self.angles) || self.angles.is_empty());
        if is_doubled {
            self.lines.pop();
            self.times.pop();
            self.angles.pop();
            self.codes.pop();
        }
        is_doubled
    }
}

fn field<'a>(table: &Table, row: &Row<'a>, idx: usize) -> Result<&'a str, Fault> {
    let short = || Fault::ShortRow { line: row.line, n_found: row.fields.len(), column: table.column_name(idx) };
    row.fields.get(idx).copied().ok_or_else(short)
}

fn finite(table: &Table, row: &Row, idx: usize) -> Result<f64, Fault> {
    let text = field(table, row, idx)?;
    table.number(text).filter(|number| number.is_finite()).ok_or_else(|| Fault::NotANumber {
        place: format!("line {}", row.line),
        column: table.column_name(idx),
        value: text.chars().take(40).collect(),
    })
}

fn code(table: &Table, row: &Row, idx: usize) -> Result<u16, Fault> {
    let number = finite(table, row, idx)?;
    if number.fract() != 0.0 || !(0.0..=f64::from(u16::MAX)).contains(&number) {
        return Err(Fault::BadCode { line: row.line, value: number.to_string() });
    }
    Ok(number as u16)
}
