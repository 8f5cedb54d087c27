//! The application on a board made of memory.

use embassy_futures::select::select;
use embassy_futures::{block_on, yield_now};
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embedded_io_async::{ErrorType, Read, Write};
use firmware::ports::{BATCH, Batch, Board, Sampler, System};
use firmware::spare::Spare;
use shared::bank::tape::Tape;
use shared::sensor::Sensor;
use shared::units::Code;
use shared::wire::{Chip, Command, Deframer, Frame, Health, MAX_FRAME, encode};
use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::convert::Infallible;
use target_tests::cut_flash::{CutFlash, SIZE};

/// A board made of memory, seen from outside.
#[derive(Default)]
pub(crate) struct Bench {
    to_rig: RefCell<VecDeque<u8>>,
    from_rig: RefCell<Vec<u8>>,
    pub(crate) link_takes: Cell<bool>,
    pub(crate) n_batches: Cell<u64>,
    pub(crate) n_fed: Cell<u64>,
    pub(crate) supply_is_low: Cell<bool>,
    spare: NoSpareTime,
}

/// Nobody carries out what is ordered here.
struct NoSpareTime(Spare<NoopRawMutex>);

impl Default for NoSpareTime {
    fn default() -> Self {
        Self(Spare::new(Box::leak(Box::new(Tape::new()))))
    }
}

/// Its codes say at which rate they were taken.
struct MemorySampler<'b> {
    bench: &'b Bench,
    rate_hz: f32,
}

/// What a sampler at this rate gives.
pub(crate) fn code_at(rate_hz: f32) -> u16 {
    7190 + rate_hz as u16
}

impl Sampler for MemorySampler<'_> {
    /// It makes every whole rate.
    fn nearest_rate(rate_hz: f32) -> f32 {
        rate_hz.round()
    }

    fn can_read(sensor: &Sensor) -> bool {
        matches!(sensor, Sensor::Potentiometer(_))
    }

    fn start(&mut self, _: &Sensor, rate_hz: f32) {
        self.rate_hz = rate_hz;
    }

    async fn next(&mut self) -> Batch {
        // Not in step with the link.
        for _ in 0..=self.bench.n_batches.get() % 2 {
            yield_now().await;
        }
        self.bench.n_batches.set(self.bench.n_batches.get() + 1);
        Batch { lost: 0, cycles: 32 * 100, codes: [Code(code_at(self.rate_hz)); BATCH].into_iter().collect() }
    }
}

struct MemoryLink<'b>(&'b Bench);

impl ErrorType for MemoryLink<'_> {
    type Error = Infallible;
}

impl Read for MemoryLink<'_> {
    async fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
        yield_now().await;
        let mut waiting = self.0.to_rig.borrow_mut();
        let n_bytes = waiting.len().min(bytes.len());
        bytes[..n_bytes].iter_mut().zip(waiting.drain(..n_bytes)).for_each(|(to, from)| *to = from);
        Ok(n_bytes)
    }
}

impl Write for MemoryLink<'_> {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        while !self.0.link_takes.get() {
            yield_now().await;
        }
        self.0.from_rig.borrow_mut().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    async fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

struct MemoryChip<'b>(&'b Bench);

impl System for MemoryChip<'_> {
    type Lock = NoopRawMutex;
    const HAS_BOOTLOADER: bool = false;

    fn since_power_up(&mut self) -> Health {
        Health::default()
    }

    fn measure(&mut self, _: &mut Health) {}

    fn chip(&self) -> Chip {
        Chip { clock_hz: 1_000_000, ..Chip::default() }
    }

    fn cycles() -> u32 {
        0
    }

    fn can_save(&self) -> bool {
        !self.0.supply_is_low.get()
    }

    fn feed_watchdog(&mut self) {
        self.0.n_fed.set(self.0.n_fed.get() + 1);
    }

    fn spare(&self) -> &Spare<NoopRawMutex> {
        &self.0.spare.0
    }

    fn light(&mut self, _: bool) {}

    async fn pause(_: u32) {}

    fn reset(&mut self) -> ! {
        panic!("nobody asked")
    }

    fn bootloader(&mut self) -> ! {
        panic!("nobody asked")
    }
}

impl Bench {
    /// Runs the application on this board while a script plays.
    pub(crate) fn run(&self, script: impl Future<Output = ()>) {
        let mut flash = CutFlash::new(1);
        let board = Board {
            name: "memory",
            most_points_per_s: 100.0,
            sampler: MemorySampler { bench: self, rate_hz: 0.0 },
            receiver: MemoryLink(self),
            sender: MemoryLink(self),
            flash: &mut flash,
            store: 0..SIZE as u32,
            system: MemoryChip(self),
        };
        block_on(select(firmware::app::run(board), script));
    }

    /// What came out of the link.
    pub(crate) fn frames(&self) -> Vec<Frame> {
        let mut deframer = Deframer::new();
        self.from_rig.borrow().iter().filter_map(|byte| deframer.push(*byte)).map(Result::unwrap).collect()
    }

    pub(crate) fn send(&self, command: Command) {
        let mut buffer = [0; MAX_FRAME];
        let bytes = encode(&Frame::Command(1, command), &mut buffer).unwrap();
        self.to_rig.borrow_mut().extend(bytes);
    }

    /// Lets the application go on for so many batches.
    pub(crate) async fn pass(&self, n_batches: u64) {
        let end = self.n_batches.get() + n_batches;
        while self.n_batches.get() < end {
            yield_now().await;
        }
    }
}
