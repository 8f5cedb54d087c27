//! A model and the recordings it is held against: what compare, diagnose, improve and plan are given.

use super::columns::Reading;
use super::{output, rig};
use crate::error::Failure;
use crate::operations::given::{doubts, doubts_of_held_out, refuse_doubles};
use crate::rigfile::RigFile;
use crate::swing::Swing;
use clap::Args;
use shared::parameters::Parameters;
use std::path::{Path, PathBuf};

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

    /// The free swings of the recordings, which must be able to be this pendulum's.
    pub(super) fn swings(&self, model: &RigFile) -> Result<Vec<Swing>, Failure> {
        let mut swings = self.reading.of(model).swings(&self.recordings)?;
        refuse_doubles(&swings, &[])?;
        check_geometry(model.parameters(), &mut swings)?;
        Ok(swings)
    }

    /// The free swings of recordings that take no part; none of them may be among those that do.
    pub(super) fn held_out(&self, model: &RigFile, paths: &[PathBuf], fitted: &[Swing]) -> Result<Vec<Swing>, Failure> {
        let held_out = self.reading.of(model).swings(paths)?;
        refuse_doubles(fitted, &held_out)?;
        check_held_out(model.parameters(), fitted, &held_out);
        Ok(held_out)
    }

    /// May these files be written? Nothing that is read is replaced, nor any other file unasked.
    pub(super) fn check_outputs(&self, new: &[&Path], held_out: &[PathBuf], force: bool) -> Result<(), Failure> {
        let rig = rig::chosen_path(self.rig.as_deref());
        let read: Vec<&Path> = self.recordings.iter().chain(held_out).chain(&rig).map(PathBuf::as_path).collect();
        output::check(new, &read, force)
    }
}

/// Can what is held out be of the fitted pendulum? Doubts are told.
pub(super) fn check_held_out(parameters: &Parameters<f64>, fitted: &[Swing], held_out: &[Swing]) {
    doubts_of_held_out(parameters, fitted, held_out).iter().for_each(|doubt| output::warn(doubt));
}

/// Can these be swings of this pendulum, and of one? Doubts are told, and kept with the swings.
pub(super) fn check_geometry(parameters: &Parameters<f64>, swings: &mut [Swing]) -> Result<(), Failure> {
    doubts(parameters, swings)?.iter().for_each(|doubt| output::warn(doubt));
    Ok(())
}
