//! Writing a recording, sample by sample, in our own format.
//!
//! What was taken reaches the file at least once per second of recorded time, and every line ends with a line end: a
//! program killed in the middle leaves a file that reads back up to its last second.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::Recording;
use super::error::WriteError;
use super::header::Header;
use super::limits::FORMAT_VERSION;
use crate::files::{Existing, NewFile};
use shared::measured::Measured;

/// Recorded time after which samples are handed to the system, s.
const FLUSH_EVERY_S: f64 = 1.0;

/// Times are written to the microsecond.
const TICKS_PER_S: f64 = 1e6;

/// An open recording.
#[derive(Debug)]
pub struct Writer {
    file: NewFile,
    has_codes: bool,
    n_samples: usize,
    n_handed_over: usize,
    last_tick: Option<i64>,
    flushed_s: f64,
}

impl Writer {
    /// Opens `path` and writes the header. Codes are a column when the header has a calibration.
    ///
    /// # Errors
    /// The file exists and may not be replaced, or the system refuses.
    pub fn create(path: &Path, header: &Header, existing: Existing) -> Result<Self, WriteError> {
        Self::begin(NewFile::growing(path, existing)?, header)
    }

    /// The same for a recording that is made at once: it appears when it is finished.
    ///
    /// # Errors
    /// As [`Writer::create`].
    pub fn whole(path: &Path, header: &Header, existing: Existing) -> Result<Self, WriteError> {
        Self::begin(NewFile::whole(path, existing)?, header)
    }

    fn begin(file: NewFile, header: &Header) -> Result<Self, WriteError> {
        let has_codes = header.calibration.is_some() && header.measured != Some(Measured::Rate);
        let mut writer =
            Self { file, has_codes, n_samples: 0, n_handed_over: 0, last_tick: None, flushed_s: f64::NEG_INFINITY };
        let names = match (header.measured.unwrap_or_default(), has_codes) {
            (Measured::Rate, _) => "t,rate",
            (_, true) => "t,theta,code",
            (_, false) => "t,theta",
        };
        let header = Header { version: Some(FORMAT_VERSION), ..header.clone() };
        writer.line(format_args!("{header}{names}"))?;
        Ok(writer)
    }

    /// Appends one sample: time in s, raw angle in rad, converter code when the header has a calibration.
    ///
    /// # Errors
    /// A value that could not be read back (not finite, time not increasing by at least 1 µs, code missing), or the
    /// system refuses (disk full).
    pub fn write(&mut self, time_s: f64, angle_rad: f64, code: Option<u16>) -> Result<(), WriteError> {
        let tick = (time_s * TICKS_PER_S).round() as i64;
        if let Some(reason) = self.objection(time_s, angle_rad, code, tick) {
            return Err(WriteError::BadSample { sample_idx: self.n_samples, time_s, angle_rad, reason });
        }
        match code.filter(|_| self.has_codes) {
            Some(code) => self.line(format_args!("{time_s:.6},{angle_rad:.7},{code}"))?,
            None => self.line(format_args!("{time_s:.6},{angle_rad:.7}"))?,
        }
        self.last_tick = Some(tick);
        self.n_samples += 1;
        self.flush_when_due(time_s)
    }

    /// How many samples were taken.
    pub fn n_samples(&self) -> usize {
        self.n_samples
    }

    /// How many of them are in the file for sure, whatever the system refuses from now on.
    pub fn n_handed_over(&self) -> usize {
        self.n_handed_over
    }

    /// Where the file belongs.
    pub fn path(&self) -> &Path {
        self.file.path()
    }

    /// Where the file is now.
    pub fn lies_at(&self) -> &Path {
        self.file.lies_at()
    }

    /// Closes the file without giving it the place of an older one; gives where it is.
    ///
    /// # Errors
    /// The system refuses (disk full).
    pub fn leave(self) -> Result<PathBuf, WriteError> {
        Ok(self.file.leave()?)
    }

    /// Takes the file away again.
    pub fn discard(self) {
        self.file.discard();
    }

    /// Hands everything to the disk and closes the file.
    ///
    /// # Errors
    /// The system refuses (disk full).
    pub fn finish(self) -> Result<(), WriteError> {
        Ok(self.file.finish()?)
    }

    fn objection(&self, time_s: f64, angle_rad: f64, code: Option<u16>, tick: i64) -> Option<&'static str> {
        if !time_s.is_finite() || !angle_rad.is_finite() {
            return Some("time and angle must be finite");
        }
        if self.last_tick.is_some_and(|last| tick <= last) {
            return Some("time must increase by at least 1 µs from sample to sample");
        }
        (self.has_codes && code.is_none()).then_some("the header has a calibration, so every sample needs its code")
    }

    fn flush_when_due(&mut self, time_s: f64) -> Result<(), WriteError> {
        if time_s - self.flushed_s < FLUSH_EVERY_S {
            return Ok(());
        }
        self.flushed_s = time_s;
        self.file.flush().map_err(|source| self.io(source))?;
        self.n_handed_over = self.n_samples;
        Ok(())
    }

    fn line(&mut self, text: std::fmt::Arguments<'_>) -> Result<(), WriteError> {
        writeln!(self.file, "{text}").map_err(|source| self.io(source))
    }

    fn io(&self, source: io::Error) -> WriteError {
        self.file.failed(source).into()
    }
}

/// Writes a whole recording.
///
/// # Errors
/// As [`Writer::create`] and [`Writer::write`].
pub fn save(recording: &Recording, path: &Path, existing: Existing) -> Result<(), WriteError> {
    let mut header = recording.header().clone();
    if recording.codes().is_none() {
        header.calibration = None;
    }
    let mut writer = Writer::whole(path, &header, existing)?;
    for idx in 0..recording.len() {
        let code = recording.codes().map(|codes| codes[idx]);
        writer.write(recording.times_s()[idx], recording.angles_rad()[idx], code)?;
    }
    writer.finish()
}
