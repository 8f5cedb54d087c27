//! Recordings: files, arrays, and what commands are given of them.

use crate::errors::raised;
use host::compare::measurement::Measurement;
use host::error::Failure;
use host::operations::reading::Reading;
use host::recording::segment::SegmentOptions;
use host::recording::{AngleUnit, Existing, Header, Measured, ReadOptions, Recording, save};
use host::rigfile::RigFile;
use host::swing::Swing;
use numpy::{IntoPyArray, PyArray1, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// How recordings are read: the options of the command line, by attribute.
#[derive(FromPyObject)]
pub(crate) struct Options {
    columns: Option<String>,
    degrees: bool,
    radians: bool,
    rate: Option<f64>,
    zero: Option<f64>,
    pivot: Option<[f64; 2]>,
    mirror: bool,
    run: Option<RunName>,
    start: Option<f64>,
    end: Option<f64>,
}

/// A run by its name, or by its number from 1.
#[derive(FromPyObject)]
enum RunName {
    Number(u32),
    Name(String),
}

impl RunName {
    fn in_words(&self) -> String {
        match self {
            Self::Number(number) => number.to_string(),
            Self::Name(name) => name.clone(),
        }
    }
}

impl Options {
    /// Checked, and with what the model file says of the sensor.
    pub(crate) fn reading(&self, rig: Option<&RigFile>) -> Result<Reading, Failure> {
        let columns = self.columns.as_deref().map(str::parse).transpose().map_err(Failure::wrong_use)?;
        let angle_unit = match (self.degrees, self.radians) {
            (true, true) => {
                return Err(Failure::wrong_use("angles can't be in degrees and in radians").next("give one of them"));
            }
            (true, false) => Some(AngleUnit::Degrees),
            (false, true) => Some(AngleUnit::Radians),
            (false, false) => None,
        };
        let reading = Reading {
            options: ReadOptions {
                columns,
                rate_hz: self.rate,
                angle_unit,
                zero: self.zero,
                pivot: self.pivot,
                within_s: [self.start, self.end],
                mirrored: self.mirror,
                runs: self.run.iter().map(RunName::in_words).collect(),
                measured: None,
            },
            segment: SegmentOptions { from_s: self.start, to_s: self.end },
        };
        reading.check()?;
        Ok(rig.map_or(reading.clone(), |rig| reading.of(rig)))
    }
}

/// A recording in memory.
#[pyclass(frozen, name = "Recording", module = "pendulum_rig._native")]
pub(crate) struct PyRecording {
    name: String,
    inner: Arc<Recording>,
    times_s: PyOnceLock<Py<PyArray1<f64>>>,
    readings: PyOnceLock<Py<PyArray1<f64>>>,
}

impl PyRecording {
    pub(crate) fn new(name: String, recording: Recording) -> Self {
        Self { name, inner: Arc::new(recording), times_s: PyOnceLock::new(), readings: PyOnceLock::new() }
    }
}

#[pymethods]
impl PyRecording {
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf, reading: Options) -> PyResult<Self> {
        let name = path.display().to_string();
        let read = py.detach(|| reading.reading(None)?.recording(&path)).map_err(|failure| raised(&failure))?;
        Ok(Self::new(name, read))
    }

    #[staticmethod]
    fn of_arrays(
        name: String,
        times_s: PyReadonlyArray1<'_, f64>,
        readings: PyReadonlyArray1<'_, f64>,
        rates: bool,
    ) -> PyResult<Self> {
        let measured = if rates { Measured::Rate } else { Measured::Angle };
        let header = Header { measured: Some(measured), ..Header::default() };
        let copied = |array: PyReadonlyArray1<'_, f64>| array.as_array().to_vec();
        let recording = Recording::new(header, copied(times_s), copied(readings), None);
        let failed = |fault| raised(&Failure::failed(format!("{name}: {fault}")));
        Ok(Self::new(name.clone(), recording.map_err(failed)?))
    }

    #[getter]
    fn name(&self) -> &str {
        &self.name
    }

    #[getter]
    fn times_s(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        kept(py, &self.times_s, self.inner.times_s())
    }

    #[getter]
    fn readings(&self, py: Python<'_>) -> Py<PyArray1<f64>> {
        kept(py, &self.readings, self.inner.angles_rad())
    }

    #[getter]
    fn codes<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<u16>>> {
        self.inner.codes().map(|codes| codes.to_vec().into_pyarray(py))
    }

    #[getter]
    fn unit(&self) -> &'static str {
        self.inner.measured().unit()
    }

    #[getter]
    fn rate_hz(&self) -> f64 {
        self.inner.header().rate_hz.unwrap_or_else(|| self.inner.rate_hz())
    }

    #[getter]
    fn duration_s(&self) -> f64 {
        self.inner.duration_s()
    }

    #[getter]
    fn started(&self) -> Option<String> {
        self.inner.header().started.clone()
    }

    #[getter]
    fn comment(&self) -> Option<String> {
        self.inner.header().comment.clone()
    }

    #[getter]
    fn notes(&self) -> Vec<String> {
        self.inner.notes().to_vec()
    }

    #[getter]
    fn gaps(&self) -> Vec<(f64, f64)> {
        self.inner.gaps().iter().map(|gap| (gap.from_s, gap.to_s)).collect()
    }

    fn __len__(&self) -> usize {
        self.inner.len()
    }

    fn save(&self, path: PathBuf, force: bool) -> PyResult<()> {
        save(&self.inner, &path, Existing::forced(force)).map_err(|error| raised(&Failure::failed(error)))
    }
}

/// One array for all who ask; it can't be written to.
fn kept(py: Python<'_>, place: &PyOnceLock<Py<PyArray1<f64>>>, values: &[f64]) -> Py<PyArray1<f64>> {
    let made = || {
        let array = values.to_vec().into_pyarray(py);
        array.readwrite().make_nonwriteable();
        array.unbind()
    };
    place.get_or_init(py, made).clone_ref(py)
}

/// A recording by name: a file, unless it is in memory.
pub(crate) struct Given {
    name: String,
    held: Option<Arc<Recording>>,
}

impl<'py> FromPyObject<'_, 'py> for Given {
    type Error = PyErr;

    fn extract(object: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(recording) = object.cast::<PyRecording>() {
            let recording = recording.get();
            return Ok(Self { name: recording.name.clone(), held: Some(recording.inner.clone()) });
        }
        Ok(Self { name: object.extract::<PathBuf>()?.display().to_string(), held: None })
    }
}

impl Given {
    /// What the recording gives, or the runs of the file.
    fn with<T>(
        &self,
        reading: &Reading,
        use_it: impl Fn(&str, &Recording) -> Result<Vec<T>, Failure>,
    ) -> Result<Vec<T>, Failure> {
        match &self.held {
            Some(recording) => use_it(&self.name, recording),
            None => {
                let mut found = Vec::new();
                for run in reading.runs(Path::new(&self.name))? {
                    found.extend(use_it(&run.name_in(&self.name), &run.recording)?);
                }
                Ok(found)
            }
        }
    }
}

/// The free swings, and what was noticed.
pub(crate) fn swings(given: &[Given], reading: &Reading) -> Result<(Vec<Swing>, Vec<String>), Failure> {
    let read = |given: &Given| given.with(reading, |name, recording| reading.swings(name, recording));
    let read: Vec<_> = given.par_iter().map(read).collect();
    let (mut swings, mut notes) = (Vec::new(), Vec::new());
    for of_file in read {
        for (swing, told) in of_file? {
            swings.push(swing);
            notes.extend(told);
        }
    }
    Ok((swings, notes))
}

/// The free swings with what is known around them.
pub(crate) fn measurements(given: &[Given], reading: &Reading) -> Result<Vec<Measurement>, Failure> {
    let of_file = |given: &Given| given.with(reading, |name, recording| reading.measurements(name, recording));
    let read: Vec<Vec<Measurement>> = given.par_iter().map(of_file).collect::<Result<_, Failure>>()?;
    Ok(read.into_iter().flatten().collect())
}
