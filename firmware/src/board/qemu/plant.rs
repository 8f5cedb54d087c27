//! Samples from a simulated pendulum outside, which is also the clock: one code is one sample, however long it takes.
//!
//! A code is two bytes, the first with its top bit set: 1hhhhhhh 0lllllll, high and low seven bits of fourteen. A
//! byte that is lost costs one sample and nothing else. For every sixteen codes taken one byte goes back, so that the
//! pendulum never runs far ahead of the firmware; a zero says that the firmware starts, before which it hears nothing.

use super::usart::{Receiver, Sender};
use embedded_io_async::{Read, Write};
use firmware::ports::{BATCH, Batch, Sampler};
use shared::sensor::Sensor;
use shared::units::Code;

/// Samples acknowledged by one byte.
const SAMPLES_PER_CREDIT: u32 = 16;

const FIRST: u8 = 0x80;

const STARTS: u8 = 0;

/// The pendulum's end of the line.
pub struct Plant {
    codes: Receiver,
    credits: Sender,
    high: Option<u8>,
    uncredited: u32,
    has_started: bool,
}

impl Plant {
    /// On the two directions of a serial port.
    pub fn new(codes: Receiver, credits: Sender) -> Self {
        Self { codes, credits, high: None, uncredited: 0, has_started: false }
    }

    fn push(&mut self, byte: u8, batch: &mut Batch) {
        if byte & FIRST != 0 {
            self.high = Some(byte & !FIRST);
        } else if let Some(high) = self.high.take() {
            // As many bytes were read as can make codes that fit.
            let _ = batch.codes.push(Code(u16::from(high) << 7 | u16::from(byte)));
        }
    }
}

impl Sampler for Plant {
    /// The pendulum outside is the clock.
    fn nearest_rate(rate_hz: f32) -> f32 {
        rate_hz
    }

    /// Fourteen bits of a code come through, enough for a potentiometer.
    fn can_read(sensor: &Sensor) -> bool {
        matches!(sensor, Sensor::Potentiometer(_))
    }

    fn start(&mut self, _: &Sensor, _: f32) {}

    async fn next(&mut self) -> Batch {
        if !self.has_started {
            self.has_started = true;
            let Ok(()) = self.credits.write_all(&[STARTS]).await;
        }
        let mut batch = Batch::default();
        let mut bytes = [0; BATCH];
        let Ok(n_bytes) = self.codes.read(&mut bytes).await;
        bytes[..n_bytes].iter().for_each(|byte| self.push(*byte, &mut batch));
        self.uncredited += batch.codes.len() as u32;
        while self.uncredited >= SAMPLES_PER_CREDIT {
            self.uncredited -= SAMPLES_PER_CREDIT;
            let Ok(()) = self.credits.write_all(&[SAMPLES_PER_CREDIT as u8]).await;
        }
        batch
    }
}
