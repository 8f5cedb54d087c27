//! Recording a swing from the rig: waits for stillness, then for the release, then for rest.
//!
//! In: the stream of raw converter codes. Out: a recording file, written while the samples arrive, so that whatever
//! ends it early leaves what was recorded. Time is the sample count over the sampling rate; the program's own clock
//! plays no part. Samples at an end of the potentiometer's range mean nothing and are left out.

mod detector;
mod lead_in;

pub use detector::Stage;

use crate::error::Failure;
use crate::link::{LinkError, Session};
use crate::recording::{Calibration, Existing, Header, WriteError, Writer};
use detector::Detector;
use lead_in::{LeadIn, Sample};
use shared::units::{Code, Radian};
use shared::wire::{Frame, Samples, Settings, Stream};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use thiserror::Error;

/// A stream that is silent for so long has dried up.
const SILENCE: Duration = Duration::from_secs(3);

/// So often Ctrl-C is looked for while nothing comes.
const LOOK_EVERY: Duration = Duration::from_millis(100);

/// The wiper may leave its track for a moment at the top; longer is a broken wire.
const DISCONNECTED_S: f64 = 0.2;

/// A swing with fewer passages through the lowest point is of no use.
const USABLE_PASSAGES: u32 = 4;

/// A recording begins so long before the first passage through the lowest point, s: the end of the hold.
const LEAD_IN_S: f64 = 1.2;

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
    /// The potentiometer reads an end of its range.
    Disconnected {
        /// The code it reads.
        code: u16,
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
}

/// Nothing was recorded, and why.
#[derive(Debug, Error)]
pub enum RecordError {
    /// The link could not be used.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The potentiometer reads an end of its range.
    #[error("the potentiometer reads code {code} of 0 … {full_scale}: an end of its range")]
    Disconnected {
        /// The code it reads.
        code: u16,
        /// The converter's largest code.
        full_scale: u16,
    },
    /// Never still.
    #[error("the pendulum did not come to rest within {seconds:.0} s; its angle still varies by {spread_rad:.3} rad")]
    NeverStill {
        /// How long it was waited for.
        seconds: f64,
        /// Standard deviation of the angle over the last half second.
        spread_rad: f64,
    },
    /// Nobody let it go.
    #[error("no release was seen within {seconds:.0} s")]
    NoRelease {
        /// How long it was waited for.
        seconds: f64,
    },
    /// Stopped before there was anything.
    #[error("stopped before the pendulum was let go: nothing was recorded")]
    StoppedEarly,
}

impl From<RecordError> for Failure {
    fn from(error: RecordError) -> Self {
        let hint = match error {
            RecordError::Link(error) => return error.into(),
            RecordError::Write(WriteError::Exists { path }) => {
                return Self::wrong_use(format!("{} exists already", path.display()))
                    .next("choose another name with -o, or replace it with --force");
            }
            RecordError::Write(_) => return Self::failed(error),
            RecordError::Disconnected { .. } => {
                "check the potentiometer's three wires, and that the pendulum hangs in the middle of its travel"
            }
            RecordError::NeverStill { .. } => "stop the pendulum by hand, or look for what shakes it, and record again",
            RecordError::NoRelease { .. } => {
                "lift the pendulum by 0.5 rad (30°) or more, hold it still, let it go; --wait SECONDS gives more time"
            }
            RecordError::StoppedEarly => "repeat the command",
        };
        Self::failed(error).next(hint)
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
    let settings = session.settings()?;
    let header = header(plan, &settings, session.firmware());
    session.start(Stream { raw: true, live_every: 0 })?;
    let mut recorder = Recorder::new(plan, header, settings);
    watch.stage(Stage::Settling);
    let end = recorder.run(session, watch, stop);
    // The link may be what broke, and then it can't be told to stop either.
    let _ = session.stop();
    recorder.finish(session, end?)
}

fn refuse_existing(plan: &Plan) -> Result<(), WriteError> {
    let in_the_way = plan.existing == Existing::Keep && plan.path.exists();
    if in_the_way { Err(WriteError::Exists { path: plan.path.to_owned() }) } else { Ok(()) }
}

fn header(plan: &Plan, settings: &Settings, firmware: String) -> Header {
    let potentiometer = settings.potentiometer;
    Header {
        rate_hz: Some(f64::from(settings.rate_hz)),
        firmware: Some(firmware),
        calibration: Some(Calibration {
            zero_code: f64::from(potentiometer.zero_code),
            radians_per_code: f64::from(potentiometer.radian_per_code),
        }),
        cutoff_hz: Some(f64::from(settings.cutoff_hz)),
        started: plan.started.clone(),
        ..Header::default()
    }
}

/// One recording while it goes on.
struct Recorder<'a> {
    plan: &'a Plan<'a>,
    header: Header,
    settings: Settings,
    detector: Detector,
    lead_in: LeadIn,
    writer: Option<Writer>,
    /// Number of the sample that is time zero in the file.
    first_written: Option<u64>,
    first_received: Option<u64>,
    stage_began_s: f64,
    released_s: Option<f64>,
    now_s: f64,
    n_disconnected: u32,
    left_out: u64,
}

impl<'a> Recorder<'a> {
    fn new(plan: &'a Plan<'a>, header: Header, settings: Settings) -> Self {
        let rate_hz = f64::from(settings.rate_hz);
        let step_rad = f64::from(settings.potentiometer.radian_per_code).abs();
        Self {
            plan,
            header,
            settings,
            detector: Detector::new(rate_hz, step_rad),
            lead_in: LeadIn::new((LEAD_IN_S * rate_hz) as usize),
            writer: None,
            first_written: None,
            first_received: None,
            stage_began_s: 0.0,
            released_s: None,
            now_s: 0.0,
            n_disconnected: 0,
            left_out: 0,
        }
    }

    fn run(&mut self, session: &mut Session, watch: &mut dyn Watch, stop: &AtomicBool) -> Result<End, RecordError> {
        let mut heard = session.elapsed();
        loop {
            if stop.load(Ordering::Relaxed) {
                return self.ended_early(End::Stopped);
            }
            match session.receive(LOOK_EVERY) {
                Err(error) => return self.ended_early(End::Lost(error)),
                Ok(Some(Frame::Samples(samples))) => {
                    heard = session.elapsed();
                    if let Some(end) = self.take(&samples, watch)? {
                        return Ok(end);
                    }
                    watch.live(&self.live(session.tally().frames_lost));
                }
                Ok(_) if session.elapsed() > heard + SILENCE => {
                    let port = session.port().to_owned();
                    return self.ended_early(End::Lost(LinkError::StreamStopped { port }));
                }
                Ok(_) => {}
            }
        }
    }

    /// From the moment the release is awaited, what was seen so far is kept.
    fn ended_early(&mut self, end: End) -> Result<End, RecordError> {
        if self.writer.is_some() {
            self.write_lead_in()?;
            return Ok(end);
        }
        match end {
            End::Lost(error) => Err(error.into()),
            _ => Err(RecordError::StoppedEarly),
        }
    }

    fn take(&mut self, samples: &Samples, watch: &mut dyn Watch) -> Result<Option<End>, RecordError> {
        let first = *self.first_received.get_or_insert(samples.first_sample);
        for (offset, code) in samples.codes.iter().enumerate() {
            let number = samples.first_sample + offset as u64;
            self.now_s = number.saturating_sub(first) as f64 / f64::from(self.settings.rate_hz);
            if let Some(end) = self.take_sample(number, *code, watch)? {
                return Ok(Some(end));
            }
        }
        Ok(None)
    }

    fn take_sample(&mut self, number: u64, code: u16, watch: &mut dyn Watch) -> Result<Option<End>, RecordError> {
        if !self.settings.potentiometer.is_connected(Code(code)) {
            return self.pass_over(code);
        }
        self.n_disconnected = 0;
        let Radian(angle_rad) = self.settings.potentiometer.angle(Code(code));
        let sample = Sample { number, angle_rad: f64::from(angle_rad), code };
        if let Some(stage) = self.detector.push(sample.angle_rad) {
            self.enter(stage, watch)?;
        }
        self.store(sample)?;
        self.patience()
    }

    /// Leaves a reading at an end of the range out; many in a row end the recording.
    fn pass_over(&mut self, code: u16) -> Result<Option<End>, RecordError> {
        self.n_disconnected += 1;
        self.left_out += u64::from(self.first_written.is_some());
        let too_many = f64::from(self.n_disconnected) > DISCONNECTED_S * f64::from(self.settings.rate_hz);
        match (too_many, self.detector.stage()) {
            (false, _) => Ok(None),
            (true, Stage::Swinging) => Ok(Some(End::Disconnected { code })),
            (true, _) => {
                let full_scale = self.settings.potentiometer.full_scale;
                Err(RecordError::Disconnected { code, full_scale })
            }
        }
    }

    fn store(&mut self, sample: Sample) -> Result<(), WriteError> {
        match self.detector.stage() {
            Stage::Settling | Stage::Waiting => {
                self.lead_in.push(sample, self.detector.n_passages() > 0);
                Ok(())
            }
            Stage::Swinging | Stage::AtRest => self.write(sample),
        }
    }

    fn write(&mut self, sample: Sample) -> Result<(), WriteError> {
        let Some(writer) = &mut self.writer else { return Ok(()) };
        let first = *self.first_written.get_or_insert(sample.number);
        let time_s = sample.number.saturating_sub(first) as f64 / f64::from(self.settings.rate_hz);
        writer.write(time_s, sample.angle_rad, Some(sample.code))
    }

    fn write_lead_in(&mut self) -> Result<(), WriteError> {
        while let Some(sample) = self.lead_in.pop() {
            self.write(sample)?;
        }
        Ok(())
    }

    fn enter(&mut self, stage: Stage, watch: &mut dyn Watch) -> Result<(), RecordError> {
        self.stage_began_s = self.now_s;
        match stage {
            Stage::Settling | Stage::AtRest => {}
            // Opened before the release is asked for: a folder that can't be written to costs nobody a swing.
            Stage::Waiting => self.writer = Some(Writer::create(self.plan.path, &self.header, self.plan.existing)?),
            Stage::Swinging => {
                self.released_s = Some(self.now_s);
                self.write_lead_in()?;
            }
        }
        watch.stage(stage);
        Ok(())
    }

    /// Ends what takes too long.
    fn patience(&self) -> Result<Option<End>, RecordError> {
        let seconds = self.now_s - self.stage_began_s;
        match self.detector.stage() {
            Stage::AtRest => Ok(Some(End::AtRest)),
            Stage::Swinging if seconds > self.plan.limit_s => Ok(Some(End::TimeLimit)),
            Stage::Waiting if seconds > self.plan.wait_s => Err(RecordError::NoRelease { seconds: self.plan.wait_s }),
            Stage::Settling if seconds > self.plan.wait_s => {
                Err(RecordError::NeverStill { seconds: self.plan.wait_s, spread_rad: self.detector.spread_rad() })
            }
            _ => Ok(None),
        }
    }

    fn live(&self, frames_lost: u64) -> Live {
        Live {
            angle_rad: self.detector.angle_rad(),
            amplitude_rad: self.detector.amplitude_rad(),
            elapsed_s: self.now_s - self.stage_began_s,
            frames_lost,
        }
    }

    fn finish(mut self, session: &Session, end: End) -> Result<Taken, RecordError> {
        let n_samples = self.writer.as_ref().map_or(0, Writer::n_samples);
        if let Some(writer) = self.writer.take() {
            writer.finish()?;
        }
        let tally = session.tally();
        Ok(Taken {
            path: self.plan.path.to_owned(),
            n_samples,
            release_rad: self.detector.release_rad(),
            n_passages: self.detector.n_passages(),
            swing_s: self.released_s.map_or(0.0, |released_s| self.now_s - released_s),
            frames_lost: tally.frames_lost,
            samples_lost: tally.samples_lost + self.left_out,
            end,
        })
    }
}

/// A file in which nothing was recorded is taken away again.
impl Drop for Recorder<'_> {
    fn drop(&mut self) {
        if self.writer.take().is_some_and(|writer| writer.n_samples() == 0) {
            let _ = std::fs::remove_file(self.plan.path);
        }
    }
}

#[cfg(test)]
mod tests;
