//! A rig on a port. Its session lives on a thread of its own, which does one thing after another.

use crate::errors::raised;
use crate::rig::PyRig;
use crate::wait::{Message, Tell, hear, reply};
use host::error::Failure;
use host::link::{self, Session};
use host::operations::json;
use host::operations::push::push;
use host::operations::record::{Recorded, at_rate};
use host::operations::watch::watch;
use host::record::{Limits, Live, Plan, Stage, Watch, record, usable};
use host::recording::Existing;
use host::watch::Event;
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::{Receiver, Sender, channel};

type Job = Box<dyn FnOnce(&mut Session) + Send>;

/// An open rig.
#[pyclass(frozen, module = "pendulum_rig._native")]
pub(crate) struct Connection {
    jobs: Sender<Job>,
    #[pyo3(get)]
    port: String,
    #[pyo3(get)]
    firmware: String,
}

#[pymethods]
impl Connection {
    #[new]
    fn new(py: Python<'_>, port: String) -> PyResult<Self> {
        let (jobs, waiting) = channel::<Job>();
        let (sender, receiver) = channel();
        let name = port.clone();
        std::thread::spawn(move || serve(&name, &sender, &waiting));
        let firmware = hear(py, receiver, None, None)?;
        Ok(Self { jobs, port, firmware })
    }

    /// `record --json`.
    #[expect(clippy::too_many_arguments, reason = "the options of a command")]
    fn record(
        &self,
        py: Python<'_>,
        path: PathBuf,
        force: bool,
        rate: Option<f32>,
        wait: f64,
        limit: f64,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<String> {
        self.ask(py, progress, move |session, stop, tell| {
            let (taken, rate_hz) = at_rate(session, rate, &|text| tell(text.to_owned()), |session| {
                let existing = Existing::forced(force);
                let plan = Plan { path: &path, existing, wait_s: wait, limit_s: limit, started: None, live_every: 0 };
                let taken = record(session, &plan, &mut Told(tell), stop)?;
                usable(&taken)?;
                Ok(taken)
            })?;
            json::text("record", &Recorded::new(&taken, rate_hz)).map_err(Failure::failed)
        })
    }

    /// The rig's model.
    fn pull(&self, py: Python<'_>) -> PyResult<PyRig> {
        self.ask(py, None, |session, _, _| session.model_file()).map(PyRig::of)
    }

    /// `push --json`.
    fn push(
        &self,
        py: Python<'_>,
        rig: &PyRig,
        calibration: bool,
        without_sensor: bool,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<String> {
        let mut file = rig.file.clone();
        if without_sensor {
            file.remove_gyroscope();
        }
        self.ask(py, progress, move |session, _, tell| {
            let pushed = push(session, &file, calibration, &|note| tell(note.to_owned()))?;
            json::text("push", &pushed).map_err(Failure::failed)
        })
    }

    /// `watch --json`; nothing if it was stopped before the first look.
    fn watch(
        &self,
        py: Python<'_>,
        swings: Option<u32>,
        wait: f64,
        limit: f64,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Option<String>> {
        self.ask(py, progress, move |session, stop, tell| {
            let mut heard = |event: Event<'_>| {
                if let Event::Stage(stage) = event {
                    tell(words(stage).to_owned());
                }
            };
            let limits = Limits { wait_s: wait, limit_s: limit };
            let look = watch(session, swings, limits, &mut heard, stop)?;
            look.map(|look| json::text("watch", &look).map_err(Failure::failed)).transpose()
        })
    }
}

impl Connection {
    fn ask<T: Send + 'static>(
        &self,
        py: Python<'_>,
        progress: Option<&Bound<'_, PyAny>>,
        work: impl FnOnce(&mut Session, &AtomicBool, Tell<'_>) -> Result<T, Failure> + Send + 'static,
    ) -> PyResult<T> {
        let stop = Arc::new(AtomicBool::new(false));
        let (sender, receiver) = channel();
        let flag = stop.clone();
        let job: Job = Box::new(move |session| reply(&sender, |tell| work(session, &flag, tell)));
        let gone = |_| raised(&Failure::failed("the rig's thread has ended").next("connect again"));
        self.jobs.send(job).map_err(gone)?;
        hear(py, receiver, progress, Some(&stop))
    }
}

/// Opens the port, says who is there, and does what is asked until nobody can ask any more.
fn serve(port: &str, greeting: &Sender<Message<String>>, jobs: &Receiver<Job>) {
    let mut session = None;
    reply(greeting, |_| Ok(session.insert(link::connect(port)?).firmware()));
    if let Some(mut session) = session {
        jobs.iter().for_each(|job| job(&mut session));
    }
}

/// Stages as news.
struct Told<'a>(Tell<'a>);

impl Watch for Told<'_> {
    fn stage(&mut self, stage: Stage) {
        self.0(words(stage).to_owned());
    }

    fn live(&mut self, _: &Live) {}
}

fn words(stage: Stage) -> &'static str {
    match stage {
        Stage::Settling => "waiting until the pendulum is still …",
        Stage::Waiting => "still: lift it, hold it, and let it go",
        Stage::Swinging => "released: it swings until it rests (Ctrl-C ends earlier)",
        Stage::AtRest => "at rest",
    }
}
