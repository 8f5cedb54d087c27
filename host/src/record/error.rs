//! What leaves no recording.

use crate::error::Failure;
use crate::files::FileError;
use crate::link::LinkError;
use crate::recording::WriteError;
use shared::sensor::Sensor;
use std::path::PathBuf;
use thiserror::Error;

/// Nothing was recorded, and why.
#[derive(Debug, Error)]
pub enum RecordError {
    /// The link could not be used.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The disk took a part of the swing only.
    #[error("{source}; the first {n_samples} samples are kept in {}", path.display())]
    CutShort {
        /// The reason.
        source: WriteError,
        /// So many are in the file.
        n_samples: usize,
        /// The file.
        path: PathBuf,
    },
    /// The sensor reads an end of its range.
    #[error("the {} reads code {code} of 0 … {}: an end of its range", sensor.name(), sensor.full_scale())]
    Disconnected {
        /// The code it reads.
        code: u16,
        /// Which sensor.
        sensor: Sensor,
    },
    /// Never still.
    #[error("the pendulum did not come to rest within {seconds} s; its angle still varies by {spread_rad:.3} rad")]
    NeverStill {
        /// How long it was waited for.
        seconds: f64,
        /// Standard deviation of the angle over the last half second.
        spread_rad: f64,
    },
    /// Nobody let it go.
    #[error("no release was seen within {seconds} s")]
    NoRelease {
        /// How long it was waited for.
        seconds: f64,
    },
    /// Stopped before there was anything.
    #[error("stopped before the pendulum was let go: nothing was recorded")]
    StoppedEarly,
}

impl RecordError {
    /// Is all well but that nobody is there to let the pendulum go, or not any more?
    pub fn is_nobody_there(&self) -> bool {
        matches!(self, Self::NeverStill { .. } | Self::NoRelease { .. } | Self::StoppedEarly)
    }
}

impl From<RecordError> for Failure {
    fn from(error: RecordError) -> Self {
        let hint = match error {
            RecordError::Link(error) => return error.into(),
            RecordError::Write(WriteError::Exists { path }) => return FileError::Exists { path }.into(),
            RecordError::Write(_) => return Self::failed(error),
            RecordError::CutShort { .. } => "make space, or name a file on another disk, and record again",
            RecordError::Disconnected { sensor, .. } => {
                let hint = format!("{}, and that the pendulum hangs in the middle of its travel", sensor.wires());
                return Self::failed(error).next(hint);
            }
            RecordError::NeverStill { .. } => "stop the pendulum by hand, or look for what shakes it, and record again",
            RecordError::NoRelease { .. } => {
                "lift the pendulum by 0.5 rad (30°) or more, hold it still, let it go; --wait SECONDS gives more time"
            }
            RecordError::StoppedEarly => return Self::interrupted(error).next("repeat the command"),
        };
        Self::failed(error).next(hint)
    }
}
