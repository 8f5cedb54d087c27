//! The board, chosen by feature. One file each; nothing outside knows a pin, a clock or an interrupt.

use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_time::Instant;
use firmware::spare::Spare;
use shared::bank::tape::Tape;

#[cfg(feature = "board-feather-f405")]
mod feather_f405;
#[cfg(feature = "board-feather-f405")]
pub use feather_f405::{IDENTITY, pac, start};

#[cfg(feature = "board-nucleo-f446")]
mod nucleo_f446;
#[cfg(feature = "board-nucleo-f446")]
pub use nucleo_f446::{IDENTITY, pac, start};

#[cfg(feature = "board-qemu")]
mod qemu;
#[cfg(feature = "board-qemu")]
pub use qemu::{CLOCK_HZ, IDENTITY, cycles, pac, start};

#[cfg(feature = "stm32")]
mod stm32;
#[cfg(feature = "stm32")]
pub use stm32::{CLOCK_HZ, cycles};

static TAPE: Tape = Tape::new();

/// What `main` does when nothing else is to be done.
pub static SPARE: Spare<CriticalSectionRawMutex> = Spare::new(&TAPE);

/// Cycles by the clock, sleep included.
pub fn cycles_since_start() -> u64 {
    Instant::now().as_micros() * u64::from(CLOCK_HZ / 1_000_000)
}

/// What must happen before anything else runs.
pub fn before_all() {
    #[cfg(feature = "stm32")]
    stm32::before_all();
}

const _: () = assert!(
    cfg!(feature = "board-feather-f405") as u8
        + cfg!(feature = "board-nucleo-f446") as u8
        + cfg!(feature = "board-qemu") as u8
        == 1,
    "choose one board: --no-default-features --features board-nucleo-f446, for example"
);

/// Lets every other interrupt go first.
#[allow(unsafe_code, reason = "priorities can break critical sections that are built on them; ours mask all")]
pub fn lowest_priority(interrupt: pac::Interrupt) {
    const LOWEST: u8 = 0xff;
    // SAFETY: before the interrupt is enabled, and no critical section depends on priorities.
    unsafe { cortex_m::Peripherals::steal().NVIC.set_priority(interrupt, LOWEST) }
}
