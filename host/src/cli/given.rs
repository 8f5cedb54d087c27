//! A model and the recordings it is held against: what compare, diagnose, improve and plan are given.

use super::columns::Reading;
use super::{output, rig};
use crate::error::Failure;
use crate::geometry;
use crate::rigfile::RigFile;
use crate::swing::{Swing, one_kind};
use clap::Args;
use shared::parameters::Parameters;
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

    /// The free swings of the recordings, which must be able to be this pendulum's.
    pub(super) fn swings(&self, model: &RigFile) -> Result<Vec<Swing>, Failure> {
        let swings = self.reading.of(model).swings(&self.recordings)?;
        refuse_doubles(&swings, &[])?;
        check_geometry(model.parameters(), &swings)?;
        Ok(swings)
    }

    /// The free swings of recordings that take no part; none of them may be among those that do.
    pub(super) fn held_out(&self, model: &RigFile, paths: &[PathBuf], fitted: &[Swing]) -> Result<Vec<Swing>, Failure> {
        let held_out = self.reading.of(model).swings(paths)?;
        refuse_doubles(fitted, &held_out)?;
        Ok(held_out)
    }
}

/// Can these be swings of this pendulum? Doubts are told.
pub(super) fn check_geometry(parameters: &Parameters<f64>, swings: &[Swing]) -> Result<(), Failure> {
    let doubts = geometry::check(parameters, swings).map_err(Failure::failed)?;
    doubts.iter().for_each(|doubt| output::warn(doubt));
    Ok(())
}

/// Angles and rates do not mix; a recording that is given twice would count twice, and one that is fitted confirms nothing when it is held out.
pub(super) fn refuse_doubles(fitted: &[Swing], held_out: &[Swing]) -> Result<(), Failure> {
    one_kind(fitted.iter().chain(held_out)).map_err(Failure::failed)?;
    let all: Vec<(&Swing, bool)> =
        fitted.iter().map(|swing| (swing, false)).chain(held_out.iter().map(|swing| (swing, true))).collect();
    for (i, (swing, is_held_out)) in all.iter().enumerate() {
        let Some((other, _)) = all[..i].iter().find(|(other, _)| is_same(swing, other)) else { continue };
        let (name, other) = (&swing.name, &other.name);
        let was_fitted = *is_held_out && fitted.iter().any(|fitted| is_same(swing, fitted));
        let failure = if was_fitted {
            Failure::wrong_use(format!("{name} is fitted (as {other}) and held out at once, so it confirms nothing"))
                .next("hold out another recording, or leave this one out of the fit")
        } else {
            Failure::wrong_use(format!("{name} holds the same recording as {other}, which would count twice"))
                .next("give each recording once")
        };
        return Err(failure);
    }
    Ok(())
}

fn is_same(a: &Swing, b: &Swing) -> bool {
    a.len() == b.len() && a.angles_rad == b.angles_rad && a.times_s == b.times_s
}
