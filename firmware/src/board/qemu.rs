//! QEMU's machine `netduinoplus2`: an STM32F405 without clock tree, converter and watchdog.
//!
//! | what | here |
//! |---|---|
//! | link | USART1, the first `-serial` |
//! | samples | USART2, the second `-serial`: see [`plant`] |
//! | flash | 12 KB of SRAM that survives a restart: see [`ram_flash`] |
//! | time | SysTick at 168 MHz: see [`systick`] |
//! | log | defmt by semihosting, on QEMU's standard output |

mod plant;
mod ram_flash;
pub mod systick;
mod usart;

use super::identity::NAME;
use super::{log, spare, usage};
use crate::{crash, stack};
use defmt_semihosting as _;
use embassy_executor::Spawner;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_time::Timer;
use firmware::ports::{Board, System};
use firmware::spare::Spare;
use plant::Plant;
use ram_flash::RamFlash;
use shared::wire::{Chip, Health, ResetCause};
pub use stm32_metapac as pac;
use usart::{Receiver, Sender};

/// Its serial port knows no rate.
const MOST_POINTS_PER_S: f32 = 10_000.0;

/// Brings the machine up.
pub fn start(_: Spawner) -> Board<Plant, Receiver, Sender, RamFlash, Machine> {
    systick::start();
    let (sender, receiver) = usart::link();
    let (replies, blocks) = usart::plant();
    Board {
        name: NAME,
        most_points_per_s: MOST_POINTS_PER_S,
        sampler: Plant::new(blocks, replies),
        receiver,
        sender,
        flash: RamFlash::new(),
        store: 0..ram_flash::SIZE as u32,
        system: Machine,
    }
}

/// The simulated chip. It has no watchdog, no bootloader and no light.
pub struct Machine;

impl System for Machine {
    type Lock = CriticalSectionRawMutex;
    const HAS_BOOTLOADER: bool = false;

    fn since_power_up(&mut self) -> Health {
        let before = crash::before_this_start();
        let asked = if before.warm { ResetCause::Asked } else { ResetCause::Power };
        let cause = before.cause.unwrap_or(asked);
        let health = Health { cause, resets: before.resets, last_fault: before.last_fault, ..Health::default() };
        log::start(&health);
        health
    }

    fn measure(&mut self, health: &mut Health) {
        usage::measure(health);
        health.stack_size = stack::size() as u32;
        health.stack_used = stack::used() as u32;
    }

    fn chip(&self) -> Chip {
        Chip { clock_hz: systick::CLOCK_HZ, ..Chip::default() }
    }

    fn cycles() -> u32 {
        systick::cycles()
    }

    fn can_save(&self) -> bool {
        true
    }

    fn feed_watchdog(&mut self) {}

    fn spare(&self) -> &Spare<CriticalSectionRawMutex> {
        &spare::SPARE
    }

    fn light(&mut self, _: bool) {}

    async fn pause(milliseconds: u32) {
        Timer::after_millis(u64::from(milliseconds)).await;
    }

    fn reset(&mut self) -> ! {
        cortex_m::peripheral::SCB::sys_reset()
    }

    fn bootloader(&mut self) -> ! {
        self.reset()
    }
}
