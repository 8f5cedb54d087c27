//! Time from the processor's SysTick: a thousand interrupts a second, and the counter's value in between.
#![allow(unsafe_code, reason = "the registers of the one SysTick are reached from the interrupt and the tasks alike")]

use core::cell::RefCell;
use core::task::Waker;
use cortex_m::peripheral::{SCB, SYST, syst::SystClkSource};
use cortex_m_rt::exception;
use embassy_sync::blocking_mutex::{Mutex, raw::CriticalSectionRawMutex};
use embassy_time::Instant;
use embassy_time_driver::Driver;
use embassy_time_queue_utils::Queue;

/// The machine's processor clock.
pub const CLOCK_HZ: u32 = 168_000_000;
const PERIODS_PER_S: u32 = 1000;
const RELOAD: u32 = CLOCK_HZ / PERIODS_PER_S - 1;
const CYCLES_PER_US: u32 = CLOCK_HZ / 1_000_000;
const US_PER_PERIOD: u64 = 1_000_000 / PERIODS_PER_S as u64;

struct State {
    periods: u64,
    queue: Queue,
}

struct SysTickDriver {
    state: Mutex<CriticalSectionRawMutex, RefCell<State>>,
}

embassy_time_driver::time_driver_impl!(
    static DRIVER: SysTickDriver = SysTickDriver {
        state: Mutex::new(RefCell::new(State { periods: 0, queue: Queue::new() })),
    }
);

/// Starts the clock.
pub fn start() {
    // SAFETY: nobody else uses SysTick.
    let mut systick = unsafe { cortex_m::Peripherals::steal() }.SYST;
    systick.set_clock_source(SystClkSource::Core);
    systick.set_reload(RELOAD);
    systick.clear_current();
    systick.enable_counter();
    systick.enable_interrupt();
}

/// Cycles of the processor, from its SysTick: QEMU's cycle counter stands still.
pub fn cycles() -> u32 {
    (Instant::now().as_micros() * u64::from(CYCLES_PER_US)) as u32
}

impl Driver for SysTickDriver {
    fn now(&self) -> u64 {
        self.state.lock(|state| {
            let before = SYST::get_current();
            // A period that ended inside this critical section has not been counted yet.
            let uncounted = u64::from(SCB::is_pendst_pending());
            let counter = if uncounted > 0 { SYST::get_current() } else { before };
            let in_period = u64::from((RELOAD - counter) / CYCLES_PER_US);
            (state.borrow().periods + uncounted) * US_PER_PERIOD + in_period
        })
    }

    fn schedule_wake(&self, at: u64, waker: &Waker) {
        // Every period looks at the queue, so there is no alarm to set.
        self.state.lock(|state| state.borrow_mut().queue.schedule_wake(at, waker));
    }
}

#[exception]
fn SysTick() {
    DRIVER.state.lock(|state| {
        let mut state = state.borrow_mut();
        state.periods += 1;
        let now = state.periods * US_PER_PERIOD;
        state.queue.next_expiration(now);
    });
}
