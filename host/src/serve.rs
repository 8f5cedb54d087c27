//! The local page: one server, one state, any number of tabs.
//!
//! In: requests of a browser on this computer. Out: the page's files, the state as JSON, and live points through a
//! WebSocket. What the page shows comes from the library (`compare`, `diagnose`, `improve`, `fit`, `record`); nothing
//! is computed in the browser.
//!
//! `app` holds what all requests share: settings, the one `state`, the queue of `jobs`, the `rig`'s doorbell. Above it
//! stand `work` (the long things), `live` (the thread that owns the rig), `edit` (changes of the model), `view` and
//! `draw` (what the page sees); `routes` names them, `guard` keeps other web pages out.

mod app;
mod downloads;
mod draw;
mod edit;
mod evidence;
mod files;
mod geometry;
mod guard;
mod jobs;
mod live;
mod preview;
mod recordings;
mod releases;
mod request;
mod rig;
mod routes;
mod settings;
mod simulate;
mod socket;
mod state;
mod surfaces;
mod view;
mod work;

pub use guard::{Access, new_token};
pub use settings::{Settings, Stop};

use crate::error::Failure;
use app::App;
use std::net::SocketAddr;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;
use tokio::net::TcpListener;

/// After Ctrl-C requests that are still being answered have this long.
const LAST_ANSWERS: Duration = Duration::from_secs(1);

/// Threads that answer requests; what takes long runs on its own threads.
const N_WORKERS: usize = 2;

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
    let rig = begin(&app);
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

/// Starts what runs beside the server: the worker, the first recordings, the rig. Gives the rig's thread.
fn begin(app: &Arc<App>) -> JoinHandle<()> {
    app.jobs.begin(app, work::look);
    if !app.settings.recordings.is_empty() {
        let _ = app.jobs.ask("reading recordings", work::read_first);
    }
    live::begin(app)
}

fn not_bound(address: SocketAddr, error: &std::io::Error) -> Failure {
    Failure::failed(format!("could not listen on {address}: {error}"))
        .next("end the other program there, or choose another port: --listen 127.0.0.1:0 takes a free one")
}
