//! The simulated rig: the board's own program ([`shared::rig::Rig`]) on a simulated bench, so that every command works
//! without hardware.
//!
//! Real frames as bytes both ways. It is deterministic and has no clock of its own: a command is carried out when its
//! bytes come in, and time goes on by one sample whenever somebody waits for bytes.

mod bench;
mod looks;
mod scenario;

pub use scenario::Scenario;

use bench::Bench;
use looks::Looks;
use shared::potentiometer::FULL_SCALE_12_BIT;
use shared::rig::{Finished, MAX_STORED, Outcome, Request, Rig, Stored};
use shared::wire::{self, Command, Deframer, Frame, MAX_FRAME, Refusal, StoreState};
use std::collections::VecDeque;
use std::time::Duration;

/// What the simulated rig says its name is.
const NAME: &str = "simulated-rig";

/// A rig, its pendulum, and the student who lets it go.
pub struct SimulatedRig {
    rig: Rig,
    bench: Bench,
    /// None with firmware that does not look by itself.
    looks: Option<Looks>,
    deframer: Deframer,
    output: VecDeque<u8>,
    flash: Option<Vec<u8>>,
    elapsed_s: f64,
}

impl SimulatedRig {
    /// A rig with empty flash, or with the bench's sensor in it; equal seeds give equal noise.
    pub fn new(scenario: &Scenario, seed: u64) -> Self {
        let rig = Rig::new(NAME, FULL_SCALE_12_BIT, Err(StoreState::Empty));
        let bench = Bench::new(scenario, seed);
        let looks = scenario.looks.then(|| Looks::new(&rig));
        let (deframer, output) = (Deframer::new(), VecDeque::new());
        let mut new = Self { rig, bench, looks, deframer, output, flash: None, elapsed_s: 0.0 };
        if let Some(sensor) = scenario.sensor {
            let settings = new.rig.settings().with_sensor(sensor);
            new.keep(&Stored { settings, ..new.rig.stored() });
            new.restart();
        }
        new
    }

    /// Takes bytes from the PC; answers are in the output at once.
    pub fn receive(&mut self, bytes: &[u8]) {
        for byte in bytes {
            match self.deframer.push(*byte) {
                None => {}
                Some(Ok(frame)) => self.on_frame(frame),
                Some(Err(_)) => self.rig.on_bad_frame(),
            }
        }
    }

    /// Takes one sample; frames that are complete are in the output.
    pub fn sample(&mut self) {
        let dt_s = 1.0 / f64::from(self.rig.settings().rate_hz);
        let code = self.bench.sample(&self.rig.settings().sensor, dt_s);
        let output = &mut self.output;
        self.rig.on_sample(code, |frame| put(output, &frame));
        if let Some(looks) = &mut self.looks {
            looks.take(code, &self.rig);
        }
        self.elapsed_s += dt_s;
    }

    /// Bytes for the PC into `buffer`; without any, simulated time goes on until there are some or it is over. Gives
    /// how many.
    pub fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> usize {
        let until_s = self.elapsed_s + timeout.as_secs_f64();
        while self.output.is_empty() && self.elapsed_s < until_s {
            self.sample();
        }
        let n_bytes = self.output.len().min(buffer.len());
        self.output.drain(..n_bytes).zip(buffer).for_each(|(byte, slot)| *slot = byte);
        n_bytes
    }

    /// Bytes for the PC.
    pub fn output(&mut self) -> &mut VecDeque<u8> {
        &mut self.output
    }

    /// Simulated seconds since power-up.
    pub fn elapsed_s(&self) -> f64 {
        self.elapsed_s
    }

    fn on_frame(&mut self, frame: Frame) {
        // The student sets the pendulum up anew whenever a stream is asked for.
        if let Frame::Command(_, Command::Start(_)) = frame {
            self.bench.set_up_next_swing();
        }
        match self.rig.on_frame(frame) {
            Outcome::Nothing => {}
            Outcome::Send(frame) => put(&mut self.output, &frame),
            Outcome::SendThenDo(frame, _) => {
                put(&mut self.output, &frame);
                self.restart();
            }
            Outcome::Do(number, request) => {
                let finished = self.carry_out(request);
                let answer = self.rig.finished(number, finished);
                put(&mut self.output, &answer);
            }
        }
        if let Some(looks) = &mut self.looks {
            looks.notice_changes(&self.rig);
        }
    }

    fn carry_out(&mut self, request: Request) -> Finished {
        match request {
            Request::Save => self.keep(&self.rig.stored()),
            Request::Load => match self.stored() {
                Ok(stored) => Finished::Loaded(stored),
                Err(_) => Finished::Failed(Refusal::NothingStored),
            },
            Request::Suspects => match &mut self.looks {
                Some(looks) => Finished::Suspects(looks.answer()),
                // What it sends is looked at by the program.
                None => Finished::Failed(Refusal::NotHere),
            },
            Request::SetRate(_) | Request::Reset | Request::Bootloader => Finished::Done,
        }
    }

    fn keep(&mut self, stored: &Stored) -> Finished {
        let mut buffer = [0; MAX_STORED];
        match stored.encode(&mut buffer) {
            Some(bytes) => self.flash = Some(bytes.to_vec()),
            None => return Finished::Failed(Refusal::Flash),
        }
        Finished::Done
    }

    fn stored(&self) -> Result<Stored, StoreState> {
        Stored::decode(self.flash.as_ref().ok_or(StoreState::Empty)?)
    }

    fn restart(&mut self) {
        self.rig = Rig::new(NAME, FULL_SCALE_12_BIT, self.stored());
        self.looks = self.looks.is_some().then(|| Looks::new(&self.rig));
    }
}

fn put(output: &mut VecDeque<u8>, frame: &Frame) {
    let mut buffer = [0; MAX_FRAME];
    output.extend(wire::encode(frame, &mut buffer).expect("every frame fits the longest"));
}

#[cfg(test)]
mod tests;
