//! Looks at the releases of a recording as a board does. Reads `codes.bin` (two bytes a code, low byte first, 1 kHz) from
//! the directory that QEMU was started in. Prints `found` and the answer as a frame in hexadecimal; what the look took,
//! `count INSTRUCTIONS`, with `-icount shift=0`; and how deep its stack was, `stack BYTES`.
#![no_std]
#![no_main]
#![allow(unsafe_code, reason = "the unused part of the stack is not an object of the language")]

use core::sync::atomic::{AtomicU32, Ordering};
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::{entry, exception};
use firmware::ports::FULL_SCALE;
use semihosting::fs::File;
use semihosting::io::{Read, Result};
use semihosting::{print, println};
use shared::bank::findings::Room;
use shared::bank::keeper::Keeper;
use shared::bank::order::Order;
use shared::bank::tape::Tape;
use shared::sensor::Potentiometer;
use shared::units::Code;
use shared::wire::{Answer, Frame, MAX_FRAME, encode};
use target_tests::traces::parameters;

/// With `shift=0` an instruction takes 1 ns, and SysTick runs at 168 MHz.
const TICKS_PER_1000_INSTRUCTIONS: u64 = 168;

const RATE_HZ: f32 = 1000.0;

const CHUNK: usize = 2048;

/// An unlikely value for a word of the stack.
const PAINT: u32 = 0xc0de_57ac;

/// Bytes below the stack pointer that painting leaves alone.
const OWN_FRAME: usize = 1024;

static TAPE: Tape = Tape::new();
static ROUNDS: AtomicU32 = AtomicU32::new(0);

unsafe extern "C" {
    static __sheap: u32;
}

#[exception]
fn SysTick() {
    ROUNDS.fetch_add(1, Ordering::Relaxed);
}

/// SysTick counts down in 24 bits.
fn ticks() -> u64 {
    (u64::from(ROUNDS.load(Ordering::Relaxed)) << 24) + u64::from(0x00ff_ffff - SYST::get_current())
}

#[entry]
fn main() -> ! {
    static mut ROOM: Room<f32> = Room::empty(0.0);
    let mut systick = cortex_m::Peripherals::take().expect("first use").SYST;
    systick.set_clock_source(SystClkSource::Core);
    systick.set_reload(0x00ff_ffff);
    systick.clear_current();
    systick.enable_counter();
    systick.enable_interrupt();
    let order = remembered().expect("codes.bin can be read");
    let top = paint();
    let began = ticks();
    let found = order.carry_out(&TAPE, ROOM);
    let took = ticks() - began;
    println!("count {}", took * 1000 / TICKS_PER_1000_INSTRUCTIONS);
    println!("stack {}", used(top));
    let mut buffer = [0; MAX_FRAME];
    let frame = Frame::Answer(0, Answer::Suspects(found.expect("nothing is written meanwhile")));
    print!("found ");
    encode(&frame, &mut buffer).expect("it fits").iter().for_each(|byte| print!("{byte:02x}"));
    println!();
    semihosting::process::exit(0)
}

fn remembered() -> Result<Order> {
    let mut codes = File::open(c"codes.bin")?;
    let mut keeper = Keeper::new(RATE_HZ, Potentiometer::nominal(FULL_SCALE).into());
    let mut bytes = [0; CHUNK];
    loop {
        let n_bytes = codes.read(&mut bytes)?;
        if n_bytes == 0 {
            break;
        }
        for code in bytes[..n_bytes].chunks_exact(2) {
            keeper.take(Code(u16::from_le_bytes([code[0], code[1]])), &TAPE);
        }
    }
    let (radian_per_step, interval_s) = (keeper.radian_per_step(), keeper.interval_s());
    Ok(Order { parameters: parameters(), radian_per_step, interval_s, releases: keeper.releases(&TAPE) })
}

fn bottom() -> usize {
    (&raw const __sheap) as usize
}

/// Marks the stack that is not in use; gives where it ends.
fn paint() -> usize {
    let end = cortex_m::register::msp::read() as usize - OWN_FRAME;
    for address in (bottom()..end).step_by(4) {
        // SAFETY: aligned, within RAM, above all statics and below every live frame.
        unsafe { (address as *mut u32).write_volatile(PAINT) }
    }
    end
}

/// Bytes of the stack below `end` that were used since.
fn used(end: usize) -> usize {
    let untouched = (bottom()..end)
        .step_by(4)
        // SAFETY: aligned and within RAM; only read.
        .take_while(|address| unsafe { (*address as *const u32).read_volatile() } == PAINT)
        .count();
    end - bottom() - 4 * untouched
}

#[panic_handler]
fn panic(info: &core::panic::PanicInfo) -> ! {
    semihosting::eprintln!("{info}");
    semihosting::process::exit(101)
}
