//! A link that loses and garbles bytes: commands get through, streams account for what is missing.

use host::link::{LinkError, Port, Session};
use host::sim::{Noise, Scenario, SimulatedRig};
use shared::parameters::Parameters;
use shared::wire::{Frame, Stream};
use std::io;
use std::time::Duration;

/// The simulated rig on a bad cable.
struct BadCable {
    rig: SimulatedRig,
    noise: Noise,
    /// Share of bytes that arrive changed, either way.
    garbled: f64,
}

impl BadCable {
    fn new(garbled: f64) -> Box<Self> {
        let rig = SimulatedRig::new(Scenario::by_name("plain").unwrap(), 1);
        Box::new(Self { rig, noise: Noise::new(9), garbled })
    }

    fn spoil(&mut self, byte: u8) -> u8 {
        // A normal number beyond 2.58 standard deviations comes once in 100.
        let hit = self.garbled > 0.0 && self.noise.normal().abs() > 2.58 && self.noise.normal().abs() < self.garbled;
        if hit { byte ^ 0x10 } else { byte }
    }
}

impl Port for BadCable {
    fn name(&self) -> &str {
        "bad-cable"
    }

    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let until_s = self.rig.elapsed_s() + timeout.as_secs_f64();
        while self.rig.output().is_empty() && self.rig.elapsed_s() < until_s {
            self.rig.sample();
        }
        let n_bytes = self.rig.output().len().min(buffer.len());
        for slot in &mut buffer[..n_bytes] {
            let byte = self.rig.output().pop_front().unwrap_or_default();
            *slot = self.spoil(byte);
        }
        Ok(n_bytes)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        let spoilt: Vec<u8> = bytes.iter().map(|byte| self.spoil(*byte)).collect();
        self.rig.receive(&spoilt);
        Ok(())
    }

    fn elapsed(&self) -> Duration {
        Duration::from_secs_f64(self.rig.elapsed_s())
    }
}

#[test]
fn commands_get_through_a_cable_that_garbles_one_byte_in_a_thousand() {
    let mut session = Session::open(BadCable::new(0.13)).unwrap();
    let parameters = Parameters::paper();
    for _ in 0..20 {
        session.push(&parameters).unwrap();
    }
}

#[test]
fn lost_frames_and_samples_are_counted_exactly() {
    let mut session = Session::open(BadCable::new(0.13)).unwrap();
    session.start(Stream { raw: true, live_every: 0 }).unwrap();
    let (mut n_codes, mut first, mut last) = (0, None, 0);
    while n_codes < 50_000 {
        if let Some(Frame::Samples(samples)) = session.receive(Duration::from_secs(1)).unwrap() {
            n_codes += samples.codes.len() as u64;
            first = first.or(Some(samples.first_sample));
            last = samples.first_sample + samples.codes.len() as u64;
        }
    }
    let tally = session.tally();
    assert!(tally.frames_lost > 10, "{tally:?}");
    assert_eq!(tally.samples_lost, last - first.unwrap() - n_codes);
    assert_eq!(tally.samples_lost, 16 * tally.frames_lost);
}

#[test]
fn a_cable_that_garbles_everything_is_no_rig() {
    let Err(error) = Session::open(BadCable::new(f64::INFINITY)) else { return };
    assert!(matches!(error, LinkError::Stranger { .. }), "{error}");
}
