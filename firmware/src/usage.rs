//! How much of the processor and of the stack is used.
//!
//! The processor's share is measured from outside the tasks: `main` sleeps with interrupts masked (a pending one still
//! wakes it), reads the clock, and only then lets the interrupt run. The stack is painted at the start; the lowest
//! byte that changed is its high-water mark.
#![allow(unsafe_code, reason = "the unused part of the stack is not an object of the language")]

use core::cell::Cell;
use embassy_sync::blocking_mutex::{Mutex, raw::CriticalSectionRawMutex};
use embassy_time::Instant;
use shared::wire::Health;

/// An unlikely value for a word of the stack.
const PAINT: u32 = 0xc0de_57ac;

/// Bytes below the stack pointer that painting leaves alone: its own frame.
const OWN_FRAME: usize = 256;

#[derive(Clone, Copy)]
struct Asleep {
    microseconds: u64,
    since: u64,
}

static ASLEEP: Mutex<CriticalSectionRawMutex, Cell<Asleep>> =
    Mutex::new(Cell::new(Asleep { microseconds: 0, since: 0 }));

/// Sleeps whenever nothing is to be done.
pub fn sleep() -> ! {
    loop {
        cortex_m::interrupt::free(|_| {
            let before = Instant::now().as_micros();
            cortex_m::asm::wfi();
            let slept = Instant::now().as_micros() - before;
            ASLEEP.lock(|asleep| {
                let so_far = asleep.get();
                asleep.set(Asleep { microseconds: so_far.microseconds + slept, ..so_far });
            });
        });
    }
}

/// The share since the last call, and the stack's high-water mark.
pub fn measure(health: &mut Health) {
    let now = Instant::now().as_micros();
    let asleep = ASLEEP.lock(|asleep| asleep.replace(Asleep { microseconds: 0, since: now }));
    let passed = (now - asleep.since).max(1);
    let awake = passed.saturating_sub(asleep.microseconds);
    health.cpu_permille = (awake * 1000 / passed).clamp(1, 1000) as u16;
    health.stack_size = (stack_top() - stack_bottom()) as u32;
    health.stack_used = stack_used() as u32;
}

unsafe extern "C" {
    static _stack_start: u32;
    static __sheap: u32;
}

fn stack_top() -> usize {
    (&raw const _stack_start) as usize
}

/// The end of all static variables.
fn stack_bottom() -> usize {
    (&raw const __sheap) as usize
}

/// Marks the stack that is not in use yet. Call it first of all.
pub fn paint_stack() {
    let end = cortex_m::register::msp::read() as usize - OWN_FRAME;
    for address in (stack_bottom()..end).step_by(4) {
        // SAFETY: aligned, within RAM, above all statics and below every live frame; no interrupt is enabled yet.
        unsafe { (address as *mut u32).write_volatile(PAINT) }
    }
}

fn stack_used() -> usize {
    let untouched = (stack_bottom()..stack_top())
        .step_by(4)
        // SAFETY: aligned and within RAM; only read.
        .take_while(|address| unsafe { (*address as *const u32).read_volatile() } == PAINT)
        .count();
    stack_top() - stack_bottom() - 4 * untouched
}
