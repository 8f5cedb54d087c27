//! The potentiometer's input: TIM3 triggers the converter, DMA2 carries the results into the ring.
//!
//! The converter starts on triggers alone, so there is no sample off the grid at the start. After an overrun its
//! requests to the DMA stop until both are set up anew.

use super::clock::wait_for_clock;
use super::ring::{RING, Stream};
use embassy_stm32::Peri;
use embassy_stm32::adc::Adc;
use embassy_stm32::gpio::{Flex, Pin};
use embassy_stm32::pac::adc::vals::{Dds, Exten, SampleTime};
use embassy_stm32::pac::{ADC1, DMA2, RCC};
use embassy_stm32::peripherals::{ADC1 as Adc1, DMA2_CH0};

/// The input's capacitor delivers the charge, so a long sample time costs nothing.
const SAMPLE_TIME: SampleTime = SampleTime::CYCLES144;

/// Of the processor, for one conversion: 156 cycles at 21 MHz.
const CONVERSION_CYCLES: u32 = 156 * 8;

/// TIM3's trigger output among the converter's triggers (RM0090, EXTSEL).
const TRIGGER_TIM3_TRGO: u8 = 8;

/// What belongs to the converter (RM0090, table of DMA2's requests).
const STREAM: Stream = Stream { dma: DMA2, number: 0, channel: 0 };

/// Which pin the wiper is on.
#[derive(Clone, Copy)]
pub struct Input {
    /// The converter's channel of that pin.
    pub channel: u8,
}

/// The converter, with the wiper's pin.
pub struct Converter {
    input: Input,
    _pin: Flex<'static>,
    _adc: Adc<'static, Adc1>,
    _dma: Peri<'static, DMA2_CH0>,
}

impl Converter {
    /// On this pin.
    pub fn new(
        input: Input,
        pin: Peri<'static, impl Pin>,
        adc: Peri<'static, Adc1>,
        dma: Peri<'static, DMA2_CH0>,
    ) -> Self {
        RCC.ahb1enr().modify(|w| w.set_dma2en(true));
        wait_for_clock();
        let mut pin = Flex::new(pin);
        pin.set_as_analog();
        Self { input, _pin: pin, _adc: Adc::new(adc), _dma: dma }
    }

    /// Nothing is converted any more.
    pub fn stop(&self) {
        STREAM.stop();
        ADC1.cr2().modify(|w| {
            w.set_dma(false);
            w.set_exten(Exten::DISABLED);
        });
        // A conversion that is under way ends before its result could be taken for one of the next ones.
        cortex_m::asm::delay(CONVERSION_CYCLES);
        let _ = ADC1.dr().read();
        ADC1.sr().modify(|w| {
            w.set_eoc(false);
            w.set_strt(false);
            w.set_ovr(false);
        });
    }

    /// Once stopped, from the beginning of the ring; gives what `triggers` counts when the next trigger converts.
    pub fn start(&self, triggers: impl FnOnce() -> u32) -> u32 {
        STREAM.fill_readings(ADC1.dr().as_ptr().cast());
        ADC1.sqr1().modify(|w| w.set_l(0));
        ADC1.sqr3().modify(|w| w.set_sq(0, self.input.channel));
        ADC1.smpr2().modify(|w| w.set_smp(usize::from(self.input.channel), SAMPLE_TIME));
        cortex_m::interrupt::free(|_| {
            ADC1.cr2().modify(|w| {
                w.set_adon(true);
                w.set_dds(Dds::CONTINUOUS);
                w.set_dma(true);
                w.set_extsel(TRIGGER_TIM3_TRGO);
                w.set_exten(Exten::RISING_EDGE);
            });
            triggers()
        })
    }

    /// The place in the ring that is written next.
    pub fn writes_to(&self) -> u32 {
        STREAM.writes_to(RING) as u32
    }
}
