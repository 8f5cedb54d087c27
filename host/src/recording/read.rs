//! Reading a recording: our own format or anybody's CSV.
//!
//! Nothing is repaired silently: what is dropped or assumed is told in the notes, what cannot be understood is an error
//! that names line, column and value. No bytes whatever make it panic.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

use super::angle::Angles;
use super::columns::{AngleUnit, ColumnRef, Columns, TimeUnit};
use super::error::{Fault, ReadError, check_step};
use super::header::{Header, HeaderReader};
use super::number::{Cell, Numerals};
use super::source::Lines;
use super::table::Table;
use super::words::{Meaning, meaning};
use super::{MIN_SAMPLES, Recording, clock, median_step_s};

/// Steps of unstated unit beyond this are refused: at 2 Hz a laboratory pendulum cannot be followed.
pub(super) const LONGEST_STEP_S: f64 = 0.5;

/// More samples than a day's at 200 Hz, or ten hours' at 480 Hz, are not one swing.
pub(super) const MOST_SAMPLES: usize = 17_280_000;

/// Times of unstated unit beyond this many seconds count from 1970, in the unit that puts them within a century of it.
const EPOCH_BEGINS_S: f64 = 1e8;

/// A clock that goes back by more than this passed midnight, s.
const MIDNIGHT_S: f64 = 43_200.0;

/// What the user says about the file; what is left out is found.
#[derive(Debug, Clone, Default)]
pub struct ReadOptions {
    /// `--columns`
    pub columns: Option<Columns>,
    /// `--rate`, Hz: for files without a time column; a time column is then ignored.
    pub rate_hz: Option<f64>,
    /// `--degrees` or `--radians`.
    pub angle_unit: Option<AngleUnit>,
    /// `--zero`: what the sensor reads while the pendulum hangs, in the file's unit; degrees for x and y.
    pub zero: Option<f64>,
    /// `--pivot`: where the pivot is, in the file's x and y.
    pub pivot: Option<[f64; 2]>,
}

/// Reads the recording at `path`.
///
/// # Errors
/// Everything in [`Fault`], with the file's name.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Recording, ReadError> {
    let with_name = |fault| ReadError { file: path.display().to_string(), fault };
    let file = open(path).map_err(with_name)?;
    parse(BufReader::new(UntilItsEnd { file, has_ended: false }), options).map_err(with_name)
}

/// A file up to where its end was once met: one that is cut and written anew meanwhile would go on in the middle of a
/// number.
struct UntilItsEnd {
    file: File,
    has_ended: bool,
}

impl Read for UntilItsEnd {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.has_ended {
            return Ok(0);
        }
        let n = self.file.read(buffer)?;
        self.has_ended = n == 0 && !buffer.is_empty();
        Ok(n)
    }
}

/// Reads a recording from the bytes of a file; `file` is what messages call it.
///
/// # Errors
/// Everything in [`Fault`], with the file's name.
pub fn read_bytes(file: &str, bytes: &[u8], options: &ReadOptions) -> Result<Recording, ReadError> {
    parse(bytes, options).map_err(|fault| ReadError { file: file.to_owned(), fault })
}

fn open(path: &Path) -> Result<File, Fault> {
    if path.is_dir() {
        return Err(Fault::Directory);
    }
    File::open(path).map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => Fault::Missing,
        _ => Fault::Unreadable(error),
    })
}

fn parse(reader: impl BufRead, options: &ReadOptions) -> Result<Recording, Fault> {
    let mut notes = Vec::new();
    let mut table = Table::new(Lines::of(reader, &mut notes)?)?;
    let header = read_header(&table)?;
    let sources = Sources::choose(&table, &header, options, &mut notes)?;
    let is_ours = header.version.is_some();
    let samples = Samples::collect(&mut table, &sources, is_ours, &mut notes)?;
    let times_s = sources.times_s(&samples, &mut notes)?;
    let angles_rad = sources.angles_rad(&samples, &times_s, &header, options, &mut notes)?;
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
    angle: AngleSource,
    code: Option<usize>,
}

#[derive(Debug)]
enum TimeSource {
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

#[derive(Debug)]
enum AngleSource {
    Column {
        idx: usize,
        unit: Option<AngleUnit>,
    },
    /// Of a point on the pendulum.
    Point {
        x: usize,
        y: usize,
    },
    Codes,
}

/// The needed columns as read, in the file's units.
#[derive(Default)]
struct Samples {
    times: Vec<f64>,
    /// Angles, or x of a point.
    angles: Vec<f64>,
    ys: Vec<f64>,
    codes: Vec<u16>,
    /// Which rows they are, where the rate tells the time and rows are missing.
    rows: Vec<u32>,
    /// Day of the first clock time.
    first_day: Option<i64>,
    n_midnights: u32,
}

impl TimeSource {
    fn column(&self) -> Option<usize> {
        match self {
            Self::Column { idx, .. } | Self::Clock { idx } => Some(*idx),
            Self::Rate(_) => None,
        }
    }

    /// Seconds of one unit as far as it is known while rows are read.
    fn scale(&self) -> f64 {
        match self {
            Self::Column { unit, .. } => unit.unwrap_or(TimeUnit::Seconds).seconds(),
            _ => 1.0,
        }
    }
}

impl Sources {
    fn choose(table: &Table, header: &Header, options: &ReadOptions, notes: &mut Vec<String>) -> Result<Self, Fault> {
        let asked = options.columns.clone().unwrap_or_default();
        if let Some((column, _)) = &asked.rate {
            return Err(Fault::RateColumn { column: table.column_name(find(table, column)?) });
        }
        let code = choose_code(table, &asked)?;
        let has_rate = options.rate_hz.or(header.rate_hz).is_some();
        let angle = choose_angle(table, &asked, code, has_rate);
        let angle_idx = match &angle {
            Ok(AngleSource::Column { idx, .. }) => Some(*idx),
            _ => None,
        };
        let time = choose_time(table, header, options, &asked, angle_idx, notes)?;
        let mut angle = match angle? {
            AngleSource::Column { idx, .. } if time.column() == Some(idx) => {
                return Err(Fault::NoAngleColumn { available: table.available() });
            }
            angle => angle,
        };
        if let AngleSource::Column { unit, .. } = &mut angle {
            *unit = options.angle_unit.or(*unit);
        }
        log::debug!("columns: time from {time:?}, angle from {angle:?}, code from {code:?}");
        Ok(Self { time, angle, code })
    }

    fn times_s(&self, samples: &Samples, notes: &mut Vec<String>) -> Result<Vec<f64>, Fault> {
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

    fn angles_rad(
        &self,
        samples: &Samples,
        times_s: &[f64],
        header: &Header,
        options: &ReadOptions,
        notes: &mut Vec<String>,
    ) -> Result<Vec<f64>, Fault> {
        let as_read = Angles { times_s, is_ours: header.version.is_some(), options, notes };
        match self.angle {
            AngleSource::Codes => {
                let calibration = header.calibration.ok_or(Fault::NoCalibration)?;
                Ok(samples.codes.iter().map(|code| calibration.angle_rad(*code)).collect())
            }
            AngleSource::Column { unit, .. } => as_read.of_column(&samples.angles, unit),
            AngleSource::Point { .. } => as_read.of_point(&samples.angles, &samples.ys),
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
    angle_idx: Option<usize>,
    notes: &mut Vec<String>,
) -> Result<TimeSource, Fault> {
    let named = match &asked.time {
        Some((column, unit)) => Some((find(table, column)?, *unit)),
        None => named_time(table, angle_idx, notes)?,
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
        (None, None, None) if table.names.is_none() && table.n_columns >= 2 && angle_idx != Some(0) => {
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

/// A named angle column, or x and y of a point; without names the first one that is not taken; none at all is fine when
/// there are codes.
fn choose_angle(table: &Table, asked: &Columns, code_idx: Option<usize>, has_rate: bool) -> Result<AngleSource, Fault> {
    if let Some((column, unit)) = &asked.angle {
        let idx = find(table, column)?;
        return Ok(AngleSource::Column { idx, unit: unit.or(angle_unit_in_name(table, idx)) });
    }
    if let (Some(x), Some(y)) = (&asked.x, &asked.y) {
        return Ok(AngleSource::Point { x: find(table, x)?, y: find(table, y)? });
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
    let unnamed = (0..table.n_columns).find(|idx| is_free(idx) && is_number(idx));
    match (named, named_so(Meaning::X), named_so(Meaning::Y), unnamed) {
        (Some((idx, unit)), ..) => Ok(AngleSource::Column { idx, unit }),
        (None, Some(x), Some(y), _) => Ok(AngleSource::Point { x, y }),
        (None, ..) if code_idx.is_some() => Ok(AngleSource::Codes),
        (None, _, _, Some(idx)) if table.names.is_none() || table.n_columns == 1 => {
            Ok(AngleSource::Column { idx, unit: None })
        }
        _ => match table.names.iter().flatten().position(|name| meaning(name) == Meaning::Rate) {
            Some(idx) => Err(Fault::RateColumn { column: table.column_name(idx) }),
            None => Err(Fault::NoAngleColumn { available: table.available() }),
        },
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

/// Rows without a value.
#[derive(Default)]
struct Missing {
    n_rows: usize,
    first: Option<String>,
}

/// What became of a row.
enum Taken {
    Sample,
    Gap { column: usize },
}

impl Samples {
    fn collect(table: &mut Table, sources: &Sources, is_ours: bool, notes: &mut Vec<String>) -> Result<Self, Fault> {
        let mut samples = Self::default();
        let mut numerals = table.numerals.clone();
        let mut missing = Missing::default();
        let (mut n_doubled, mut row_idx) = (0_usize, 0_u32);
        while table.advance()? {
            // Our own writer ends every line: in a row without an end, even what looks like a number may be the
            // beginning of one. The writers of others often leave out the last end.
            let may_be_whole = table.is_complete() || !is_ours;
            match may_be_whole.then(|| samples.take(table, sources, &mut numerals)) {
                Some(Ok(Taken::Sample)) => samples.rows.extend(sources.counts_rows().then_some(row_idx)),
                Some(Ok(Taken::Gap { column })) if table.is_complete() => missing.count(table, column),
                Some(Err(fault)) if table.is_complete() => return Err(fault),
                _ => {
                    notes.push(format!("line {}: cut off while it was written, left out", table.line()));
                    continue;
                }
            }
            row_idx += 1;
            n_doubled += usize::from(samples.drop_doubled());
            samples.check_last(table, sources)?;
        }
        if n_doubled > 0 {
            notes.push(format!("{n_doubled} rows stood there twice (same time, same angle), left out once each"));
        }
        notes.extend(missing.in_words());
        if samples.n_midnights > 0 {
            notes.push("the clock passed midnight: a day added".to_owned());
        }
        samples.shrink();
        Ok(samples)
    }

    fn take(&mut self, table: &Table, sources: &Sources, numerals: &mut Numerals) -> Result<Taken, Fault> {
        let row = Row { table, fields: table.fields() };
        let (x, y) = match sources.angle {
            AngleSource::Column { idx, .. } => (Some(idx), None),
            AngleSource::Point { x, y } => (Some(x), Some(y)),
            AngleSource::Codes => (None, None),
        };
        let mut numbers = [None; 3];
        for (number, column) in numbers.iter_mut().zip([x, y, sources.code]) {
            let Some(column) = column else { continue };
            match row.number(column, numerals)? {
                None => return Ok(Taken::Gap { column }),
                found => *number = found,
            }
        }
        let time = match sources.time {
            TimeSource::Rate(_) => None,
            TimeSource::Column { idx, .. } => match row.number(idx, numerals)? {
                None => return Ok(Taken::Gap { column: idx }),
                found => found,
            },
            TimeSource::Clock { idx } => match self.clock_s(&row, idx)? {
                None => return Ok(Taken::Gap { column: idx }),
                found => found,
            },
        };
        let [x, y, code] = numbers;
        let code = code.map(|code| as_code(table.line(), code)).transpose()?;
        self.times.extend(time);
        self.angles.extend(x);
        self.ys.extend(y);
        self.codes.extend(code);
        Ok(Taken::Sample)
    }

    /// Seconds since midnight of the first day.
    fn clock_s(&mut self, row: &Row, idx: usize) -> Result<Option<f64>, Fault> {
        let text = row.field(idx)?;
        if super::number::is_missing(text) {
            return Ok(None);
        }
        let moment = clock::read(text).ok_or_else(|| row.not_a_number(idx, text))?;
        let day = match moment.day {
            Some(day) => day - *self.first_day.get_or_insert(day),
            None => {
                let before_s = self.times.last().copied().unwrap_or(0.0);
                let now_s = f64::from(self.n_midnights) * clock::DAY_S + moment.second;
                self.n_midnights += u32::from(now_s < before_s - MIDNIGHT_S);
                i64::from(self.n_midnights)
            }
        };
        Ok(Some(day as f64 * clock::DAY_S + moment.second))
    }

    /// Removes the last sample when it repeats time and angle of the one before.
    fn drop_doubled(&mut self) -> bool {
        let repeats = |values: &[f64]| matches!(values, [.., before, last] if before == last);
        let is_doubled = repeats(&self.times) && (repeats(&self.angles) || self.angles.is_empty());
        if is_doubled {
            self.times.pop();
            self.angles.pop();
            self.ys.pop();
            self.codes.pop();
        }
        is_doubled
    }

    /// Time goes on, and there is an end to it.
    fn check_last(&self, table: &Table, sources: &Sources) -> Result<(), Fault> {
        if self.angles.len().max(self.codes.len()) > MOST_SAMPLES {
            return Err(Fault::TooManySamples);
        }
        match self.times[..] {
            [.., before, last] => {
                let scale = sources.time.scale();
                check_step(|| format!("line {}", table.line()), before * scale, last * scale)
            }
            _ => Ok(()),
        }
    }

    fn shrink(&mut self) {
        [&mut self.times, &mut self.angles, &mut self.ys].into_iter().for_each(Vec::shrink_to_fit);
        self.codes.shrink_to_fit();
    }
}

impl Sources {
    fn counts_rows(&self) -> bool {
        matches!(self.time, TimeSource::Rate(_))
    }
}

impl Missing {
    fn count(&mut self, table: &Table, column: usize) {
        self.n_rows += 1;
        self.first.get_or_insert_with(|| {
            let text = table.fields().get(column).copied().unwrap_or_default().to_owned();
            format!("line {}, column {}: \"{text}\"", table.line(), table.column_name(column))
        });
    }

    fn in_words(self) -> Option<String> {
        let first = self.first?;
        Some(format!("{} rows without a value are gaps, the first at {first}", self.n_rows))
    }
}

/// A row of the table while its cells are read.
struct Row<'a> {
    table: &'a Table<'a>,
    fields: Vec<&'a str>,
}

impl<'a> Row<'a> {
    fn field(&self, idx: usize) -> Result<&'a str, Fault> {
        let (line, n_found) = (self.table.line(), self.fields.len());
        let short = || Fault::ShortRow { line, n_found, column: self.table.column_name(idx) };
        self.fields.get(idx).copied().ok_or_else(short)
    }

    /// A finite number; `None` where nothing was measured.
    fn number(&self, idx: usize, numerals: &mut Numerals) -> Result<Option<f64>, Fault> {
        let text = self.field(idx)?;
        match numerals.read(text) {
            Cell::Number(number) if number.is_finite() => Ok(Some(number)),
            Cell::Missing => Ok(None),
            Cell::Contradiction => {
                Err(Fault::ThousandsTooLate { line: self.table.line(), value: text.chars().take(40).collect() })
            }
            _ => Err(self.not_a_number(idx, text)),
        }
    }

    fn not_a_number(&self, idx: usize, text: &str) -> Fault {
        Fault::NotANumber {
            place: format!("line {}", self.table.line()),
            column: self.table.column_name(idx),
            value: text.chars().take(40).collect(),
        }
    }
}

fn as_code(line: usize, number: f64) -> Result<u16, Fault> {
    if number.fract() != 0.0 || !(0.0..=f64::from(u16::MAX)).contains(&number) {
        return Err(Fault::BadCode { line, value: number.to_string() });
    }
    Ok(number as u16)
}
