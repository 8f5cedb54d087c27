//! The thread that owns the rig's session and fulfils what is wished of it.

mod points;
mod rate;
mod recorder;
mod watching;

use super::app::App;
use super::evidence::Evidence;
use super::rig::{RigView, Wish};
use super::state::{Named, Numbers};
use crate::error::Failure;
use crate::link::{self, Paced, Session};
use crate::operations::watch::is_simulated;
use crate::rigfile::RigFile;
use crate::sim::Scenario;
use crate::watch::{Asked, OwnLooks};
use points::Points;
use shared::wire::{Frame, Stream};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, TryRecvError};
use std::thread::JoinHandle;
use std::time::Duration;
use watching::Heard;

/// Live points per second: more than a screen can show.
const POINTS_PER_S: f32 = 200.0;

/// Wishes are looked for this often while a stream runs.
const LOOK_EVERY: Duration = Duration::from_millis(20);

/// A stream that is silent for so long has dried up.
const SILENCE: Duration = Duration::from_secs(3);

/// The rig's own counters are asked for this often, by its own clock.
const ASK_EVERY: Duration = Duration::from_secs(1);

/// Starts the thread; it connects to the port of the command line, if there is one.
pub(super) fn begin(app: &Arc<App>) -> JoinHandle<()> {
    if let Some(port) = &app.settings.port {
        app.rig.wish(Wish::Connect(port.clone()));
    }
    let (app, wishes) = (app.clone(), app.rig.wishes());
    std::thread::spawn(move || {
        if let Some(wishes) = wishes {
            let watching = watching::begin(&app);
            let (points, own_looks) = (Points::default(), OwnLooks::default());
            Owner {
                app: &app,
                session: None,
                wishes,
                points,
                watching,
                own_looks,
                is_new_rig: true,
                is_leaving: false,
            }
            .run();
        }
    })
}

/// Opens a port of the list that the page was given; any other device is not the page's business.
pub(super) fn connect(app: &App, port: String) -> Result<(), Failure> {
    if !ports(app.settings.port.as_deref()).contains(&port) {
        let what = format!("{port:?} is not in the list of ports");
        return Err(Failure::wrong_use(what).next("start the program with --port"));
    }
    app.rig.wish(Wish::Connect(port));
    Ok(())
}

/// The ports that a page may ask for: the one of the command line and the simulated rigs.
pub(super) fn ports(own: Option<&str>) -> Vec<String> {
    let simulated = Scenario::ALL.iter().map(|scenario| format!("{}:{}", link::SIMULATED, scenario.name));
    own.map(str::to_owned).into_iter().chain(simulated).collect()
}

/// Owns the session.
struct Owner<'a> {
    app: &'a Arc<App>,
    session: Option<Session>,
    wishes: Receiver<Wish>,
    points: Points,
    /// Whoever looks at what the rig sends.
    watching: Sender<Heard>,
    own_looks: OwnLooks,
    /// Was nothing listened to since it was connected?
    is_new_rig: bool,
    is_leaving: bool,
}

impl Owner<'_> {
    fn run(mut self) {
        while !self.is_leaving {
            let wish = if self.is_listening() { self.listen() } else { self.wishes.recv().ok() };
            let Some(wish) = wish else { continue };
            if let Err(failure) = self.fulfil(wish) {
                self.break_off(&failure);
            }
        }
    }

    fn is_listening(&self) -> bool {
        self.app.read(|state| state.rig.listening)
    }

    fn show(&self, change: impl FnOnce(&mut RigView)) {
        self.app.change(|state| change(&mut state.rig));
    }

    fn fulfil(&mut self, wish: Wish) -> Result<(), Failure> {
        match wish {
            Wish::Connect(port) => self.connect(&port),
            Wish::Listen => {
                self.show(|rig| rig.recorded = None);
                self.start()
            }
            Wish::Pause => self.pause(),
            Wish::Record => self.record(),
            Wish::Read(answer) => {
                let parameters = self.session().and_then(|session| Ok(session.parameters()?));
                let _ = answer.send(parameters);
                Ok(())
            }
            Wish::Push(model, answer) => {
                let _ = answer.send(self.push(&model));
                Ok(())
            }
            Wish::Leave => {
                self.is_leaving = true;
                Ok(())
            }
        }
    }

    fn session(&mut self) -> Result<&mut Session, Failure> {
        let nothing = || Failure::wrong_use("no rig is connected").next("connect one first");
        self.session.as_mut().ok_or_else(nothing)
    }

    fn connect(&mut self, port: &str) -> Result<(), Failure> {
        self.session = None;
        let simulated = is_simulated(port);
        self.show(|rig| *rig = RigView { port: Some(port.to_owned()), simulated, ..RigView::default() });
        let mut opened = link::open(port)?;
        if simulated {
            opened = Box::new(Paced::new(opened, self.app.settings.sim_speed));
        }
        let mut session = Session::open(opened)?;
        let firmware = session.firmware();
        let knows = session.knows_the_same_effects();
        self.take_model(&mut session)?;
        self.meet(&mut session)?;
        self.session = Some(session);
        self.show(|rig| {
            rig.firmware = Some(firmware);
            let older = "its firmware knows other effects than this program; update the older of the two";
            rig.note = (!knows).then(|| older.to_owned());
        });
        self.start()
    }

    /// Shows what the rig found before it was connected.
    fn meet(&mut self, session: &mut Session) -> Result<(), Failure> {
        let (own_looks, last) = OwnLooks::with_last(session)?;
        (self.own_looks, self.is_new_rig) = (own_looks, true);
        self.app.show_evidence(|evidence| {
            *evidence = Evidence::of_rig(own_looks.are_made());
            evidence.is_rig_due = own_looks.are_made();
            last.iter().for_each(|look| evidence.show(look));
        });
        Ok(())
    }

    /// Without a model file the rig's own model is the one to begin with.
    fn take_model(&self, session: &mut Session) -> Result<(), Failure> {
        self.app.change(|state| state.meet(session.port()));
        if self.app.read(|state| state.model.is_some()) {
            return Ok(());
        }
        let model = session.model_file()?;
        self.app.change(|state| {
            let origin = "reported by the rig".to_owned();
            state.model.get_or_insert(Named { file: model, origin, numbers: Numbers::Foreign });
            state.model_port = Some(session.port().to_owned());
        });
        self.app.jobs.ask_for_a_look();
        Ok(())
    }

    /// A fresh stream; the simulated student lifts the pendulum anew.
    fn start(&mut self) -> Result<(), Failure> {
        let session = self.session()?;
        let settings = session.settings()?;
        let live_every = (settings.rate_hz / POINTS_PER_S).round().max(1.0) as u16;
        self.is_watched(true)?;
        self.session()?.start(Stream { raw: true, live_every })?;
        self.points = Points::new(settings.rate_hz);
        self.show(|rig| {
            rig.listening = true;
            rig.failure = None;
        });
        Ok(())
    }

    /// The bank looks at the stream that begins now; keeps it, unless a recording does.
    fn is_watched(&mut self, is_kept: bool) -> Result<(), Failure> {
        let session = self.session()?;
        let (settings, firmware, clock) = (session.settings()?, session.firmware(), session.clock()?);
        let parameters = match session.parameters() {
            Ok(parameters) => parameters.map(f64::from),
            // A model that this program can't run can be listened to all the same.
            Err(error) => {
                let failure = Failure::from(error);
                let _ = self.watching.send(Heard::Silence);
                self.app.show_evidence(|evidence| evidence.fails(&failure));
                return Ok(());
            }
        };
        let is_new_rig = std::mem::take(&mut self.is_new_rig);
        let stream = watching::Stream { parameters, settings, firmware, clock, is_new_rig, is_kept };
        let _ = self.watching.send(Heard::Stream(Box::new(stream)));
        Ok(())
    }

    fn pause(&mut self) -> Result<(), Failure> {
        let _ = self.watching.send(Heard::Silence);
        self.show(|rig| rig.listening = false);
        Ok(self.session()?.stop()?)
    }

    /// Passes live points on until somebody wishes something.
    fn listen(&mut self) -> Option<Wish> {
        let now = self.session.as_ref()?.elapsed();
        let (mut heard, mut asked) = (now, now);
        loop {
            match self.wishes.try_recv() {
                Ok(wish) => return Some(wish),
                Err(TryRecvError::Disconnected) => return Some(Wish::Leave),
                Err(TryRecvError::Empty) => {}
            }
            if let Err(failure) = self.pass_on(&mut heard, &mut asked) {
                self.break_off(&failure);
                return None;
            }
        }
    }

    /// Takes a frame; every now and then asks for the rig's counters.
    fn pass_on(&mut self, heard: &mut Duration, asked: &mut Duration) -> Result<(), Failure> {
        let session = self.session.as_mut().ok_or_else(|| Failure::failed("no rig is connected"))?;
        match session.receive(LOOK_EVERY)? {
            Some(frame) => {
                *heard = session.elapsed();
                match frame {
                    Frame::Live(live) => {
                        if let Some(message) = self.points.take(&live) {
                            let _ = self.app.live.send(message);
                        }
                    }
                    Frame::Samples(samples) => drop(self.watching.send(Heard::Samples(samples))),
                    _ => {}
                }
            }
            None if session.elapsed() > *heard + link::patient(SILENCE) => {
                return Err(link::LinkError::StreamStopped { port: session.port().to_owned() }.into());
            }
            None => {}
        }
        if session.elapsed() >= *asked + ASK_EVERY {
            *asked = session.elapsed();
            self.count()?;
            self.ask_for_look()?;
        }
        Ok(())
    }

    fn count(&mut self) -> Result<(), Failure> {
        let session = self.session()?;
        let statistics = session.statistics()?;
        let tally = session.tally().clone();
        self.show(|rig| {
            rig.frames = tally.frames;
            rig.frames_lost = tally.frames_lost;
            rig.frames_damaged = tally.frames_damaged;
            rig.samples_lost = tally.samples_lost;
            rig.innovation_rms_rad = Some(f64::from(statistics.innovation_rms_rad));
            rig.overruns = statistics.overruns;
            rig.dropped_frames = statistics.dropped_frames;
            rig.disconnected = statistics.disconnected;
        });
        Ok(())
    }

    /// Asks the rig what it found, once it is due.
    fn ask_for_look(&mut self) -> Result<(), Failure> {
        if !self.app.read(|state| state.evidence.is_rig_due) {
            return Ok(());
        }
        let session = self.session.as_mut().ok_or_else(|| Failure::failed("no rig is connected"))?;
        match self.own_looks.ask(session)? {
            Asked::Looking => {}
            Asked::Nothing => self.app.show_evidence(|evidence| evidence.is_rig_due = false),
            Asked::Looked(look) => self.app.show_evidence(|evidence| {
                evidence.is_rig_due = false;
                evidence.show(&look);
            }),
        }
        Ok(())
    }

    fn push(&mut self, model: &RigFile) -> Result<(), Failure> {
        let was_listening = self.is_listening();
        let session = self.session()?;
        let lost = session.push(model.parameters())?.map_or(String::new(), |note| format!("; {note}"));
        let firmware = session.firmware();
        self.show(|rig| rig.note = Some(format!("saved in {firmware} and read back the same{lost}")));
        // What was found is of the model before; the rig looks at its releases anew.
        self.app.show_evidence(|evidence| {
            evidence.forget();
            evidence.is_rig_due = evidence.rig_looks_by_itself;
        });
        if was_listening { self.start() } else { Ok(()) }
    }

    /// The rig is gone, or says what cannot be gone on from.
    fn break_off(&mut self, failure: &Failure) {
        self.session = None;
        let _ = self.watching.send(Heard::Silence);
        let told = (failure.what().to_owned(), failure.next_step().map(str::to_owned));
        self.show(|rig| {
            rig.listening = false;
            rig.recording = None;
            rig.firmware = None;
            rig.failure = Some(told);
        });
    }
}
