//! What can be wrong with a model file.

use super::FORMAT_VERSION;
use crate::files::FileError;
use shared::parameters::ParameterError;
use thiserror::Error;

/// A model file that can't be used.
#[derive(Debug, Error)]
pub enum RigFileError {
    /// The system refused.
    #[error("could not read {file}: {source}")]
    Unreadable {
        /// The file.
        file: String,
        /// The reason.
        source: std::io::Error,
    },
    /// Not UTF-8.
    #[error("could not read {file}: it is not a text file")]
    NotText {
        /// The file.
        file: String,
    },
    /// Not TOML.
    #[error("{file}, line {line}: {problem}")]
    Syntax {
        /// The file.
        file: String,
        /// Line, counted from 1.
        line: usize,
        /// In the parser's words.
        problem: String,
    },
    /// A key with a wrong value, or one that means nothing here.
    #[error("{file}, line {line}: {key}: {problem}")]
    Key {
        /// The file.
        file: String,
        /// Line, counted from 1.
        line: usize,
        /// The key with its table.
        key: String,
        /// What is wrong and what was expected.
        problem: String,
    },
    /// A key that is needed.
    #[error("{file}: {key} is missing; expected {expected}")]
    Missing {
        /// The file.
        file: String,
        /// The key with its table.
        key: String,
        /// What should stand there.
        expected: String,
    },
    /// Written by a later program.
    #[error("{file} has format {version}; this program knows up to {FORMAT_VERSION}")]
    Newer {
        /// The file.
        file: String,
        /// Version found.
        version: i64,
    },
    /// Numbers that no model can have.
    #[error("{0}")]
    Model(ParameterError),
    /// What is known of one sensor says nothing of another.
    #[error(
        "{effects} of the model is that of the gyroscope whose rates it was fitted to; the rig's potentiometer would be \
         corrected by it"
    )]
    OtherSensor {
        /// The effects' names.
        effects: String,
    },
    /// The system refused.
    #[error(transparent)]
    NotWritten(FileError),
}

impl RigFileError {
    /// What to do next.
    pub fn next_step(&self) -> String {
        match self {
            Self::Unreadable { source, .. } if source.kind() == std::io::ErrorKind::NotFound => {
                "make one with `host init`, or take it from the rig with `host pull`".into()
            }
            Self::Unreadable { .. } => "check that it is a file and may be read".into(),
            Self::NotText { file } => format!("save {file} as plain text (UTF-8), or make a new one with `host init`"),
            Self::Syntax { file, line, .. } | Self::Key { file, line, .. } => {
                format!("correct line {line} of {file}; `host init -o example.toml …` shows a valid file")
            }
            Self::Missing { file, key, .. } => format!("add {key} to {file}"),
            Self::Newer { .. } => "update this program".into(),
            Self::Model(_) => "give a value within the range, in SI units".into(),
            Self::OtherSensor { .. } => "send the rest with `host push --without-sensor`, or fit the model to a swing \
                                         that the rig recorded"
                .into(),
            Self::NotWritten(error) => error.next_step().into(),
        }
    }
}
