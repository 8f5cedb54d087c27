//! The bank looks at what the rig sends, in a thread of its own, so that no curve waits for a look.

use crate::error::Failure;
use crate::now;
use crate::record::{End, Limits, Listener, Listening, Sample, Stage, header};
use crate::serve::app::App;
use crate::serve::evidence::Evidence;
use crate::serve::releases::Releases;
use crate::watch::{Event, Watcher, disconnected};
use shared::parameters::Parameters;
use shared::wire::{Clock, Samples, Settings};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};

/// Nobody has to let a pendulum go; but a swing ends after so many seconds, as a recording does.
const LIMITS: Limits = Limits { wait_s: f64::INFINITY, ..Limits::USUAL };

/// What the thread hears.
pub(super) enum Heard {
    /// A fresh stream begins.
    Stream(Box<Stream>),
    /// What came of it.
    Samples(Samples),
    /// Nothing comes any longer.
    Silence,
}

/// Where samples come from, and who has which model.
#[derive(Clone)]
pub(super) struct Stream {
    /// The rig's.
    pub(super) parameters: Parameters<f64>,
    pub(super) settings: Settings,
    pub(super) firmware: String,
    pub(super) clock: Clock,
    /// Is another rig connected than before, or one that may have been changed?
    pub(super) is_new_rig: bool,
    /// Is nobody else recording it?
    pub(super) is_kept: bool,
}

/// Starts the thread; it ends with whoever can still tell it something.
pub(super) fn begin(app: &Arc<App>) -> Sender<Heard> {
    let (sender, heard) = channel();
    let app = app.clone();
    std::thread::spawn(move || {
        let mut next = heard.recv().ok();
        while let Some(now) = next {
            next = match now {
                Heard::Stream(stream) => watch_rig(&app, *stream, &heard),
                Heard::Samples(_) | Heard::Silence => heard.recv().ok(),
            };
        }
    });
    sender
}

/// Watches one rig; gives the stream of the next one.
fn watch_rig(app: &App, stream: Stream, heard: &Receiver<Heard>) -> Option<Heard> {
    let mut tell = |event: Event| {
        if let Event::Looked(look) = event {
            app.show_evidence(|evidence| evidence.show(look));
        }
    };
    let watcher = Watcher::new(stream.parameters.clone(), f64::from(stream.settings.rate_hz), &mut tell);
    app.with_releases(Releases::clear);
    let listening = Listening::new(stream.settings, LIMITS);
    let mut watching = Watching { app, stream, watcher, listening: Some(listening) };
    watching.stage(Stage::Settling);
    loop {
        let mut now = heard.recv().ok()?;
        // All that has come, and then at most one look.
        loop {
            if let Some(other) = watching.hear(now) {
                return Some(other);
            }
            now = match heard.try_recv() {
                Ok(next) => next,
                Err(TryRecvError::Empty) => break,
                Err(TryRecvError::Disconnected) => return None,
            };
        }
        watching.watcher.pause();
    }
}

/// One rig that is watched.
struct Watching<'a> {
    app: &'a App,
    stream: Stream,
    watcher: Watcher<'a>,
    /// None while nothing comes.
    listening: Option<Listening>,
}

impl Watching<'_> {
    /// Gives back what is about another rig.
    fn hear(&mut self, heard: Heard) -> Option<Heard> {
        match heard {
            Heard::Stream(stream) if stream.is_new_rig || stream.settings != self.stream.settings => {
                return Some(Heard::Stream(stream));
            }
            Heard::Stream(stream) => self.begin(*stream),
            Heard::Samples(samples) => return self.take(&samples),
            Heard::Silence => {
                self.listening = None;
                self.end();
                self.app.show_evidence(|evidence| evidence.goes_on(None));
            }
        }
        None
    }

    /// A fresh stream of the same rig, perhaps with another model.
    fn begin(&mut self, stream: Stream) {
        let is_new_model = stream.parameters != self.stream.parameters;
        self.stream = stream;
        self.begin_anew();
        if is_new_model {
            self.app.show_evidence(Evidence::forget);
            self.watcher.takes_over(self.stream.parameters.clone());
        }
    }

    /// Waits for the next release.
    fn begin_anew(&mut self) {
        self.end();
        self.listening = Some(Listening::new(self.stream.settings, LIMITS));
        self.stage(Stage::Settling);
    }

    fn take(&mut self, samples: &Samples) -> Option<Heard> {
        let mut listening = self.listening.take()?;
        if listening.is_begun_anew(samples) {
            self.begin_anew();
            return None;
        }
        match listening.take(samples, self) {
            Ok(None) => self.listening = Some(listening),
            Ok(Some(End::Disconnected { code, sensor })) => return Some(self.forgets(&disconnected(code, &sensor))),
            Ok(Some(_)) => self.rests(),
            Err(error) => return Some(self.forgets(&error.into())),
        }
        None
    }

    /// The rig has the last word where it looks by itself.
    fn rests(&mut self) {
        self.watcher.rests();
        self.app.show_evidence(|evidence| evidence.is_rig_due = evidence.rig_looks_by_itself);
        self.begin_anew();
    }

    /// What a sensor said that was not connected may be of no pendulum: all is begun anew.
    fn forgets(&self, failure: &Failure) -> Heard {
        self.app.show_evidence(|evidence| {
            evidence.forget();
            evidence.fails(failure);
        });
        Heard::Stream(Box::new(self.stream.clone()))
    }

    fn end(&self) {
        self.app.with_releases(Releases::end);
    }
}

impl Listener for Watching<'_> {
    fn stage(&mut self, stage: Stage) {
        if stage == Stage::Swinging && self.app.read(|state| state.rig.recorded.is_some()) {
            self.app.change(|state| state.rig.recorded = None);
        }
        if stage == Stage::Swinging && self.stream.is_kept {
            let header = header(&self.stream.settings, &self.stream.firmware, self.stream.clock, Some(now::iso()));
            self.app.with_releases(|releases| releases.begin(header, f64::from(self.stream.settings.rate_hz)));
        }
        self.watcher.stage(stage);
        self.app.show_evidence(|evidence| evidence.goes_on(Some(stage)));
    }

    fn reading(&mut self, angle_rad: f64) {
        self.watcher.reading(angle_rad);
    }

    fn sample(&mut self, sample: Sample) {
        self.app.with_releases(|releases| releases.grow(sample));
        self.reading(sample.angle_rad);
    }

    fn gap(&mut self) {
        self.watcher.gap();
    }

    fn pause(&mut self) {}
}
