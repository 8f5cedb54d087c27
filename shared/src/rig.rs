//! The application on the board, without input, output or clock: codes in, frames out, commands in, answers out.
//!
//! Firmware, simulated rig and tests run this same code. What needs the board (flash, sampling rate, reset) comes out
//! as a [`Request`]; the board carries it out and reports back with [`Rig::finished`].

use crate::filter::{Butterworth, FilterState};
use crate::motion::Pendulum;
use crate::observer::{Estimate, Observer};
use crate::parameters::Parameters;
use crate::sensor::{NoGain, Potentiometer, Reader, Sensor};
use crate::units::{Code, Radian};
use crate::wire::{
    Answer, Chip, Command, Frame, Health, Hello, Live, PROTOCOL, Point, Refusal, Samples, Settings, Statistics,
    StoreState, Stream, Suspects, status,
};
use core::f32::consts::TAU;
use heapless::Vec;
use laws::Laws;
use settings::{SENSOR, check_settings};

mod laws;
mod settings;
mod stored;

pub use settings::{HIGHEST_BANDWIDTH_RAD_S, HIGHEST_CUTOFF, HIGHEST_RATE_HZ, LOWEST_RATE_HZ};
pub use stored::{MAX_STORED, Stored};

/// For calibration: codes are averaged with this time constant.
const AVERAGING_S: f32 = 0.25;

/// What the rig asks of its board.
#[derive(Clone, Debug, PartialEq)]
pub enum Request {
    /// Write [`Rig::stored`] to flash and read it back.
    Save,
    /// Read flash.
    Load,
    /// Sample at this rate, and with the sensor of the settings, from now on.
    SetRate(f32),
    /// Say what was found missing in the model.
    Suspects,
    /// Restart.
    Reset,
    /// Restart into the chip's bootloader.
    Bootloader,
}

/// How a [`Request`] ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Finished {
    /// As asked.
    Done,
    /// It samples at this rate now, the nearest to what was asked for.
    Sampling(f32),
    /// Flash held this.
    Loaded(Stored),
    /// This was found.
    Suspects(Suspects),
    /// Not done.
    Failed(Refusal),
}

/// What a received frame leads to.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// Send this.
    Send(Frame),
    /// Send this, then do that.
    SendThenDo(Frame, Request),
    /// Do that, then send what [`Rig::finished`] gives for the number.
    Do(u16, Request),
    /// Nothing to do.
    Nothing,
}

/// The pendulum rig.
pub struct Rig {
    hello: Hello,
    /// The converter's largest code.
    full_scale: u16,
    parameters: Parameters<f32>,
    /// For the next parameters that contain their effects.
    laws: Laws,
    settings: Settings,
    reader: Reader,
    filter: Butterworth<f32>,
    filter_state: Option<FilterState<f32>>,
    /// How long there has been no angle, s.
    unseen_s: f32,
    observer: Observer<f32>,
    stream: Option<Stream>,
    raw: Samples,
    live: Live,
    until_point: u16,
    next_sample: u64,
    position: i32,
    /// Mean of the codes beyond the last position: far from zero an `f32` has too few digits for the mean itself.
    mean_ahead: f32,
    mean_square_code: f32,
    refused_protocol: Option<u16>,
    statistics: Statistics,
    chip: Chip,
    n_models: u32,
}

impl Rig {
    /// A rig called `name` with what its flash held. `full_scale` is its converter's largest code.
    pub fn new(name: &str, full_scale: u16, stored: Result<Stored, StoreState>) -> Self {
        let (store, in_use) = match stored {
            Ok(stored) => (StoreState::Loaded, stored),
            Err(reason) => (reason, defaults(full_scale)),
        };
        let settings = in_use.settings.with_sensor(in_use.settings.sensor.at_power_up());
        let statistics = Statistics { health: Health { store, ..Health::default() }, ..Statistics::default() };
        let observer = Observer::new(&in_use.parameters, in_use.settings.bandwidth_rad_s);
        let mut rig = Self {
            hello: Hello::new(name),
            full_scale,
            laws: Laws::of(&in_use.parameters),
            parameters: in_use.parameters,
            settings,
            reader: Reader::new(settings.sensor),
            filter: filter_of(&default_settings(full_scale)),
            filter_state: None,
            unseen_s: 0.0,
            observer,
            stream: None,
            raw: empty_samples(),
            live: empty_live(),
            until_point: 0,
            next_sample: 0,
            position: 0,
            mean_ahead: 0.0,
            mean_square_code: 0.0,
            refused_protocol: None,
            statistics,
            chip: Chip::default(),
            n_models: 0,
        };
        rig.use_settings(settings);
        rig
    }

    /// Settings and calibration in use.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Parameters in use.
    pub fn parameters(&self) -> &Parameters<f32> {
        &self.parameters
    }

    /// What a save keeps.
    pub fn stored(&self) -> Stored {
        Stored { parameters: self.parameters.clone(), settings: self.settings }
    }

    /// The counters that only the board can fill.
    pub fn health(&mut self) -> &mut Health {
        &mut self.statistics.health
    }

    /// What only the board can say of its chip.
    pub fn chip(&mut self) -> &mut Chip {
        &mut self.chip
    }

    /// Does somebody listen to samples or points?
    pub fn is_streaming(&self) -> bool {
        self.stream.is_some()
    }

    /// How often other parameters came into use.
    pub fn n_models(&self) -> u32 {
        self.n_models
    }

    /// Makes the sample counter start elsewhere, to test its limits.
    pub fn start_counting_at(&mut self, sample: u64) {
        self.next_sample = sample;
    }

    // --- samples ---

    /// Takes the next code; `send` is called with each frame that is complete.
    pub fn on_sample(&mut self, code: Code, mut send: impl FnMut(Frame)) {
        let sample = self.next_sample;
        self.next_sample = sample.wrapping_add(1);
        self.statistics.samples += 1;
        let position = self.reader.follow(code);
        self.average(position);

        let connected = self.settings.sensor.is_connected(code);
        let dt_s = 1.0 / self.settings.rate_hz;
        let (filtered_rad, estimate) = if connected { self.observe(position, dt_s) } else { self.coast(dt_s) };
        if !connected {
            self.statistics.disconnected += 1;
            self.raw.status |= status::DISCONNECTED;
            self.live.status |= status::DISCONNECTED;
        }

        let Some(stream) = self.stream else { return };
        if stream.raw {
            self.add_code(sample, code, &mut send);
        }
        if stream.live_every > 0 {
            self.add_point(sample, stream.live_every, filtered_rad, estimate, &mut send);
        }
    }

    /// Accounts for samples that the converter could not deliver: time goes on without them. `send` is called with the
    /// frames that were begun before them, because a frame holds samples without a gap.
    pub fn on_samples_lost(&mut self, count: u32, by_overrun: bool, mut send: impl FnMut(Frame)) {
        let counter = if by_overrun { &mut self.statistics.overruns } else { &mut self.statistics.paused };
        *counter = counter.saturating_add(count);
        self.next_sample = self.next_sample.wrapping_add(u64::from(count));
        if self.stream.is_some() {
            self.send_begun(&mut send);
        }
        self.raw.status |= status::SAMPLES_LOST;
        self.live.status |= status::SAMPLES_LOST;
        self.until_point = 0;
        let lost_s = count as f32 / self.settings.rate_hz;
        self.unseen_s += lost_s;
        self.observer.on_gap(lost_s);
    }

    /// Accounts for a frame that the link did not take.
    pub fn on_frame_dropped(&mut self) {
        self.statistics.dropped_frames = self.statistics.dropped_frames.saturating_add(1);
        self.raw.status |= status::FRAMES_DROPPED;
        self.live.status |= status::FRAMES_DROPPED;
    }

    /// Accounts for received bytes that were no frame.
    pub fn on_bad_frame(&mut self) {
        self.statistics.bad_frames = self.statistics.bad_frames.saturating_add(1);
    }

    fn observe(&mut self, position: i32, dt_s: f32) -> (f32, Estimate<f32>) {
        let Radian(angle_rad) = self.settings.sensor.angle_at(position);
        // Beyond its time constant what the filter remembers is not where the pendulum is.
        if self.unseen_s * TAU * self.settings.cutoff_hz > 1.0 {
            self.filter_state = None;
        }
        self.unseen_s = 0.0;
        let filter_state = self.filter_state.get_or_insert(FilterState::settled_at(angle_rad));
        (filter_state.step(&self.filter, angle_rad), self.observer.on_measurement(angle_rad, dt_s))
    }

    /// Without a usable measurement the model goes on alone.
    fn coast(&mut self, dt_s: f32) -> (f32, Estimate<f32>) {
        self.unseen_s += dt_s;
        let estimate = self.observer.on_gap(dt_s);
        (estimate.angle_rad, estimate)
    }

    fn average(&mut self, position: i32) {
        let share = 1.0 / (AVERAGING_S * self.settings.rate_hz);
        let deviation = position.wrapping_sub(self.position) as f32 - self.mean_ahead;
        self.position = position;
        self.mean_ahead = (share - 1.0) * deviation;
        self.mean_square_code += share * (deviation * deviation - self.mean_square_code);
    }

    /// The mean of the last codes.
    fn mean_code(&self) -> f32 {
        self.position as f32 + self.mean_ahead
    }

    fn add_code(&mut self, sample: u64, code: Code, send: &mut impl FnMut(Frame)) {
        if self.raw.codes.is_empty() {
            self.raw.first_sample = sample;
        }
        // A full frame is sent and emptied at once, so there is always room.
        let _ = self.raw.codes.push(code.0);
        if self.raw.codes.is_full() {
            self.send_raw(send);
        }
    }

    fn add_point(
        &mut self,
        sample: u64,
        every: u16,
        filtered_rad: f32,
        estimate: Estimate<f32>,
        send: &mut impl FnMut(Frame),
    ) {
        if self.until_point > 0 {
            self.until_point -= 1;
            return;
        }
        self.until_point = every - 1;
        if self.live.points.is_empty() {
            self.live.first_sample = sample;
        }
        let _ = self.live.points.push(Point {
            filtered_rad,
            angle_rad: estimate.angle_rad,
            velocity_rad_s: estimate.velocity_rad_s,
            innovation_rad: estimate.innovation_rad,
            friction_nm: estimate.friction_nm,
        });
        if self.live.points.is_full() {
            self.send_live(send);
        }
    }

    fn send_begun(&mut self, send: &mut impl FnMut(Frame)) {
        if !self.raw.codes.is_empty() {
            self.send_raw(send);
        }
        if !self.live.points.is_empty() {
            self.send_live(send);
        }
    }

    fn send_raw(&mut self, send: &mut impl FnMut(Frame)) {
        let fresh = Samples { sequence: self.raw.sequence.wrapping_add(1), ..empty_samples() };
        send(Frame::Samples(core::mem::replace(&mut self.raw, fresh)));
    }

    fn send_live(&mut self, send: &mut impl FnMut(Frame)) {
        let fresh = Live { sequence: self.live.sequence.wrapping_add(1), every: self.live.every, ..empty_live() };
        send(Frame::Live(core::mem::replace(&mut self.live, fresh)));
    }

    // --- commands ---

    /// Takes a received frame.
    pub fn on_frame(&mut self, frame: Frame) -> Outcome {
        match frame {
            Frame::Hello(hello) => {
                self.refused_protocol = (hello.protocol != PROTOCOL).then_some(hello.protocol);
                // A new session starts quiet, whatever the one before left running.
                self.stream = None;
                let protocol = self.settings.sensor.protocol();
                Outcome::Send(Frame::Hello(Hello { protocol, ..self.hello.clone() }))
            }
            Frame::Command(number, command) => match self.refused_protocol {
                Some(host) => refuse(number, Refusal::Protocol { host, rig: PROTOCOL }),
                None => self.on_command(number, command),
            },
            Frame::CustomFormula(bytes) => held(self.laws.take_formula(&bytes).map(Frame::CustomFormula)),
            Frame::FrictionCurve(knots) => held(self.laws.take_curve(&knots).map(Frame::FrictionCurve)),
            Frame::Answer(..) | Frame::Samples(_) | Frame::Live(_) => Outcome::Nothing,
        }
    }

    fn on_command(&mut self, number: u16, command: Command) -> Outcome {
        let done = Outcome::Send(Frame::Answer(number, Answer::Done));
        match command {
            Command::Start(stream) => {
                self.start(stream);
                done
            }
            Command::Stop => {
                self.stream = None;
                done
            }
            Command::GetParameters => answer(number, Answer::Parameters((&self.parameters).into())),
            Command::SetParameters(numbers) => {
                let parameters = self.laws.complete(numbers);
                match parameters.check() {
                    Ok(()) => {
                        self.use_parameters(parameters);
                        done
                    }
                    Err(error) => refuse(number, Refusal::Parameters(error)),
                }
            }
            Command::GetSettings => answer(number, Answer::Settings(self.settings)),
            Command::SetSettings(settings) => self.set_settings(number, settings),
            Command::Save => Outcome::Do(number, Request::Save),
            Command::Load => Outcome::Do(number, Request::Load),
            Command::Defaults => {
                let defaults = defaults(self.full_scale);
                self.use_parameters(defaults.parameters);
                self.set_settings(number, defaults.settings)
            }
            Command::ZeroHere => self.calibrate(number, |sensor, mean_code| Ok(sensor.with_zero(mean_code))),
            Command::CalibrateGain(angle) => self.calibrate(number, |sensor, mean_code| {
                sensor.with_gain(mean_code, angle).map_err(|reason| match reason {
                    NoGain::Known => Refusal::GainIsKnown,
                    NoGain::Absurd => Refusal::BadAngle,
                })
            }),
            Command::Statistics => answer(number, Answer::Statistics(self.statistics_now())),
            Command::Chip => answer(number, Answer::Chip(self.chip.clone())),
            Command::Suspects => Outcome::Do(number, Request::Suspects),
            Command::Reset => Outcome::SendThenDo(Frame::Answer(number, Answer::Done), Request::Reset),
            Command::Bootloader => Outcome::SendThenDo(Frame::Answer(number, Answer::Done), Request::Bootloader),
        }
    }

    /// The answer to the command `number`, once the board has carried out its request.
    pub fn finished(&mut self, number: u16, finished: Finished) -> Frame {
        let answer = match finished {
            Finished::Done => Answer::Done,
            Finished::Sampling(rate_hz) => {
                self.use_settings(self.settings.at_rate(rate_hz));
                Answer::Done
            }
            Finished::Failed(refusal) => Answer::Refused(refusal),
            Finished::Suspects(suspects) => Answer::Suspects(suspects),
            Finished::Loaded(stored) => {
                self.laws = Laws::of(&stored.parameters);
                self.use_parameters(stored.parameters);
                let sensor = stored.settings.sensor.taken_over(&self.settings.sensor);
                self.use_settings(stored.settings.with_sensor(sensor));
                Answer::Done
            }
        };
        Frame::Answer(number, answer)
    }

    fn start(&mut self, stream: Stream) {
        self.raw = empty_samples();
        self.live = Live { every: stream.live_every, ..empty_live() };
        self.until_point = 0;
        self.stream = Some(stream);
    }

    fn use_parameters(&mut self, parameters: Parameters<f32>) {
        self.observer.set_parameters(&parameters);
        self.parameters = parameters;
        self.n_models = self.n_models.wrapping_add(1);
    }

    fn set_settings(&mut self, number: u16, settings: Settings) -> Outcome {
        if let Err(index) = check_settings(&settings) {
            return refuse(number, Refusal::Setting { index });
        }
        // A sensor with ends is read by the rig's own converter.
        if settings.sensor.span().is_none() && settings.sensor.full_scale() != self.full_scale {
            return refuse(number, Refusal::Setting { index: SENSOR });
        }
        let is_new = settings.rate_hz != self.settings.rate_hz || !settings.sensor.is_like(&self.settings.sensor);
        self.use_settings(settings);
        if is_new { Outcome::Do(number, Request::SetRate(settings.rate_hz)) } else { answer(number, Answer::Done) }
    }

    fn use_settings(&mut self, settings: Settings) {
        self.filter = filter_of(&settings);
        self.filter_state = None;
        self.observer.set_bandwidth(settings.bandwidth_rad_s);
        if settings.sensor != self.settings.sensor {
            self.reader = Reader::new(settings.sensor);
            self.observer.begin_anew();
        }
        self.settings = settings;
    }

    fn calibrate(&mut self, number: u16, compute: impl FnOnce(Sensor, f32) -> Result<Sensor, Refusal>) -> Outcome {
        let sensor = self.settings.sensor;
        let still = self.mean_square_code < sensor.still_codes() * sensor.still_codes();
        let mean_code = self.mean_code();
        let computed = match () {
            () if !still => Err(Refusal::NotStill),
            () if !sensor.is_connected(Code(mean_code as u16)) => Err(Refusal::SensorDisconnected),
            () => compute(sensor, mean_code),
        };
        match computed {
            Err(refusal) => refuse(number, refusal),
            Ok(sensor) => self.set_settings(number, self.settings.with_sensor(sensor)),
        }
    }

    fn statistics_now(&self) -> Statistics {
        Statistics { innovation_rms_rad: self.observer.innovation_rms_rad(), ..self.statistics.clone() }
    }
}

fn answer(number: u16, answer: Answer) -> Outcome {
    Outcome::Send(Frame::Answer(number, answer))
}

/// A law that is held now, or why it is not.
fn held(law: Result<Frame, Refusal>) -> Outcome {
    law.map_or_else(|refusal| refuse(0, refusal), Outcome::Send)
}

fn refuse(number: u16, refusal: Refusal) -> Outcome {
    answer(number, Answer::Refused(refusal))
}

fn empty_samples() -> Samples {
    Samples { sequence: 0, first_sample: 0, status: 0, codes: Vec::new() }
}

fn empty_live() -> Live {
    Live { sequence: 0, first_sample: 0, every: 0, status: 0, points: Vec::new() }
}

/// What a rig with an empty flash uses.
fn defaults(full_scale: u16) -> Stored {
    Stored { parameters: default_parameters(), settings: default_settings(full_scale) }
}

/// The defaults: the paper's pendulum with the inertia of its CAD drawing and the middle of its Table 2.
fn default_parameters() -> Parameters<f32> {
    let mut parameters = Parameters::frictionless(Pendulum::paper());
    parameters.set_friction(5.5e-4, 5.5e-4, 5.5e-3, 0.03);
    parameters
}

fn default_settings(full_scale: u16) -> Settings {
    let sensor = Potentiometer::nominal(full_scale).into();
    Settings { rate_hz: 1000.0, cutoff_hz: 50.0, bandwidth_rad_s: 3.0, sensor }
}

/// The filter of checked settings.
fn filter_of(settings: &Settings) -> Butterworth<f32> {
    Butterworth::new(settings.cutoff_hz, settings.rate_hz).expect("settings are checked before use")
}

#[cfg(test)]
mod tests;
