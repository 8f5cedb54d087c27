//! A model and the recordings it is held against: what compare, diagnose, improve and plan are given.

use super::columns::Reading;
use super::rig;
use crate::error::Failure;
use crate::rigfile::RigFile;
use crate::swing::Swing;
use clap::Args;
use std::path::PathBuf;

/// Recordings, a model file, and how to answer.
#[derive(Clone, Debug, Args)]
pub(super) struct Given {
    /// Recordings of one rig, all at once; several release angles tell the most
    #[arg(value_name = "RECORDING", required = true)]
    pub(super) recordings: Vec<PathBuf>,
    /// The model file; ./rig.toml if there is one. One straight from `host init` will do
    #[arg(long, value_name = "FILE")]
    pub(super) rig: Option<PathBuf>,
    /// Print one JSON object instead of text
    #[arg(long)]
    pub(super) json: bool,
    #[command(flatten)]
    pub(super) reading: Reading,
}

impl Given {
    /// The model, once the options are known to make sense.
    pub(super) fn model(&self) -> Result<RigFile, Failure> {
        self.reading.check()?;
        let file = rig::load(self.rig.as_deref())?;
        rig::tell_if_normalised(&file);
        Ok(file)
    }

    /// The free swings of the recordings.
    pub(super) fn swings(&self) -> Result<Vec<Swing>, Failure> {
        self.reading.swings(&self.recordings)
    }
}
