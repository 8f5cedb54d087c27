//! A link that loses and garbles bytes: commands get through, streams account for what is missing.

use host::link::{LinkError, Port, Session};
use host::sim::{Scenario, SimulatedRig};
use shared::parameters::Parameters;
use shared::wire::{Frame, Stream};
use std::io;
use std::time::Duration;

/// The simulated rig on a bad cable.
struct BadCable {
    rig: SimulatedRig,
    /// Every so many bytes one arrives changed, either way.
    period: u32,
    n_passed: u32,
}

impl BadCable {
    fn new(period: u32) -> Box<Self> {
        let rig = SimulatedRig::new(Scenario::by_name("plain").unwrap(), 1);
        Box::new(Self { rig, period, n_passed: 0 })
    }

    fn spoil(&mut self, byte: u8) -> u8 {
        self.n_passed += 1;
        if self.n_passed.is_multiple_of(self.period) { byte ^ 0x10 } else { byte }
    }
}

impl Port for BadCable {
    fn name(&self) -> &str {
        "bad-cable"
    }

    fn read(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let n_bytes = self.rig.read(buffer, timeout);
        for slot in &mut buffer[..n_bytes] {
            *slot = self.spoil(*slot);
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
    let mut session = Session::open(BadCable::new(997)).unwrap().keeping_in(None);
    let parameters = Parameters::paper();
    for _ in 0..20 {
        session.push(&parameters).unwrap();
    }
}

#[test]
fn lost_frames_and_samples_are_counted_exactly() {
    let mut session = Session::open(BadCable::new(997)).unwrap();
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
fn a_cable_that_garbles_every_frame_lets_no_greeting_through() {
    let Err(error) = Session::open(BadCable::new(7)) else { panic!("opened") };
    assert!(matches!(error, LinkError::Silent { .. } | LinkError::Stranger { .. }), "{error}");
}
