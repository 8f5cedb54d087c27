//! A recording of a swinging pendulum: times, raw angles or angular velocities, and how they were taken.
//!
//! In: a file (ours or anybody's CSV) or samples from the link. Out: a [`Recording`] whose times increase strictly and
//! whose values are finite, so that what comes after (noise, segments, fits) cannot fail on its shape.
//! Times in s, angles in rad; 0 = hanging, counter-clockwise positive; never filtered. Where [`Recording::measured`] says
//! so, the readings are rates in rad/s instead.
//! This crate knows files and samples, but neither models nor the link.

#![forbid(unsafe_code)]

mod angle;
mod bare_g;
mod bunches;
mod carrier;
mod cell;
mod chance;
pub mod check;
mod choose;
mod chosen;
mod circle;
mod clock;
mod columns;
mod drive;
mod error;
pub mod files;
mod foreign;
mod frames;
mod frozen;
mod grid;
mod groups;
pub mod growth;
mod header;
mod heading;
mod labels;
mod limits;
mod look;
mod lost;
mod monitor;
pub mod noise;
pub mod number;
mod on_change;
mod options;
mod order;
mod places;
pub mod plausible;
mod preamble;
mod rails;
pub mod random;
mod rate;
mod read;
mod row;
mod runs;
mod samples;
pub mod segment;
mod slip;
pub mod smooth;
mod source;
mod spikes;
mod straight;
mod stuck;
mod table;
mod ticks;
mod told;
mod trail;
pub mod turning;
mod unit;
mod units;
mod whole_turns;
mod words;
mod write;
mod zero_step;

pub use columns::{ColumnRef, Columns, ColumnsError};
pub use error::{Fault, NoAngle, ReadError, WriteError};
pub use files::Existing;
pub use header::{Calibration, Header, clock_name, sensor_name};
pub use limits::{FORMAT_NAME, FORMAT_VERSION, MIN_SAMPLES, MOST_SAMPLES};
pub use look::{Look, look};
pub use options::ReadOptions;
pub use read::{Run, check_readable, read, read_bytes, read_runs, read_runs_of_bytes};
pub use shared::measured::Measured;
pub use told::Told;
pub use units::{AngleUnit, RateUnit, TimeUnit};
pub use write::{Writer, save};

use carrier::Carrier;
use drive::Drive;
use limits::LARGEST_RAD;
use std::ops::Range;
use unit::Unit;

/// A step longer than this many median steps is a gap.
const GAP_STEPS: f64 = 1.5;

/// Steps within this share of the median count as even.
const EVEN_TOLERANCE: f64 = 0.05;

/// Raw samples of one recording with the facts about how they were taken.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    header: Header,
    times_s: Vec<f64>,
    angles_rad: Vec<f64>,
    codes: Option<Vec<u16>>,
    /// The median one: asked for often.
    step_s: f64,
    gaps: Vec<Gap>,
    notes: Vec<String>,
    /// What moves it, as the file says.
    drives: Vec<Drive>,
    /// What carries it.
    carriers: Vec<Carrier>,
    /// Of its angles, where somebody else's file holds them.
    unit: Option<Unit>,
}

/// A place where samples are missing.
#[derive(Debug, Clone, PartialEq)]
pub struct Gap {
    /// Index of the last sample before the gap.
    pub after_idx: usize,
    /// Time of the last sample before the gap, s.
    pub from_s: f64,
    /// Time of the first sample after it, s.
    pub to_s: f64,
    /// How many samples are missing; only known when the steps are even.
    pub n_missing: Option<usize>,
}

impl Recording {
    /// Takes samples as they are: times in s, strictly increasing, steps may be uneven; angles in rad.
    ///
    /// # Errors
    /// Fewer than [`MIN_SAMPLES`], lengths that differ, a value that is not finite, or time that does not increase.
    pub fn new(
        header: Header,
        times_s: Vec<f64>,
        angles_rad: Vec<f64>,
        codes: Option<Vec<u16>>,
    ) -> Result<Self, Fault> {
        check_lengths(&times_s, &angles_rad, codes.as_deref())?;
        check_finite("time", &times_s)?;
        check_finite("angle", &angles_rad)?;
        check_turns(&angles_rad)?;
        check_increasing(&times_s)?;
        let step_s = median_step_s(&times_s);
        let gaps = find_gaps(&times_s, step_s);
        Ok(Self {
            header,
            times_s,
            angles_rad,
            codes,
            step_s,
            gaps,
            notes: Vec::new(),
            drives: Vec::new(),
            carriers: Vec::new(),
            unit: None,
        })
    }

    /// Evenly sampled angles (rad) at `rate_hz`, starting at t = 0.
    ///
    /// # Errors
    /// As [`Recording::new`], and a rate that is not positive.
    pub fn uniform(rate_hz: f64, angles_rad: Vec<f64>) -> Result<Self, Fault> {
        let times_s = uniform_times(rate_hz, angles_rad.len())?;
        Self::new(Header { rate_hz: Some(rate_hz), ..Header::default() }, times_s, angles_rad, None)
    }

    /// How and with what it was taken.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// Times, s, strictly increasing.
    pub fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    /// What the readings are.
    pub fn measured(&self) -> Measured {
        self.header.measured.unwrap_or_default()
    }

    /// Raw readings: angles in rad, 0 = hanging, counter-clockwise positive; where rates are measured, those in rad/s.
    pub fn angles_rad(&self) -> &[f64] {
        &self.angles_rad
    }

    /// Converter codes, when they were recorded.
    pub fn codes(&self) -> Option<&[u16]> {
        self.codes.as_deref()
    }

    /// Places where samples are missing.
    pub fn gaps(&self) -> &[Gap] {
        &self.gaps
    }

    /// What was noticed while reading, in words for a person.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Number of samples, at least [`MIN_SAMPLES`].
    #[expect(clippy::len_without_is_empty, reason = "a recording is never empty")]
    pub fn len(&self) -> usize {
        self.times_s.len()
    }

    /// From the first to the last sample, s.
    pub fn duration_s(&self) -> f64 {
        self.times_s[self.len() - 1] - self.times_s[0]
    }

    /// The median step, s.
    pub fn step_s(&self) -> f64 {
        self.step_s
    }

    /// Measured rate, Hz: one over the median step. The nominal rate stands in the header.
    pub fn rate_hz(&self) -> f64 {
        self.step_s().recip()
    }

    /// Whether all steps outside gaps are even within 5 %.
    pub fn is_even(&self) -> bool {
        steps_are_even(&self.times_s, self.step_s)
    }

    /// The first sample at or after `time_s`; the length when there is none.
    pub fn index_at(&self, time_s: f64) -> usize {
        self.times_s.partition_point(|&t| t < time_s)
    }

    /// A part of the recording with times as they were.
    ///
    /// # Errors
    /// A part with fewer than [`MIN_SAMPLES`] samples, or outside the recording.
    pub fn part(&self, range: Range<usize>) -> Result<Self, Fault> {
        let n_wanted = range.len();
        let (times_s, angles_rad) = self
            .times_s
            .get(range.clone())
            .zip(self.angles_rad.get(range.clone()))
            .ok_or(Fault::TooFewSamples { n_found: n_wanted.min(self.len()) })?;
        let codes = self.codes.as_ref().map(|codes| codes[range.clone()].to_vec());
        let mut part = Self::new(self.header.clone(), times_s.to_vec(), angles_rad.to_vec(), codes)?;
        part.notes.clone_from(&self.notes);
        part.unit = self.unit;
        part.drives = self.drives.iter().filter_map(|drive| drive.part(range.clone())).collect();
        part.carriers = self.carriers.iter().filter_map(|carrier| carrier.part(range.clone())).collect();
        Ok(part)
    }

    fn with_notes(mut self, notes: Vec<String>) -> Self {
        self.notes = notes;
        self
    }

    fn with_unit(mut self, unit: Option<Unit>) -> Self {
        self.unit = unit;
        self
    }

    fn with_others(mut self, (drives, carriers): (Vec<Drive>, Vec<Carrier>)) -> Self {
        (self.drives, self.carriers) = (drives, carriers);
        self
    }
}

/// Times of `n_samples` evenly spaced samples from 0, s.
fn uniform_times(rate_hz: f64, n_samples: usize) -> Result<Vec<f64>, Fault> {
    if !(rate_hz.is_finite() && rate_hz > 0.0) {
        return Err(Fault::BadRate { rate_hz });
    }
    Ok((0..n_samples).map(|sample_idx| sample_idx as f64 / rate_hz).collect())
}

fn check_lengths(times_s: &[f64], angles_rad: &[f64], codes: Option<&[u16]>) -> Result<(), Fault> {
    let n_codes = codes.map_or(times_s.len(), <[u16]>::len);
    if times_s.len() != angles_rad.len() || times_s.len() != n_codes {
        return Err(Fault::LengthsDiffer { n_times: times_s.len(), n_angles: angles_rad.len(), n_codes });
    }
    if times_s.len() < MIN_SAMPLES {
        return Err(Fault::TooFewSamples { n_found: times_s.len() });
    }
    Ok(())
}

fn check_turns(angles_rad: &[f64]) -> Result<(), Fault> {
    let largest = angles_rad.iter().fold(0.0_f64, |largest, angle| largest.max(angle.abs()));
    if largest > LARGEST_RAD { Err(Fault::TooManyTurns { largest }) } else { Ok(()) }
}

fn check_finite(column: &str, values: &[f64]) -> Result<(), Fault> {
    match values.iter().position(|value| !value.is_finite()) {
        None => Ok(()),
        Some(idx) => Err(Fault::NotANumber {
            place: format!("sample {idx}"),
            column: column.to_owned(),
            value: values[idx].to_string(),
        }),
    }
}

fn check_increasing(times_s: &[f64]) -> Result<(), Fault> {
    for (idx, pair) in times_s.windows(2).enumerate() {
        error::check_step(|| format!("sample {}", idx + 1), " s", pair[0], pair[1])?;
    }
    Ok(())
}

/// The median difference of neighbours, s.
pub fn median_step_s(times_s: &[f64]) -> f64 {
    let mut steps_s: Vec<f64> = times_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    median(&mut steps_s)
}

/// The middle value (the upper one of two); NaN when there is none. Reorders its input.
pub fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The value with half of the weight below it, of pairs of value and weight; NaN when there is none.
fn weighted_median(mut values: Vec<(f64, f64)>) -> f64 {
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = values.iter().map(|(_, weight)| weight).sum::<f64>() / 2.0;
    let mut below = 0.0;
    let reaches = |(_, weight): &&(f64, f64)| {
        below += weight;
        below >= half
    };
    values.iter().find(reaches).or(values.last()).map_or(f64::NAN, |(value, _)| *value)
}

fn steps_are_even(times_s: &[f64], median_s: f64) -> bool {
    times_s
        .windows(2)
        .map(|pair| pair[1] - pair[0])
        .filter(|step_s| *step_s <= GAP_STEPS * median_s)
        .all(|step_s| (step_s - median_s).abs() <= EVEN_TOLERANCE * median_s)
}

fn find_gaps(times_s: &[f64], median_s: f64) -> Vec<Gap> {
    let even = steps_are_even(times_s, median_s);
    let is_gap = |pair: &[f64]| pair[1] - pair[0] > GAP_STEPS * median_s;
    let n_missing = |pair: &[f64]| even.then(|| ((pair[1] - pair[0]) / median_s).round() as usize - 1);
    times_s
        .windows(2)
        .enumerate()
        .filter(|(_, pair)| is_gap(pair))
        .map(|(after_idx, pair)| Gap { after_idx, from_s: pair[0], to_s: pair[1], n_missing: n_missing(pair) })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(n_samples: usize) -> Vec<f64> {
        (0..n_samples).map(|idx| (idx as f64 * 0.05).cos()).collect()
    }

    #[test]
    fn three_lost_samples_are_a_gap_with_its_count() {
        let mut times_s = uniform_times(100.0, 50).unwrap();
        times_s[20..].iter_mut().for_each(|time_s| *time_s += 0.03);
        let recording = Recording::new(Header::default(), times_s, wave(50), None).unwrap();
        assert_eq!(recording.gaps().len(), 1);
        assert_eq!(recording.gaps()[0].after_idx, 19);
        assert_eq!(recording.gaps()[0].n_missing, Some(3));
        assert!((recording.rate_hz() - 100.0).abs() < 1e-6);
    }

    #[test]
    fn uneven_steps_are_kept_and_gaps_have_no_count() {
        let mut time_s = 0.0;
        let steps = (0..60).map(|idx| if idx == 30 { 0.5 } else { 0.05 + 0.01 * f64::from(idx % 3) });
        let times_s: Vec<f64> = steps
            .map(|step| {
                time_s += step;
                time_s
            })
            .collect();
        let recording = Recording::new(Header::default(), times_s.clone(), wave(60), None).unwrap();
        assert_eq!(recording.times_s(), times_s);
        assert!(!recording.is_even());
        assert_eq!(recording.gaps()[0].n_missing, None);
    }

    #[test]
    fn even_samples_know_the_rate_they_were_told() {
        assert_eq!(Recording::uniform(30.0, wave(30)).unwrap().header().rate_hz, Some(30.0));
    }

    #[test]
    fn a_recording_with_three_samples_is_refused() {
        assert!(matches!(Recording::uniform(100.0, wave(3)), Err(Fault::TooFewSamples { n_found: 3 })));
    }

    #[test]
    fn a_rate_of_zero_is_refused() {
        assert!(matches!(Recording::uniform(0.0, wave(30)), Err(Fault::BadRate { .. })));
    }

    #[test]
    fn a_part_outside_the_recording_is_refused() {
        let recording = Recording::uniform(100.0, wave(30)).unwrap();
        assert!(recording.part(10..40).is_err());
        assert_eq!(recording.part(10..30).unwrap().times_s()[0], 0.1);
    }
}
