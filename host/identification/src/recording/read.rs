//! Reading a recording: our own format or anybody's table.
//!
//! Nothing is repaired silently: what is dropped or assumed is told in the notes, what cannot be understood is an error
//! that names line, column and value. No bytes whatever make it panic. Columns are chosen in `choose.rs`, rows read in
//! `samples.rs`, and their numbers become angles or rates in `angle.rs` and `rate.rs`.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

use super::Recording;
use super::chosen::Sources;
use super::error::{Fault, ReadError};
use super::grid;
use super::header::{Header, HeaderReader};
use super::lost;
use super::measured::Measured;
use super::options::ReadOptions;
use super::samples::Samples;
use super::source::Lines;
use super::table::Table;
use super::words;

/// Reads the recording at `path`.
///
/// # Errors
/// Everything in [`Fault`], with the file's name.
pub fn read(path: &Path, options: &ReadOptions) -> Result<Recording, ReadError> {
    let with_name = |fault| ReadError { file: path.display().to_string(), fault };
    let file = open(path).map_err(with_name)?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    parse(BufReader::new(UntilItsEnd { file, has_ended: false }), &name, options).map_err(with_name)
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
    parse(bytes, file, options).map_err(|fault| ReadError { file: file.to_owned(), fault })
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

fn parse(reader: impl BufRead, name: &str, options: &ReadOptions) -> Result<Recording, Fault> {
    let mut notes = Vec::new();
    let mut table = Table::new(Lines::of(reader, &mut notes)?)?;
    if table.is_turned {
        notes.push("it has a quantity a line: each is read as a column".to_owned());
    }
    table.is_of_gyroscope |= words::is_gyroscope(name);
    let (mut header, said_rate_hz) = read_header(&table)?;
    let rate_hz = rate_of_settings(&table, &mut notes);
    header.rate_hz = header.rate_hz.or(rate_hz).or(said_rate_hz);
    let sources = Sources::choose(&table, &header, options, &mut notes)?;
    let is_ours = header.version.is_some();
    let collected = Samples::collect(&mut table, &sources, is_ours, &mut notes);
    let mut samples = collected.map_err(|fault| sources.undecided(&table).unwrap_or(fault))?;
    let sources = sources.settled(&table, &mut samples, options, &mut notes)?;
    let mut times_s = sources.time.times_s(&samples, sources.told(), &mut notes)?;
    if !is_ours && samples.codes.is_empty() {
        grid::make_even(&mut times_s, &mut notes);
        samples.leave_out_spikes(&mut times_s, &mut notes);
    }
    let mut readings = sources.readings(&table, &samples, &times_s, &header, options, &mut notes)?;
    // Rigs of ours count their samples, and rows that are counted have no times to be wrong.
    if !is_ours && samples.codes.is_empty() && !sources.counts_rows() {
        lost::set_right(&mut times_s, &mut readings, &mut notes);
    }
    if options.mirrored {
        readings.iter_mut().for_each(|reading| *reading = -*reading);
    }
    let is_rate = sources.measured() == Measured::Rate;
    let header = Header { measured: is_rate.then_some(Measured::Rate), ..header };
    let codes = (!samples.codes.is_empty()).then_some(samples.codes);
    Ok(Recording::new(header, times_s, readings, codes)?.with_notes(notes))
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
