//! From recordings to the swings that a command works on.

use crate::compare::measurement::Measurement;
use crate::error::Failure;
use crate::recording::segment::SegmentOptions;
use crate::recording::{self, ReadOptions, Recording, Run};
use crate::rigfile::RigFile;
use crate::swing::Swing;
use std::path::Path;

/// How recordings are read, and where their free swing lies if somebody knows it better.
#[derive(Clone, Debug, Default)]
pub struct Reading {
    /// How files are read.
    pub options: ReadOptions,
    /// Where the free swing lies.
    pub segment: SegmentOptions,
}

impl Reading {
    /// What only both limits together tell.
    ///
    /// # Errors
    /// The swing would end before it begins.
    pub fn check(&self) -> Result<(), Failure> {
        match (self.segment.from_s, self.segment.to_s) {
            (Some(from), Some(to)) if from >= to => {
                Err(Failure::wrong_use(format!("--from {from} s is not before --to {to} s"))
                    .next(format!("write --from {to} --to {from}, or leave one out")))
            }
            _ => Ok(()),
        }
    }

    /// The same, for recordings of the sensor that a model file tells of.
    pub fn of(self, model: &RigFile) -> Self {
        Self { options: ReadOptions { measured: model.measured(), ..self.options }, ..self }
    }

    /// Reads the recordings of a file, one for each run.
    ///
    /// # Errors
    /// As [`recording::read_runs`].
    pub fn runs(&self, path: &Path) -> Result<Vec<Run>, Failure> {
        recording::read_runs(path, &self.options).map_err(Failure::failed)
    }

    /// Reads the recording of a file that holds only one.
    ///
    /// # Errors
    /// As [`recording::read`].
    pub fn recording(&self, path: &Path) -> Result<Recording, Failure> {
        recording::read(path, &self.options).map_err(Failure::failed)
    }

    /// The free swings of a recording, each with what was noticed on the way.
    ///
    /// # Errors
    /// No free swing is in it.
    pub fn swings(&self, name: &str, recording: &Recording) -> Result<Vec<(Swing, Vec<String>)>, Failure> {
        let told = |Measurement { swing, notes, .. }: Measurement| {
            let notes = notes.iter().map(|note| format!("{}: {note}", swing.name)).collect();
            (swing, notes)
        };
        Ok(self.measurements(name, recording)?.into_iter().map(told).collect())
    }

    /// The free swings of a recording, with what is known around them.
    ///
    /// # Errors
    /// No free swing is in it.
    pub fn measurements(&self, name: &str, recording: &Recording) -> Result<Vec<Measurement>, Failure> {
        Measurement::each_of(name, recording, &self.segment)
            .map_err(|error| Failure::failed(format!("{name}: {error}")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_swing_that_would_end_before_it_begins_is_refused_with_the_limits_the_other_way_round() {
        let check = |from_s, to_s| {
            let segment = SegmentOptions { from_s: Some(from_s), to_s: Some(to_s) };
            Reading { segment, ..Reading::default() }.check()
        };
        assert!(check(2.0, 3.0).is_ok() && check(2.0, 2.0).is_err());
        let refused = check(3.0, 2.0).unwrap_err();
        assert_eq!(refused.what(), "--from 3 s is not before --to 2 s");
        assert_eq!(refused.next_step(), Some("write --from 2 --to 3, or leave one out"));
    }
}
