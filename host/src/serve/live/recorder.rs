//! Recording from the page: the same stages as on the command line, while the live curves go on.

use super::points::Points;
use super::watching::Heard;
use super::{Owner, POINTS_PER_S};
use crate::error::Failure;
use crate::now;
use crate::record::{Limits, Live, Plan, Stage, Watch, in_words, record, unused_path, usable};
use crate::recording::Existing;
use crate::serve::app::App;
use crate::serve::recordings;
use shared::wire;
use std::sync::Arc;
use std::sync::mpsc::Sender;

impl Owner<'_> {
    /// Records a swing into the folder the server was started in, and adds it to the list.
    pub(super) fn record(&mut self) -> Result<(), Failure> {
        let app = self.app.clone();
        let path = unused_path(&app.settings.folder, "");
        let session = self.session()?;
        let (port, rate_hz) = (session.port().to_owned(), session.settings()?.rate_hz);
        let live_every = (rate_hz / POINTS_PER_S).round().max(1.0) as u16;
        let started = Some(now::iso());
        let Limits { wait_s, limit_s } = Limits::USUAL;
        let plan = Plan { path: &path, existing: Existing::Number, wait_s, limit_s, started, live_every };
        self.show(|rig| rig.recorded = None);
        self.is_watched(false)?;
        let mut watcher = Watcher { app: &app, points: Points::new(rate_hz), watching: self.watching.clone() };
        let session = self.session()?;
        let result = record(session, &plan, &mut watcher, &app.rig.stop_recording);
        self.show(|rig| rig.recording = None);
        let note = result.map_err(Failure::from).and_then(|taken| {
            let note = usable(&taken)?.unwrap_or_else(|| in_words(&taken));
            Ok((note, taken.path))
        });
        match note.and_then(|(note, path)| Ok((note, recordings::of_file(&path, &app.settings)?))) {
            Ok((note, loaded)) => {
                self.show(|rig| rig.recorded = Some(note));
                app.take_in(recordings::of_port(loaded, Some(&port)), None)?;
            }
            Err(failure) => app.change(|state| state.failure = Some(failure)),
        }
        // Listening goes on where the rig is still there.
        self.start()
    }
}

struct Watcher<'a> {
    app: &'a Arc<App>,
    points: Points,
    /// The bank looks at what is recorded, too.
    watching: Sender<Heard>,
}

impl Watch for Watcher<'_> {
    fn stage(&mut self, stage: Stage) {
        let words = match stage {
            Stage::Settling => "waiting until the pendulum is still",
            Stage::Waiting => "still: lift it, hold it, and let it go",
            Stage::Swinging => "released: recording until it rests",
            Stage::AtRest => "at rest",
        };
        self.app.change(|state| state.rig.recording = Some(words));
    }

    fn live(&mut self, _: &Live) {}

    fn points(&mut self, live: &wire::Live) {
        if let Some(message) = self.points.take(live) {
            let _ = self.app.live.send(message);
        }
    }

    fn samples(&mut self, samples: &wire::Samples) {
        let _ = self.watching.send(Heard::Samples(samples.clone()));
    }
}
