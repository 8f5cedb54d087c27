//! The firmware in QEMU for a long time of the clock on the wall: every sample arrives once, in order and as it was,
//! the sample counter passes 32 bits, nothing grows. `SOAK_S=3600` makes it an hour.
#![cfg(unix)]

use shared::wire::{Answer, Command, Frame, Statistics, Stream};
use std::collections::VecDeque;
use std::time::{Duration, Instant};
use tests::image::{Board, firmware};
use tests::link::Link;
use tests::memory;
use tests::plant::{Plant, Scenario};
use tests::qemu::Qemu;

/// Seconds.
const SECONDS: u64 = 15;

/// The counter begins so many samples below 32 bits.
const BELOW: u64 = 5_000;

const LIVE_EVERY: u16 = 10;

/// Memory of this process may grow by this much.
const MOST_GROWTH: u64 = 16 << 20;

/// Samples that may be on their way between pendulum and PC, in seconds.
const ON_THE_WAY_S: f64 = 1.0;

/// A code that comes before the firmware has opened the pendulum's serial port is lost in it; the port holds one.
const LOST_AT_POWER_UP: usize = 1;

/// Checks a stream against the pendulum that it came from.
struct Listener {
    plant: Plant,
    /// Codes of the pendulum that are expected next, before it is asked for more.
    ahead: VecDeque<u16>,
    next_sample: Option<u64>,
    n_samples: u64,
    n_points: u64,
    n_frames: u64,
}

impl Listener {
    /// For a stream in which sample `k + shift` is the pendulum's `k`th, or the next if one was lost at power-up.
    fn take(&mut self, frame: &Frame, shift: u64) {
        match frame {
            Frame::Samples(samples) => {
                if self.next_sample.is_none() {
                    self.go_to((samples.first_sample - shift) as usize, &samples.codes);
                }
                let next = *self.next_sample.get_or_insert(samples.first_sample);
                assert_eq!((samples.first_sample, samples.status), (next, 0));
                assert_eq!(u64::from(samples.sequence), self.n_samples / 16);
                for code in &samples.codes {
                    let expected = self.ahead.pop_front().unwrap_or_else(|| self.plant.next_code().0);
                    assert_eq!(*code, expected, "sample {next} and those behind it");
                }
                self.n_samples += samples.codes.len() as u64;
                self.next_sample = Some(next + samples.codes.len() as u64);
            }
            Frame::Live(live) => self.n_points += live.points.len() as u64,
            _ => return,
        }
        self.n_frames += 1;
    }

    /// Goes to the pendulum's sample with this number, or the next, from where it gave these codes.
    fn go_to(&mut self, number: usize, codes: &[u16]) {
        let given: Vec<u16> = (0..number + LOST_AT_POWER_UP + codes.len()).map(|_| self.plant.next_code().0).collect();
        let mut places = number..=number + LOST_AT_POWER_UP;
        let place = places.find(|place| given[*place..].starts_with(codes));
        let place = place.unwrap_or_else(|| panic!("the pendulum gave {:?}, not {codes:?}", &given[number..]));
        self.ahead = given[place..].iter().copied().collect();
    }
}

#[test]
fn for_a_long_time_every_sample_arrives_once_in_order_and_as_it_was() {
    let seconds: u64 = std::env::var("SOAK_S").map_or(SECONDS, |seconds| seconds.parse().unwrap());
    let image = firmware(Board::Qemu).unwrap();
    let scenario = Scenario { in_real_time: true, ..Scenario::default() };
    let limit = Duration::from_secs(seconds + 120);
    let qemu = Qemu::start(&image, scenario.clone(), limit).unwrap();
    let mut link = Link::open(qemu.port()).unwrap();
    link.hello().unwrap();
    // Long enough for the counter to be unlike other numbers in the memory.
    std::thread::sleep(Duration::from_secs(2));
    let before = link.statistics().unwrap();
    let new = u64::from(u32::MAX) + 1 - BELOW;
    let shift = new - qemu.move_counter(before.samples, new).unwrap();
    assert_eq!(link.ask(Command::Start(Stream { raw: true, live_every: LIVE_EVERY })).unwrap(), Answer::Done);

    let mut listener = Listener {
        plant: Plant::new(scenario),
        ahead: VecDeque::new(),
        next_sample: None,
        n_samples: 0,
        n_points: 0,
        n_frames: 0,
    };
    let (began, sent_before, memory_before) = (Instant::now(), qemu.n_samples(), memory::resident());
    while began.elapsed() < Duration::from_secs(seconds) {
        link.frames.drain(..).for_each(|frame| listener.take(&frame, shift));
        if let Some(frame) = link.receive().unwrap() {
            listener.take(&frame, shift);
        }
        assert!(!qemu.has_ended(), "after {:?}", began.elapsed());
    }
    let (took_s, sent) = (began.elapsed().as_secs_f64(), qemu.n_samples() - sent_before);
    assert_eq!(link.ask(Command::Stop).unwrap(), Answer::Done);
    let growth = memory::resident().saturating_sub(memory_before);
    let after = link.statistics().unwrap();

    let Listener { n_samples, n_points, n_frames, next_sample, .. } = listener;
    println!(
        "{took_s:.0} s: {n_samples} samples as they were sent, {n_points} live points, {n_frames} frames, the last \
         sample is number {next_sample:?}; {:.3} s behind the clock; stack {} to {} bytes; memory grew by {} KB",
        took_s - n_samples as f64 / 1000.0,
        before.health.stack_used,
        after.health.stack_used,
        growth >> 10
    );
    assert!(sent.abs_diff(n_samples) as f64 <= ON_THE_WAY_S * 1000.0, "{n_samples} of {sent}");
    assert!(next_sample.is_some_and(|next| next > u64::from(u32::MAX)), "{next_sample:?}");
    assert!((took_s - n_samples as f64 / 1000.0).abs() < ON_THE_WAY_S, "{n_samples} samples in {took_s} s");
    assert!(n_points.abs_diff(n_samples / u64::from(LIVE_EVERY)) < 200, "{n_points} points of {n_samples} samples");
    assert_eq!(losses(&after), losses(&before));
    assert_eq!(after.health.resets, 0);
    assert!(after.health.stack_used <= before.health.stack_used + 1024, "{} bytes", after.health.stack_used);
    assert!(growth < MOST_GROWTH, "{growth} bytes");
    assert_eq!(link.n_bad, 0);
}

fn losses(statistics: &Statistics) -> [u32; 5] {
    let Statistics { overruns, paused, dropped_frames, bad_frames, disconnected, .. } = statistics;
    [*overruns, *paused, *dropped_frames, *bad_frames, *disconnected]
}
