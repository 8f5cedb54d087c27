//! A swing to be judged, with what its recording tells beside it: noise of its still stretches, what was cut, and what
//! is not there.

use crate::recording::Recording;
use crate::recording::noise;
use crate::recording::segment::{SegmentOptions, Segments};
use crate::swing::{Swing, SwingError};
use serde::Serialize;
use std::ops::Range;

use super::colour;

/// A free swing and its surroundings.
#[derive(Clone, Debug)]
pub struct Measurement {
    /// The free swing.
    pub swing: Swing,
    /// Noise of its recording.
    pub noise: SensorNoise,
    /// Time of the swing's first sample on the recording's clock, s.
    pub from_s: f64,
    /// Was it held still before the release?
    pub has_lead_in: bool,
    /// Did it come to rest?
    pub has_rest: bool,
    /// What was noticed on the way, in words.
    pub notes: Vec<String>,
}

/// Noise of a sensor, from the recording itself; rms values in rad.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SensorNoise {
    /// White noise and quantisation, from differences of neighbours.
    pub total_rms: f64,
    /// What remains of it without quantisation.
    pub white_rms: f64,
    /// Step / √12; 0 without steps.
    pub quantisation_rms: f64,
    /// Smallest step of the sensor.
    pub lsb: Option<f64>,
    /// Scatter of the longest still stretch.
    pub still_rms: Option<f64>,
    /// True if the still stretch wanders: then neighbours alone say too little.
    pub is_coloured: bool,
}

impl SensorNoise {
    /// What a perfect model leaves, rad.
    pub fn level_rad(&self) -> f64 {
        match self.still_rms {
            Some(still_rms) if self.is_coloured => self.total_rms.max(still_rms),
            _ => self.total_rms,
        }
    }
}

/// Still samples tell of colour from so many on.
const MIN_STILL: usize = 200;

/// Scatter beyond this many times that of neighbours is colour.
const COLOURED_RATIO: f64 = 1.1;

impl Measurement {
    /// Finds the free swing of a recording and looks at what lies around it.
    ///
    /// # Errors
    /// There is no free swing.
    pub fn from_recording(name: &str, recording: &Recording, options: &SegmentOptions) -> Result<Self, SwingError> {
        let (mut swing, segments) = Swing::from_recording(name, recording, options)?;
        let noise = sensor_noise(recording, &segments);
        swing.noise_rad = noise.level_rad();
        let from_s = recording.times_s()[segments.free.start];
        let notes = recording.notes().iter().chain(&segments.notes).cloned().collect();
        let (has_lead_in, has_rest) = (segments.lead_in.is_some(), segments.rest.is_some());
        Ok(Self { swing, noise, from_s, has_lead_in, has_rest, notes })
    }

    /// A bare swing, of whose recording nothing else is known; its own noise is taken as it stands.
    pub fn of_swing(swing: Swing) -> Self {
        let lsb = noise::smallest_step(&swing.angles_rad);
        let quantisation_rms = lsb.unwrap_or(0.0) / 12f64.sqrt();
        let total_rms = swing.noise_rad;
        let white_rms = (total_rms.powi(2) - quantisation_rms.powi(2)).max(0.0).sqrt();
        let noise = SensorNoise { total_rms, white_rms, quantisation_rms, lsb, still_rms: None, is_coloured: false };
        Self { swing, noise, from_s: 0.0, has_lead_in: false, has_rest: false, notes: Vec::new() }
    }
}

fn sensor_noise(recording: &Recording, segments: &Segments) -> SensorNoise {
    let of_neighbours = &segments.noise;
    let total_rms = of_neighbours.total_rms;
    // A hand may tremble before the release: the stillest stretch decides.
    let stretches = [segments.lead_in.clone(), segments.rest.clone()].into_iter().flatten();
    let still = stretches.filter_map(|range| still_stretch(recording, range)).min_by(|a, b| a.0.total_cmp(&b.0));
    let is_coloured = still.is_some_and(|(rms, is_white)| !is_white && rms > COLOURED_RATIO * total_rms);
    SensorNoise {
        total_rms,
        white_rms: of_neighbours.white_rms,
        quantisation_rms: of_neighbours.quantisation_rms,
        lsb: of_neighbours.lsb,
        still_rms: still.map(|(rms, _)| rms),
        is_coloured,
    }
}

/// Scatter of a still stretch (rad), and whether it is white.
fn still_stretch(recording: &Recording, range: Range<usize>) -> Option<(f64, bool)> {
    let noise = noise::of_still(recording, range.clone()).filter(|_| range.len() >= MIN_STILL)?;
    let angles_rad = &recording.angles_rad()[range];
    let mean = angles_rad.iter().sum::<f64>() / angles_rad.len() as f64;
    let scatter: Vec<f64> = angles_rad.iter().map(|angle| angle - mean).collect();
    let is_white = !colour::slow_excess(&scatter, noise.total_rms, STILL_BLOCK).is_significant();
    Some((noise.total_rms, is_white))
}

/// Samples of a block of still ones.
const STILL_BLOCK: usize = 8;
