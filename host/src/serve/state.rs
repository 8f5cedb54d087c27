//! What all tabs see: one model, its recordings, what was found, and the rig.

use super::evidence::Evidence;
use super::recordings::{self, Loaded};
use super::rig::RigView;
use crate::compare::Comparison;
use crate::compare::follow::Followed;
use crate::diagnose::Diagnosis;
use crate::error::Failure;
use crate::fit::fitted::Fitted;
use crate::fit::identify::Fit;
use crate::improve::Step;
use crate::rigfile::RigFile;
use std::collections::HashMap;
use std::sync::Arc;

/// So many changes can be taken back.
const MOST_UNDOS: usize = 50;

/// The one state.
#[derive(Default)]
pub(super) struct State {
    pub(super) model: Option<Named>,
    /// Of the rig whose model this was at first, if it was one's.
    pub(super) model_port: Option<String>,
    pub(super) recordings: Vec<Arc<Loaded>>,
    /// What speaks against some of them among the others.
    pub(super) doubts: Vec<String>,
    /// The model beside each recording, by the recording's id.
    pub(super) runs: HashMap<u32, Arc<Followed>>,
    pub(super) comparison: Option<Arc<Comparison>>,
    pub(super) diagnosis: Option<Arc<Diagnosis>>,
    /// What the model had in it when that was made.
    pub(super) diagnosed: Vec<&'static str>,
    pub(super) fit: Option<Arc<Fit>>,
    /// The fitted model from which changes go on; absent once recordings or values changed.
    pub(super) trial: Option<Fitted>,
    pub(super) staircase: Vec<Step>,
    pub(super) history: Vec<Snapshot>,
    pub(super) failure: Option<Failure>,
    /// Why there is no comparison, if one was tried in vain.
    pub(super) not_compared: Option<Failure>,
    pub(super) rig: RigView,
    pub(super) evidence: Evidence,
    /// Counts changes of what is drawn.
    pub(super) drawing: u64,
    next_id: u32,
}

/// A model and what it is called.
#[derive(Clone)]
pub(super) struct Named {
    pub(super) file: RigFile,
    pub(super) origin: String,
    pub(super) numbers: Numbers,
}

/// Where a model's numbers come from, and so whether the page may fit them unasked.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Numbers {
    /// From a file or a rig: fitted first if they do not fit the recordings.
    Foreign,
    /// Set by hand on the page: they stay.
    Typed,
    /// Fitted to the recordings with these ids.
    FittedTo(Vec<u32>),
}

/// What undo brings back.
pub(super) struct Snapshot {
    model: Option<Named>,
    runs: HashMap<u32, Arc<Followed>>,
    comparison: Option<Arc<Comparison>>,
    trial: Option<Fitted>,
    staircase: Vec<Step>,
    /// Undo is for the model; with other recordings what was seen of them is seen anew.
    ids: Vec<(u32, bool)>,
}

impl State {
    /// Nothing but a model, if there is one.
    pub(super) fn with(model: Option<Named>) -> Self {
        Self { model, ..Self::default() }
    }

    /// One recording of the list.
    ///
    /// # Errors
    /// There is none with this id.
    pub(super) fn recording(&self, id: u32) -> Result<Arc<Loaded>, Failure> {
        Ok(self.recordings[self.place_of(id)?].clone())
    }

    /// Where a recording stands in the list.
    ///
    /// # Errors
    /// There is none with this id.
    pub(super) fn place_of(&self, id: u32) -> Result<usize, Failure> {
        let next = "it may have been taken out in another tab";
        let missing = || Failure::wrong_use(format!("there is no recording {id}")).next(next);
        self.recordings.iter().position(|recording| recording.id == id).ok_or_else(missing)
    }

    /// Another rig is connected: what was listened to before is of another pendulum, and so is a model that was a rig's.
    pub(super) fn meet(&mut self, port: &str) {
        let is_here = |of: &Option<String>| of.as_deref().is_none_or(|of| of == port);
        if is_here(&self.model_port) && self.recordings.iter().all(|recording| is_here(&recording.port)) {
            return;
        }
        self.remember();
        if !is_here(&self.model_port) {
            (self.model, self.model_port) = (None, None);
        }
        self.recordings.retain(|recording| is_here(&recording.port));
        self.runs.clear();
        self.comparison = None;
        self.data_changed();
    }

    /// Takes the recordings of a file in, all or none, perhaps in the place of one that was read otherwise; what was seen
    /// before is looked at anew. Gives the first one's id.
    ///
    /// # Errors
    /// One of them is there already, or there are too many.
    pub(super) fn add(&mut self, loaded: Vec<Loaded>, replaced: Option<u32>) -> Result<u32, Failure> {
        let is_kept = |recording: &&Arc<Loaded>| Some(recording.id) != replaced;
        let kept: Vec<_> = self.recordings.iter().filter(is_kept).cloned().collect();
        recordings::refuse_doubles(&kept, &loaded)?;
        recordings::check_room(&kept, &loaded)?;
        if let Some(id) = replaced {
            self.recordings = kept;
            self.runs.remove(&id);
            self.comparison = None;
        }
        let first_id = self.next_id + 1;
        for loaded in loaded {
            self.next_id += 1;
            let name = recordings::unused_name(&self.recordings, &loaded.name);
            self.recordings.push(Arc::new(Loaded { id: self.next_id, name, ..loaded }));
        }
        self.data_changed();
        Ok(first_id)
    }

    /// Other recordings: what was found from the old ones no longer counts.
    pub(super) fn data_changed(&mut self) {
        self.trial = None;
        self.diagnosis = None;
        self.doubts.clear();
        self.staircase.clear();
        self.drawing += 1;
    }

    /// Keeps the present model for undo.
    pub(super) fn remember(&mut self) {
        let snapshot = Snapshot {
            model: self.model.clone(),
            runs: self.runs.clone(),
            comparison: self.comparison.clone(),
            trial: self.trial.clone(),
            staircase: self.staircase.clone(),
            ids: self.ids(),
        };
        if self.history.len() == MOST_UNDOS {
            self.history.remove(0);
        }
        self.history.push(snapshot);
    }

    /// Takes the last change of the model back; false if its recordings are no longer the same and need a look.
    ///
    /// # Errors
    /// There is none.
    pub(super) fn undo(&mut self) -> Result<bool, Failure> {
        let nothing = Failure::wrong_use("there is no change to take back").next("change the model first");
        let snapshot = self.history.pop().ok_or(nothing)?;
        let same = snapshot.ids == self.ids();
        self.model = snapshot.model;
        self.drawing += 1;
        if same {
            self.runs = snapshot.runs;
            self.comparison = snapshot.comparison;
            self.trial = snapshot.trial;
            self.staircase = snapshot.staircase;
        } else {
            self.data_changed();
        }
        Ok(same)
    }

    fn ids(&self) -> Vec<(u32, bool)> {
        self.recordings.iter().map(|recording| (recording.id, recording.held_out)).collect()
    }
}
