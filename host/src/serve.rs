//! The local page: one server, one state, any number of tabs.
//!
//! In: requests of a browser on this computer. Out: the page's files, the state as JSON, and live points through a
//! WebSocket. What the page shows comes from the library (`compare`, `diagnose`, `improve`, `fit`, `record`); nothing
//! is computed in the browser. `guard` keeps other web pages out, `jobs` does one long thing after the other,
//! `live` owns the rig.

mod downloads;
mod draw;
mod files;
mod guard;
mod jobs;
mod live;
mod recordings;
mod request;
mod routes;
mod simulate;
mod socket;
mod state;
mod surfaces;
mod view;
mod work;

pub use guard::{Access, new_token};

use crate::error::Failure;
use crate::recording::ReadOptions;
use crate::recording::segment::SegmentOptions;
use crate::rigfile::RigFile;
use state::App;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::sync::watch;

/// After Ctrl-C requests that are still being answered have this long.
const LAST_ANSWERS: Duration = Duration::from_secs(1);

/// Threads that answer requests; what takes long runs on its own threads.
const N_WORKERS: usize = 2;

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
    async fn asked(&self) {
        let _ = self.0.subscribe().wait_for(|asked| *asked).await;
    }
}

/// Serves until `stop`; `announce` gets the address once the page can be opened.
///
/// # Errors
/// The address cannot be listened on.
pub fn run(settings: Settings, stop: &Stop, announce: impl FnOnce(&str)) -> Result<(), Failure> {
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(N_WORKERS).enable_all().build();
    runtime.map_err(Failure::failed)?.block_on(serve(settings, stop, announce))
}

/// The page without a network, a rig and a worker, for tests: takes requests, and what they ask for stays waiting.
pub fn unplugged(settings: Settings) -> axum::Router {
    let access = Access::new(settings.listen, settings.token.clone());
    routes::router(&App::new(settings, Stop::default()), access)
}

async fn serve(settings: Settings, stop: &Stop, announce: impl FnOnce(&str)) -> Result<(), Failure> {
    let wanted = settings.listen;
    let listener = TcpListener::bind(wanted).await.map_err(|error| not_bound(wanted, &error))?;
    let address = listener.local_addr().map_err(Failure::failed)?;
    let access = Access::new(address, settings.token.clone());
    let url = access.url();
    let app = App::new(settings, stop.clone());
    let rig = app.begin();
    announce(&url);
    let ended = stop.clone();
    let served = axum::serve(listener, routes::router(&app, access))
        .with_graceful_shutdown(async move { ended.asked().await })
        .into_future();
    tokio::select! {
        result = served => result.map_err(Failure::failed)?,
        () = async { stop.asked().await; tokio::time::sleep(LAST_ANSWERS).await } => {}
    }
    app.rig.leave();
    let _ = rig.join();
    Ok(())
}

fn not_bound(address: SocketAddr, error: &std::io::Error) -> Failure {
    Failure::failed(format!("could not listen on {address}: {error}"))
        .next("end the other program there, or choose another port: --listen 127.0.0.1:0 takes a free one")
}
