//! Runs every check and every trace on the microcontroller and prints one line each:
//! `check NAME ok`, `trace NAME COUNT HASH`. Ends with exit code 0, or 101 at the first check that fails.
#![no_std]
#![no_main]

use cortex_m as _;
use cortex_m_rt::entry;
use semihosting::println;
use target_tests::{checks, traces};

#[entry]
fn main() -> ! {
    for check in checks::ALL {
        println!("check {} ...", check.name);
        (check.run)();
        println!("check {} ok", check.name);
    }
    for trace in traces::ALL {
        let (n_results, hash) = traces::fingerprint(trace);
        println!("trace {} {} {:08x}", trace.name, n_results, hash);
    }
    semihosting::process::exit(0)
}

#[panic_handler]
fn panic(info: &core::panic::PanicInfo) -> ! {
    semihosting::eprintln!("{info}");
    semihosting::process::exit(101)
}
