//! Is what the board streams what its potentiometer showed?
//!
//! The emulator's ramp is a code that counts milliseconds, so every sample says itself when it was taken.

use shared::wire::{Frame, Samples, status};

/// The ramp's first code, and how many there are.
const FIRST_CODE: f64 = 1000.0;
const N_CODES: f64 = 14_000.0;

/// A sample is a mean over its period, rounded: it may be off by this much besides half a period.
const TOLERANCE_MS: f64 = 1.0;

/// What was missing in a stream.
#[derive(Debug, Default, PartialEq)]
pub struct Gaps {
    /// Samples that came.
    pub n_samples: u64,
    /// Samples whose numbers were left out.
    pub n_missing: u64,
    /// The longest gap, in samples.
    pub longest: u64,
}

/// Goes through the samples of a stream, each `period_s` after the last one: their codes have to fit their numbers, and
/// whatever is missing must have been announced. An error says what did not fit.
pub fn check(frames: &[Frame], period_s: f64) -> Result<Gaps, String> {
    check_with(frames, period_s, true)
}

/// The same behind faults of the link, which take frames with them: their numbers tell what is missing.
pub fn check_numbers(frames: &[Frame], period_s: f64) -> Result<Gaps, String> {
    check_with(frames, period_s, false)
}

fn check_with(frames: &[Frame], period_s: f64, link_is_whole: bool) -> Result<Gaps, String> {
    let mut gaps = Gaps::default();
    let (mut next, mut sequence, mut zero_ms) = (None, None, None);
    for samples in frames.iter().filter_map(samples_of) {
        let expected = next.unwrap_or(samples.first_sample);
        let missing = samples.first_sample.checked_sub(expected).ok_or("the numbers go back")?;
        let announced = !link_is_whole || samples.status & (status::SAMPLES_LOST | status::FRAMES_DROPPED) != 0;
        if missing > 0 && !announced {
            return Err(format!("{missing} samples are missing before {expected} and nobody says so"));
        }
        let may_jump = !link_is_whole || samples.status & status::FRAMES_DROPPED != 0;
        if sequence.is_some_and(|sequence| samples.sequence != sequence) && !may_jump {
            return Err(format!("a frame is missing before {} and nobody says so", samples.sequence));
        }
        gaps.n_missing += missing;
        gaps.longest = gaps.longest.max(missing);
        gaps.n_samples += samples.codes.len() as u64;
        sequence = Some(samples.sequence + 1);
        next = Some(samples.first_sample + samples.codes.len() as u64);
        check_codes(samples, period_s, &mut zero_ms)?;
    }
    Ok(gaps)
}

fn samples_of(frame: &Frame) -> Option<&Samples> {
    match frame {
        Frame::Samples(samples) => Some(samples),
        _ => None,
    }
}

fn check_codes(samples: &Samples, period_s: f64, zero_ms: &mut Option<f64>) -> Result<(), String> {
    for (i, code) in samples.codes.iter().enumerate() {
        let (number, shown_ms) = (samples.first_sample + i as u64, f64::from(*code) - FIRST_CODE);
        let taken_ms = number as f64 * period_s * 1e3;
        let zero_ms = *zero_ms.get_or_insert(shown_ms - taken_ms);
        let off_ms = (shown_ms - taken_ms - zero_ms + N_CODES / 2.0).rem_euclid(N_CODES) - N_CODES / 2.0;
        // Where the ramp starts again a mean lies anywhere between its ends.
        let at_an_end = shown_ms < period_s * 1e3 + 2.0 || shown_ms > N_CODES - period_s * 1e3 - 2.0;
        if off_ms.abs() > TOLERANCE_MS + period_s * 1e3 && !at_an_end && !wraps_within(taken_ms + zero_ms, period_s) {
            return Err(format!("sample {number} was taken {off_ms:.1} ms away from where its number says"));
        }
    }
    Ok(())
}

fn wraps_within(at_ms: f64, period_s: f64) -> bool {
    let place = at_ms.rem_euclid(N_CODES);
    place < 2.0 + period_s * 1e3 || place > N_CODES - 2.0 - period_s * 1e3
}
