//! Listening to one swing without keeping a file: the same stillness, release and rest as of a recording, each reading
//! told to a listener. [`listen`] owns the session meanwhile; who has other use for it gives a [`Listening`] its
//! samples.

use super::detector::{Detector, Stage};
use super::lead_in::LeadIn;
use super::limits::{Limits, disconnected};
use super::recorder::{LEAD_IN_S, LOOK_EVERY, SILENCE};
use super::{End, RecordError, Sample};
use crate::link::{LinkError, Session, patient};
use shared::sensor::Reader;
use shared::units::{Code, Radian};
use shared::wire::{Frame, Samples, Settings, Stream};
use std::sync::atomic::{AtomicBool, Ordering};

/// Somebody who listens.
pub trait Listener {
    /// A new stage begins.
    fn stage(&mut self, stage: Stage);
    /// A reading of the swing in rad, from shortly before the release on.
    fn reading(&mut self, angle_rad: f64);
    /// The same, for whoever keeps what came.
    fn sample(&mut self, sample: Sample) {
        self.reading(sample.angle_rad);
    }
    /// Readings are missing between the last one and the next.
    fn gap(&mut self);
    /// All readings that have come so far were told.
    fn pause(&mut self);
}

/// One swing while it goes on, from whatever brings the samples.
pub struct Listening {
    settings: Settings,
    reader: Reader,
    limits: Limits,
    detector: Detector,
    lead_in: LeadIn,
    next_number: Option<u64>,
    n_in_stage: u64,
    n_disconnected: u32,
}

/// Listens until the pendulum rests.
///
/// # Errors
/// Whatever comes before a release; what ends a swing early is told by [`End`].
pub fn listen(
    session: &mut Session,
    limits: Limits,
    listener: &mut dyn Listener,
    stop: &AtomicBool,
) -> Result<End, RecordError> {
    let settings = session.settings()?;
    session.start(Stream { raw: true, live_every: 0 })?;
    listener.stage(Stage::Settling);
    let mut swing = Swing { listening: Listening::new(settings, limits), listener };
    let end = swing.run(session, stop);
    // The link may be what broke, and then it can't be told to stop either.
    let _ = session.stop();
    end
}

/// One swing of a rig.
struct Swing<'a> {
    listening: Listening,
    listener: &'a mut dyn Listener,
}

impl Swing<'_> {
    fn run(&mut self, session: &mut Session, stop: &AtomicBool) -> Result<End, RecordError> {
        let mut heard = session.elapsed();
        loop {
            if stop.load(Ordering::Relaxed) {
                return self.ended_early(End::Stopped);
            }
            let port = session.port().to_owned();
            match session.receive(LOOK_EVERY) {
                Err(error) => return self.ended_early(End::Lost(error)),
                Ok(Some(Frame::Samples(samples))) if self.listening.is_begun_anew(&samples) => {
                    return self.ended_early(End::Lost(LinkError::Restarted { port }));
                }
                Ok(Some(Frame::Samples(samples))) => {
                    heard = session.elapsed();
                    if let Some(end) = self.listening.take(&samples, self.listener)? {
                        return Ok(end);
                    }
                    self.listener.pause();
                }
                Ok(_) if session.elapsed() > heard + patient(SILENCE) => {
                    return self.ended_early(End::Lost(LinkError::StreamStopped { port }));
                }
                Ok(_) => {}
            }
        }
    }

    fn ended_early(&self, end: End) -> Result<End, RecordError> {
        match (self.listening.detector.stage(), end) {
            (Stage::Swinging | Stage::AtRest, end) => Ok(end),
            (_, End::Lost(error)) => Err(error.into()),
            _ => Err(RecordError::StoppedEarly),
        }
    }
}

impl Listening {
    /// To a rig with these settings.
    pub fn new(settings: Settings, limits: Limits) -> Self {
        let rate_hz = f64::from(settings.rate_hz);
        let step_rad = f64::from(settings.sensor.step_rad());
        Self {
            reader: Reader::new(settings.sensor),
            settings,
            limits,
            detector: Detector::new(rate_hz, step_rad),
            lead_in: LeadIn::new((LEAD_IN_S * rate_hz) as usize),
            next_number: None,
            n_in_stage: 0,
            n_disconnected: 0,
        }
    }

    /// Do these samples come from before the last ones? Then the rig was started anew.
    pub fn is_begun_anew(&self, samples: &Samples) -> bool {
        self.next_number.is_some_and(|next| samples.first_sample < next)
    }

    /// Takes what came. Has the swing ended with it?
    ///
    /// # Errors
    /// Whatever comes before a release.
    pub fn take(&mut self, samples: &Samples, listener: &mut dyn Listener) -> Result<Option<End>, RecordError> {
        if self.next_number.is_some_and(|next| samples.first_sample > next) && self.detector.stage() == Stage::Swinging
        {
            listener.gap();
        }
        for (offset, code) in samples.codes.iter().enumerate() {
            let number = samples.first_sample.saturating_add(offset as u64);
            self.next_number = Some(number.saturating_add(1));
            if let Some(end) = self.take_sample(number, *code, listener)? {
                return Ok(Some(end));
            }
        }
        Ok(None)
    }

    fn take_sample(&mut self, number: u64, code: u16, listener: &mut dyn Listener) -> Result<Option<End>, RecordError> {
        let Some(Radian(angle_rad)) = self.reader.read(Code(code)) else { return self.pass_over(code) };
        let sample = Sample { number, angle_rad: f64::from(angle_rad), code };
        if std::mem::take(&mut self.n_disconnected) > 0 && self.detector.stage() == Stage::Swinging {
            listener.gap();
        }
        self.n_in_stage += 1;
        if let Some(stage) = self.detector.push(sample.angle_rad) {
            self.enter(stage, listener);
        }
        match self.detector.stage() {
            Stage::Settling | Stage::Waiting => self.lead_in.push(sample, self.detector.n_passages() > 0),
            Stage::Swinging | Stage::AtRest => listener.sample(sample),
        }
        self.patience()
    }

    fn enter(&mut self, stage: Stage, listener: &mut dyn Listener) {
        self.n_in_stage = 0;
        listener.stage(stage);
        while let (Stage::Swinging, Some(sample)) = (stage, self.lead_in.pop()) {
            listener.sample(sample);
        }
    }

    /// Leaves a reading at an end of the range out; many in a row end the swing.
    fn pass_over(&mut self, code: u16) -> Result<Option<End>, RecordError> {
        self.n_disconnected += 1;
        disconnected(&self.settings, self.detector.stage(), self.n_disconnected, code)
    }

    fn patience(&self) -> Result<Option<End>, RecordError> {
        self.limits.patience(&self.detector, self.n_in_stage as f64 / f64::from(self.settings.rate_hz))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::sensor::{Potentiometer, Sensor};
    use std::ops::Range;

    const POTENTIOMETER: Potentiometer = Potentiometer::nominal(4095);

    fn listening() -> Listening {
        let sensor = Sensor::Potentiometer(POTENTIOMETER);
        let settings = Settings { rate_hz: 1000.0, cutoff_hz: 50.0, bandwidth_rad_s: 3.0, sensor };
        Listening::new(settings, Limits::USUAL)
    }

    fn samples(number: u64, code: u16) -> Samples {
        Samples { sequence: 0, first_sample: number, status: 0, codes: [code].into_iter().collect() }
    }

    #[derive(Default)]
    struct Heard {
        stages: Vec<Stage>,
        n_readings: usize,
        n_gaps: usize,
    }

    impl Listener for Heard {
        fn stage(&mut self, stage: Stage) {
            self.stages.push(stage);
        }
        fn reading(&mut self, _: f64) {
            self.n_readings += 1;
        }
        fn gap(&mut self) {
            self.n_gaps += 1;
        }
        fn pause(&mut self) {}
    }

    /// Held at 1 rad for 3 s, then a damped swing of 1.3 Hz; some samples do not arrive, some read the end of the range.
    fn code(number: u64) -> u16 {
        let since_s = number as f32 / 1000.0 - 3.0;
        let swing_rad = (-0.3 * since_s).exp() * (std::f32::consts::TAU * 1.3 * since_s).cos();
        POTENTIOMETER.code(Radian(if since_s < 0.0 { 1.0 } else { swing_rad })).0
    }

    #[test]
    fn readings_are_told_from_the_hold_to_rest_and_gaps_within_the_swing() {
        let lost: [Range<u64>; 2] = [1000..1010, 5000..5010];
        let off: [Range<u64>; 3] = [2000..2005, 6000..6005, 7000..7001];
        let within = |ranges: &[Range<u64>], number: u64| ranges.iter().any(|range| range.contains(&number));
        let (mut listening, mut heard) = (listening(), Heard::default());
        let mut last = 0;
        let end = (0..60_000).filter(|number| !within(&lost, *number)).find_map(|number| {
            last = number;
            let code = if within(&off, number) { 0 } else { code(number) };
            listening.take(&samples(number, code), &mut heard).unwrap()
        });
        assert!(matches!(end, Some(End::AtRest)), "{end:?}");
        assert_eq!(heard.stages, [Stage::Waiting, Stage::Swinging, Stage::AtRest]);
        assert_eq!(heard.n_gaps, 3);
        // From 1.2 s before the first passage, which is a quarter of a period after the release, without those that are
        // missing in the swing.
        let begin = 3000.0 + 1000.0 / 1.3 / 4.0 - 1000.0 * LEAD_IN_S;
        let n_expected = last as f64 - begin - 16.0;
        assert!((heard.n_readings as f64 - n_expected).abs() < 5.0, "{} {n_expected}", heard.n_readings);
    }

    #[test]
    fn numbers_that_go_back_tell_of_a_rig_that_was_started_anew() {
        let mut listening = listening();
        assert!(!listening.is_begun_anew(&samples(0, 2048)));
        listening.take(&samples(7000, 2048), &mut Heard::default()).unwrap();
        assert!(listening.is_begun_anew(&samples(0, 2048)));
        assert!(listening.is_begun_anew(&samples(7000, 2048)));
        assert!(!listening.is_begun_anew(&samples(7001, 2048)) && !listening.is_begun_anew(&samples(9000, 2048)));
    }
}
