//! What the application asks of a board: samples in, bytes in and out, flash, and the chip's own business.

use crate::spare::Spare;
use embassy_sync::blocking_mutex::raw::RawMutex;
use embedded_io_async::{Read, Write};
use embedded_storage_async::nor_flash::NorFlash;
use heapless::Vec;
use shared::sensor::Sensor;
use shared::units::Code;
use shared::wire::{Chip, Health};

/// A potentiometer's largest code: four times 4095. Every board averages until its codes have this scale, or is fed
/// such codes, so that a calibration means the same on all of them.
pub const FULL_SCALE: u16 = 4 * 4095;

/// The most samples handed over at once.
pub const BATCH: usize = 32;

/// Samples in the order they were taken.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Batch {
    /// How many samples were lost before the first of these.
    pub lost: u32,
    /// What making them took, in cycles of [`System::cycles`]; 0 if not measured.
    pub cycles: u32,
    /// The codes: a potentiometer's are 0 … [`FULL_SCALE`].
    pub codes: Vec<Code, BATCH>,
}

/// Where the samples come from. Their timing is the board's; the application only counts them.
pub trait Sampler {
    /// The rate nearest to this one (50 … 10 000 Hz) that it can make.
    fn nearest_rate(rate_hz: f32) -> f32;
    /// Is there an input for this sensor?
    fn can_read(sensor: &Sensor) -> bool;
    /// Samples of this sensor, at this rate or at the nearest one, from now on.
    fn start(&mut self, sensor: &Sensor, rate_hz: f32);
    /// Waits for the next samples.
    async fn next(&mut self) -> Batch;
}

/// The chip's own business.
pub trait System {
    /// What keeps the spare time's work and the application apart while one of them is at their desk.
    type Lock: RawMutex;
    /// Is there a bootloader to restart into?
    const HAS_BOOTLOADER: bool;
    /// Why it started, where the last fault was, how many restarts.
    fn since_power_up(&mut self) -> Health;
    /// Processor share and stack, measured now.
    fn measure(&mut self, health: &mut Health);
    /// Which chip this is, and what it runs on.
    fn chip(&self) -> Chip;
    /// A counter of processor cycles, for differences; it may stand still while the processor sleeps.
    fn cycles() -> u32;
    /// Is the supply good enough to write to flash?
    fn can_save(&self) -> bool;
    /// Called when samples have arrived, and only then: a rig that stopped sampling is restarted.
    fn feed_watchdog(&mut self);
    /// What is done in spare time.
    fn spare(&self) -> &Spare<Self::Lock>;
    /// Switches the light that people see on or off.
    fn light(&mut self, is_on: bool);
    /// Lets milliseconds pass.
    async fn pause(milliseconds: u32);
    /// Restarts.
    fn reset(&mut self) -> !;
    /// Restarts into the chip's bootloader; asked only if there is one.
    fn bootloader(&mut self) -> !;
}

/// Everything the application needs.
pub struct Board<S: Sampler, R: Read, W: Write, F: NorFlash, Y: System> {
    /// The name in the greeting.
    pub name: &'static str,
    /// Live points that the link carries in a second beside raw codes at the highest rate; more are refused.
    pub most_points_per_s: f32,
    /// Samples.
    pub sampler: S,
    /// Bytes from the PC.
    pub receiver: R,
    /// Bytes to the PC.
    pub sender: W,
    /// Where the store lives.
    pub flash: F,
    /// The bytes of it that the store may use.
    pub store: core::ops::Range<u32>,
    /// The chip.
    pub system: Y,
}
