//! A swing to be judged, with what its recording tells beside it: noise of its still stretches, what was cut, and what
//! is not there.

use crate::fit::short_memory::NoiseLeft;
use crate::fit::touch::{self, Touch};
use crate::recording::Recording;
use crate::recording::noise::{self, Noise};
use crate::recording::segment::{FreeSwing, SegmentOptions, Segments, free_swings, segment};
use crate::swing::{Swing, SwingError};

/// The longest part of each that something touched on its way.
pub(super) fn longest(measurements: &[Measurement], touches: &[Touch]) -> Vec<Measurement> {
    let swings: Vec<Swing> = measurements.iter().map(|measurement| measurement.swing.clone()).collect();
    measurements.iter().zip(touch::longest(&swings, touches)).map(|(whole, part)| whole.cut_to(part)).collect()
}

/// A free swing and its surroundings.
#[derive(Clone, Debug)]
pub struct Measurement {
    /// The free swing.
    pub swing: Swing,
    /// Noise of its recording.
    pub noise: Noise,
    /// Was that told by what a model leaves?
    pub is_told_by_model: bool,
    /// Time of the swing's first sample on the recording's clock, s.
    pub from_s: f64,
    /// Was it held still before the release?
    pub has_lead_in: bool,
    /// Did it come to rest?
    pub has_rest: bool,
    /// What was noticed on the way, in words.
    pub notes: Vec<String>,
}

impl Measurement {
    /// Finds the longest free swing of a recording and looks at what lies around it.
    ///
    /// # Errors
    /// There is no free swing.
    pub fn from_recording(name: &str, recording: &Recording, options: &SegmentOptions) -> Result<Self, SwingError> {
        Self::of_segments(name, recording, segment(recording, options)?, options)
    }

    /// Finds all free swings of a recording likewise, in order of time.
    ///
    /// # Errors
    /// There is no free swing.
    pub fn each_of(name: &str, recording: &Recording, options: &SegmentOptions) -> Result<Vec<Self>, SwingError> {
        let found = free_swings(recording, options)?;
        let name_of =
            |idx: usize| if found.len() == 1 { name.to_owned() } else { format!("{name}, swing {}", idx + 1) };
        let names: Vec<String> = (0..found.len()).map(name_of).collect();
        let measurement = |(name, FreeSwing { recording, segments }): (&String, FreeSwing)| {
            Self::of_segments(name, &recording, segments, options)
        };
        names.iter().zip(found).map(measurement).collect()
    }

    fn of_segments(
        name: &str,
        recording: &Recording,
        segments: Segments,
        options: &SegmentOptions,
    ) -> Result<Self, SwingError> {
        let (swing, segments) = Swing::of_segments(name, recording, segments, options)?;
        let from_s = recording.times_s()[segments.free.start];
        let notes = recording.notes().iter().chain(&segments.notes).cloned().collect();
        let (has_lead_in, has_rest) = (segments.lead_in.is_some(), segments.rest.is_some());
        Ok(Self { swing, noise: segments.noise, is_told_by_model: false, from_s, has_lead_in, has_rest, notes })
    }

    /// The same of a part of its swing.
    fn cut_to(&self, part: Swing) -> Self {
        let begins_s = part.from_s - self.swing.from_s;
        let is_whole_to_the_end = begins_s + part.duration_s() >= self.swing.duration_s();
        Self {
            from_s: self.from_s + begins_s,
            has_lead_in: self.has_lead_in && begins_s == 0.0,
            has_rest: self.has_rest && is_whole_to_the_end,
            swing: part,
            ..self.clone()
        }
    }

    /// The same in the noise that a model leaves of it.
    pub fn in_noise(&self, left: NoiseLeft) -> Self {
        let NoiseLeft { noise_rad, colour } = left;
        let mut louder = Self { swing: self.swing.in_noise(noise_rad, colour), is_told_by_model: true, ..self.clone() };
        (louder.noise.still_rms, louder.noise.colour) = (Some(noise_rad), Some(colour));
        louder
    }

    /// A bare swing, of whose recording nothing else is known; its own noise is taken as it stands.
    pub fn of_swing(swing: Swing) -> Self {
        let lsb = noise::smallest_step(&swing.angles_rad);
        let quantisation_rms = lsb.unwrap_or(0.0) / 12f64.sqrt();
        let total_rms = swing.noise_rad;
        let white_rms = (total_rms.powi(2) - quantisation_rms.powi(2)).max(0.0).sqrt();
        let (colour, method) = (swing.colour, "the swing itself".to_owned());
        let noise = Noise {
            total_rms,
            white_rms,
            quantisation_rms,
            lsb,
            still_rms: None,
            colour,
            wanders_where_held: false,
            method,
        };
        Self {
            swing,
            noise,
            is_told_by_model: false,
            from_s: 0.0,
            has_lead_in: false,
            has_rest: false,
            notes: Vec::new(),
        }
    }
}
