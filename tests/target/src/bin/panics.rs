//! Panics at its first start, and at its second says what the firmware's crash record kept of it.
#![no_std]
#![no_main]

#[allow(unreachable_pub, reason = "the firmware's own file")]
#[path = "../../../../firmware/src/crash.rs"]
mod crash;

#[allow(dead_code, reason = "the firmware's own file, of which the crash record asks one thing")]
#[allow(unreachable_pub, reason = "as above")]
#[path = "../../../../firmware/src/stack.rs"]
mod stack;

use cortex_m as _;
use cortex_m_rt::entry;
use semihosting::println;

#[entry]
fn main() -> ! {
    let before = crash::before_this_start();
    if !before.warm {
        panic!("on purpose");
    }
    println!("cause {:?}, resets {}, at {}", before.cause, before.resets, before.last_fault);
    semihosting::process::exit(0)
}
