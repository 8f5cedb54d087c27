//! What both STM32F4 boards have in common: clocks, sensors' inputs, flash, watchdog, restarts.

mod bootloader;
pub mod clock;
mod converter;
mod quadrature;
mod ring;
mod sampling;
mod sectors;
#[cfg(feature = "board-nucleo-f446")]
pub mod serial;
#[cfg(feature = "board-feather-f405")]
mod usb_bus;
#[cfg(feature = "board-feather-f405")]
pub mod usb_endpoints;
#[cfg(feature = "board-feather-f405")]
pub mod usb_recovery;
mod watchdog;

#[cfg(feature = "board-feather-f405")]
pub use clock::source as clock_source;
pub use clock::{CLOCK_HZ, clocks, start as start_clock};
pub use converter::{Converter, Input};
pub use quadrature::Quadrature;
pub use sampling::{Inputs, Sampling};
pub use sectors::{STORE, Sectors};

use super::{log, spare, usage};
use crate::{crash, stack};
use core::fmt::Write;
use core::sync::atomic::{AtomicU32, Ordering};
use defmt_rtt as _;
use embassy_stm32::Peri;
use embassy_stm32::gpio::{Level, Output, Pin, Speed};
use embassy_stm32::pac::rcc::regs::Csr;
use embassy_stm32::pac::{RCC, UID};
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_time::Timer;
use firmware::ports::System;
use firmware::spare::Spare;
use heapless::String;
use shared::wire::{Chip as Description, Health, ResetCause};

/// Why the chip was reset last, as its flags told at the start (CSR).
static RESET_FLAGS: AtomicU32 = AtomicU32::new(0);

/// Call it first of all.
pub fn before_all() {
    bootloader::enter_if_asked();
    take_reset_flags();
    bootloader::silence();
    watchdog::start();
}

/// Before anything can go wrong, which the next start would find told by the flags of this one. Memory may outlast a short
/// power cut, which is no restart.
fn take_reset_flags() {
    let flags = RCC.csr().read();
    RCC.csr().modify(|w| w.set_rmvf(true));
    if flags.porrstf() || flags.borrstf() {
        crash::forget();
    }
    RESET_FLAGS.store(flags.0, Ordering::Relaxed);
}

/// The chip's unique number in twelve hexadecimal digits, made as its own bootloader makes them: over USB both show the
/// same one.
pub fn serial() -> String<12> {
    let byte = |i: usize| UID.uid(i / 4).read().to_le_bytes()[i % 4];
    let both = |i: usize, j: usize| byte(i).wrapping_add(byte(j));
    let mut serial = String::new();
    for part in [byte(11), both(10, 2), byte(9), both(8, 0), byte(7), byte(6)] {
        let _ = write!(serial, "{part:02X}");
    }
    serial
}

/// The chip, and the light on its board.
pub struct Chip {
    light: Output<'static>,
}

impl Chip {
    /// With a light that shines when its pin is high.
    pub fn new(light: Peri<'static, impl Pin>) -> Self {
        Self { light: Output::new(light, Level::Low, Speed::Low) }
    }
}

impl System for Chip {
    type Lock = CriticalSectionRawMutex;
    const HAS_BOOTLOADER: bool = true;

    fn since_power_up(&mut self) -> Health {
        let before = crash::before_this_start();
        let flags = Csr(RESET_FLAGS.load(Ordering::Relaxed));
        // Every reset pulls the pin, too: its flag alone says that somebody pressed the button, and so asked.
        let by_hardware = match () {
            () if !before.warm => ResetCause::Power,
            () if flags.wdgrstf() => ResetCause::Watchdog,
            () => ResetCause::Asked,
        };
        let cause = before.cause.unwrap_or(by_hardware);
        let health = Health { cause, resets: before.resets, last_fault: before.last_fault, ..Health::default() };
        log::start(&health);
        health
    }

    fn measure(&mut self, health: &mut Health) {
        usage::measure(health);
        health.stack_size = stack::size() as u32;
        health.stack_used = stack::used() as u32;
    }

    fn chip(&self) -> Description {
        Description { serial: serial(), clock: clock::source(), clock_hz: CLOCK_HZ, ..Description::default() }
    }

    fn cycles() -> u32 {
        clock::cycles()
    }

    fn can_save(&self) -> bool {
        sectors::supply_is_good()
    }

    fn feed_watchdog(&mut self) {
        watchdog::feed();
    }

    fn spare(&self) -> &Spare<CriticalSectionRawMutex> {
        &spare::SPARE
    }

    fn light(&mut self, is_on: bool) {
        self.light.set_level(is_on.into());
    }

    async fn pause(milliseconds: u32) {
        Timer::after_millis(u64::from(milliseconds)).await;
    }

    fn reset(&mut self) -> ! {
        cortex_m::peripheral::SCB::sys_reset()
    }

    fn bootloader(&mut self) -> ! {
        bootloader::restart_into()
    }
}
