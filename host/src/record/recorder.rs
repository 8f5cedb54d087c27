//! One recording from its first sample to its last: what is kept, what is left out, when it ends.

use super::detector::{Detector, Stage};
use super::lead_in::{LeadIn, Sample};
use super::limits::{Limits, disconnected};
use super::{End, Live, Plan, RecordError, Taken, Watch};
use crate::link::{LinkError, Session, patient};
use crate::recording::{Calibration, Header, WriteError, Writer, clock_name, sensor_name};
use shared::sensor::Reader;
use shared::units::{Code, Radian};
use shared::wire::{Clock, Frame, Samples, Settings};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// A stream that is silent for so long has dried up.
pub(super) const SILENCE: Duration = Duration::from_secs(3);

/// So often Ctrl-C is looked for while nothing comes.
pub(super) const LOOK_EVERY: Duration = Duration::from_millis(100);

/// A recording begins so long before the first passage through the lowest point, s: the end of the hold.
pub(super) const LEAD_IN_S: f64 = 1.2;

/// One recording while it goes on.
pub(super) struct Recorder<'a> {
    plan: &'a Plan<'a>,
    header: Header,
    settings: Settings,
    reader: Reader,
    detector: Detector,
    lead_in: LeadIn,
    writer: Option<Writer>,
    /// Number of the sample that is time zero in the file.
    first_written: Option<u64>,
    first_received: Option<u64>,
    next_number: u64,
    stage_began_s: f64,
    released_s: Option<f64>,
    now_s: f64,
    n_disconnected: u32,
    left_out: u64,
}

impl<'a> Recorder<'a> {
    pub(super) fn new(plan: &'a Plan<'a>, firmware: &str, clock: Clock, settings: Settings) -> Self {
        let rate_hz = f64::from(settings.rate_hz);
        let step_rad = f64::from(settings.sensor.step_rad());
        Self {
            plan,
            header: header(&settings, firmware, clock, plan.started.clone()),
            reader: Reader::new(settings.sensor),
            settings,
            detector: Detector::new(rate_hz, step_rad),
            lead_in: LeadIn::new((LEAD_IN_S * rate_hz) as usize),
            writer: None,
            first_written: None,
            first_received: None,
            next_number: 0,
            stage_began_s: 0.0,
            released_s: None,
            now_s: 0.0,
            n_disconnected: 0,
            left_out: 0,
        }
    }

    pub(super) fn run(
        &mut self,
        session: &mut Session,
        watch: &mut dyn Watch,
        stop: &AtomicBool,
    ) -> Result<End, RecordError> {
        let mut heard = session.elapsed();
        loop {
            if stop.load(Ordering::Relaxed) {
                return self.ended_early(End::Stopped);
            }
            match session.receive(LOOK_EVERY) {
                Err(error) => return self.ended_early(End::Lost(error)),
                Ok(Some(Frame::Samples(samples))) if samples.first_sample < self.next_number => {
                    let port = session.port().to_owned();
                    return self.ended_early(End::Lost(LinkError::Restarted { port }));
                }
                Ok(Some(Frame::Samples(samples))) => {
                    heard = session.elapsed();
                    watch.samples(&samples);
                    if let Some(end) = self.take(&samples, watch)? {
                        return Ok(end);
                    }
                    watch.live(&self.live(session.tally().frames_lost));
                }
                Ok(Some(Frame::Live(points))) => watch.points(&points),
                Ok(_) if session.elapsed() > heard + patient(SILENCE) => {
                    let port = session.port().to_owned();
                    return self.ended_early(End::Lost(LinkError::StreamStopped { port }));
                }
                Ok(_) => {}
            }
        }
    }

    /// From the release on, what was seen so far is kept.
    fn ended_early(&self, end: End) -> Result<End, RecordError> {
        match (self.detector.stage(), end) {
            (Stage::Swinging | Stage::AtRest, end) => Ok(end),
            (_, End::Lost(error)) => Err(error.into()),
            _ => Err(RecordError::StoppedEarly),
        }
    }

    fn take(&mut self, samples: &Samples, watch: &mut dyn Watch) -> Result<Option<End>, RecordError> {
        let first = *self.first_received.get_or_insert(samples.first_sample);
        for (offset, code) in samples.codes.iter().enumerate() {
            let number = samples.first_sample.saturating_add(offset as u64);
            self.next_number = number.saturating_add(1);
            self.now_s = number.saturating_sub(first) as f64 / f64::from(self.settings.rate_hz);
            if let Some(end) = self.take_sample(number, *code, watch)? {
                return Ok(Some(end));
            }
        }
        Ok(None)
    }

    fn take_sample(&mut self, number: u64, code: u16, watch: &mut dyn Watch) -> Result<Option<End>, RecordError> {
        let Some(Radian(angle_rad)) = self.reader.read(Code(code)) else { return self.pass_over(code) };
        self.n_disconnected = 0;
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
        disconnected(&self.settings, self.detector.stage(), self.n_disconnected, code)
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

    fn patience(&self) -> Result<Option<End>, RecordError> {
        let limits = Limits { wait_s: self.plan.wait_s, limit_s: self.plan.limit_s };
        limits.patience(&self.detector, self.now_s - self.stage_began_s)
    }

    fn live(&self, frames_lost: u64) -> Live {
        Live {
            angle_rad: self.detector.angle_rad(),
            amplitude_rad: self.detector.amplitude_rad(),
            elapsed_s: self.now_s - self.stage_began_s,
            frames_lost,
        }
    }

    pub(super) fn finish(mut self, session: &Session, end: End) -> Result<Taken, RecordError> {
        let writer = self.writer.take();
        let tally = session.tally();
        let mut taken = Taken {
            path: writer.as_ref().map_or(self.plan.path, Writer::path).to_owned(),
            n_samples: writer.as_ref().map_or(0, Writer::n_samples),
            release_rad: self.detector.release_rad(),
            n_passages: self.detector.n_passages(),
            swing_s: self.released_s.map_or(0.0, |released_s| self.now_s - released_s),
            frames_lost: tally.frames_lost,
            samples_lost: tally.samples_lost + self.left_out,
            end,
        };
        if let Some(writer) = writer {
            close(writer, &mut taken)?;
        }
        Ok(taken)
    }

    /// A file in which nothing was recorded is taken away again; of a swing, what reached the disk is kept.
    pub(super) fn given_up(mut self, error: RecordError) -> RecordError {
        match (error, self.writer.take()) {
            (RecordError::Write(source), Some(writer)) if writer.n_handed_over() > 0 => cut_short(source, &writer),
            (error, Some(writer)) => {
                writer.discard();
                error
            }
            (error, None) => error,
        }
    }
}

/// An older recording gives its place to a usable one only.
fn close(writer: Writer, taken: &mut Taken) -> Result<(), RecordError> {
    let kept = (writer.n_handed_over(), writer.lies_at().to_owned());
    let closed = match taken.may_replace() {
        true => writer.finish(),
        false => writer.leave().map(|path| taken.path = path),
    };
    let (n_samples, path) = kept;
    closed.map_err(|source| RecordError::CutShort { source, n_samples, path })
}

fn cut_short(source: WriteError, writer: &Writer) -> RecordError {
    RecordError::CutShort { source, n_samples: writer.n_handed_over(), path: writer.lies_at().to_owned() }
}

/// What a file says of a recording that was begun at this date and time.
pub fn header(settings: &Settings, firmware: &str, clock: Clock, started: Option<String>) -> Header {
    Header {
        rate_hz: Some(f64::from(settings.rate_hz)),
        firmware: Some(firmware.to_owned()),
        clock: clock_name(clock),
        sensor: sensor_name(&settings.sensor),
        calibration: Some(Calibration::of(&settings.sensor)),
        cutoff_hz: Some(f64::from(settings.cutoff_hz)),
        started,
        ..Header::default()
    }
}
