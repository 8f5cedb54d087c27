//! What both STM32F4 boards have in common: clocks, converter, flash, watchdog, restarts.

mod bootloader;
mod converter;

pub use bootloader::enter_if_asked;
pub use converter::{Converter, Input};

use crate::{crash, log, usage};
use defmt_rtt as _;
use embassy_stm32::flash::{Async, Bank1Region1, Flash};
use embassy_stm32::interrupt::typelevel::{Binding, FLASH as FLASH_INTERRUPT};
use embassy_stm32::pac::RCC;
use embassy_stm32::peripherals::{FLASH, IWDG};
use embassy_stm32::rcc::{AHBPrescaler, APBPrescaler, Hse, Pll, PllMul, PllPDiv, PllPreDiv, PllSource, Sysclk};
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_stm32::{Config, Peri, flash};
use embassy_time::Timer;
use firmware::ports::System;
use shared::wire::{Health, ResetCause};

/// The store: sectors 1 to 3 of 16 KB, as memory.x leaves them free.
pub const STORE: core::ops::Range<u32> = 0x4000..0x1_0000;

/// Longer than three erases (0.5 s each by the data sheet), shorter than anyone's patience.
const WATCHDOG_US: u32 = 4_000_000;

/// 168 MHz from a clock that `to_1_mhz` divides to 1 MHz: · 336 / 2; the buses at the most that they take.
pub fn clocks(clock_in: Hse, to_1_mhz: PllPreDiv) -> Config {
    let mut config = Config::default();
    config.rcc.hse = Some(clock_in);
    config.rcc.pll_src = PllSource::HSE;
    config.rcc.pll =
        Some(Pll { prediv: to_1_mhz, mul: PllMul::MUL336, divp: Some(PllPDiv::DIV2), divq: None, divr: None });
    config.rcc.ahb_pre = AHBPrescaler::DIV1;
    config.rcc.apb1_pre = APBPrescaler::DIV4;
    config.rcc.apb2_pre = APBPrescaler::DIV2;
    config.rcc.sys = Sysclk::PLL1_P;
    config
}

/// The first sectors only: erased 16 KB at a time, while the whole flash counts as 128 KB.
pub fn sectors(
    flash: Peri<'static, FLASH>,
    irq: impl Binding<FLASH_INTERRUPT, flash::InterruptHandler> + 'static,
) -> Bank1Region1<'static, Async> {
    Flash::new(flash, irq).into_regions().bank1_region1
}

/// The chip.
pub struct Chip {
    watchdog: IndependentWatchdog<'static, IWDG>,
}

impl Chip {
    /// Starts the watchdog: from now on samples have to come.
    pub fn new(watchdog: Peri<'static, IWDG>) -> Self {
        let mut watchdog = IndependentWatchdog::new(watchdog, WATCHDOG_US);
        watchdog.unleash();
        Self { watchdog }
    }
}

impl System for Chip {
    const HAS_BOOTLOADER: bool = true;

    fn since_power_up(&mut self) -> Health {
        let before = crash::before_this_start();
        let flags = RCC.csr().read();
        RCC.csr().modify(|w| w.set_rmvf(true));
        let by_hardware = match () {
            () if flags.porrstf() || flags.borrstf() || !before.warm => ResetCause::Power,
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
    }

    fn feed_watchdog(&mut self) {
        self.watchdog.pet();
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
