//! The rig's doorbell: what may be asked of it, and what the page shows of it.

use crate::error::Failure;
use crate::rigfile::RigFile;
use serde::Serialize;
use shared::parameters::Parameters;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Mutex, PoisonError};
use tokio::sync::oneshot;

/// Where an answer goes.
type Answer<T> = oneshot::Sender<Result<T, Failure>>;

/// What may be asked of the rig.
pub(super) enum Wish {
    /// Opens a port and listens.
    Connect(String),
    /// Listens on, from a fresh stream.
    Listen,
    /// Stops listening.
    Pause,
    /// Records a swing.
    Record,
    /// Gives the parameters in use.
    Read(Answer<Parameters<f32>>),
    /// Sends a model and saves it to flash.
    Push(Box<RigFile>, Answer<()>),
    /// Ends the thread.
    Leave,
}

/// The rig's doorbell.
pub(super) struct Rig {
    sender: Sender<Wish>,
    receiver: Mutex<Option<Receiver<Wish>>>,
    /// Ends a recording early.
    pub(super) stop_recording: AtomicBool,
}

/// What the page shows of the rig.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(super) struct RigView {
    /// As named by the user.
    pub(super) port: Option<String>,
    /// Name and version, once connected.
    pub(super) firmware: Option<String>,
    /// Does its pendulum let go by itself?
    pub(super) simulated: bool,
    pub(super) listening: bool,
    /// The stage of a recording.
    pub(super) recording: Option<&'static str>,
    /// How the last recording ended, until the next swing.
    pub(super) recorded: Option<String>,
    /// The last thing worth telling.
    pub(super) note: Option<String>,
    pub(super) failure: Option<(String, Option<String>)>,
    pub(super) frames: u64,
    pub(super) frames_lost: u64,
    pub(super) frames_damaged: u64,
    pub(super) samples_lost: u64,
    /// By the rig's own count, over the last seconds.
    pub(super) innovation_rms_rad: Option<f64>,
    pub(super) overruns: u32,
    pub(super) dropped_frames: u32,
    pub(super) disconnected: u32,
}

impl Rig {
    pub(super) fn new() -> Self {
        let (sender, receiver) = channel();
        Self { sender, receiver: Mutex::new(Some(receiver)), stop_recording: AtomicBool::new(false) }
    }

    /// The wishes, for whoever fulfils them; only the first who asks gets them.
    pub(super) fn wishes(&self) -> Option<Receiver<Wish>> {
        self.receiver.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// The parameters in use.
    pub(super) async fn parameters(&self) -> Result<Parameters<f32>, Failure> {
        self.answered(Wish::Read).await
    }

    /// Sends a model and saves it to flash.
    pub(super) async fn push(&self, model: RigFile) -> Result<(), Failure> {
        if model.is_normalised() {
            let what = "the model's geometry is unknown, so the rig cannot use it";
            return Err(Failure::wrong_use(what).next("give mass, length and inertia"));
        }
        model.check_sensor()?;
        self.answered(|answer| Wish::Push(Box::new(model), answer)).await
    }

    async fn answered<T>(&self, wish: impl FnOnce(Answer<T>) -> Wish) -> Result<T, Failure> {
        let (sender, receiver) = oneshot::channel();
        self.wish(wish(sender));
        receiver.await.map_err(|_| Failure::failed("the rig is gone").next("connect it again"))?
    }

    /// Asks for something.
    pub(super) fn wish(&self, wish: Wish) {
        let _ = self.sender.send(wish);
    }

    /// Asks for a recording, whatever ended the last one.
    pub(super) fn wish_recording(&self) {
        self.stop_recording.store(false, Ordering::SeqCst);
        self.wish(Wish::Record);
    }

    /// Lets go of the rig; a recording that goes on is kept as far as it is.
    pub(super) fn leave(&self) {
        self.stop_recording.store(true, Ordering::SeqCst);
        self.wish(Wish::Leave);
    }
}
