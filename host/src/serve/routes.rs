//! What can be asked of the server, one line each.

use super::guard::{self, Access};
use super::live::{Wish, ports};
use super::recordings::{MOST_BYTES, of_bytes, take_in};
use super::request::{Answered, Body, DONE, Done, Path, Query, Refused, Sent, blocking};
use super::simulate::{Question, Slider, Values, answer, named, sliders_of, unknown_recording, with};
use super::state::{App, Named, State as Page};
use super::{downloads, draw, files, socket, surfaces, work};
use crate::error::Failure;
use crate::formula::{self, effect_of};
use crate::improve::Change;
use crate::rigfile::{Knowledge, Quantity, RigFile, Source};
use axum::extract::{DefaultBodyLimit, State, WebSocketUpgrade};
use axum::http::header::CONTENT_TYPE;
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

/// Requests other than uploads are small.
const MOST_JSON_BYTES: usize = 64 << 10;

/// A model file is small too.
const MOST_MODEL_BYTES: usize = 1 << 20;

/// What every request sees.
pub(super) type Shared = State<Arc<App>>;

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

/// What a file is called by the person who sends it.
#[derive(Deserialize)]
struct Name {
    name: String,
}

async fn upload(State(app): Shared, Query(Name { name }): Query<Name>, body: Body) -> Answered<u32> {
    blocking(move || take_in(&app, of_bytes(&name, &body.0, &app.settings)?)).await
}

async fn upload_model(State(app): Shared, Query(Name { name }): Query<Name>, body: Body) -> Done {
    let text = String::from_utf8(body.0.to_vec())
        .map_err(|_| Failure::wrong_use(format!("{name} is no text")).next("choose a rig.toml"))?;
    let model = RigFile::parse(&name, &text).map_err(Failure::from)?;
    work::set_model(&app, model, &name);
    DONE
}

async fn remove(State(app): Shared, Path(id): Path<u32>) -> Done {
    change_recording(&app, id, |state, place| {
        state.recordings.remove(place);
        state.runs.remove(&id);
    })
}

/// Changes one recording; what was compared no longer holds.
fn change_recording(app: &App, id: u32, change: impl FnOnce(&mut Page, usize)) -> Done {
    app.change(|state| {
        let place = state.recordings.iter().position(|recording| recording.id == id);
        change(state, place.ok_or_else(|| unknown_recording(id))?);
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
    change_recording(&app, id, |state, place| {
        state.recordings[place] = Arc::new(state.recordings[place].with_held_out(held_out));
    })
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
            RigFile::new(pendulum).map_err(refused)?
        }
        (None, None, None) => RigFile::normalised(GRAVITY_M_S2).map_err(Failure::from)?,
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
    let mut model = model_of(&app)?.file;
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

pub(super) fn model_of(app: &App) -> Result<Named, Failure> {
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
    let custom = model_of(&app).ok().and_then(|named| effect_of(named.file.parameters(), CUSTOM_FORMULA_ID));
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
    let new = model_of(&app)?.file.parameters().clone();
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
    let model = model_of(&app)?.file;
    if model.is_normalised() {
        let what = "the model's geometry is unknown, so the rig cannot use it";
        return Err(Failure::wrong_use(what).next("give mass, length and inertia").into());
    }
    let (sender, receiver) = oneshot::channel();
    app.rig.wish(Wish::Push(Box::new(model), sender));
    receiver.await.map_err(|_| rig_is_gone())??;
    DONE
}
