//! The incremental encoder's input: TIM4 counts every edge of A and B, up or down; at each update of TIM3, at which the
//! converter would begin, DMA1 carries the count into the ring.
//!
//! It counts from power-up on, whichever sensor is in use, so that zero stays where the pendulum hung then. Counts are
//! never lost to software: the counter needs none, and has 16 bits for half of which nobody may look.

use super::clock::wait_for_clock;
use super::ring::{RING, Stream};
use embassy_stm32::Peri;
use embassy_stm32::pac::timer::vals::FilterValue;
use embassy_stm32::pac::{DMA1, RCC, TIM3, TIM4};
use embassy_stm32::peripherals::{PB6, PB7, TIM4 as Tim4};
use embassy_stm32::timer::qei::{Config, Qei};
use shared::sensor::Sensor;

/// TIM3's update among DMA1's requests (RM0090, table of DMA1's requests).
const STREAM: Stream = Stream { dma: DMA1, number: 2, channel: 5 };

/// Eight looks 32 cycles of 84 MHz apart have to agree on an edge: 3 µs. Half would let more of a motor's noise
/// through; twice is not to be had. Of an encoder with 32,768 counts a turn edges are 3 µs apart at 64 rad/s.
const FILTER: FilterValue = FilterValue::FDTS_DIV32_N8;

/// The counter with its two pins.
pub struct Quadrature {
    _counter: Qei<'static, Tim4>,
}

impl Quadrature {
    /// On PB6 (A) and PB7 (B), which take 5 V as they are; the pull-ups that an open collector needs are outside.
    pub fn new(counter: Peri<'static, Tim4>, a: Peri<'static, PB6>, b: Peri<'static, PB7>) -> Self {
        RCC.ahb1enr().modify(|w| w.set_dma1en(true));
        wait_for_clock();
        let counter = Qei::new(counter, a, b, Config::default());
        TIM4.ccmr_input(0).modify(|w| {
            w.set_icf(0, FILTER);
            w.set_icf(1, FILTER);
        });
        TIM4.cnt().write(|w| w.set_cnt(Sensor::BEGINS_AT));
        Self { _counter: counter }
    }

    /// No count is taken any more; counting goes on.
    pub fn stop(&self) {
        TIM3.dier().modify(|w| w.set_ude(false));
        STREAM.stop();
    }

    /// Once stopped, from the beginning of the ring; gives what `triggers` counts when the next one takes a count.
    pub fn start(&self, triggers: impl FnOnce() -> u32) -> u32 {
        STREAM.fill_readings(TIM4.cnt().as_ptr().cast());
        cortex_m::interrupt::free(|_| {
            TIM3.dier().modify(|w| w.set_ude(true));
            triggers()
        })
    }

    /// The place in the ring that is written next.
    pub fn writes_to(&self) -> u32 {
        STREAM.writes_to(RING) as u32
    }
}
