//! Reading a recording, or the several runs of a file: our own format or anybody's table.
//!
//! Nothing is repaired silently: what is dropped or assumed is told in the notes, what cannot be understood is an error
//! that names line, column and value. No bytes whatever make it panic. Columns are chosen in `choose.rs`, rows read in
//! `samples.rs`, and their numbers become angles or rates in `angle.rs` and `rate.rs`.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

use super::Recording;
use super::bare_g;
use super::bunches;
use super::chosen::Sources;
use super::error::{Fault, ReadError};
use super::grid;
use super::header::{Header, HeaderReader};
use super::limits::LARGEST_UNSTATED_RAD;
use super::lost;
use super::on_change;
use super::options::ReadOptions;
use super::runs::{self, Runs};
use super::samples::{Samples, keep};
use super::source::Lines;
use super::table::Table;
use shared::measured::Measured;

/// Degrees are 57 to the radian: numbers that become so many times smaller were some.
const HALF_OF_DEGREES: f64 = 28.0;

/// One of the recordings in a file.
#[derive(Debug)]
pub struct Run {
    /// What the file calls it, or its number from 1; `None` where the file holds nothing else.
    pub name: Option<String>,
    /// What was recorded.
    pub recording: Recording,
}

impl Run {
    /// What messages and results call it: `swings.csv, run 2`.
    pub fn name_in(&self, file: &str) -> String {
        name_in(file, self.name.as_deref())
    }
}

fn name_in(file: &str, run: Option<&str>) -> String {
    match run {
        None => file.to_owned(),
        Some(run) if runs::says_run(run) => format!("{file}, {run}"),
        Some(run) => format!("{file}, run {run}"),
    }
}

/// Reads the recording at `path`.
///
/// # Errors
/// Everything in [`Fault`], with the file's name; it holds several runs and none of them is chosen.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Recording, ReadError> {
    read_runs(path, options).and_then(|runs| only_one(runs, &path.display().to_string()))
}

/// Reads the recordings at `path`: one, or as many as it holds runs.
///
/// # Errors
/// Everything in [`Fault`], with the file's name.
pub fn read_runs(path: &Path, options: &ReadOptions) -> Result<Vec<Run>, ReadError> {
    let with_name = |Faulty { run, fault }| {
        let file = path.display().to_string();
        ReadError { file: name_in(&file, run.as_deref()), fault }
    };
    let file = open(path).map_err(|fault| with_name(Faulty::from(fault)))?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    parse(BufReader::new(UntilItsEnd { file, has_ended: false }), &name, options).map_err(with_name)
}

fn only_one(mut runs: Vec<Run>, file: &str) -> Result<Recording, ReadError> {
    if runs.len() > 1 {
        let names: Vec<String> = runs.iter().filter_map(|run| run.name.clone()).collect();
        let lengths =
            runs.iter().zip(&names).map(|(run, name)| format!("{name} of {:.1} s", run.recording.duration_s()));
        let listed = runs::listed(&lengths.collect::<Vec<_>>());
        let fault = Fault::SeveralRuns { n: names.len(), runs: listed, example: runs::example(&names, 1) };
        return Err(ReadError { file: file.to_owned(), fault });
    }
    Ok(runs.swap_remove(0).recording)
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
/// Everything in [`Fault`], with the file's name; it holds several runs and none of them is chosen.
pub fn read_bytes(file: &str, bytes: &[u8], options: &ReadOptions) -> Result<Recording, ReadError> {
    read_runs_of_bytes(file, bytes, options).and_then(|runs| only_one(runs, file))
}

/// Reads the recordings in the bytes of a file, likewise.
///
/// # Errors
/// Everything in [`Fault`], with the file's name.
pub fn read_runs_of_bytes(file: &str, bytes: &[u8], options: &ReadOptions) -> Result<Vec<Run>, ReadError> {
    let with_name = |Faulty { run, fault }| ReadError { file: name_in(file, run.as_deref()), fault };
    parse(bytes, file, options).map_err(with_name)
}

/// What is wrong, and with which run where it is only one of them.
struct Faulty {
    run: Option<String>,
    fault: Fault,
}

impl From<Fault> for Faulty {
    fn from(fault: Fault) -> Self {
        Self { run: None, fault }
    }
}

/// Can this file be opened?
///
/// # Errors
/// It is not there, it is a folder, or the system refuses.
pub fn check_readable(path: &Path) -> Result<(), ReadError> {
    open(path).map(drop).map_err(|fault| ReadError { file: path.display().to_string(), fault })
}

pub(super) fn open(path: &Path) -> Result<File, Fault> {
    if path.is_dir() {
        return Err(Fault::Directory);
    }
    File::open(path).map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => Fault::Missing,
        _ => Fault::Unreadable(error),
    })
}

fn parse(reader: impl BufRead, name: &str, options: &ReadOptions) -> Result<Vec<Run>, Faulty> {
    let mut notes = Vec::new();
    let mut table = Table::new(Lines::of(reader, &mut notes)?)?;
    if table.is_turned {
        notes.push("it has a quantity a line: each is read as a column".to_owned());
    }
    table.call(name);
    match bare_g::fault(&table).filter(|_| options.columns.is_none()) {
        Some(fault) => Err(Faulty::from(fault)),
        None => of_table(table, options, notes),
    }
}

fn of_table(mut table: Table, options: &ReadOptions, mut notes: Vec<String>) -> Result<Vec<Run>, Faulty> {
    if let Some(line) = table.glued_line {
        notes.push(format!(
            "line {line}: the first row stands behind the names of the columns without a line end between, and is left out"
        ));
    }
    let (mut header, said_rate_hz) = read_header(&table)?;
    let rate_hz = rate_of_settings(&table, &mut notes);
    header.rate_hz = header.rate_hz.or(rate_hz).or(said_rate_hz);
    let sources = Sources::choose(&table, &header, options, &mut notes)?;
    let collected = Samples::collect(&mut table, &sources, header.version.is_some(), &mut notes);
    let samples = collected.map_err(|fault| sources.undecided(&table).unwrap_or(fault))?;
    let file = Opened { table: &table, header: &header, options };
    match Runs::find(&samples, &table, sources.run).filter(|_| header.version.is_none()) {
        Some(found) => file.runs(found.apart(samples, &options.runs, &mut notes)?, &sources, notes),
        None => {
            runs::refuse_others(&options.runs)?;
            Ok(vec![Run { name: None, recording: file.recording(samples, sources, notes)? }])
        }
    }
}

/// A file whose rows are read.
struct Opened<'a> {
    table: &'a Table<'a>,
    header: &'a Header,
    options: &'a ReadOptions,
}

impl Opened<'_> {
    /// Each run as a recording of its own; the first has the notes of the file. Small swings can't tell degrees from
    /// radians: the widest of the file tell it for all.
    fn runs(&self, parts: Vec<(String, Samples)>, sources: &Sources, notes: Vec<String>) -> Result<Vec<Run>, Faulty> {
        let largest: Vec<f64> = parts.iter().map(|(_, samples)| samples.largest_reading()).collect();
        let widest = (0..parts.len()).max_by(|a, b| largest[*a].total_cmp(&largest[*b])).unwrap_or(0);
        let mut places: Vec<(usize, (String, Samples))> = parts.into_iter().enumerate().collect();
        places.sort_by_key(|(place, _)| *place != widest);
        let mut in_degrees = None;
        let mut runs = Vec::new();
        for (place, (name, samples)) in places {
            let mut notes = if place == 0 { notes.clone() } else { Vec::new() };
            let told = in_degrees.as_ref().filter(|_| largest[place] <= LARGEST_UNSTATED_RAD);
            notes.extend(told.map(|_| "read as degrees, which the wider swings of the file are".to_owned()));
            let faulty = |fault| Faulty { run: Some(name.clone()), fault };
            let recording = self.recording(samples, told.unwrap_or(sources).clone(), notes).map_err(faulty)?;
            if place == widest && self.are_degrees(&recording, largest[widest]) {
                in_degrees = sources.in_degrees();
            }
            runs.push((place, Run { name: Some(name), recording }));
        }
        runs.sort_by_key(|(place, _)| *place);
        Ok(runs.into_iter().map(|(_, run)| run).collect())
    }

    /// Was the largest number of the file taken for one of degrees, though nobody said so?
    fn are_degrees(&self, recording: &Recording, largest: f64) -> bool {
        let in_rad = recording.angles_rad().iter().fold(0.0_f64, |largest, angle| largest.max(angle.abs()));
        self.options.angle_unit.is_none() && largest > LARGEST_UNSTATED_RAD && in_rad < largest / HALF_OF_DEGREES
    }

    /// The rows of a run as a recording.
    fn recording(&self, mut samples: Samples, sources: Sources, mut notes: Vec<String>) -> Result<Recording, Fault> {
        let Self { table, header, options } = *self;
        let is_ours = header.version.is_some();
        samples.finish(&mut notes).map_err(|fault| sources.undecided(table).unwrap_or(fault))?;
        let sources = sources.settled(table, &mut samples, options, &mut notes)?;
        let sources = sources.swinging(table, &mut samples, options, &mut notes)?;
        if !is_ours {
            sources.refuse_readings(table, &samples, options)?;
        }
        let mut times_s = sources.time.times_s(&samples, sources.told(), &mut notes)?;
        if !is_ours {
            if !sources.counts() {
                grid::make_even(&mut times_s, &mut notes);
                bunches::make_even(&mut times_s, samples.readings.first().map_or(&[], Vec::as_slice), &mut notes);
            }
            samples.leave_out_losses(&mut times_s, &mut notes);
        }
        let mut readings = sources.readings(table, &samples, &times_s, header, options, &mut notes)?;
        // Rigs of ours count their samples.
        if !is_ours && samples.codes.is_empty() {
            if sources.measured() == Measured::Angle
                && let Some(held) = on_change::held(&times_s, &readings, &mut notes)
            {
                let at_rows = |list: &[f64]| held.rows.iter().map(|row| list[*row]).collect::<Vec<f64>>();
                readings = at_rows(&readings);
                samples.others.iter_mut().for_each(|list| *list = at_rows(list));
                times_s = held.times_s;
            }
            let kept = lost::set_right(&mut times_s, &mut readings, sources.counts_rows(), &mut notes);
            samples.others.iter_mut().for_each(|list| keep(list, &kept));
        }
        let others = sources.others(table, &samples, &readings);
        if options.mirrored {
            readings.iter_mut().for_each(|reading| *reading = -*reading);
        }
        notes.extend(header.doubt().map(str::to_owned));
        let is_rate = sources.measured() == Measured::Rate;
        let header = Header { measured: is_rate.then_some(Measured::Rate), ..header.clone() };
        let unit = samples.readings.first().filter(|_| !is_ours).and_then(|angles| sources.unit(angles));
        let codes = (!samples.codes.is_empty()).then_some(samples.codes);
        let recording = Recording::new(header, times_s, readings, codes)?;
        Ok(recording.with_notes(notes).with_others(others).with_unit(unit))
    }
}

/// What is said above the table, and how many samples a second where somebody said so in words: columns without names may
/// hold the time all the same.
fn read_header(table: &Table) -> Result<(Header, Option<f64>), Fault> {
    let mut reader = HeaderReader::default();
    table.comments().try_for_each(|(line, text)| reader.take(line, text))?;
    let said_rate_hz = reader.said_rate_hz().filter(|_| table.n_columns == 1 || table.names.is_some());
    Ok((reader.finish(), said_rate_hz))
}

/// Hz, where nothing but settings above a lone column tells it.
fn rate_of_settings(table: &Table, notes: &mut Vec<String>) -> Option<f64> {
    let settings = table.settings.as_ref()?;
    let rate_hz = settings.rate_hz.filter(|_| table.n_columns == 1);
    let rate = rate_hz.map_or(String::new(), |rate_hz| format!(", with {rate_hz} samples a second"));
    notes.push(format!("\"{}\" above the table are settings, no row{rate}", settings.values));
    rate_hz
}
