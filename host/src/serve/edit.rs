//! Changes of the model that somebody asks for on the page: geometry, values, effects, a formula.

use super::app::App;
use super::geometry::Geometry;
use super::simulate::{Values, named, with};
use super::state::{Numbers, State};
use super::work;
use crate::error::Failure;
use crate::formula::{self, FRICTION_CURVE, FormulaError, effect_of};
use crate::improve::Change;
use crate::rigfile::{Knowledge, Quantity, RigFile, RigFileError, Source};
use serde::Deserialize;
use shared::effect::{CUSTOM_FORMULA_ID, Effect};
use shared::motion::{GRAVITY_M_S2, Pendulum};
use std::sync::Arc;
use tokio::sync::oneshot;

/// Longer formulas nobody reads.
const LONGEST_FORMULA: usize = 400;

/// Takes a model file over; `name` is what messages call it.
pub(super) fn model_file(app: &App, name: &str, bytes: &[u8]) -> Result<(), Failure> {
    let text = String::from_utf8(bytes.to_vec())
        .map_err(|_| Failure::wrong_use(format!("{name} is no text")).next("choose a rig.toml"))?;
    work::set_model(app, RigFile::parse(name, &text)?, name, Numbers::Foreign);
    Ok(())
}

/// A model of a pendulum with this geometry.
pub(super) fn geometry(app: &App, geometry: &Geometry) -> Result<(), Failure> {
    let model = match (geometry.mass_kg, geometry.length_m, geometry.inertia_kg_m2) {
        (Some(mass_kg), Some(length_m), Some(inertia_kg_m2)) => {
            let next = "give kg, m and kg·m², such as 0.147, 0.156 and 0.0028";
            let pendulum = Pendulum { mass_kg, length_m, inertia_kg_m2, gravity_m_s2: GRAVITY_M_S2 };
            with_geometry(app, pendulum).map_err(|error| Failure::wrong_use(error).next(next))?
        }
        (None, None, None) => RigFile::normalised(GRAVITY_M_S2)?,
        _ => {
            let what = "mass, length and inertia belong together";
            return Err(Failure::wrong_use(what).next("give all three, or none"));
        }
    };
    work::set_model(app, model, "typed on this page", Numbers::Foreign);
    Ok(())
}

/// The model with another geometry: its effects and its sensor stay. Friction is a guess again, as what was fitted
/// beside a wrong mass may be far off.
fn with_geometry(app: &App, pendulum: Pendulum<f64>) -> Result<RigFile, RigFileError> {
    let guess = RigFile::new(pendulum)?;
    let named = app.read(|state| state.model.clone());
    let Some(mut model) = named.map(|named| named.file).filter(|model| !model.is_normalised()) else {
        return Ok(guess);
    };
    // Beside a curve no friction law of the base model may act.
    let has_curve = model.parameters().curve.is_some();
    let is_typed = |quantity: &Quantity| matches!(quantity, Quantity::Mass | Quantity::Length | Quantity::Inertia);
    let is_guessed = |quantity: &Quantity| quantity.owner() != "pendulum" && !has_curve;
    for quantity in Quantity::all(guess.parameters()) {
        let is_here = quantity.get(model.parameters()).is_some();
        let value = quantity.get(guess.parameters()).filter(|_| is_here);
        if let Some(value) = value.filter(|_| is_typed(&quantity) || is_guessed(&quantity)) {
            model.set(quantity, value, Knowledge { std: None, source: None })?;
        }
    }
    Ok(model)
}

/// Sets values by name.
pub(super) fn values(app: &App, values: &Values) -> Result<(), Failure> {
    let mut model = app.model()?.file;
    with(model.parameters(), values)?;
    let source = Source::new("set by hand", &[]);
    for (name, value) in values {
        let quantity = named(model.parameters(), name)?;
        // A measured mass or length that is typed anew is another measurement.
        let source = (!model.has_tolerance(quantity)).then(|| source.clone());
        let knowledge = Knowledge { std: None, source };
        model.set(quantity, *value, knowledge)?;
    }
    work::set_model(app, model, "set by hand", Numbers::Typed);
    Ok(())
}

/// Effects by name.
#[derive(Deserialize)]
pub(super) struct Changes {
    #[serde(default)]
    add: Vec<String>,
    #[serde(default)]
    remove: Vec<String>,
}

/// Adds and removes effects.
pub(super) fn effects(app: &App, changes: &Changes) -> Result<(), Failure> {
    let custom = app.model().ok().and_then(|named| effect_of(named.file.parameters(), CUSTOM_FORMULA_ID));
    let effect = |name: &String| {
        let missing = || Failure::wrong_use(format!("there is no effect called {name}")).next("choose one of the list");
        let own = [custom, Some(&FRICTION_CURVE)].into_iter().flatten().find(|own| own.name == name);
        Effect::<f64>::by_name(name).or(own).ok_or_else(missing)
    };
    let added = changes.add.iter().map(|name| effect(name).map(Change::Add));
    let removed = changes.remove.iter().map(|name| effect(name).map(Change::Remove));
    let all: Vec<Change> = added.chain(removed).collect::<Result<_, Failure>>()?;
    if all.is_empty() {
        return Err(Failure::wrong_use("no effect was named").next("name one to add or to remove"));
    }
    let names = [changes.add.join(" and "), changes.remove.join(" and ")].concat();
    let name = if changes.remove.is_empty() { format!("adding {names}") } else { format!("removing {names}") };
    app.jobs.ask(&name, work::change_model(all))
}

/// What is to be changed by what the live view has listened to.
#[derive(Deserialize)]
pub(super) struct Suspect {
    /// An effect to add; none to fit the numbers of the model that is there.
    effect: Option<String>,
}

/// Fits the model, with a suspect in it, to the recordings and to what the live view has listened to; answers when that
/// is done.
pub(super) async fn suspect(app: &App, suspect: &Suspect) -> Result<(), Failure> {
    let missing = |name: &str| Failure::wrong_use(format!("there is no effect called {name}")).next("reload the page");
    let effect = suspect.effect.as_deref().map(|name| Effect::<f64>::by_name(name).ok_or_else(|| missing(name)));
    let change = effect.transpose()?.map(Change::Add);
    let (sender, receiver) = oneshot::channel();
    let name = suspect.effect.as_ref().map_or("fitting".to_owned(), |name| format!("adding {name}"));
    app.jobs.ask(&name, move |app, progress| {
        let _ = sender.send(work::take_over(app, change, progress));
        Ok(())
    })?;
    let ended = |_| Failure::failed("the fit ended unexpectedly").next("try it again");
    receiver.await.map_err(ended)?
}

/// Adds a law that somebody typed; it takes the place of the one that was typed before.
pub(super) fn formula(app: &App, text: &str) -> Result<(), Failure> {
    if text.len() > LONGEST_FORMULA {
        let what = format!("the formula has {} bytes, {LONGEST_FORMULA} are allowed", text.len());
        return Err(Failure::wrong_use(what).next("write it shorter"));
    }
    let hint = "write it like torque = -k*omega*abs(omega)^p; k in 0..1e-3 N·m; p in 0..3";
    let refused = |error: FormulaError| {
        let next = if error.place.is_some() { hint } else { "correct it and add it again" };
        Failure::wrong_use(error).next(next)
    };
    let effect = formula::read(text).map_err(refused)?;
    let before = app.model().ok().and_then(|named| effect_of(named.file.parameters(), CUSTOM_FORMULA_ID));
    let changes = before.map(Change::Remove).into_iter().chain([Change::Add(effect)]).collect();
    app.jobs.ask("adding a formula", work::change_model(changes))
}

/// Takes a recording out of the list.
pub(super) fn remove_recording(app: &App, id: u32) -> Result<(), Failure> {
    change_recording(app, id, |state, place| {
        state.recordings.remove(place);
        state.runs.remove(&id);
    })
}

/// Lets a recording take part or not.
pub(super) fn hold_out(app: &App, id: u32, held_out: bool) -> Result<(), Failure> {
    change_recording(app, id, |state, place| {
        state.recordings[place] = Arc::new(state.recordings[place].with_held_out(held_out));
    })
}

/// Changes one recording; what was compared no longer holds.
fn change_recording(app: &App, id: u32, change: impl FnOnce(&mut State, usize)) -> Result<(), Failure> {
    app.change(|state| {
        let place = state.place_of(id)?;
        change(state, place);
        state.comparison = None;
        state.data_changed();
        Ok::<(), Failure>(())
    })?;
    app.jobs.ask_for_a_look();
    Ok(())
}
