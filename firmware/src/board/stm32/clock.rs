//! Where the cycles come from, and what time it is.
//!
//! Without its crystal a board still starts, on the internal oscillator, and can say so. Time comes from TIM5, which
//! counts microseconds in 32 bits: a flash erase holds up its interrupts for half a second, in which a counter of 16
//! bits wraps seven times unseen.
#![allow(unsafe_code, reason = "the registers of the one TIM5 are reached from the interrupt and the tasks alike")]

use core::cell::RefCell;
use core::sync::atomic::{AtomicBool, Ordering};
use core::task::Waker;
use embassy_stm32::Config;
use embassy_stm32::pac::{DBGMCU, FLASH, Interrupt, RCC, TIM5, interrupt};
use embassy_stm32::rcc::{
    AHBPrescaler, APBPrescaler, Hse, HseMode, Pll, PllMul, PllPDiv, PllPreDiv, PllSource, Sysclk,
};
use embassy_sync::blocking_mutex::{Mutex, raw::CriticalSectionRawMutex};
use embassy_time_driver::Driver;
use embassy_time_queue_utils::Queue;
use shared::wire::Clock;

/// Of the processor.
pub const CLOCK_HZ: u32 = 168_000_000;

/// The timers' clock: twice a quarter of it.
pub const TIMER_CLOCK_HZ: u32 = CLOCK_HZ / 2;

/// A crystal starts within 2 ms (data sheet); one that has not started after so many looks, 100 ms, is missing.
const LOOKS: u32 = 100;

/// Cycles from one look to the next: 1 ms of the internal oscillator, on which the chip starts.
const BETWEEN_LOOKS: u32 = 16_000;

static CRYSTAL_MISSING: AtomicBool = AtomicBool::new(false);

/// What the processor runs on.
pub fn source() -> Clock {
    if CRYSTAL_MISSING.load(Ordering::Relaxed) { Clock::Internal } else { Clock::Crystal }
}

/// 168 MHz: from the clock outside, which `to_1_mhz` divides to 1 MHz, or from the internal 16 MHz if nothing comes
/// from there; · 336 / 2; the buses at the most that they take.
pub fn clocks(outside: Hse, to_1_mhz: PllPreDiv) -> Config {
    let mut config = Config::default();
    let (source, prediv) = if comes(outside.mode) {
        config.rcc.hse = Some(outside);
        (PllSource::HSE, to_1_mhz)
    } else {
        CRYSTAL_MISSING.store(true, Ordering::Relaxed);
        (PllSource::HSI, PllPreDiv::DIV16)
    };
    config.rcc.pll_src = source;
    config.rcc.pll = Some(Pll { prediv, mul: PllMul::MUL336, divp: Some(PllPDiv::DIV2), divq: None, divr: None });
    config.rcc.ahb_pre = AHBPrescaler::DIV1;
    config.rcc.apb1_pre = APBPrescaler::DIV4;
    config.rcc.apb2_pre = APBPrescaler::DIV2;
    config.rcc.sys = Sysclk::PLL1_P;
    config
}

/// Call it between turning on a peripheral's clock and writing to its registers: the first writes may be lost otherwise
/// (errata of the F405, ES0182, "Delay after an RCC peripheral clock enabling").
pub fn wait_for_clock() {
    cortex_m::asm::dsb();
}

/// Does the clock from outside start?
fn comes(mode: HseMode) -> bool {
    use_internal();
    RCC.cr().modify(|w| w.set_hsebyp(mode != HseMode::Oscillator));
    RCC.cr().modify(|w| w.set_hseon(true));
    for _ in 0..LOOKS {
        if RCC.cr().read().hserdy() {
            return true;
        }
        cortex_m::asm::delay(BETWEEN_LOOKS);
    }
    RCC.cr().modify(|w| w.set_hseon(false));
    false
}

/// As after a reset: whoever started the program may have left other clocks on, and how the one outside is connected
/// can be said only while that is off.
fn use_internal() {
    RCC.cr().modify(|w| w.set_hsion(true));
    while !RCC.cr().read().hsirdy() {}
    RCC.cfgr().modify(|w| w.set_sw(Sysclk::HSI));
    while RCC.cfgr().read().sws() != Sysclk::HSI {}
    RCC.cr().modify(|w| {
        w.set_pllon(false);
        w.set_hseon(false);
    });
    let _ = (0..BETWEEN_LOOKS).find(|_| !RCC.cr().read().hserdy());
}

/// Once the clocks run: caches, cycle counter, time.
pub fn start() {
    use_caches();
    // SAFETY: nobody else uses the cycle counter.
    let mut core = unsafe { cortex_m::Peripherals::steal() };
    core.DCB.enable_trace();
    core.DWT.enable_cycle_counter();
    DRIVER.start();
}

/// The F405 by its number, and its first revision, A, with which the prefetch must stay off. That one gives the number of
/// an STM32F2, which has another processor and never runs this (ES0182).
const F405: u16 = 0x413;
const REVISION_A: u16 = 0x1000;
const F2: u16 = 0x411;

/// Flash takes six cycles a word; prefetch and caches hide most of it. The clocks' set-up leaves them off.
fn use_caches() {
    let chip = DBGMCU.idcode().read();
    let has_prefetch = chip.dev_id() != F2 && (chip.dev_id(), chip.rev_id()) != (F405, REVISION_A);
    FLASH.acr().modify(|w| {
        w.set_prften(has_prefetch);
        w.set_icen(true);
        w.set_dcen(true);
    });
}

/// Cycles of the processor; it may stand still while the processor sleeps.
pub fn cycles() -> u32 {
    cortex_m::peripheral::DWT::cycle_count()
}

const TICKS_PER_S: u32 = 1_000_000;

struct State {
    wraps: u64,
    queue: Queue,
}

struct Microseconds {
    state: Mutex<CriticalSectionRawMutex, RefCell<State>>,
}

embassy_time_driver::time_driver_impl!(
    static DRIVER: Microseconds = Microseconds {
        state: Mutex::new(RefCell::new(State { wraps: 0, queue: Queue::new() })),
    }
);

impl Microseconds {
    fn start(&self) {
        RCC.apb1enr().modify(|w| w.set_tim5en(true));
        wait_for_clock();
        TIM5.psc().write_value((TIMER_CLOCK_HZ / TICKS_PER_S - 1) as u16);
        TIM5.arr().write_value(u32::MAX);
        // Takes the prescaler over, without the interrupt that this would ask for.
        TIM5.cr1().modify(|w| w.set_urs(embassy_stm32::pac::timer::vals::Urs::COUNTER_ONLY));
        TIM5.egr().write(|w| w.set_ug(true));
        TIM5.dier().write(|w| w.set_uie(true));
        TIM5.cr1().modify(|w| w.set_cen(true));
        // SAFETY: the handler needs nothing but a static.
        unsafe { cortex_m::peripheral::NVIC::unmask(Interrupt::TIM5) }
    }

    /// Sets the alarm for the next task; the interrupt looks again when its time has come meanwhile.
    fn set_alarm(state: &mut State) {
        loop {
            let now = now(state);
            let next = state.queue.next_expiration(now);
            TIM5.ccr(0).write_value(next as u32);
            let this_round = next >> 32 == now >> 32;
            TIM5.dier().modify(|w| w.set_ccie(0, this_round));
            // An alarm beyond this round is set again when the counter wraps.
            if !this_round || self::now(state) < next {
                return;
            }
        }
    }
}

/// Microseconds since the start, in a critical section.
fn now(state: &State) -> u64 {
    let before = TIM5.cnt().read();
    // A wrap inside this critical section has not been counted yet.
    let uncounted = TIM5.sr().read().uif();
    let counter = if uncounted { TIM5.cnt().read() } else { before };
    (state.wraps + u64::from(uncounted)) << 32 | u64::from(counter)
}

impl Driver for Microseconds {
    fn now(&self) -> u64 {
        self.state.lock(|state| now(&state.borrow()))
    }

    fn schedule_wake(&self, at: u64, waker: &Waker) {
        self.state.lock(|state| {
            let mut state = state.borrow_mut();
            if state.queue.schedule_wake(at, waker) {
                Self::set_alarm(&mut state);
            }
        });
    }
}

#[interrupt]
fn TIM5() {
    DRIVER.state.lock(|state| {
        let mut state = state.borrow_mut();
        let flags = TIM5.sr().read();
        // Zeros clear, and only what was seen.
        TIM5.sr().write(|w| {
            w.0 = !flags.0;
        });
        state.wraps += u64::from(flags.uif());
        Microseconds::set_alarm(&mut state);
    });
}
