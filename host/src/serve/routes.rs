//! What can be asked of the server, one line each, and how requests and answers are wrapped.

use super::guard::{self, Access};
use super::live::{Wish, ports};
use super::recordings::{MOST_BYTES, of_bytes, take_in};
use super::simulate::{Question, Slider, Values, answer, named, sliders_of, unknown_recording, with};
use super::state::{App, Named};
use super::{draw, files, socket, surfaces, work};
use crate::error::Failure;
use crate::formula::{self, effect_of};
use crate::improve::Change;
use crate::report::report;
use crate::rigfile::{Knowledge, Quantity, RigFile, Source};
use axum::body::Bytes;
use axum::extract::rejection::{JsonRejection, QueryRejection};
use axum::extract::{DefaultBodyLimit, FromRequest, FromRequestParts, Path, State, WebSocketUpgrade};
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::http::{StatusCode, Uri};
use axum::middleware::from_fn_with_state;
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Json, Router};
use serde::{Deserialize, Serialize};
use shared::effect::{CUSTOM_FORMULA_ID, Effect};
use shared::motion::Pendulum;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use tokio::sync::oneshot;
use tokio::task::spawn_blocking;

/// Requests other than uploads are small.
const MOST_JSON_BYTES: usize = 64 << 10;

/// A model file is small too.
const MOST_MODEL_BYTES: usize = 1 << 20;

type Shared = State<Arc<App>>;

/// Everything there is.
pub(super) fn router(app: &Arc<App>, access: Access) -> Router {
    let uploads = Router::new()
        .route("/api/recordings", post(upload))
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
        .route("/api/rig/values", get(rig_values))
        .route("/api/rig/push", post(push))
        .route("/download/rig.toml", get(download_model))
        .route("/download/comparison.json", get(download_comparison))
        .route("/download/report.html", get(download_report))
        .route("/download/recording/{id}", get(download_recording))
        .route("/download/modelled/{id}", get(download_modelled))
        .layer(DefaultBodyLimit::max(MOST_JSON_BYTES));
    let all = uploads.merge(small).fallback(page_file).method_not_allowed_fallback(wrong_method);
    all.layer(from_fn_with_state(access, guard::check)).with_state(app.clone())
}

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

impl From<QueryRejection> for Refused {
    fn from(rejection: QueryRejection) -> Self {
        Self::new(rejection.status(), rejection.body_text(), "send a query as the page does")
    }
}

/// JSON whose faults are told as [`Refused`].
#[derive(FromRequest)]
#[from_request(via(Json), rejection(Refused))]
struct Sent<T>(T);

/// A query whose faults are told as [`Refused`].
#[derive(FromRequestParts)]
#[from_request(via(axum::extract::Query), rejection(Refused))]
struct Query<T>(T);

type Answered<T> = Result<Json<T>, Refused>;
type Done = Result<StatusCode, Refused>;

const DONE: Done = Ok(StatusCode::NO_CONTENT);

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

/// An effect with its explanation, and sliders to try it.
#[derive(Serialize)]
struct EffectView {
    name: &'static str,
    summary: &'static str,
    formula: &'static str,
    source: &'static str,
    experiment: &'static str,
    base: bool,
    sliders: Vec<Slider>,
}

async fn effects() -> Json<Vec<EffectView>> {
    let view = |effect: &'static Effect<f64>| EffectView {
        name: effect.name,
        summary: effect.summary,
        formula: effect.formula,
        source: effect.source,
        experiment: effect.experiment,
        base: effect.is_base(),
        sliders: sliders_of(effect),
    };
    Json(Effect::<f64>::ALL.iter().map(view).collect())
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

/// Work that would hold other requests up.
async fn blocking<T: Send + 'static>(work: impl FnOnce() -> Result<T, Failure> + Send + 'static) -> Answered<T> {
    let crashed = |_| {
        Failure::failed("the request ended unexpectedly").next("this is a mistake in the program: please report it")
    };
    Ok(Json(spawn_blocking(work).await.map_err(crashed)??))
}

/// What a file is called by the person who sends it.
#[derive(Deserialize)]
struct Name {
    name: String,
}

async fn upload(State(app): Shared, Query(Name { name }): Query<Name>, body: Body) -> Answered<u32> {
    blocking(move || take_in(&app, of_bytes(&name, &body.0, &app.settings)?)).await
}

/// A body whose faults are told as [`Refused`].
struct Body(Bytes);

impl<S: Send + Sync> FromRequest<S> for Body {
    type Rejection = Refused;

    async fn from_request(request: axum::extract::Request, state: &S) -> Result<Self, Refused> {
        Bytes::from_request(request, state).await.map(Self).map_err(|rejection| {
            let next = format!("send no more than {} MB at once", MOST_BYTES >> 20);
            Refused::new(rejection.status(), rejection.body_text(), next)
        })
    }
}

async fn upload_model(State(app): Shared, Query(Name { name }): Query<Name>, body: Body) -> Done {
    let text = String::from_utf8(body.0.to_vec())
        .map_err(|_| Failure::wrong_use(format!("{name} is no text")).next("choose a rig.toml"))?;
    let model = RigFile::parse(&name, &text).map_err(Failure::from)?;
    work::set_model(&app, model, &name);
    DONE
}

async fn remove(State(app): Shared, Path(id): Path<u32>) -> Done {
    app.change(|state| {
        let place = state.recordings.iter().position(|recording| recording.id == id);
        state.recordings.remove(place.ok_or_else(|| unknown_recording(id))?);
        state.runs.remove(&id);
        state.comparison = None;
        state.data_changed();
        Ok::<(), Failure>(())
    })?;
    app.jobs.ask_for_a_look();
    DONE
}

#[derive(Deserialize)]
struct HeldOut {
    held_out: bool,
}

async fn hold_out(State(app): Shared, Path(id): Path<u32>, Sent(HeldOut { held_out }): Sent<HeldOut>) -> Done {
    app.change(|state| {
        let recording = state.recordings.iter_mut().find(|recording| recording.id == id);
        let recording = recording.ok_or_else(|| unknown_recording(id))?;
        *recording = Arc::new(recording.with_held_out(held_out));
        state.comparison = None;
        state.data_changed();
        Ok::<(), Failure>(())
    })?;
    app.jobs.ask_for_a_look();
    DONE
}

/// Geometry, or none.
#[derive(Deserialize)]
struct Geometry {
    mass_kg: Option<f64>,
    length_m: Option<f64>,
    inertia_kg_m2: Option<f64>,
}

async fn pendulum(State(app): Shared, Sent(geometry): Sent<Geometry>) -> Done {
    const GRAVITY_M_S2: f64 = 9.81;
    let model = match (geometry.mass_kg, geometry.length_m, geometry.inertia_kg_m2) {
        (Some(mass_kg), Some(length_m), Some(inertia_kg_m2)) => {
            let pendulum = Pendulum { mass_kg, length_m, inertia_kg_m2, gravity_m_s2: GRAVITY_M_S2 };
            let refused =
                |error| Failure::wrong_use(error).next("give kg, m and kg·m², such as 0.147, 0.156 and 0.0028");
            shared::parameters::Parameters::frictionless(pendulum).check().map_err(refused)?;
            RigFile::new(pendulum)
        }
        (None, None, None) => RigFile::normalised(GRAVITY_M_S2),
        _ => {
            return Err(Failure::wrong_use("mass, length and inertia belong together")
                .next("give all three, or none")
                .into());
        }
    };
    work::set_model(&app, model, "typed on this page");
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
    let mut model = model(&app)?.file;
    with(model.parameters(), &values)?;
    let source = Source { method: "set by hand".to_owned(), recordings: Vec::new() };
    for (name, value) in &values {
        let quantity = named(model.parameters(), name)?;
        let knowledge = Knowledge { std: None, source: Some(source.clone()) };
        model.set(quantity, *value, knowledge).map_err(Failure::from)?;
    }
    work::set_model(&app, model, "set by hand");
    DONE
}

fn model(app: &App) -> Result<Named, Failure> {
    let missing = || Failure::wrong_use("there is no model yet").next("give mass, length and inertia, or a rig.toml");
    app.read(|state| state.model.clone()).ok_or_else(missing)
}

/// Effects by name.
#[derive(Deserialize)]
struct Changes {
    #[serde(default)]
    add: Vec<String>,
    #[serde(default)]
    remove: Vec<String>,
}

async fn change(State(app): Shared, Sent(changes): Sent<Changes>) -> Done {
    let custom = model(&app).ok().and_then(|named| effect_of(named.file.parameters(), CUSTOM_FORMULA_ID));
    let effect = |name: &String| {
        let missing = || Failure::wrong_use(format!("there is no effect called {name}")).next("choose one of the list");
        Effect::<f64>::by_name(name).or(custom.filter(|custom| custom.name == name)).ok_or_else(missing)
    };
    let added = changes.add.iter().map(|name| effect(name).map(Change::Add));
    let removed = changes.remove.iter().map(|name| effect(name).map(Change::Remove));
    let all: Vec<Change> = added.chain(removed).collect::<Result<_, Failure>>()?;
    if all.is_empty() {
        return Err(Failure::wrong_use("no effect was named").next("name one to add or to remove").into());
    }
    let names = [changes.add.join(" and "), changes.remove.join(" and ")].concat();
    let name = if changes.remove.is_empty() { format!("adding {names}") } else { format!("removing {names}") };
    app.jobs.ask(&name, work::change_model(all))?;
    DONE
}

/// A law that somebody typed.
#[derive(Deserialize)]
struct Typed {
    formula: String,
}

/// Longer ones nobody reads.
const LONGEST_FORMULA: usize = 400;

async fn add_formula(State(app): Shared, Sent(Typed { formula }): Sent<Typed>) -> Done {
    if formula.len() > LONGEST_FORMULA {
        let what = format!("the formula has {} bytes, {LONGEST_FORMULA} are allowed", formula.len());
        return Err(Failure::wrong_use(what).next("write it shorter").into());
    }
    let hint = "write it like torque = -k*omega*abs(omega)^p; k in 0..1e-3 N·m; p in 0..3";
    let effect = formula::read(&formula).map_err(|error| Failure::wrong_use(error).next(hint))?;
    app.jobs.ask("adding a formula", work::change_model(vec![Change::Add(effect)]))?;
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

/// A port of the list that the page was given; any other device is not the page's business.
async fn connect(State(app): Shared, Sent(Port { port }): Sent<Port>) -> Done {
    let known = ports(app.settings.port.as_deref());
    if !known.contains(&port) {
        return Err(Failure::wrong_use(format!("{port:?} is not in the list of ports"))
            .next("start the program with --port")
            .into());
    }
    app.rig.wish(Wish::Connect(port));
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

/// A value on the rig and the one that would take its place.
#[derive(Serialize)]
struct Replaced {
    name: &'static str,
    symbol: &'static str,
    unit: &'static str,
    old: Option<f64>,
    new: Option<f64>,
}

async fn rig_values(State(app): Shared) -> Answered<Vec<Replaced>> {
    let new = model(&app)?.file.parameters().clone();
    let (sender, receiver) = oneshot::channel();
    app.rig.wish(Wish::Read(sender));
    let old = receiver.await.map_err(|_| rig_is_gone())??.map(f64::from);
    let mut all = Quantity::all(&old);
    all.extend(Quantity::all(&new).into_iter().filter(|quantity| quantity.get(&old).is_none()));
    let replaced = |quantity: Quantity| Replaced {
        name: quantity.owner(),
        symbol: quantity.symbol(),
        unit: quantity.unit(),
        old: quantity.get(&old),
        new: quantity.get(&new),
    };
    Ok(Json(all.into_iter().map(replaced).collect()))
}

fn rig_is_gone() -> Failure {
    Failure::failed("the rig is gone").next("connect it again")
}

async fn push(State(app): Shared) -> Done {
    let model = model(&app)?.file;
    if model.is_normalised() {
        let what = "the model's geometry is unknown, so the rig cannot use it";
        return Err(Failure::wrong_use(what).next("give mass, length and inertia").into());
    }
    let (sender, receiver) = oneshot::channel();
    app.rig.wish(Wish::Push(Box::new(model), sender));
    receiver.await.map_err(|_| rig_is_gone())??;
    DONE
}

/// A file to keep.
fn download(name: &str, kind: &'static str, content: impl Into<axum::body::Body>) -> Response {
    let plain: String =
        name.chars().map(|c| if c.is_ascii_alphanumeric() || ".-_ ".contains(c) { c } else { '_' }).collect();
    let disposition = format!("attachment; filename=\"{plain}\"");
    ([(CONTENT_TYPE, kind.to_owned()), (CONTENT_DISPOSITION, disposition)], content.into()).into_response()
}

async fn download_model(State(app): Shared) -> Result<Response, Refused> {
    Ok(download("rig.toml", "application/toml", model(&app)?.file.to_string()))
}

fn comparison(app: &App) -> Result<Arc<crate::compare::Comparison>, Failure> {
    let missing =
        || Failure::wrong_use("nothing has been compared yet").next("load a recording and wait for the verdict");
    app.read(|state| state.comparison.clone()).ok_or_else(missing)
}

async fn download_comparison(State(app): Shared) -> Result<Response, Refused> {
    let comparison = comparison(&app)?;
    let text = serde_json::to_string_pretty(&*comparison).map_err(Failure::failed)?;
    Ok(download("comparison.json", "application/json", text))
}

async fn download_report(State(app): Shared) -> Result<Response, Refused> {
    let comparison = comparison(&app)?;
    let Json(text) = blocking(move || Ok(report(&comparison))).await?;
    Ok(download("report.html", "text/html; charset=utf-8", text))
}

async fn download_recording(State(app): Shared, Path(id): Path<u32>) -> Result<Response, Refused> {
    let found = app.read(|state| state.recordings.iter().find(|recording| recording.id == id).cloned());
    let recording = found.ok_or_else(|| unknown_recording(id))?;
    Ok(download(&recording.name, "text/csv", recording.bytes.to_vec()))
}

async fn download_modelled(State(app): Shared, Path(id): Path<u32>) -> Result<Response, Refused> {
    let Json((name, text)) = blocking(move || draw::table(&app, id)).await?;
    Ok(download(&format!("modelled-{name}"), "text/csv", text))
}
