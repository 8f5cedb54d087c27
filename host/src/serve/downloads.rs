//! Files to keep: the model, what was compared, the recordings.

use super::app::App;
use super::draw;
use super::request::{Path, Refused, blocking};
use crate::error::Failure;
use crate::report::report;
use axum::Json;
use axum::extract::State;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::{IntoResponse, Response};
use std::sync::Arc;

/// A file to keep.
fn download(name: &str, kind: &'static str, content: impl Into<axum::body::Body>) -> Response {
    let plain: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() || ".-_ ".contains(c) { c } else { '_' }).collect();
    let disposition = format!("attachment; filename=\"{plain}\"");
    ([(CONTENT_TYPE, kind.to_owned()), (CONTENT_DISPOSITION, disposition)], content.into()).into_response()
}

pub(super) async fn model(State(app): State<Arc<App>>) -> Result<Response, Refused> {
    Ok(download("rig.toml", "application/toml", app.model()?.file.to_string()))
}

fn comparison(app: &App) -> Result<Arc<crate::compare::Comparison>, Failure> {
    let missing =
        || Failure::wrong_use("nothing has been compared yet").next("load a recording and wait for the verdict");
    app.read(|state| state.comparison.clone()).ok_or_else(missing)
}

pub(super) async fn comparison_json(State(app): State<Arc<App>>) -> Result<Response, Refused> {
    let comparison = comparison(&app)?;
    let text = serde_json::to_string_pretty(&*comparison).map_err(Failure::failed)?;
    Ok(download("comparison.json", "application/json", text))
}

pub(super) async fn report_html(State(app): State<Arc<App>>) -> Result<Response, Refused> {
    let comparison = comparison(&app)?;
    let Json(text) = blocking(move || Ok(report(&comparison))).await?;
    Ok(download("report.html", "text/html; charset=utf-8", text))
}

pub(super) async fn recording(State(app): State<Arc<App>>, Path(id): Path<u32>) -> Result<Response, Refused> {
    let recording = app.read(|state| state.recording(id))?;
    let name = recording.file.clone();
    let gone = format!("{name} can't be read any more");
    let failed = move |error| Failure::failed(format!("{gone}: {error}")).next("load it again");
    let Json(bytes) = blocking(move || std::fs::read(recording.kept.path()).map_err(failed)).await?;
    Ok(download(&name, "text/csv", bytes))
}

pub(super) async fn modelled(State(app): State<Arc<App>>, Path(id): Path<u32>) -> Result<Response, Refused> {
    let Json((name, text)) = blocking(move || draw::table(&app, id)).await?;
    Ok(download(&format!("modelled-{name}"), "text/csv", text))
}
