//! Recording a swing from the rig: waits for stillness, then for the release, then for rest.
//!
//! In: the stream of raw converter codes. Out: a recording file, written while the samples arrive, so that whatever
//! ends it early leaves what was recorded. Time is the sample count over the sampling rate; the program's own clock
//! plays no part. Samples at an end of the sensor's range mean nothing and are left out.

mod detector;
mod error;
mod lead_in;
mod limits;
mod listen;
mod recorder;
mod words;

pub use detector::Stage;
pub use error::RecordError;
pub use lead_in::Sample;
pub use limits::Limits;
pub use listen::{Listener, Listening, listen};
pub use recorder::header;
pub use words::{in_words, usable};

use crate::files;
use crate::link::{LinkError, Session};
use crate::now;
use crate::recording::{Existing, WriteError};
use recorder::Recorder;
use shared::sensor::Sensor;
use shared::wire::{self, Stream};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

/// A swing with fewer passages through the lowest point is of no use.
const USABLE_PASSAGES: u32 = 4;

/// A file in this folder for a swing that begins now: `swing-DATE-TIME` and the suffix, with a number behind it if that
/// is taken.
pub fn unused_path(folder: &Path, suffix: &str) -> PathBuf {
    let stamp = now::for_file_name();
    let numbers = std::iter::once(String::new()).chain((2..).map(|number| format!("-{number}")));
    let mut paths = numbers.map(|number| folder.join(format!("swing-{stamp}{suffix}{number}.csv")));
    paths.find(|path| !path.exists()).unwrap_or_default()
}

/// What to record, and when to give up.
#[derive(Clone, Debug)]
pub struct Plan<'a> {
    /// The file.
    pub path: &'a Path,
    /// Whether it may be replaced.
    pub existing: Existing,
    /// Give up if there is no release within so many seconds.
    pub wait_s: f64,
    /// End the recording so many seconds after the release.
    pub limit_s: f64,
    /// Date and time of the start as text, for the header.
    pub started: Option<String>,
    /// The rig sends a live point every so many samples beside the recording; 0 for none.
    pub live_every: u16,
}

/// What a person may see while it goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Live {
    /// Measured angle, rad.
    pub angle_rad: f64,
    /// Largest angle of the present half swing, rad.
    pub amplitude_rad: f64,
    /// Seconds since the stage began.
    pub elapsed_s: f64,
    /// Frames that did not arrive.
    pub frames_lost: u64,
}

/// Somebody who watches.
pub trait Watch {
    /// A new stage begins.
    fn stage(&mut self, stage: Stage);
    /// Called for every frame.
    fn live(&mut self, live: &Live);
    /// Live points, if the plan asks for some.
    fn points(&mut self, _: &wire::Live) {}
    /// What the rig sends, as it comes.
    fn samples(&mut self, _: &wire::Samples) {}
}

/// Nobody watches.
impl Watch for () {
    fn stage(&mut self, _: Stage) {}
    fn live(&mut self, _: &Live) {}
}

/// Why a recording ended.
#[derive(Debug)]
pub enum End {
    /// The pendulum rests.
    AtRest,
    /// The time limit was reached.
    TimeLimit,
    /// It was told to stop (Ctrl-C).
    Stopped,
    /// The sensor reads an end of its range.
    Disconnected {
        /// The code it reads.
        code: u16,
        /// Which sensor.
        sensor: Sensor,
    },
    /// The link broke.
    Lost(LinkError),
}

/// What was recorded.
#[derive(Debug)]
pub struct Taken {
    /// The file.
    pub path: PathBuf,
    /// Samples in it.
    pub n_samples: usize,
    /// Largest angle before the release, rad, with its sign.
    pub release_rad: f64,
    /// Passages through the lowest point after the release.
    pub n_passages: u32,
    /// From the moment the release was noticed to the end, s.
    pub swing_s: f64,
    /// Frames that did not arrive.
    pub frames_lost: u64,
    /// Samples missing within the recording, left out ones included.
    pub samples_lost: u64,
    /// Why it ended.
    pub end: End,
}

impl Taken {
    /// Is there enough of a swing to learn from?
    pub fn is_usable(&self) -> bool {
        self.n_passages >= USABLE_PASSAGES
    }

    /// Is it worth more than an older recording of the same name?
    fn may_replace(&self) -> bool {
        self.is_usable() && matches!(self.end, End::AtRest | End::TimeLimit | End::Stopped)
    }
}

/// Records one swing.
///
/// # Errors
/// Anything that leaves no swing in the file. What ends a swing early is told by [`Taken::end`] instead.
pub fn record(
    session: &mut Session,
    plan: &Plan,
    watch: &mut dyn Watch,
    stop: &AtomicBool,
) -> Result<Taken, RecordError> {
    refuse_existing(plan)?;
    let (settings, clock) = (session.settings()?, session.clock()?);
    session.start(Stream { raw: true, live_every: plan.live_every })?;
    let mut recorder = Recorder::new(plan, &session.firmware(), clock, settings);
    watch.stage(Stage::Settling);
    let end = recorder.run(session, watch, stop);
    // The link may be what broke, and then it can't be told to stop either.
    let _ = session.stop();
    match end {
        Ok(end) => recorder.finish(session, end),
        Err(error) => Err(recorder.given_up(error)),
    }
}

fn refuse_existing(plan: &Plan) -> Result<(), WriteError> {
    Ok(files::check(&[plan.path], &[], plan.existing)?)
}

#[cfg(test)]
mod tests;
