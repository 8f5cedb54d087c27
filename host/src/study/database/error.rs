//! Why a database can't be used, and what to do.

use super::VERSION;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a database can't be used.
#[derive(Debug, Error)]
pub enum DatabaseError {
    /// It is not there.
    #[error("there is no database {}", path.display())]
    Missing {
        /// The file.
        path: PathBuf,
    },
    /// A file of something else.
    #[error("{} is no database of a study", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// Tables of another version.
    #[error("{} has version {found} of the tables; this program has {VERSION}", path.display())]
    Version {
        /// The file.
        path: PathBuf,
        /// As found.
        found: i32,
    },
    /// SQLite or the system refused.
    #[error("could not use the database {}: {source}", path.display())]
    Refused {
        /// The file.
        path: PathBuf,
        /// The reason.
        source: rusqlite::Error,
    },
}

impl DatabaseError {
    /// What to do next.
    pub fn next_step(&self) -> &'static str {
        match self {
            Self::Missing { .. } => "check its name, or run `host study FOLDER` first",
            Self::Foreign { .. } => "choose another file with --database",
            Self::Version { .. } => "use the program that made it, or begin another one with --database",
            Self::Refused { .. } => "name one with --database in a folder that may be written to and has space",
        }
    }
}

pub(super) fn refused(path: &Path, source: rusqlite::Error) -> DatabaseError {
    match source.sqlite_error_code() {
        Some(rusqlite::ErrorCode::NotADatabase) => DatabaseError::Foreign { path: path.to_owned() },
        _ => DatabaseError::Refused { path: path.to_owned(), source },
    }
}
