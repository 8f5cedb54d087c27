//! How much of the processor is used.
//!
//! Measured from outside the tasks: `main` sleeps with interrupts masked (a pending one still wakes it), and reads the
//! cycle counter before and after. Only the time awake is counted, in cycles, since a chip's counter may stand still
//! while it sleeps; a flash erase, which stops the processor, counts as awake.

use super::cycles::{CLOCK_HZ, cycles};
use core::cell::Cell;
use embassy_sync::blocking_mutex::{Mutex, raw::CriticalSectionRawMutex};
use embassy_time::Instant;
use shared::wire::Health;

#[derive(Clone, Copy)]
struct Awake {
    cycles: u64,
    /// The counter when counting went on; `None` while it stands still.
    counts_from: Option<u32>,
    /// When counting began.
    since_us: u64,
}

impl Awake {
    /// Up to now; then counting goes on or stands still.
    fn counted(self, goes_on: bool) -> Self {
        let now = cycles();
        let more = self.counts_from.map_or(0, |from| now.wrapping_sub(from));
        Self { cycles: self.cycles + u64::from(more), counts_from: goes_on.then_some(now), ..self }
    }
}

static AWAKE: Mutex<CriticalSectionRawMutex, Cell<Awake>> =
    Mutex::new(Cell::new(Awake { cycles: 0, counts_from: Some(0), since_us: 0 }));

/// Counts up to now; gives whether it had stood still.
fn count(goes_on: bool) -> bool {
    AWAKE.lock(|awake| {
        let stood_still = awake.get().counts_from.is_none();
        awake.set(awake.get().counted(goes_on));
        stood_still
    })
}

/// Works, in time that nobody else wants, as long as there is something to do; then sleeps. That work counts as sleep.
pub fn spend(mut work: impl FnMut() -> bool) -> ! {
    loop {
        count(false);
        while work() {}
        count(true);
        cortex_m::interrupt::free(|_| {
            count(false);
            cortex_m::asm::wfi();
            count(true);
        });
    }
}

/// Runs tasks, which count even where they interrupt that work.
pub fn counted(run: impl FnOnce()) {
    let stood_still = count(true);
    run();
    count(!stood_still);
}

/// The share since the last call.
pub fn measure(health: &mut Health) {
    let since_us = Instant::now().as_micros();
    let awake = AWAKE.lock(|awake| {
        let goes_on = awake.get().counts_from.is_some();
        let counted = awake.get().counted(goes_on);
        awake.set(Awake { cycles: 0, since_us, ..counted });
        counted
    });
    let passed_us = since_us.saturating_sub(awake.since_us).max(1);
    let awake_us = awake.cycles / u64::from(CLOCK_HZ / 1_000_000);
    health.cpu_permille = (awake_us * 1000 / passed_us).clamp(1, 1000) as u16;
}
