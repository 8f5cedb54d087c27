//! What the server is started with, and what ends it.

use crate::recording::ReadOptions;
use crate::recording::segment::SegmentOptions;
use crate::rigfile::RigFile;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;
use tokio::sync::watch;

/// What the server is started with.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Where to listen; port 0 takes a free one.
    pub listen: SocketAddr,
    /// Who may come in; needed unless `listen` is this computer only.
    pub token: Option<String>,
    /// The rig: serial device, `sim` or `sim:NAME`.
    pub port: Option<String>,
    /// The simulated rig runs so many times faster than real time.
    pub sim_speed: f64,
    /// The model and what it is called; none yet without a file.
    pub model: Option<(RigFile, String)>,
    /// Recordings to begin with.
    pub recordings: Vec<PathBuf>,
    /// New recordings go here.
    pub folder: PathBuf,
    /// How recordings are read.
    pub reading: ReadOptions,
    /// The free swing, if the user knows it better.
    pub segment: SegmentOptions,
}

/// Ends the server from outside.
#[derive(Clone, Debug)]
pub struct Stop(Arc<watch::Sender<bool>>);

impl Default for Stop {
    fn default() -> Self {
        Self(Arc::new(watch::Sender::new(false)))
    }
}

impl Stop {
    /// Asks for the end.
    pub fn now(&self) {
        self.0.send_replace(true);
    }

    /// Waits until somebody asks.
    pub(super) async fn asked(&self) {
        let _ = self.0.subscribe().wait_for(|asked| *asked).await;
    }
}
