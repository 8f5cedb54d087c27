//! What can be wrong with a recording file, in words: the thing, the value, what was expected, what to do next.

mod fault;
mod growth;
mod no_angle;
mod write;

pub use fault::Fault;
pub use no_angle::NoAngle;
pub use write::WriteError;

use growth::growth_in_words;
use thiserror::Error;

/// A file that could not be read as a recording.
#[derive(Debug, Error)]
#[error("could not read recording {file}: {fault}")]
pub struct ReadError {
    /// The file as the user named it.
    pub file: String,
    /// What is wrong with it.
    pub fault: Fault,
}

impl Fault {
    /// What speaks against the unit of the angle, without what to do about it.
    pub(super) fn evidence(&self) -> String {
        match self {
            Self::NotRadians { predicted_percent, found_percent, .. } => {
                growth_in_words(*predicted_percent, *found_percent)
            }
            Self::NotDegrees { factor, .. } => {
                format!("the period grows with the amplitude as it does for angles {factor:.0} times as large")
            }
            other => other.to_string(),
        }
    }
}

/// Time must increase from one sample to the next.
pub(super) fn check_step(place: impl Fn() -> String, unit: &'static str, before: f64, after: f64) -> Result<(), Fault> {
    if after < before {
        return Err(Fault::TimeBackwards { place: place(), before, after, unit });
    }
    if after == before {
        return Err(Fault::TimeRepeats { place: place(), time: after, unit, n_rows: 2, has_digits: false });
    }
    Ok(())
}
