//! Into the chip's own bootloader and thereby to USB updates without a probe.
//!
//! It wants the chip as after a reset, so the wish is written down, the chip restarted, and the wish obeyed before
//! anything else runs.
#![allow(unsafe_code, reason = "the wish survives a restart, and the jump leaves the program for good")]

use super::clock::wait_for_clock;
use core::mem::MaybeUninit;
use core::ptr::{addr_of, addr_of_mut};
use cortex_m::peripheral::{NVIC, SCB, SYST};
use embassy_stm32::pac::rcc::regs::{Ahb1rstr, Ahb2rstr, Apb1rstr, Apb2rstr};
use embassy_stm32::pac::{RCC, SYSCFG};

/// Where the bootloader's vectors are (AN2606, STM32F40x and F446).
const SYSTEM_MEMORY: *const u32 = 0x1fff_0000 as *const u32;

/// MEM_MODE of SYSCFG: the bootloader expects its vectors at address zero as well.
const SYSTEM_FLASH_AT_ZERO: u8 = 1;

const WISH: u32 = 0x0df0_b007;

#[unsafe(link_section = ".uninit.bootloader")]
static mut WISHED: MaybeUninit<u32> = MaybeUninit::uninit();

/// Restarts into the bootloader.
pub fn restart_into() -> ! {
    // SAFETY: a plain word that nobody refers to.
    unsafe { addr_of_mut!(WISHED).cast::<u32>().write_volatile(WISH) }
    cortex_m::peripheral::SCB::sys_reset()
}

/// Bits of ICSR that take back the interrupt of the system timer and that for switching tasks (PM0214, 4.4.3).
const PENDSTCLR: u32 = 1 << 25;
const PENDSVCLR: u32 = 1 << 27;

/// Of 32 interrupts each: the F446 has 97.
const WORDS: usize = 4;

/// A bootloader may have jumped here without a restart, with whatever it used still running: nothing of its making may
/// interrupt us, write to our memory, or count where we begin to count.
pub fn silence() {
    reset_peripherals();
    // SAFETY: nothing has been set up yet, so nobody misses an interrupt.
    unsafe {
        (*SYST::PTR).csr.write(0);
        (*SCB::PTR).icsr.write(PENDSTCLR | PENDSVCLR);
        let nvic = &*NVIC::PTR;
        nvic.icer[..WORDS].iter().for_each(|enabled| enabled.write(u32::MAX));
        nvic.icpr[..WORDS].iter().for_each(|pending| pending.write(u32::MAX));
        cortex_m::interrupt::enable();
    }
}

/// Call it first of all.
pub fn enter_if_asked() {
    // SAFETY: as above; any bits are a valid word.
    let wished = unsafe { addr_of!(WISHED).cast::<u32>().read_volatile() };
    if wished != WISH {
        return;
    }
    // SAFETY: nothing has been set up yet, as the bootloader expects.
    unsafe {
        addr_of_mut!(WISHED).cast::<u32>().write_volatile(0);
        RCC.apb2enr().modify(|w| w.set_syscfgen(true));
        wait_for_clock();
        SYSCFG.memrm().modify(|w| w.set_mem_mode(SYSTEM_FLASH_AT_ZERO));
        // Where they are after a reset; ours would get the bootloader's interrupts.
        (*SCB::PTR).vtor.write(0);
        cortex_m::asm::dsb();
        cortex_m::asm::isb();
        cortex_m::asm::bootload(SYSTEM_MEMORY)
    }
}

/// All of them, and so without a wrong word for those that a chip does not have.
fn reset_peripherals() {
    for bits in [u32::MAX, 0] {
        RCC.ahb1rstr().write_value(Ahb1rstr(bits));
        RCC.ahb2rstr().write_value(Ahb2rstr(bits));
        RCC.apb1rstr().write_value(Apb1rstr(bits));
        RCC.apb2rstr().write_value(Apb2rstr(bits));
    }
}
