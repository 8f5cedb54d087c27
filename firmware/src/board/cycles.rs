//! The processor's cycles, whichever chip counts them.

use embassy_time::Instant;

#[cfg(feature = "board-qemu")]
pub use super::qemu::systick::{CLOCK_HZ, cycles};
#[cfg(feature = "stm32")]
pub use super::stm32::clock::{CLOCK_HZ, cycles};

/// Cycles by the clock, sleep included.
pub fn cycles_since_start() -> u64 {
    Instant::now().as_micros() * u64::from(CLOCK_HZ / 1_000_000)
}
