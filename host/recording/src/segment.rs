//! Where the pendulum swings freely: after it was held or touched, until it hangs still.
//!
//! In: a recording, perhaps with the user's own limits. Out: index ranges and what was cut, in words.
//!
//! A free pendulum obeys `α = −ω0² sin θ + b cos θ − c sgn ω − d ω − e ω|ω|`. The five numbers are fitted to the middle
//! of the recording, robustly; where the acceleration (from local polynomials) is off by far more than noise, a hand
//! did it. The free swing is the undisturbed stretch with the most swings. The friction law is crude on purpose:
//! it must recognise a hand, which does tens of rad/s², and be blind to every kind of missing physics.
//! If the pendulum was held still before, the release is placed to a few ms by fitting the start of the fall; the free
//! range begins shortly after it, never before.

mod anew;
mod backwards;
mod bounds;
mod cut;
mod ends;
mod error;
mod growth;
mod half_swing;
mod held;
mod interrupted;
mod kept;
mod law;
mod middle;
mod motor;
mod rest;
mod several;
mod start;
mod stretch;
mod too_few;
mod words;

use super::Recording;
use super::noise::Noise;
use bounds::Bounds;
use cut::Cut;
pub use error::SegmentError;
pub use several::{FreeSwing, free_swings};
use std::ops::Range;

/// Two swings there and back.
const MIN_TURNING_POINTS: usize = 4;

/// Stillness is doubted when the mean over a short window leaves the start by this many of its standard deviations.
const STILL_SPREADS: f64 = 5.0;

/// Standard deviations that a growth, a motor or a rest wants.
const SURE: f64 = 6.0;

/// A free swing of ten hours; a simulation of more would want more memory than there is.
const LONGEST_S: f64 = 36_000.0;

/// The user's own limits, s; `None` = found.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SegmentOptions {
    /// `--from`: the free swing begins here.
    pub from_s: Option<f64>,
    /// `--to`: the free swing ends here.
    pub to_s: Option<f64>,
}

/// The parts of a recording, as ranges of samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Segments {
    /// Held still at the beginning, before the release or before a hand lifted it.
    pub lead_in: Option<Range<usize>>,
    /// Swinging freely, down to the final stop.
    pub free: Range<usize>,
    /// Samples of the free swing that are none of it, though it goes on behind: left out.
    pub interrupted: Vec<Range<usize>>,
    /// Parts beside it that may be free swings as well.
    pub others: Vec<Range<usize>>,
    /// Hanging still at the end.
    pub rest: Option<Range<usize>>,
    /// The release, s: fitted when it was held still before, else the begin of the free range.
    pub release_s: f64,
    /// Turning points within the free range.
    pub n_turning_points: usize,
    /// A typical half swing, s.
    pub half_swing_s: f64,
    /// Noise of the whole recording, or of the free range alone where something else jumps.
    pub noise: Noise,
    /// Do the swings become smaller, as free ones must?
    pub fades: bool,
    /// What was cut and why, in words.
    pub notes: Vec<String>,
}

/// Finds the free swing.
///
/// # Errors
/// Fewer than two swings, or limits outside the recording.
pub fn segment(recording: &Recording, options: &SegmentOptions) -> Result<Segments, SegmentError> {
    let asked = asked_range(recording, options)?;
    free_swing(recording, options, asked.clone()).map_err(|fault| too_few::explained(fault, recording, &asked))
}

fn free_swing(recording: &Recording, options: &SegmentOptions, asked: Range<usize>) -> Result<Segments, SegmentError> {
    let whole = Cut::new(recording, asked)?;
    let is_told = *options != SegmentOptions::default();
    let found = whole.narrowed(is_told)?;
    parts(recording, options, &whole, &found).or_else(|fault| match fault {
        SegmentError::TooFewSwings { .. } if !is_told => {
            let behind = whole.behind_hold().and_then(|behind| parts(recording, options, &whole, &behind).ok());
            behind.ok_or(fault)
        }
        _ => Err(fault),
    })
}

/// The parts about a stretch that swings freely, with what tells of it if that is less than all.
fn parts(
    recording: &Recording,
    options: &SegmentOptions,
    whole: &Cut,
    (narrower, stretch): &(Option<Cut>, Range<usize>),
) -> Result<Segments, SegmentError> {
    let is_told = *options != SegmentOptions::default();
    let cut = narrower.as_ref().unwrap_or(whole);
    let bounds = Bounds::of(cut, stretch, &whole.asked, options);
    let n_turning_points = cut.check_enough_swings(&bounds.free)?;
    let (held, hanging) = cut.held_or_hanging(&bounds.start);
    let quiet_end = if options.to_s.is_some() { None } else { cut.quiet_end(stretch) };
    let noise = cut.noise(&bounds.free).beside_still(recording, [hanging, quiet_end], held);
    log_noise(&noise, &bounds.free);
    let interrupted = cut.interrupted_within(&bounds.free);
    let others = if is_told { Vec::new() } else { whole.other_swings(&bounds.free) };
    Ok(Segments {
        notes: words::notes([whole, cut], options, &bounds, &interrupted, &noise),
        fades: cut.fades(&bounds.free),
        half_swing_s: cut.half_swing_s,
        lead_in: bounds.start.lead_in,
        release_s: bounds.start.release_s,
        free: bounds.free,
        rest: bounds.rest,
        interrupted,
        others,
        n_turning_points,
        noise,
    })
}

fn log_noise(noise: &Noise, free: &Range<usize>) {
    let still = noise.still_rms.map_or("nothing known".to_owned(), |rms| format!("{rms:.3e} rad"));
    log::debug!(
        "noise {:.3e} rad from {}, {still} where it is still; free swing {free:?}",
        noise.total_rms,
        noise.method
    );
}

fn asked_range(recording: &Recording, options: &SegmentOptions) -> Result<Range<usize>, SegmentError> {
    let (first_s, last_s) = (recording.times_s()[0], recording.times_s()[recording.len() - 1]);
    let (from_s, to_s) = (options.from_s.unwrap_or(first_s), options.to_s.unwrap_or(last_s));
    let start = recording.index_at(from_s);
    let end = recording.times_s().partition_point(|time_s| *time_s <= to_s);
    let n_samples = end.saturating_sub(start);
    if n_samples < super::limits::MIN_SAMPLES {
        return Err(SegmentError::NothingBetween { from_s, to_s, n_samples, first_s, last_s });
    }
    Ok(start..end)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[cfg(test)]
mod tests;
