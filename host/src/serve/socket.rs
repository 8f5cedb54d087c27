//! One tab's WebSocket: the state whenever it changes, progress while something is done, live points as they come.

use super::app::App;
use super::view::view;
use axum::extract::ws::{Message, WebSocket};
use serde::Serialize;
use std::sync::Arc;
use std::time::Duration;
use tokio::sync::broadcast::error::RecvError;
use tokio::time::{MissedTickBehavior, interval, sleep};

/// Progress is shown this often.
const PROGRESS_EVERY: Duration = Duration::from_millis(200);

/// Changes within this time are one.
const GATHER: Duration = Duration::from_millis(30);

/// Serves a tab until it closes or the program ends.
pub(super) async fn serve(app: Arc<App>, mut socket: WebSocket) {
    let mut changes = app.changes();
    changes.mark_changed();
    let mut live = app.live.subscribe();
    let mut ticks = interval(PROGRESS_EVERY);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let mut was_busy = true;
    loop {
        let message = tokio::select! {
            () = app.stop.asked() => break,
            received = socket.recv() => match received {
                Some(Ok(Message::Close(_)) | Err(_)) | None => break,
                Some(Ok(_)) => continue,
            },
            _ = changes.changed() => {
                sleep(GATHER).await;
                changes.mark_unchanged();
                text(&view(&app))
            }
            _ = ticks.tick() => {
                let job = app.jobs.now();
                let is_busy = job.is_some();
                if !is_busy && !std::mem::replace(&mut was_busy, is_busy) {
                    continue;
                }
                was_busy = is_busy;
                text(&Progress { kind: "job", job })
            }
            points = live.recv() => match points {
                Ok(points) => Message::Text(points),
                // A tab that is too slow misses points rather than letting them pile up.
                Err(RecvError::Lagged(_)) => continue,
                Err(RecvError::Closed) => break,
            },
        };
        if socket.send(message).await.is_err() {
            break;
        }
    }
    let _ = socket.send(Message::Close(None)).await;
}

#[derive(Serialize)]
struct Progress<T> {
    #[serde(rename = "type")]
    kind: &'static str,
    job: T,
}

fn text(value: &impl Serialize) -> Message {
    Message::Text(serde_json::to_string(value).unwrap_or_default().into())
}
