//! The state as the page sees it: small, and the same for every tab. Curves are asked for apart.

use super::app::App;
use super::evidence::Evidence;
use super::geometry::Geometry;
use super::live::ports;
use super::rig::RigView;
use super::simulate::{Slider, sliders, sliders_of};
use super::state::{Named, State};
use crate::compare::verdict::{Answer, Totals};
use crate::diagnose::Diagnosis;
use crate::error::Failure;
use crate::fit::identify::Identified;
use crate::formula::effect_of;
use crate::improve::Step;
use crate::recording::Measured;
use crate::rigfile::{Quantity, RigFile};
use serde::Serialize;
use shared::effect::{CURVE_NAME, CUSTOM_FORMULA_ID, Effect};
use shared::parameters::Parameters;
use std::sync::Arc;

/// Everything but curves.
#[derive(Serialize)]
pub(super) struct View {
    #[serde(rename = "type")]
    kind: &'static str,
    model: Option<ModelView>,
    recordings: Vec<RecordingView>,
    comparison: Option<ComparisonView>,
    staircase: Vec<Step>,
    undos: usize,
    diagnosis: Option<Diagnosis>,
    /// Has the model other effects now than when that was made?
    diagnosis_is_old: bool,
    /// What the diagnosis says of a friction curve, if it offers one.
    curve_words: Option<String>,
    /// On which parts of the swings each claim of the diagnosis is seen, and why not on the others.
    seen_words: Vec<String>,
    /// What the diagnosis says of the sensor's zero, where it is off.
    zero_words: Option<String>,
    /// What speaks against recordings, as the command line says it.
    doubts: Vec<String>,
    fit: Option<FitView>,
    failure: Option<FailureView>,
    /// Why there is no comparison, if one was tried in vain.
    not_compared: Option<FailureView>,
    rig: RigView,
    evidence: Evidence,
    ports: Vec<String>,
    /// Is a rig what the page is opened for?
    begins_live: bool,
    drawing: u64,
}

#[derive(Serialize)]
struct ModelView {
    origin: String,
    fresh: bool,
    normalised: bool,
    /// None where it is unknown.
    geometry: Option<Geometry>,
    effects: Vec<&'static str>,
    /// The law that somebody typed, if it has one.
    typed: Option<&'static str>,
    sliders: Vec<Slider>,
}

#[derive(Serialize)]
struct RecordingView {
    id: u32,
    measured: Measured,
    name: String,
    held_out: bool,
    duration_s: f64,
    samples: usize,
    noise_rad: f64,
    rmse_rad: Option<f64>,
    notes: Vec<String>,
}

#[derive(Serialize)]
struct ComparisonView {
    answer: Answer,
    verdict: Vec<String>,
    totals: Totals,
    held_out: Option<Totals>,
    limits: Vec<String>,
}

#[derive(Serialize)]
struct FitView {
    parameters: Vec<Identified>,
    warnings: Vec<String>,
    n_stages: usize,
    simulations: usize,
    seconds: f64,
}

/// A failure in two parts.
#[derive(Serialize)]
pub(super) struct FailureView {
    what: String,
    next: Option<String>,
}

impl From<&Failure> for FailureView {
    fn from(failure: &Failure) -> Self {
        Self { what: failure.what().to_owned(), next: failure.next_step().map(str::to_owned) }
    }
}

/// The state of this moment.
pub(super) fn view(app: &App) -> View {
    app.read(|state| View {
        kind: "state",
        model: state.model.as_ref().map(|model| model_view(&model.file, &model.origin)),
        recordings: recordings(state),
        comparison: comparison(state),
        staircase: state.staircase.clone(),
        undos: state.history.len(),
        diagnosis: state.diagnosis.as_deref().cloned(),
        diagnosis_is_old: is_diagnosis_old(state),
        curve_words: state.diagnosis.as_deref().and_then(curve_words),
        seen_words: state.diagnosis.as_deref().map_or(Vec::new(), seen_words),
        zero_words: state.diagnosis.as_deref().and_then(Diagnosis::zero_in_words),
        doubts: doubts(state),
        fit: fit(state),
        failure: state.failure.as_ref().map(FailureView::from),
        not_compared: state.not_compared.as_ref().map(FailureView::from),
        rig: state.rig.clone(),
        evidence: state.evidence.clone(),
        ports: ports(app.settings.port.as_deref()),
        begins_live: app.settings.port.is_some() && app.settings.recordings.is_empty(),
        drawing: state.drawing,
    })
}

fn is_diagnosis_old(state: &State) -> bool {
    let is_same = |named: &Named| names_of_effects(named.file.parameters()) == state.diagnosed;
    state.diagnosis.is_some() && !state.model.as_ref().is_some_and(is_same)
}

fn curve_words(diagnosis: &Diagnosis) -> Option<String> {
    diagnosis.curve.as_ref().map(|curve| curve.in_words(diagnosis))
}

fn seen_words(diagnosis: &Diagnosis) -> Vec<String> {
    diagnosis.holds_on.iter().map(|claim| format!("{}: {}", claim.effect, claim.seen_on())).collect()
}

/// Of single recordings first, then of one among the others.
fn doubts(state: &State) -> Vec<String> {
    let of = |recording: &Arc<super::recordings::Loaded>| -> Vec<String> {
        let notes = recording.measurement.notes.iter();
        let doubts = notes.filter_map(|note| note.strip_prefix("doubtful: "));
        doubts.map(|words| format!("doubtful: {}: {words}", recording.name)).collect()
    };
    state.recordings.iter().flat_map(of).chain(state.doubts.iter().cloned()).collect()
}

fn model_view(file: &RigFile, origin: &str) -> ModelView {
    let parameters = file.parameters();
    ModelView {
        origin: origin.to_owned(),
        fresh: file.is_fresh(),
        normalised: file.is_normalised(),
        geometry: (!file.is_normalised()).then(|| Geometry::of(&parameters.pendulum)),
        effects: names_of_effects(parameters),
        typed: effect_of(parameters, CUSTOM_FORMULA_ID).map(|effect| effect.formula),
        sliders: sliders(parameters, |quantity| file.knowledge(quantity).and_then(|knowledge| knowledge.std)),
    }
}

/// What is in a model, its friction curve included.
pub(super) fn names_of_effects(parameters: &Parameters<f64>) -> Vec<&'static str> {
    let effects = parameters.effects.iter().filter_map(|effect| effect_of(parameters, effect.id));
    let curve = parameters.curve.as_ref().map(|_| CURVE_NAME);
    effects.map(|effect| effect.name).chain(curve).collect()
}

fn recordings(state: &State) -> Vec<RecordingView> {
    let of = |recording: &Arc<super::recordings::Loaded>| {
        let measurement = &recording.measurement;
        RecordingView {
            id: recording.id,
            measured: measurement.swing.measured,
            name: recording.name.clone(),
            held_out: recording.held_out,
            duration_s: measurement.swing.duration_s(),
            samples: measurement.swing.len(),
            noise_rad: measurement.noise.level_rad(),
            rmse_rad: state.runs.get(&recording.id).map(|run| crate::compare::rms(&run.residuals_rad)),
            notes: measurement.notes.clone(),
        }
    };
    state.recordings.iter().map(of).collect()
}

fn comparison(state: &State) -> Option<ComparisonView> {
    let comparison = state.comparison.as_ref()?;
    Some(ComparisonView {
        answer: comparison.answer,
        verdict: comparison.verdict.clone(),
        totals: comparison.totals,
        held_out: comparison.held_out_totals,
        limits: comparison.limits.clone(),
    })
}

fn fit(state: &State) -> Option<FitView> {
    let fit = state.fit.as_ref()?;
    Some(FitView {
        parameters: fit.identified.clone(),
        warnings: state.doubts.iter().chain(&fit.warnings).cloned().collect(),
        n_stages: fit.stages.len(),
        simulations: fit.n_simulations,
        seconds: fit.seconds,
    })
}

/// An effect with its explanation, and sliders to try it.
#[derive(Serialize)]
pub(super) struct EffectView {
    name: &'static str,
    summary: &'static str,
    formula: &'static str,
    source: &'static str,
    experiment: &'static str,
    base: bool,
    sliders: Vec<Slider>,
}

/// Every effect of the list.
pub(super) fn effects() -> Vec<EffectView> {
    let view = |effect: &'static Effect<f64>| EffectView {
        name: effect.name,
        summary: effect.summary,
        formula: effect.formula,
        source: effect.source,
        experiment: effect.experiment,
        base: effect.is_base(),
        sliders: sliders_of(effect),
    };
    Effect::<f64>::ALL.iter().map(view).collect()
}

/// A value on the rig and the one that would take its place.
#[derive(Serialize)]
pub(super) struct Replaced {
    name: &'static str,
    symbol: &'static str,
    unit: &'static str,
    old: Option<f64>,
    new: Option<f64>,
}

/// All values of both models, the old one's first.
pub(super) fn replaced(old: &Parameters<f64>, new: &Parameters<f64>) -> Vec<Replaced> {
    let mut all = Quantity::all(old);
    all.extend(Quantity::all(new).into_iter().filter(|quantity| quantity.get(old).is_none()));
    let replaced = |quantity: Quantity| Replaced {
        name: quantity.owner(),
        symbol: quantity.symbol(),
        unit: quantity.unit(),
        old: quantity.get(old),
        new: quantity.get(new),
    };
    all.into_iter().map(replaced).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_rig_has_is_old_and_what_comes_is_new() {
        let (mut old, mut new) = (Parameters::paper(), Parameters::paper());
        old.set_friction(1e-4, 2e-3, 0.0, 0.0);
        new.set_friction(3e-4, 2e-3, 0.0, 0.0);
        let all = replaced(&old, &new);
        let viscous = all.iter().find(|one| one.symbol == "Mw").unwrap();
        assert_eq!((viscous.old, viscous.new, viscous.unit), (Some(1e-4), Some(3e-4), "N·m·s/rad"));
    }
}
