//! The stack: a guard below it, and how much of it is used.
//!
//! The stack grows down towards the static variables. A kilobyte between them may not be touched, which the memory
//! protection unit sees to: whoever does ends in the hard fault's handler, which may (the unit is off there), and which
//! finds room enough in it. Above the guard the stack is painted at the start; the lowest word that changed is its
//! high-water mark.
#![allow(unsafe_code, reason = "the unused part of the stack is not an object of the language")]

use cortex_m::peripheral::MPU;

/// A power of two, as the unit wants it, and more than the fault's handler needs.
const GUARD: usize = 1024;

/// Region 0, of 2^(SIZE + 1) bytes, without any access or instructions (ARMv7-M, B3.5.9).
const REGION: u32 = 0;
const SIZE: u32 = GUARD.ilog2() - 1;
const NO_ACCESS_NO_CODE: u32 = 1 << 28;
const ENABLE: u32 = 1;

/// Everything else stays as it is without the unit, and fault handlers run without it.
const OTHERS_AS_BEFORE: u32 = 1 << 2;

/// What the processor says of a memory fault (ARMv7-M, B3.2.15): with its address, and while saving registers.
const STATUS: *const u32 = 0xe000_ed28 as *const u32;
const ADDRESS: *const u32 = 0xe000_ed34 as *const u32;
const ADDRESS_IS_VALID: u32 = 1 << 7;
const WHILE_SAVING: u32 = 1 << 4 | 1 << 5;

/// An unlikely value for a word of the stack.
const PAINT: u32 = 0xc0de_57ac;

/// Bytes below the stack pointer that painting leaves alone: its own frame.
const OWN_FRAME: usize = 256;

unsafe extern "C" {
    static _stack_start: u32;
    static __sheap: u32;
}

/// Where it begins; it grows down from there.
pub fn top() -> usize {
    (&raw const _stack_start) as usize
}

/// Above the end of all static variables.
fn guard() -> core::ops::Range<usize> {
    let begin = ((&raw const __sheap) as usize).next_multiple_of(GUARD);
    begin..begin + GUARD
}

/// Bytes there are.
pub fn size() -> usize {
    top() - guard().end
}

/// Sets the guard up and marks the stack that is not in use yet. Call it first of all.
pub fn prepare() {
    let end = cortex_m::register::msp::read() as usize - OWN_FRAME;
    for address in (guard().end..end).step_by(4) {
        // SAFETY: aligned, within RAM, above all statics and below every live frame; no interrupt is enabled yet.
        unsafe { (address as *mut u32).write_volatile(PAINT) }
    }
    // SAFETY: nobody uses the guard, and nobody else the unit.
    unsafe {
        let unit = &*MPU::PTR;
        unit.rnr.write(REGION);
        unit.rbar.write(guard().start as u32);
        unit.rasr.write(NO_ACCESS_NO_CODE | SIZE << 1 | ENABLE);
        unit.ctrl.write(OTHERS_AS_BEFORE | ENABLE);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// Most bytes ever used.
pub fn used() -> usize {
    let untouched = (guard().end..top())
        .step_by(4)
        // SAFETY: aligned and within RAM; only read.
        .take_while(|address| unsafe { (*address as *const u32).read_volatile() } == PAINT)
        .count();
    size() - 4 * untouched
}

/// In the handler of a fault: did it come from the guard?
pub fn overflowed() -> bool {
    // SAFETY: a register of the processor; only read.
    let address = unsafe { ADDRESS.read_volatile() };
    frame_was_lost() || (status() & ADDRESS_IS_VALID != 0 && guard().contains(&(address as usize)))
}

/// In the handler of a fault: an interrupt came, and there was no room for the registers that it saves. Where the frame
/// should be is something else then.
pub fn frame_was_lost() -> bool {
    status() & WHILE_SAVING != 0
}

fn status() -> u32 {
    // SAFETY: a register of the processor; only read.
    unsafe { STATUS.read_volatile() }
}
