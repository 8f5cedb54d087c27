//! The noise of a recording, from the recording itself.
//!
//! In: raw times (s) and angles (rad). Out: total rms (rad) = white noise and quantisation together, and its parts.
//! It is what differences of neighbours leave (`differences`), or of a swing with few samples a period what pieces leave
//! that are fitted with sinusoids (`sinusoids`). On simulated rigs of known noise (0.6–1.8 steps of the converter,
//! 200–400 Hz) within 2 %.

mod colour;
mod differences;
mod scatter;
mod sinusoids;
mod steps;
mod still;

use crate::Recording;
use differences::{agreeing_order, robust_of_samples};
use serde::Serialize;
use std::ops::Range;
use steps::{frozen_blocks, lsb};

pub use colour::Colour;
pub use scatter::rms_about_line;
pub(crate) use scatter::{MEDIAN_SIZE, robust_spread};
pub use steps::smallest_step;
pub(crate) use still::noise_of_means;
pub use still::{SlowExcess, slow_excess};

/// Fewer still samples than this give no noise of their own.
const MIN_STILL: usize = 20;

/// Noise beyond so many times what most samples have is not theirs: that of a camera that blurs, or of rates that are worse the
/// faster it swings, is within a few times of it. A reading on the other side of a swing of 30° in 25 frames a second makes it 30
/// times. Half and twice: that reading is told as well.
const OUTWEIGHED: f64 = 8.0;

/// Noise of a recording; all rms values in rad.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Noise {
    /// White noise and quantisation together, from differences of neighbours.
    pub total_rms: f64,
    /// Smallest step of the sensor; `None` when the angles are not in steps.
    pub lsb: Option<f64>,
    /// Step / √12; 0 without steps.
    pub quantisation_rms: f64,
    /// What remains of the total.
    pub white_rms: f64,
    /// Scatter of the stillest still stretch.
    pub still_rms: Option<f64>,
    /// Present if neighbours are not independent while the pendulum hangs still: then they say too little or too much.
    #[serde(rename = "is_coloured", serialize_with = "is_there")]
    pub colour: Option<Colour>,
    /// Does it wander while the pendulum is held, and is there no rest to tell the sensor from a hand?
    #[serde(skip)]
    pub wanders_where_held: bool,
    /// How it was found, in words.
    #[serde(skip)]
    pub method: String,
}

impl Noise {
    /// What a perfect model leaves, rad.
    pub fn level_rad(&self) -> f64 {
        match self.still_rms {
            Some(still_rms) if self.colour.is_some() => still_rms,
            _ => self.total_rms,
        }
    }
}

fn is_there<S: serde::Serializer>(colour: &Option<Colour>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_bool(colour.is_some())
}

/// Noise of a whole recording from differences of neighbours; motion does not disturb it.
pub fn estimate(recording: &Recording) -> Noise {
    of_part(recording, 0..recording.len())
}

/// The same of a part of it: where it was put down or let go, the angle may jump.
pub fn of_part(recording: &Recording, part: Range<usize>) -> Noise {
    of_samples(&recording.times_s()[part.clone()], &recording.angles_rad()[part], lsb(recording))
}

/// Noise of bare samples, with the sensor's step if it is known.
pub fn of_samples(times_s: &[f64], angles_rad: &[f64], lsb: Option<f64>) -> Noise {
    let frozen = frozen_blocks(angles_rad, lsb);
    let (order, differences) = agreeing_order(times_s, angles_rad, &frozen);
    // Both are upper bounds.
    if let Some(rms) = sinusoids::rms(times_s, angles_rad, &frozen, differences.rms())
        && rms < differences.rms()
    {
        return with_parts(rms, lsb, "what pieces of a few periods leave beyond sinusoids".to_owned());
    }
    let method = format!("differences of order {order} over {} windows", differences.n_windows);
    with_parts(differences.rms(), lsb, method)
}

/// White noise (rms) of most samples where a few outweigh all others, as when a tracker takes another point; else the noise as
/// it is.
pub(crate) fn of_most_samples(times_s: &[f64], angles_rad: &[f64], noise: &Noise) -> f64 {
    let most = robust_of_samples(times_s, angles_rad).max(noise.quantisation_rms);
    if most > 0.0 && noise.total_rms > OUTWEIGHED * most { most } else { noise.total_rms }
}

/// Noise of a stretch in which the pendulum is still (held before the release, or at rest); a slow drift is removed.
/// `None` for a stretch that is too short, or frozen within one step of the sensor.
pub fn of_still(recording: &Recording, still: Range<usize>) -> Option<Noise> {
    let angles_rad = recording.angles_rad().get(still)?;
    let n = angles_rad.len();
    if n < MIN_STILL {
        return None;
    }
    let lsb = lsb(recording);
    let rms = rms_about_line(angles_rad);
    let is_frozen = rms < lsb.unwrap_or(0.0) / 4.0 || rms == 0.0;
    (!is_frozen).then(|| with_parts(rms, lsb, format!("scatter of {n} still samples")))
}

/// Splits the total. With a step the total cannot be below step / √12 while the pendulum moves across many steps.
fn with_parts(rms: f64, lsb: Option<f64>, method: String) -> Noise {
    let quantisation_rms = lsb.unwrap_or(0.0) / 12f64.sqrt();
    let total_rms = rms.max(quantisation_rms);
    let white_rms = (total_rms.powi(2) - quantisation_rms.powi(2)).sqrt();
    Noise {
        total_rms,
        lsb,
        quantisation_rms,
        white_rms,
        still_rms: None,
        colour: None,
        wanders_where_held: false,
        method,
    }
}

#[cfg(test)]
mod tests;
