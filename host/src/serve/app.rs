//! What all requests share: settings, the state and its listeners, the queue of jobs, the rig's doorbell.

use super::evidence::Evidence;
use super::jobs::{Client, Jobs};
use super::recordings::Loaded;
use super::releases::Releases;
use super::rig::Rig;
use super::settings::{Settings, Stop};
use super::state::{Named, Numbers, State};
use crate::error::Failure;
use axum::extract::ws::Utf8Bytes;
use std::sync::{Arc, Mutex, PoisonError};
use tokio::sync::{broadcast, watch};

/// Live messages that a slow tab may be behind before it loses some.
const LIVE_BACKLOG: usize = 64;

/// The server's memory.
pub(super) struct App {
    pub(super) settings: Settings,
    pub(super) stop: Stop,
    pub(super) jobs: Jobs<App>,
    pub(super) rig: Rig,
    /// Live points as messages, for every tab that listens.
    pub(super) live: broadcast::Sender<Utf8Bytes>,
    /// What the live view has listened to.
    releases: Mutex<Releases>,
    state: Mutex<State>,
    revision: watch::Sender<u64>,
}

impl App {
    pub(super) fn new(settings: Settings, stop: Stop) -> Arc<Self> {
        let model = settings.model.clone().map(|(file, origin)| Named { file, origin, numbers: Numbers::Foreign });
        Arc::new(Self {
            settings,
            stop,
            jobs: Jobs::new(),
            rig: Rig::new(),
            live: broadcast::Sender::new(LIVE_BACKLOG),
            releases: Mutex::default(),
            state: Mutex::new(State::with(model)),
            revision: watch::Sender::new(1),
        })
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

    /// Changes what is shown of the evidence; tabs hear of it if it is news.
    pub(super) fn show_evidence(&self, change: impl FnOnce(&mut Evidence)) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let before = state.evidence.clone();
        change(&mut state.evidence);
        let is_news = state.evidence != before;
        drop(state);
        if is_news {
            self.tell();
        }
    }

    /// Looks at what the live view has listened to, or changes it.
    pub(super) fn with_releases<T>(&self, change: impl FnOnce(&mut Releases) -> T) -> T {
        change(&mut self.releases.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Hears of changes.
    pub(super) fn changes(&self) -> watch::Receiver<u64> {
        self.revision.subscribe()
    }

    /// Takes the recordings of a file in, perhaps in another one's place, and looks at everything anew; gives the first
    /// one's id.
    pub(super) fn take_in(&self, loaded: Vec<Loaded>, replaced: Option<u32>) -> Result<u32, Failure> {
        let id = self.change(|state| state.add(loaded, replaced))?;
        self.jobs.ask_for_a_look();
        Ok(id)
    }

    /// The present model.
    pub(super) fn model(&self) -> Result<Named, Failure> {
        let next = "give mass, length and inertia, or a rig.toml";
        let missing = || Failure::wrong_use("there is no model yet").next(next);
        self.read(|state| state.model.clone()).ok_or_else(missing)
    }
}

impl Client for App {
    fn jobs(&self) -> &Jobs<Self> {
        &self.jobs
    }

    /// Every tab looks at the state anew.
    fn tell(&self) {
        self.revision.send_modify(|revision| *revision += 1);
    }

    fn fail(&self, failure: Failure) {
        self.change(|state| state.failure = Some(failure));
    }
}
