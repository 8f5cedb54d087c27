//! The board's application behind codes that a test makes: a potentiometer as one wishes, at a port.

use host::link::Port;
use shared::potentiometer::FULL_SCALE_12_BIT;
use shared::rig::{Finished, Outcome, Rig};
use shared::units::Code;
use shared::wire::{Deframer, Frame, MAX_FRAME, StoreState, encode};
use std::collections::VecDeque;
use std::io;
use std::time::Duration;

/// A rig whose converter reads `code` of the seconds since it was plugged in; its clock is that of its samples.
pub struct Coded<F> {
    rig: Rig,
    code: F,
    deframer: Deframer,
    output: VecDeque<u8>,
    elapsed_s: f64,
}

impl<F: FnMut(f64) -> u16> Coded<F> {
    /// Nothing is in its flash.
    pub fn new(code: F) -> Self {
        let rig = Rig::new("coded", FULL_SCALE_12_BIT, Err(StoreState::Empty));
        Self { rig, code, deframer: Deframer::new(), output: VecDeque::new(), elapsed_s: 0.0 }
    }

    fn sample(&mut self) {
        let (rig, output) = (&mut self.rig, &mut self.output);
        rig.on_sample(Code((self.code)(self.elapsed_s)), |frame| put(output, &frame));
        self.elapsed_s += 1.0 / f64::from(self.rig.settings().rate_hz);
    }

    fn receive(&mut self, byte: u8) {
        let Some(Ok(frame)) = self.deframer.push(byte) else { return };
        match self.rig.on_frame(frame) {
            Outcome::Nothing => {}
            Outcome::Send(frame) | Outcome::SendThenDo(frame, _) => put(&mut self.output, &frame),
            Outcome::Do(number, _) => {
                let answer = self.rig.finished(number, Finished::Done);
                put(&mut self.output, &answer);
            }
        }
    }
}

fn put(output: &mut VecDeque<u8>, frame: &Frame) {
    output.extend(encode(frame, &mut [0; MAX_FRAME]).expect("every frame fits the longest"));
}

impl<F: FnMut(f64) -> u16> Port for Coded<F> {
    fn name(&self) -> &str {
        "coded"
    }

    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let until_s = self.elapsed_s + timeout.as_secs_f64();
        while self.output.is_empty() && self.elapsed_s < until_s {
            self.sample();
        }
        let n_bytes = self.output.len().min(buffer.len());
        self.output.drain(..n_bytes).zip(buffer).for_each(|(byte, slot)| *slot = byte);
        Ok(n_bytes)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        bytes.iter().for_each(|byte| self.receive(*byte));
        Ok(())
    }

    fn elapsed(&self) -> Duration {
        Duration::from_secs_f64(self.elapsed_s)
    }
}
