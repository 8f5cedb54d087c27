//! The board, chosen by feature. One file each; nothing outside knows a pin, a clock or an interrupt.

#[cfg(feature = "board-feather-f405")]
mod feather_f405;
#[cfg(feature = "board-feather-f405")]
pub use feather_f405::{pac, start};

#[cfg(feature = "board-nucleo-f446")]
mod nucleo_f446;
#[cfg(feature = "board-nucleo-f446")]
pub use nucleo_f446::{pac, start};

#[cfg(feature = "board-qemu")]
mod qemu;
#[cfg(feature = "board-qemu")]
pub use qemu::{pac, start};

#[cfg(feature = "stm32")]
mod stm32;

pub mod cycles;
mod identity;
mod log;
pub mod spare;
pub mod usage;

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
