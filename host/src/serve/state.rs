//! What all tabs see: one model, its recordings, what was found, and the rig.

use super::jobs::Jobs;
use super::live::{Rig, RigView};
use super::recordings::{self, Loaded};
use super::{Settings, Stop, work};
use crate::compare::Comparison;
use crate::compare::follow::Followed;
use crate::diagnose::Diagnosis;
use crate::diagnose::trial::Trial;
use crate::error::Failure;
use crate::fit::identify::Fit;
use crate::improve::Step;
use crate::rigfile::RigFile;
use axum::extract::ws::Utf8Bytes;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use tokio::sync::{broadcast, watch};

/// Live messages that a slow tab may be behind before it loses some.
const LIVE_BACKLOG: usize = 64;

/// So many changes can be taken back.
const MOST_UNDOS: usize = 50;

/// The server's memory.
pub(super) struct App {
    pub(super) settings: Settings,
    pub(super) stop: Stop,
    pub(super) jobs: Jobs,
    pub(super) rig: Rig,
    /// Live points as messages, for every tab that listens.
    pub(super) live: broadcast::Sender<Utf8Bytes>,
    state: Mutex<State>,
    revision: watch::Sender<u64>,
}

/// The one state.
#[derive(Default)]
pub(super) struct State {
    pub(super) model: Option<Named>,
    pub(super) recordings: Vec<Arc<Loaded>>,
    /// The model beside each recording, by the recording's id.
    pub(super) runs: HashMap<u32, Arc<Followed>>,
    pub(super) comparison: Option<Arc<Comparison>>,
    pub(super) diagnosis: Option<Arc<Diagnosis>>,
    pub(super) fit: Option<Arc<Fit>>,
    /// The fitted model from which changes go on; absent once recordings or values changed.
    pub(super) trial: Option<Trial>,
    pub(super) staircase: Vec<Step>,
    pub(super) history: Vec<Snapshot>,
    pub(super) failure: Option<Failure>,
    pub(super) rig: RigView,
    /// Counts changes of what is drawn.
    pub(super) drawing: u64,
    next_id: u32,
}

/// A model and what it is called.
#[derive(Clone)]
pub(super) struct Named {
    pub(super) file: RigFile,
    pub(super) origin: String,
}

/// What undo brings back.
pub(super) struct Snapshot {
    model: Option<Named>,
    runs: HashMap<u32, Arc<Followed>>,
    comparison: Option<Arc<Comparison>>,
    trial: Option<Trial>,
    staircase: Vec<Step>,
    /// Undo is for the model; with other recordings what was seen of them is seen anew.
    ids: Vec<(u32, bool)>,
}

impl App {
    pub(super) fn new(settings: Settings, stop: Stop) -> Arc<Self> {
        let model = settings.model.clone().map(|(file, origin)| Named { file, origin });
        Arc::new(Self {
            settings,
            stop,
            jobs: Jobs::new(),
            rig: Rig::new(),
            live: broadcast::Sender::new(LIVE_BACKLOG),
            state: Mutex::new(State { model, ..State::default() }),
            revision: watch::Sender::new(1),
        })
    }

    /// Starts what runs beside the server: the worker, the rig, the first recordings. Gives the rig's thread.
    pub(super) fn begin(self: &Arc<Self>) -> JoinHandle<()> {
        self.jobs.begin(self);
        if !self.settings.recordings.is_empty() {
            let _ = self.jobs.ask("reading recordings", work::read_first);
        }
        self.rig.begin(self)
    }

    /// Looks at the state.
    pub(super) fn read<T>(&self, look: impl FnOnce(&State) -> T) -> T {
        look(&self.state.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Changes the state; every tab hears of it.
    pub(super) fn change<T>(&self, change: impl FnOnce(&mut State) -> T) -> T {
        let result = change(&mut self.state.lock().unwrap_or_else(PoisonError::into_inner));
        self.tell();
        result
    }

    /// Every tab looks at the state anew.
    pub(super) fn tell(&self) {
        self.revision.send_modify(|revision| *revision += 1);
    }

    /// Hears of changes.
    pub(super) fn changes(&self) -> watch::Receiver<u64> {
        self.revision.subscribe()
    }
}

impl State {
    /// Takes a recording in; what was seen before is looked at anew.
    ///
    /// # Errors
    /// There are too many already.
    pub(super) fn add(&mut self, loaded: Loaded) -> Result<u32, Failure> {
        recordings::check_room(&self.recordings, &loaded)?;
        self.next_id += 1;
        let name = recordings::unused_name(&self.recordings, &loaded.name);
        self.recordings.push(Arc::new(Loaded { id: self.next_id, name, ..loaded }));
        self.data_changed();
        Ok(self.next_id)
    }

    /// Other recordings: what was found from the old ones no longer counts.
    pub(super) fn data_changed(&mut self) {
        self.trial = None;
        self.diagnosis = None;
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
