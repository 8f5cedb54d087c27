//! How much of the processor is used.
//!
//! Measured from outside the tasks: `main` sleeps with interrupts masked (a pending one still wakes it), and reads the
//! cycle counter before and after. Only the time awake is counted, in cycles, since a chip's counter may stand still
//! while it sleeps; a flash erase, which stops the processor, counts as awake.

use crate::board;
use core::cell::Cell;
use embassy_sync::blocking_mutex::{Mutex, raw::CriticalSectionRawMutex};
use embassy_time::Instant;
use shared::wire::Health;

#[derive(Clone, Copy)]
struct Awake {
    cycles: u64,
    /// The counter when it woke.
    woke: u32,
    /// When counting began.
    since_us: u64,
}

impl Awake {
    /// Up to now.
    fn counted(self) -> Self {
        let now = board::cycles();
        Self { cycles: self.cycles + u64::from(now.wrapping_sub(self.woke)), woke: now, ..self }
    }
}

static AWAKE: Mutex<CriticalSectionRawMutex, Cell<Awake>> =
    Mutex::new(Cell::new(Awake { cycles: 0, woke: 0, since_us: 0 }));

/// Sleeps whenever nothing is to be done.
pub fn sleep() -> ! {
    loop {
        cortex_m::interrupt::free(|_| {
            AWAKE.lock(|awake| awake.set(awake.get().counted()));
            cortex_m::asm::wfi();
            AWAKE.lock(|awake| awake.set(Awake { woke: board::cycles(), ..awake.get() }));
        });
    }
}

/// The share since the last call.
pub fn measure(health: &mut Health) {
    let since_us = Instant::now().as_micros();
    let awake = AWAKE.lock(|awake| {
        let counted = awake.get().counted();
        awake.set(Awake { cycles: 0, since_us, ..counted });
        counted
    });
    let passed_us = since_us.saturating_sub(awake.since_us).max(1);
    let awake_us = awake.cycles / u64::from(board::CLOCK_HZ / 1_000_000);
    health.cpu_permille = (awake_us * 1000 / passed_us).clamp(1, 1000) as u16;
}
