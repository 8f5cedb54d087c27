//! A rig's model: its file, its numbers, and the model that runs.

use crate::errors::raised;
use host::error::Failure;
use host::operations::model::values;
use host::operations::simulate::{Assignment, with};
use host::rigfile::{Quantity, RigFile, Source};
use host::swing::{Swing, kind};
use host::{files, formula};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use shared::effect::Effect;
use shared::model::{Model, SensorState, State};
use shared::motion::Pendulum;
use std::path::PathBuf;

/// A model file in memory.
#[pyclass(frozen, name = "Rig", module = "pendulum_rig._native")]
pub(crate) struct PyRig {
    pub(crate) file: RigFile,
}

#[pymethods]
impl PyRig {
    #[new]
    fn new(
        mass_kg: f64,
        length_m: f64,
        inertia_kg_m2: f64,
        gravity_m_s2: f64,
        stds: [Option<f64>; 3],
    ) -> PyResult<Self> {
        let file = RigFile::new(Pendulum { mass_kg, length_m, inertia_kg_m2, gravity_m_s2 });
        typed(file.and_then(|file| file.measured_to(stds)))
    }

    #[staticmethod]
    fn of_unknown_geometry(gravity_m_s2: f64) -> PyResult<Self> {
        typed(RigFile::normalised(gravity_m_s2))
    }

    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        RigFile::load(&path).map(Self::of).map_err(|error| raised(&error.into()))
    }

    #[staticmethod]
    fn parse(text: &str) -> PyResult<Self> {
        RigFile::parse("the text", text).map(Self::of).map_err(|error| raised(&error.into()))
    }

    fn save(&self, path: PathBuf, force: bool) -> PyResult<()> {
        let checked = files::check(&[&path], &[], files::Existing::forced(force)).map_err(Failure::from);
        checked.and_then(|()| Ok(self.file.save(&path)?)).map_err(|failure| raised(&failure))
    }

    #[getter]
    fn toml(&self) -> String {
        self.file.to_string()
    }

    #[getter]
    fn is_normalised(&self) -> bool {
        self.file.is_normalised()
    }

    /// Every number: symbol, name, value, std, unit.
    fn numbers(&self) -> Vec<(&'static str, &'static str, f64, Option<f64>, &'static str)> {
        values(&self.file)
            .iter()
            .map(|number| (number.symbol, number.name, number.value, number.std, number.unit))
            .collect()
    }

    /// With other numbers, and the effect of a formula.
    fn changed(&self, numbers: Vec<(String, f64)>, effect: Option<&str>) -> PyResult<Self> {
        let change = || {
            let numbers: Vec<Assignment> =
                numbers.into_iter().map(|(name, value)| Assignment { name, value }).collect();
            let parameters = with(self.file.parameters(), effect_of(effect)?, &numbers)?;
            let mut file = self.file.clone();
            for quantity in Quantity::all(&parameters) {
                let value = quantity.get(&parameters).unwrap_or_default();
                if quantity.get(file.parameters()) != Some(value) {
                    file.set(quantity, value, host::rigfile::Knowledge::default())?;
                }
            }
            Ok(Self::of(file))
        };
        change().map_err(|failure: Failure| raised(&failure))
    }

    fn model(&self) -> PyModel {
        PyModel { inner: Model::new(self.file.parameters()) }
    }
}

impl PyRig {
    pub(crate) fn of(file: RigFile) -> Self {
        Self { file }
    }
}

fn typed(file: Result<RigFile, host::rigfile::RigFileError>) -> PyResult<PyRig> {
    let wrong = |error| Failure::wrong_use(error).next("give a value within the range, in SI units");
    file.map(PyRig::of).map_err(|error| raised(&wrong(error)))
}

/// The effect that a formula means.
pub(crate) fn effect_of(text: Option<&str>) -> Result<Option<&'static Effect<f64>>, Failure> {
    text.map(|text| formula::read(text).map_err(Failure::wrong_use)).transpose()
}

/// Where values came from.
pub(crate) fn source(method: &str, names: &[String], swings: &[Swing]) -> Source {
    Source::new(method, &names.iter().map(PathBuf::from).collect::<Vec<_>>()).of(kind(swings))
}

/// A model that runs.
#[pyclass(frozen, name = "Model", module = "pendulum_rig._native")]
pub(crate) struct PyModel {
    inner: Model<f64>,
}

/// What a running model remembers.
#[pyclass(name = "State", module = "pendulum_rig._native")]
pub(crate) struct PyState {
    inner: State<f64>,
    sensor: SensorState<f64>,
}

#[pymethods]
impl PyModel {
    #[pyo3(signature = (angle_rad, velocity_rad_s=0.0))]
    fn release(&self, angle_rad: f64, velocity_rad_s: f64) -> PyState {
        let inner = self.inner.release(angle_rad, velocity_rad_s);
        PyState { inner, sensor: self.inner.sensor_at_rest(&inner) }
    }

    fn step(&self, state: &mut PyState, dt_s: f64) {
        self.inner.step(&mut state.inner, dt_s);
    }

    /// The sensor's reading, rad.
    fn read(&self, state: &mut PyState) -> f64 {
        self.inner.read(&state.inner, &mut state.sensor)
    }

    /// Many steps: angles and velocities after each.
    fn run<'py>(
        &self,
        py: Python<'py>,
        state: &mut PyState,
        dt_s: f64,
        n_steps: usize,
    ) -> (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>) {
        let mut now = state.inner;
        let (angles, velocities): (Vec<f64>, Vec<f64>) = py.detach(|| {
            let mut after = || {
                self.inner.step(&mut now, dt_s);
                (now.angle_rad, now.velocity_rad_s)
            };
            (0..n_steps).map(|_| after()).unzip()
        });
        state.inner = now;
        (angles.into_pyarray(py), velocities.into_pyarray(py))
    }
}

#[pymethods]
impl PyState {
    #[getter]
    fn angle_rad(&self) -> f64 {
        self.inner.angle_rad
    }

    #[getter]
    fn velocity_rad_s(&self) -> f64 {
        self.inner.velocity_rad_s
    }

    #[getter]
    fn time_s(&self) -> f64 {
        self.inner.time_s
    }

    #[getter]
    fn is_resting(&self) -> bool {
        self.inner.contact.is_resting()
    }
}
