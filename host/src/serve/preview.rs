//! A file before it is taken in: its first rows, how it would be read, and the curve that this gives.

use super::recordings::{LoadingWish, read_as};
use super::settings::Settings;
use crate::error::Failure;
use crate::plot::decimate::decimated;
use crate::recording::{Measured, ReadError, look};
use serde::Serialize;
use std::path::Path;

/// So many rows tell what the columns hold.
const N_ROWS: usize = 6;

/// Points of the curve.
const N_POINTS: usize = 600;

/// What the page shows of a file.
#[derive(Serialize)]
pub(super) struct Preview {
    columns: Vec<String>,
    rows: Vec<Vec<String>>,
    /// How it would be read; absent where it can't be.
    reading: Option<Reading>,
    /// Why it can't be read.
    fault: Option<String>,
}

#[derive(Serialize)]
struct Reading {
    measured: Measured,
    unit: &'static str,
    notes: Vec<String>,
    times_s: Vec<f64>,
    readings: Vec<f64>,
}

/// Looks at a file as it was wished to be read.
pub(super) fn preview(wish: &LoadingWish, path: &Path, settings: &Settings) -> Result<Preview, Failure> {
    let hint = "choose a table: rows of time and angle, or time and rate";
    let named = |error: ReadError| Failure::failed(ReadError { file: wish.name.clone(), ..error }).next(hint);
    let seen = look(path, N_ROWS).map_err(named)?;
    let (reading, fault) = match read_as(wish, path, settings) {
        Err(failure) => (None, Some(failure.what().to_owned())),
        Ok(runs) => {
            let recording = &runs[0].recording;
            let (times_s, readings) = decimated(recording.times_s(), recording.angles_rad(), N_POINTS);
            let (measured, notes) = (recording.measured(), recording.notes().to_vec());
            (Some(Reading { measured, unit: measured.unit(), notes, times_s, readings }), None)
        }
    };
    Ok(Preview { columns: seen.columns, rows: seen.rows, reading, fault })
}
