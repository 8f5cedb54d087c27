//! The firmware in QEMU for a long time of its own clock: every sample arrives once, in order and as it was,
//! the sample counter passes 32 bits, nothing grows. `SOAK_S=3600` makes it an hour.
#![cfg(unix)]

use shared::wire::{Answer, Command, Frame, Statistics, Stream};
use tests::image::{Board, firmware};
use tests::link::Link;
use tests::memory;
use tests::plant::{Plant, Scenario};
use tests::qemu::Qemu;

/// Seconds of the rig's clock.
const SECONDS: u64 = 30;

/// The counter begins so many samples below 32 bits.
const BELOW: u64 = 5_000;

const LIVE_EVERY: u16 = 10;

/// Memory of this process may grow by this much.
const MOST_GROWTH: u64 = 16 << 20;

/// The counter is moved when it has come so far: unlike other numbers in the memory.
const WELL_ON: u64 = 5_000;

/// Samples that may be on their way between pendulum and PC: as many as fit the terminal's 4 KB and what lies before it.
const ON_THE_WAY: u64 = 4000;

/// Checks a stream against the pendulum that it came from.
struct Listener {
    plant: Plant,
    next_sample: Option<u64>,
    n_samples: u64,
    n_points: u64,
    n_frames: u64,
}

impl Listener {
    /// For a stream in which sample `k + shift` is the pendulum's `k`th.
    fn take(&mut self, frame: &Frame, shift: u64) {
        match frame {
            Frame::Samples(samples) => {
                if self.next_sample.is_none() {
                    (0..samples.first_sample - shift).for_each(|_| {
                        self.plant.next_code();
                    });
                }
                let next = *self.next_sample.get_or_insert(samples.first_sample);
                assert_eq!((samples.first_sample, samples.status), (next, 0));
                assert_eq!(u64::from(samples.sequence), self.n_samples / 16);
                for code in &samples.codes {
                    assert_eq!(*code, self.plant.next_code().0, "sample {next} and those behind it");
                }
                self.n_samples += samples.codes.len() as u64;
                self.next_sample = Some(next + samples.codes.len() as u64);
            }
            Frame::Live(live) => self.n_points += live.points.len() as u64,
            _ => return,
        }
        self.n_frames += 1;
    }
}

#[test]
fn for_a_long_time_every_sample_arrives_once_in_order_and_as_it_was() {
    let seconds: u64 = std::env::var("SOAK_S").map_or(SECONDS, |seconds| seconds.parse().unwrap());
    let image = firmware(Board::Qemu).unwrap();
    let scenario = Scenario::default();
    let qemu = Qemu::start(&image, scenario.clone()).unwrap();
    let mut link = Link::open(qemu.port()).unwrap();
    link.hello().unwrap();
    while link.statistics().unwrap().samples < WELL_ON {}
    qemu.hold(true);
    let before = link.statistics().unwrap();
    let sent_before = qemu.n_samples();
    let new = u64::from(u32::MAX) + 1 - BELOW;
    let shift = new - qemu.move_counter(before.samples, new).unwrap();
    assert_eq!(link.ask(Command::Start(Stream { raw: true, live_every: LIVE_EVERY })).unwrap(), Answer::Done);
    qemu.hold(false);

    let mut listener =
        Listener { plant: Plant::new(scenario), next_sample: None, n_samples: 0, n_points: 0, n_frames: 0 };
    let memory_before = memory::resident();
    while listener.n_samples < 1000 * seconds {
        link.frames.drain(..).for_each(|frame| listener.take(&frame, shift));
        if let Some(frame) = link.receive().unwrap() {
            listener.take(&frame, shift);
        }
        assert!(!qemu.has_ended(), "after {} samples", listener.n_samples);
    }
    let sent = qemu.n_samples() - sent_before;
    assert_eq!(link.ask(Command::Stop).unwrap(), Answer::Done);
    let growth = memory::resident().saturating_sub(memory_before);
    let after = link.statistics().unwrap();

    let Listener { n_samples, n_points, n_frames, next_sample, .. } = listener;
    println!(
        "{n_samples} samples as they were sent, {n_points} live points, {n_frames} frames, the last sample is number \
         {next_sample:?}; stack {} to {} bytes; memory grew by {} KB",
        before.health.stack_used,
        after.health.stack_used,
        growth >> 10
    );
    assert!(sent.abs_diff(n_samples) <= ON_THE_WAY, "{n_samples} of {sent}");
    assert!(next_sample.is_some_and(|next| next > u64::from(u32::MAX)), "{next_sample:?}");
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
