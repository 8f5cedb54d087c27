//! What can be asked of the server, one line each.

use super::app::App;
use super::geometry::Geometry;
use super::guard::{self, Access};
use super::preview::{self, Preview};
use super::recordings::{LoadingWish, MOST_BYTES, of_upload};
use super::request::{Answered, Body, DONE, Done, OnDisk, Path, Query, Refused, Sent, blocking};
use super::rig::Wish;
use super::simulate::{Question, Values, answer};
use super::{downloads, draw, edit, files, live, socket, surfaces, view, work};
use axum::extract::{DefaultBodyLimit, State, WebSocketUpgrade};
use axum::http::header::CONTENT_TYPE;
use axum::http::{StatusCode, Uri};
use axum::middleware::from_fn_with_state;
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Json, Router};
use serde::Deserialize;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// Requests other than uploads are small.
const MOST_JSON_BYTES: usize = 64 << 10;

/// A model file is small too.
const MOST_MODEL_BYTES: usize = 1 << 20;

/// What every request sees.
type Shared = State<Arc<App>>;

/// Everything there is.
pub(super) fn router(app: &Arc<App>, access: Access) -> Router {
    let uploads = Router::new()
        .route("/api/recordings", post(upload))
        .route("/api/preview", post(preview))
        .layer(DefaultBodyLimit::max(MOST_BYTES))
        .merge(Router::new().route("/api/model", post(upload_model)).layer(DefaultBodyLimit::max(MOST_MODEL_BYTES)));
    let small = Router::new()
        .route("/events", get(events))
        .route("/api/effects", get(effects))
        .route("/api/trace/{id}", get(trace))
        .route("/api/pictures", get(titles))
        .route("/api/pictures/{key}", get(picture))
        .route("/api/recordings/{id}", axum::routing::delete(remove))
        .route("/api/recordings/{id}/held-out", post(hold_out))
        .route("/api/pendulum", post(pendulum))
        .route("/api/simulate", post(simulate))
        .route("/api/values", post(set_values))
        .route("/api/change", post(change))
        .route("/api/formula", post(add_formula))
        .route("/api/undo", post(undo))
        .route("/api/diagnose", post(diagnose))
        .route("/api/fit", post(fit))
        .route("/api/fit/path", get(path))
        .route("/api/fit/surface", get(surface))
        .route("/api/dismiss", post(dismiss))
        .route("/api/rig/connect", post(connect))
        .route("/api/rig/listen", post(listen))
        .route("/api/rig/pause", post(pause))
        .route("/api/rig/record", post(record))
        .route("/api/rig/stop-recording", post(stop_recording))
        .route("/api/rig/suspect", post(suspect))
        .route("/api/rig/values", get(rig_values))
        .route("/api/rig/push", post(push))
        .route("/download/rig.toml", get(downloads::model))
        .route("/download/comparison.json", get(downloads::comparison_json))
        .route("/download/report.html", get(downloads::report_html))
        .route("/download/recording/{id}", get(downloads::recording))
        .route("/download/modelled/{id}", get(downloads::modelled))
        .layer(DefaultBodyLimit::max(MOST_JSON_BYTES));
    let all = uploads.merge(small).fallback(page_file).method_not_allowed_fallback(wrong_method);
    all.layer(from_fn_with_state(access, guard::check)).with_state(app.clone())
}

async fn page_file(uri: Uri) -> Response {
    match files::file(uri.path().trim_start_matches('/')) {
        Some((kind, text)) => ([(CONTENT_TYPE, kind)], text).into_response(),
        None => {
            let what = format!("there is nothing at {}", uri.path());
            Refused::new(StatusCode::NOT_FOUND, what, "open the address that the server printed").into_response()
        }
    }
}

async fn wrong_method() -> Refused {
    Refused::new(StatusCode::METHOD_NOT_ALLOWED, "this cannot be asked in this way", "use the page")
}

async fn events(State(app): Shared, upgrade: WebSocketUpgrade) -> Response {
    upgrade.on_upgrade(move |socket| socket::serve(app, socket))
}

async fn effects() -> Json<Vec<view::EffectView>> {
    Json(view::effects())
}

async fn trace(State(app): Shared, Path(id): Path<u32>, Query(range): Query<draw::Range>) -> Answered<draw::Trace> {
    blocking(move || draw::trace(&app, id, &range)).await
}

async fn titles(State(app): Shared) -> Answered<Vec<draw::Title>> {
    blocking(move || Ok(draw::titles(&app))).await
}

async fn picture(State(app): Shared, Path(key): Path<String>) -> Answered<crate::plot::Picture> {
    blocking(move || draw::picture(&app, &key)).await
}

/// What a file is called by the person who sends it.
#[derive(Deserialize)]
struct Name {
    name: String,
}

async fn upload(State(app): Shared, Query(wish): Query<LoadingWish>, file: OnDisk) -> Answered<u32> {
    let (reader, replaced) = (app.clone(), wish.replaced);
    let Json(loaded) = blocking(move || of_upload(&wish, file.0, &reader.settings)).await?;
    app.take_in(loaded, replaced).map(Json).map_err(Refused::beside_others)
}

async fn preview(State(app): Shared, Query(wish): Query<LoadingWish>, file: OnDisk) -> Answered<Preview> {
    blocking(move || preview::preview(&wish, file.0.path(), &app.settings)).await
}

async fn upload_model(State(app): Shared, Query(Name { name }): Query<Name>, body: Body) -> Done {
    edit::model_file(&app, &name, &body.0)?;
    DONE
}

async fn remove(State(app): Shared, Path(id): Path<u32>) -> Done {
    edit::remove_recording(&app, id)?;
    DONE
}

#[derive(Deserialize)]
struct HeldOut {
    held_out: bool,
}

async fn hold_out(State(app): Shared, Path(id): Path<u32>, Sent(HeldOut { held_out }): Sent<HeldOut>) -> Done {
    edit::hold_out(&app, id, held_out)?;
    DONE
}

async fn pendulum(State(app): Shared, Sent(geometry): Sent<Geometry>) -> Done {
    edit::geometry(&app, &geometry)?;
    DONE
}

async fn simulate(State(app): Shared, Sent(question): Sent<Question>) -> Answered<super::simulate::Answer> {
    blocking(move || answer(&app, &question)).await
}

/// Values by name.
#[derive(Deserialize)]
struct Set {
    values: Values,
}

async fn set_values(State(app): Shared, Sent(Set { values }): Sent<Set>) -> Done {
    edit::values(&app, &values)?;
    DONE
}

async fn change(State(app): Shared, Sent(changes): Sent<edit::Changes>) -> Done {
    edit::effects(&app, &changes)?;
    DONE
}

/// A law that somebody typed.
#[derive(Deserialize)]
struct Typed {
    formula: String,
}

async fn add_formula(State(app): Shared, Sent(Typed { formula }): Sent<Typed>) -> Done {
    edit::formula(&app, &formula)?;
    DONE
}

async fn undo(State(app): Shared) -> Done {
    work::undo(&app)?;
    DONE
}

async fn diagnose(State(app): Shared) -> Done {
    app.jobs.ask("looking for what is missing", work::find_missing)?;
    DONE
}

async fn fit(State(app): Shared) -> Done {
    app.jobs.ask("fitting", work::identify)?;
    DONE
}

async fn path(State(app): Shared) -> Answered<surfaces::Path> {
    blocking(move || surfaces::path(&app)).await
}

async fn surface(State(app): Shared, Query(which): Query<surfaces::Which>) -> Answered<surfaces::SurfaceView> {
    blocking(move || surfaces::surface(&app, &which)).await
}

async fn dismiss(State(app): Shared) -> Done {
    app.change(|state| state.failure = None);
    DONE
}

#[derive(Deserialize)]
struct Port {
    port: String,
}

async fn connect(State(app): Shared, Sent(Port { port }): Sent<Port>) -> Done {
    live::connect(&app, port)?;
    DONE
}

async fn listen(State(app): Shared) -> Done {
    app.rig.wish(Wish::Listen);
    DONE
}

async fn pause(State(app): Shared) -> Done {
    app.rig.wish(Wish::Pause);
    DONE
}

async fn record(State(app): Shared) -> Done {
    app.rig.wish_recording();
    DONE
}

async fn stop_recording(State(app): Shared) -> Done {
    app.rig.stop_recording.store(true, Ordering::SeqCst);
    DONE
}

async fn suspect(State(app): Shared, Sent(suspect): Sent<edit::Suspect>) -> Done {
    edit::suspect(&app, &suspect).await?;
    DONE
}

async fn rig_values(State(app): Shared) -> Answered<Vec<view::Replaced>> {
    let new = app.model()?.file.parameters().clone();
    let old = app.rig.parameters().await?.map(f64::from);
    Ok(Json(view::replaced(&old, &new)))
}

async fn push(State(app): Shared) -> Done {
    app.rig.push(app.model()?.file).await?;
    DONE
}
