//! A recording that could not be written.

use crate::files::FileError;
use std::path::PathBuf;
use thiserror::Error;

/// A recording that could not be written.
#[derive(Debug, Error)]
pub enum WriteError {
    /// The file is there already.
    #[error("{} exists already; choose another name, or allow it to be replaced with --force", path.display())]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// The system refused.
    #[error("could not write {}: {source}; check that the folder exists, may be written to and has space", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: std::io::Error,
    },
    /// A sample that would make the file unreadable.
    #[error("sample {sample_idx} (t = {time_s} s, theta = {angle_rad} rad) was not written: {reason}")]
    BadSample {
        /// Count of the sample, from 0.
        sample_idx: usize,
        /// Its time, s.
        time_s: f64,
        /// Its angle, rad.
        angle_rad: f64,
        /// What is wrong with it.
        reason: &'static str,
    },
}

impl From<FileError> for WriteError {
    fn from(error: FileError) -> Self {
        match error {
            FileError::Io { path, source } => Self::Io { path, source },
            FileError::Exists { path } | FileError::IsRead { path } | FileError::Twice { path } => {
                Self::Exists { path }
            }
        }
    }
}
