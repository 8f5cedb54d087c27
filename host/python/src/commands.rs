//! The commands: each gives the text of its `--json`, and beside it what a text can't hold.

use crate::errors::raised;
use crate::recording::{Given, Options, PyRecording, measurements, swings};
use crate::rig::{PyRig, effect_of, source};
use crate::wait::compute;
use host::compare::{Options as CompareOptions, compare as compare_with};
use host::diagnose::{Wishes, diagnose_with};
use host::error::Failure;
use host::fit::identify::Method;
use host::fit::problem::Start;
use host::improve::Change;
use host::operations::diagnose::Fields;
use host::operations::effects::{Shown, chosen};
use host::operations::fit::{self as fitting, Request, modelled};
use host::operations::given::{doubts, doubts_of_held_out, refuse_doubles};
use host::operations::improve::{METHOD, effect_named, improve as improve_with};
use host::operations::json;
use host::operations::plan::Planned;
use host::operations::reading::Reading;
use host::operations::simulate::{Simulation, check_size, check_start, runs_away, scenario as scenario_named};
use host::recording::Recording;
use host::rigfile::RigFile;
use host::swing::Swing;
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use serde::Serialize;
use shared::parameters::Parameters;
use shared::potentiometer::{FULL_SCALE_12_BIT, Potentiometer};

/// What every command that works on swings is given.
struct Asked {
    file: RigFile,
    names: Vec<String>,
    swings: Vec<Swing>,
    held_out: Vec<Swing>,
    notes: Vec<String>,
}

impl Asked {
    fn new(rig: RigFile, fitted: &[Given], held_out: &[Given], reading: &Reading) -> Result<Self, Failure> {
        let (mut swings, mut notes) = swings(fitted, reading)?;
        let (held_out, told) = self::swings(held_out, reading)?;
        notes.extend(told);
        refuse_doubles(&swings, &held_out)?;
        notes.extend(doubts(rig.parameters(), &mut swings)?);
        notes.extend(doubts_of_held_out(rig.parameters(), &swings, &held_out));
        Ok(Self { file: rig, names: json::all_named(&swings), swings, held_out, notes })
    }
}

fn text(command: &str, fields: &impl Serialize) -> Result<String, Failure> {
    json::text(command, fields).map_err(Failure::failed)
}

/// Measured and modelled swings, drawn only if somebody asks.
#[pyclass(frozen, module = "pendulum_rig._native")]
pub(crate) struct Curves {
    swings: Vec<Swing>,
    starts: Vec<Start>,
    parameters: Parameters<f64>,
}

#[pymethods]
impl Curves {
    fn __len__(&self) -> usize {
        self.swings.len()
    }

    /// Name, times (s), measured and modelled (rad, or rad/s) of one swing.
    #[expect(clippy::type_complexity, reason = "a name and three arrays")]
    fn of<'py>(
        &self,
        py: Python<'py>,
        index: usize,
    ) -> (String, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>) {
        let (swing, start) = (&self.swings[index], &self.starts[index]);
        let model = py.detach(|| modelled(swing, start, &self.parameters));
        let array = |values: Vec<f64>| values.into_pyarray(py);
        (swing.name.clone(), array(swing.times_s.to_vec()), array(swing.angles_rad.clone()), array(model))
    }
}

fn method_of(name: &str) -> Result<Method, Failure> {
    match name {
        "rsm" => Ok(Method::Rsm),
        "least-squares" => Ok(Method::LeastSquares),
        "both" => Ok(Method::Both),
        _ => Err(Failure::wrong_use(format!("there is no method called {name}"))
            .next("choose one of rsm, least-squares, both")),
    }
}

/// `fit --json`, the fitted model, the curves, and what was noticed.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the options of a command")]
pub(crate) fn fit(
    py: Python<'_>,
    recordings: Vec<Given>,
    hold_out: Vec<Given>,
    rig: &PyRig,
    reading: Options,
    method: &str,
    ranges: Vec<(String, f64, f64)>,
    effect: Option<&str>,
    discover: bool,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, PyRig, Curves, Vec<String>)> {
    let prepared = || {
        let request = Request { method: method_of(method)?, ranges, typed: effect_of(effect)?, discover };
        Ok((request, reading.reading(Some(&rig.file))?))
    };
    let (request, reading) = prepared().map_err(|failure: Failure| raised(&failure))?;
    let file = rig.file.clone();
    let (text, file, curves, notes) = compute(py, progress, move |tell| {
        let mut asked = Asked::new(file, &recordings, &hold_out, &reading)?;
        let told = |news: fitting::News| tell(news.to_string());
        let outcome = fitting::fit(&asked.swings, &asked.held_out, asked.file.known(), &request, &told)?;
        let text = text("fit", &outcome.fields(&asked.names, &asked.swings, request.method, None))?;
        asked.file.adopt_fit(&outcome.fit, &source(fitting::words(request.method), &asked.names, &asked.swings))?;
        let (starts, parameters) = (outcome.fit.starts, outcome.fit.parameters);
        Ok((text, asked.file, Curves { swings: asked.swings, starts, parameters }, asked.notes))
    })?;
    Ok((text, PyRig::of(file), curves, notes))
}

/// `compare --json`, and each recording's curves: name, times, measured, modelled.
#[pyfunction]
pub(crate) fn compare(
    py: Python<'_>,
    recordings: Vec<Given>,
    hold_out: Vec<Given>,
    rig: &PyRig,
    reading: Options,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, Curves, Vec<String>)> {
    let reading = reading.reading(Some(&rig.file)).map_err(|failure| raised(&failure))?;
    let file = rig.file.clone();
    compute(py, progress, move |_| {
        let measured = measurements(&recordings, &reading)?;
        let held_out = measurements(&hold_out, &reading)?;
        let mut swings: Vec<Swing> = measured.iter().map(|measurement| measurement.swing.clone()).collect();
        let notes = doubts(file.parameters(), &mut swings)?;
        let settings = CompareOptions { fit_first: file.is_fresh(), question_numbers: true };
        let comparison = compare_with(file.known(), &measured, &held_out, &settings).map_err(Failure::failed)?;
        let starts = comparison.recordings.iter().map(|judged| judged.start).collect();
        let curves = Curves { swings, starts, parameters: comparison.parameters.clone() };
        Ok((text("compare", &comparison)?, curves, notes))
    })
}

/// `diagnose --json`.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the options of a command")]
pub(crate) fn diagnose(
    py: Python<'_>,
    recordings: Vec<Given>,
    hold_out: Vec<Given>,
    rig: &PyRig,
    reading: Options,
    effect: Option<&str>,
    formulas: bool,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, Vec<String>)> {
    let prepared =
        || Ok((Wishes { typed: effect_of(effect)?, formulas, ..Wishes::default() }, reading.reading(Some(&rig.file))?));
    let (wishes, reading) = prepared().map_err(|failure: Failure| raised(&failure))?;
    let file = rig.file.clone();
    compute(py, progress, move |tell| {
        let asked = Asked::new(file, &recordings, &hold_out, &reading)?;
        tell("fitting the base model, then every effect …".to_owned());
        let diagnosis = diagnose_with(&asked.swings, &asked.held_out, asked.file.known(), wishes);
        let doubts = json::doubts(&asked.swings);
        let text = text("diagnose", &Fields { recordings: &asked.names, doubts, diagnosis: &diagnosis })?;
        Ok((text, asked.notes))
    })
}

/// `improve --json`, and the enlarged model.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the options of a command")]
pub(crate) fn improve(
    py: Python<'_>,
    recordings: Vec<Given>,
    hold_out: Vec<Given>,
    rig: &PyRig,
    reading: Options,
    effect: Option<&str>,
    add: Vec<String>,
    remove: Vec<String>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, PyRig, Vec<String>)> {
    let prepared = || {
        let typed = effect_of(effect)?;
        let named = |name: &String| effect_named(name, typed, rig.file.parameters());
        let added = add.iter().map(|name| Ok(Change::Add(named(name)?)));
        let removed = remove.iter().map(|name| Ok(Change::Remove(named(name)?)));
        let changes = added.chain(removed).collect::<Result<Vec<_>, Failure>>()?;
        Ok((typed, changes, reading.reading(Some(&rig.file))?))
    };
    let (typed, changes, reading) = prepared().map_err(|failure: Failure| raised(&failure))?;
    let file = rig.file.clone();
    let (text, file, notes) = compute(py, progress, move |tell| {
        let mut asked = Asked::new(file, &recordings, &hold_out, &reading)?;
        tell("refitting with other effects …".to_owned());
        let improved = improve_with(&asked.swings, &asked.held_out, asked.file.known(), typed, &changes)?;
        improved.write_into(&mut asked.file, &source(METHOD, &asked.names, &asked.swings))?;
        Ok((text("improve", &improved)?, asked.file, asked.notes))
    })?;
    Ok((text, PyRig::of(file), notes))
}

/// `plan --json`.
#[pyfunction]
pub(crate) fn plan(
    py: Python<'_>,
    recordings: Vec<Given>,
    rig: &PyRig,
    reading: Options,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, Vec<String>)> {
    let reading = reading.reading(Some(&rig.file)).map_err(|failure| raised(&failure))?;
    let file = rig.file.clone();
    compute(py, progress, move |tell| {
        let asked = Asked::new(file, &recordings, &[], &reading)?;
        tell("looking for the leading explanations, then simulating experiments with each …".to_owned());
        let planned = Planned::new(&asked.names, &asked.swings, &asked.file);
        Ok((text("plan", &planned)?, asked.notes))
    })
}

/// The recording of a simulated swing: of a model, or of a scenario by name.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the options of a command")]
pub(crate) fn simulate(
    py: Python<'_>,
    rig: Option<&PyRig>,
    scenario: Option<&str>,
    start_rad: f64,
    seconds: f64,
    noise_rad: f64,
    seed: u64,
    rate_hz: f64,
    exact: bool,
) -> PyResult<PyRecording> {
    let prepared = || {
        check_numbers(start_rad, seconds, noise_rad, rate_hz)?;
        let (parameters, sensor) = match (rig, scenario) {
            (Some(rig), _) => (rig.file.parameters().clone(), rig.file.sensor().copied()),
            (None, name) => (scenario_named(name.unwrap_or_default())?.true_parameters(), None),
        };
        let converter = sensor.unwrap_or(Potentiometer::nominal(FULL_SCALE_12_BIT).into());
        let converter = (!exact).then_some(converter);
        Ok(Simulation { parameters, start_rad, seconds, noise_rad, seed, rate_hz, converter })
    };
    let simulation = prepared().map_err(|failure: Failure| raised(&failure))?;
    let recording = compute(py, None, move |_| swung(&simulation))?;
    Ok(PyRecording::new(format!("simulated, seed {seed}"), recording))
}

fn swung(simulation: &Simulation) -> Result<Recording, Failure> {
    let (mut times_s, mut angles_rad, mut codes) = (Vec::new(), Vec::new(), Vec::new());
    simulation.run(|time_s, angle_rad, code: Option<u16>| {
        if !angle_rad.is_finite() {
            return Err(runs_away(time_s, angle_rad));
        }
        times_s.push(time_s);
        angles_rad.push(angle_rad);
        codes.extend(code);
        Ok(())
    })?;
    let codes = simulation.converter.is_some().then_some(codes);
    Recording::new(simulation.header(), times_s, angles_rad, codes).map_err(Failure::failed)
}

fn check_numbers(start_rad: f64, seconds: f64, noise_rad: f64, rate_hz: f64) -> Result<(), Failure> {
    let wrong = |what: &str, value: f64, wanted: &str| {
        Err(Failure::wrong_use(format!("{what} is {value}; expected {wanted}")).next("give it in SI units"))
    };
    match () {
        () if !start_rad.is_finite() => wrong("start", start_rad, "a finite angle in rad, such as 1.5"),
        () if !(seconds.is_finite() && seconds > 0.0) => wrong("seconds", seconds, "a number above zero"),
        () if !(noise_rad.is_finite() && noise_rad >= 0.0) => {
            wrong("noise", noise_rad, "zero or a number above, in rad")
        }
        () if !(rate_hz.is_finite() && rate_hz > 0.0) => wrong("rate", rate_hz, "a number above zero, in Hz"),
        () => check_size(seconds, rate_hz).and_then(|()| check_start(start_rad)),
    }
}

/// `effects --json`.
#[pyfunction]
pub(crate) fn effects(name: Option<&str>) -> PyResult<String> {
    chosen(name).and_then(|found| text("effects", &Shown::of(&found))).map_err(|failure| raised(&failure))
}
