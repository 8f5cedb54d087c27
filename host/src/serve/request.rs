//! How requests are read and answers are wrapped.

use super::recordings::MOST_BYTES;
use crate::error::Failure;
use axum::Json;
use axum::RequestExt;
use axum::body::{Bytes, HttpBody};
use axum::extract::rejection::{JsonRejection, PathRejection, QueryRejection};
use axum::extract::{FromRequest, FromRequestParts};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use serde::Serialize;
use std::future::poll_fn;
use std::io::Write;
use std::pin::Pin;
use tempfile::NamedTempFile;
use tokio::task::spawn_blocking;

/// Why a request was not answered, as JSON.
pub(super) struct Refused {
    status: StatusCode,
    what: String,
    next: Option<String>,
}

impl Refused {
    pub(super) fn new(status: StatusCode, what: impl ToString, next: impl ToString) -> Self {
        Self { status, what: what.to_string(), next: Some(next.to_string()) }
    }

    /// Nothing is wrong with what was sent, but it can't be had beside what is there.
    pub(super) fn beside_others(failure: Failure) -> Self {
        Self { status: StatusCode::CONFLICT, ..Self::from(failure) }
    }
}

impl IntoResponse for Refused {
    fn into_response(self) -> Response {
        #[derive(Serialize)]
        struct Body {
            what: String,
            next: Option<String>,
        }
        (self.status, Json(Body { what: self.what, next: self.next })).into_response()
    }
}

impl From<Failure> for Refused {
    fn from(failure: Failure) -> Self {
        let next = failure.next_step().map(str::to_owned);
        Self { status: StatusCode::UNPROCESSABLE_ENTITY, what: failure.what().to_owned(), next }
    }
}

impl From<JsonRejection> for Refused {
    fn from(rejection: JsonRejection) -> Self {
        Self::new(rejection.status(), rejection.body_text(), "send JSON as the page does")
    }
}

impl From<PathRejection> for Refused {
    fn from(rejection: PathRejection) -> Self {
        Self::new(rejection.status(), rejection.body_text(), "ask for an address that the page uses")
    }
}

impl From<QueryRejection> for Refused {
    fn from(rejection: QueryRejection) -> Self {
        Self::new(rejection.status(), rejection.body_text(), "send a query as the page does")
    }
}

/// JSON whose faults are told as [`Refused`].
#[derive(FromRequest)]
#[from_request(via(Json), rejection(Refused))]
pub(super) struct Sent<T>(pub(super) T);

/// A query whose faults are told as [`Refused`].
#[derive(FromRequestParts)]
#[from_request(via(axum::extract::Query), rejection(Refused))]
pub(super) struct Query<T>(pub(super) T);

/// A part of the address, whose faults are told as [`Refused`].
#[derive(FromRequestParts)]
#[from_request(via(axum::extract::Path), rejection(Refused))]
pub(super) struct Path<T>(pub(super) T);

/// An answer as JSON, or why there is none.
pub(super) type Answered<T> = Result<Json<T>, Refused>;
/// Done, or why not.
pub(super) type Done = Result<StatusCode, Refused>;

/// Done.
pub(super) const DONE: Done = Ok(StatusCode::NO_CONTENT);

/// A body whose faults are told as [`Refused`].
pub(super) struct Body(pub(super) Bytes);

impl<S: Send + Sync> FromRequest<S> for Body {
    type Rejection = Refused;

    async fn from_request(request: axum::extract::Request, state: &S) -> Result<Self, Refused> {
        Bytes::from_request(request, state).await.map(Self).map_err(|rejection| {
            let next = format!("send no more than {} MB at once", MOST_BYTES >> 20);
            Refused::new(rejection.status(), rejection.body_text(), next)
        })
    }
}

/// A body that may be large: it goes to the disk as it comes.
pub(super) struct OnDisk(pub(super) NamedTempFile);

impl<S: Send + Sync> FromRequest<S> for OnDisk {
    type Rejection = Refused;

    async fn from_request(request: axum::extract::Request, _: &S) -> Result<Self, Refused> {
        let mut body = request.with_limited_body().into_body();
        let mut file = NamedTempFile::new().map_err(not_kept)?;
        while let Some(frame) = poll_fn(|context| Pin::new(&mut body).poll_frame(context)).await {
            let Ok(chunk) = frame.map_err(too_large)?.into_data() else { continue };
            file.write_all(&chunk).map_err(not_kept)?;
        }
        Ok(Self(file))
    }
}

fn not_kept(error: std::io::Error) -> Refused {
    let next = "make room on the disk, or start the program with TMPDIR on another one";
    Refused::new(StatusCode::INSUFFICIENT_STORAGE, format!("the file could not be kept: {error}"), next)
}

fn too_large(error: axum::Error) -> Refused {
    let next = format!("send no more than {} MB at once", MOST_BYTES >> 20);
    Refused::new(StatusCode::PAYLOAD_TOO_LARGE, error, next)
}

/// Work that would hold other requests up.
pub(super) async fn blocking<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, Failure> + Send + 'static,
) -> Answered<T> {
    let crashed = |_| {
        Failure::failed("the request ended unexpectedly").next("this is a mistake in the program: please report it")
    };
    Ok(Json(spawn_blocking(work).await.map_err(crashed)??))
}
