//! Samples from the potentiometer with no software in their timing: TIM3 triggers the converter, DMA2 carries the
//! results into a ring, TIM2 counts the triggers.
//!
//! The converter starts on triggers alone, so there is no sample off the grid at the start. After an overrun its
//! requests to the DMA stop until both are set up anew; [`RingReader`] notices and counts what was lost.

use super::clock::{TIMER_CLOCK_HZ, cycles};
use core::sync::atomic::{AtomicU16, Ordering};
use embassy_stm32::adc::Adc;
use embassy_stm32::gpio::{Flex, Pin};
use embassy_stm32::pac::adc::vals::{Dds, Exten, SampleTime};
use embassy_stm32::pac::dma::vals::{Dir, Pl, Size};
use embassy_stm32::pac::{ADC1, DMA2};
use embassy_stm32::peripherals::{ADC1 as Adc1, DMA2_CH0, TIM2, TIM3};
use embassy_stm32::timer::low_level::{MasterMode, SlaveMode, Timer, TriggerSource};
use embassy_stm32::{Peri, pac};
use embassy_time::Timer as Delay;
use firmware::oversampling::{Plan, plan, sample};
use firmware::ports::{Batch, Sampler};
use firmware::ring::{RingReader, Trouble};

/// Below what a sample time of 144 cycles at 21 MHz allows (134 000), and slow enough for the ring to last 51 ms.
const MOST_CONVERSIONS_PER_S: u32 = 40_000;

/// The input's capacitor delivers the charge, so a long sample time costs nothing.
const SAMPLE_TIME: SampleTime = SampleTime::CYCLES144;

/// Of the processor, for one conversion: 156 cycles at 21 MHz.
const CONVERSION_CYCLES: u32 = 156 * 8;

/// TIM3's trigger output among the converter's triggers (RM0090, EXTSEL).
const TRIGGER_TIM3_TRGO: u8 = 8;

/// TIM3's trigger output among TIM2's inputs (RM0090, table of internal triggers).
const TIM2_COUNTS_TIM3: TriggerSource = TriggerSource::ITR2;

/// The stream of DMA2 that belongs to the converter, and its channel there.
const STREAM: usize = 0;
const CHANNEL: u8 = 0;

/// How often the ring is looked at.
const LOOK_EVERY_MS: u64 = 2;

const RING: usize = 2048;

static RESULTS: [AtomicU16; RING] = [const { AtomicU16::new(0) }; RING];

/// Which pin the wiper is on.
#[derive(Clone, Copy)]
pub struct Input {
    /// The converter's channel of that pin.
    pub channel: u8,
}

/// The converter with its timers.
pub struct Converter {
    input: Input,
    trigger: Timer<'static, TIM3>,
    counter: Timer<'static, TIM2>,
    plan: Plan,
    reader: RingReader<{ RING as u32 }>,
    _pin: Flex<'static>,
    _adc: Adc<'static, Adc1>,
    _dma: Peri<'static, DMA2_CH0>,
}

impl Converter {
    /// On this pin; it starts with [`Sampler::set_rate`].
    pub fn new(
        input: Input,
        pin: Peri<'static, impl Pin>,
        adc: Peri<'static, Adc1>,
        dma: Peri<'static, DMA2_CH0>,
        trigger: Peri<'static, TIM3>,
        counter: Peri<'static, TIM2>,
    ) -> Self {
        pac::RCC.ahb1enr().modify(|w| w.set_dma2en(true));
        let mut pin = Flex::new(pin);
        pin.set_as_analog();
        let trigger = Timer::new(trigger);
        trigger.set_master_mode(MasterMode::UPDATE);
        let counter = Timer::new(counter);
        counter.set_trigger_source(TIM2_COUNTS_TIM3);
        counter.set_slave_mode(SlaveMode::EXT_CLOCK_MODE);
        counter.start();
        let plan = Plan { per_sample: 1, ticks: 1 };
        let reader = RingReader::new(plan.per_sample);
        Self { input, trigger, counter, plan, reader, _pin: pin, _adc: Adc::new(adc), _dma: dma }
    }

    fn triggers(&self) -> u32 {
        pac::TIM2.cnt().read()
    }

    /// Converter and DMA from the beginning of the ring; gives the trigger behind which its first result comes. Should one
    /// come just then, the next look finds a result too many and does this again.
    fn arm(&self) -> u32 {
        let stream = DMA2.st(STREAM);
        stream.cr().modify(|w| w.set_en(false));
        while stream.cr().read().en() {}
        DMA2.ifcr(STREAM / 4).write(|w| {
            w.set_tcif(STREAM % 4, true);
            w.set_htif(STREAM % 4, true);
            w.set_teif(STREAM % 4, true);
            w.set_dmeif(STREAM % 4, true);
            w.set_feif(STREAM % 4, true);
        });
        ADC1.cr2().modify(|w| {
            w.set_dma(false);
            w.set_exten(Exten::DISABLED);
        });
        // A conversion that is under way ends before its result could be taken for one of the new ones.
        cortex_m::asm::delay(CONVERSION_CYCLES);
        let _ = ADC1.dr().read();
        ADC1.sr().modify(|w| {
            w.set_eoc(false);
            w.set_strt(false);
            w.set_ovr(false);
        });

        stream.par().write_value(ADC1.dr().as_ptr() as u32);
        stream.m0ar().write_value(RESULTS.as_ptr() as u32);
        stream.ndtr().write(|w| w.set_ndt(RING as u16));
        stream.cr().write(|w| {
            w.set_chsel(CHANNEL);
            w.set_dir(Dir::PERIPHERAL_TO_MEMORY);
            w.set_psize(Size::BITS16);
            w.set_msize(Size::BITS16);
            w.set_minc(true);
            w.set_circ(true);
            w.set_pl(Pl::VERY_HIGH);
        });
        stream.cr().modify(|w| w.set_en(true));

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
            self.triggers()
        })
    }

    /// What can be read now, and what had to be left out to get there.
    fn look(&mut self) -> (u32, u32) {
        let (triggers, writes_to) = cortex_m::interrupt::free(|_| {
            let writes_to = RING as u32 - u32::from(DMA2.st(STREAM).ndtr().read().ndt());
            (self.triggers(), writes_to % RING as u32)
        });
        match self.reader.ready(triggers, writes_to) {
            Ok(ready) => (ready, 0),
            Err(Trouble::Overtaken) => (0, self.reader.skip_to(triggers)),
            Err(Trouble::Stalled) => {
                let triggers = self.arm();
                self.reader.restarted(triggers);
                let lost = self.reader.skip_to(triggers);
                defmt::warn!("the converter overran: {} samples lost", lost);
                (0, lost)
            }
        }
    }
}

impl Sampler for Converter {
    fn nearest_rate(rate_hz: f32) -> f32 {
        plan(rate_hz, TIMER_CLOCK_HZ, MOST_CONVERSIONS_PER_S).rate_hz(TIMER_CLOCK_HZ)
    }

    fn set_rate(&mut self, rate_hz: f32) {
        self.trigger.stop();
        self.plan = plan(rate_hz, TIMER_CLOCK_HZ, MOST_CONVERSIONS_PER_S);
        pac::TIM3.psc().write_value(0);
        pac::TIM3.arr().write(|w| w.set_arr((self.plan.ticks - 1) as u16));
        self.trigger.reset();
        self.counter.reset();
        self.arm();
        self.reader = RingReader::new(self.plan.per_sample);
        self.trigger.start();
        defmt::info!("{} samples/s, {} conversions each", rate_hz, self.plan.per_sample);
    }

    async fn next(&mut self) -> Batch {
        let mut batch = Batch::default();
        loop {
            let began = cycles();
            let (ready, lost) = self.look();
            batch.lost += lost;
            let n_samples = (ready / self.plan.per_sample).min((batch.codes.capacity()) as u32);
            for _ in 0..n_samples {
                let places = (0..self.plan.per_sample).map(|i| self.reader.place(i));
                let code = sample(places.map(|place| RESULTS[place].load(Ordering::Relaxed)));
                // As many are taken as there is room for.
                let _ = batch.codes.push(code);
                self.reader.advance();
            }
            if !batch.codes.is_empty() {
                batch.cycles = cycles().wrapping_sub(began);
                return batch;
            }
            Delay::after_millis(LOOK_EVERY_MS).await;
        }
    }
}
