//! Samples with no software in their timing: TIM3 makes the instants, TIM2 counts them, and at each of them the sensor
//! in use leaves a reading in the ring. [`RingReader`] notices and counts what was lost.

use super::clock::{TIMER_CLOCK_HZ, cycles};
use super::converter::Converter;
use super::quadrature::Quadrature;
use super::ring::{RING, reading};
use embassy_stm32::peripherals::{TIM2, TIM3};
use embassy_stm32::timer::low_level::{MasterMode, SlaveMode, Timer, TriggerSource};
use embassy_stm32::{Peri, pac};
use embassy_time::Timer as Delay;
use firmware::oversampling::{Plan, middle, plan, sample};
use firmware::ports::{BATCH, Batch, Sampler};
use firmware::ring::{RingReader, Trouble};
use shared::sensor::Sensor;

/// Below what a sample time of 144 cycles at 21 MHz allows (134 000), and slow enough for the ring to last 51 ms.
const MOST_READINGS_PER_S: u32 = 40_000;

/// TIM3's trigger output among TIM2's inputs (RM0090, table of internal triggers).
const TIM2_COUNTS_TIM3: TriggerSource = TriggerSource::ITR2;

/// Samples that are not given up where the ring was overtaken: what is handed over at once. Of all that the ring holds a
/// busy processor (10 kHz, every point live, four cycles an instruction) would never catch up, and the link would starve.
const CAUGHT_UP: u32 = BATCH as u32;

/// How often the ring is looked at.
const LOOK_EVERY_MS: u64 = 2;

/// The inputs of a board.
pub struct Inputs {
    /// A potentiometer's.
    pub converter: Converter,
    /// An incremental encoder's.
    pub quadrature: Quadrature,
}

/// The inputs with the timers that sample them.
pub struct Sampling {
    inputs: Inputs,
    /// Which of them is in use.
    counts: bool,
    trigger: Timer<'static, TIM3>,
    counter: Timer<'static, TIM2>,
    plan: Plan,
    reader: RingReader<{ RING as u32 }>,
}

impl Sampling {
    /// It begins with [`Sampler::start`].
    pub fn new(inputs: Inputs, trigger: Peri<'static, TIM3>, counter: Peri<'static, TIM2>) -> Self {
        let trigger = Timer::new(trigger);
        trigger.set_master_mode(MasterMode::UPDATE);
        let counter = Timer::new(counter);
        counter.set_trigger_source(TIM2_COUNTS_TIM3);
        counter.set_slave_mode(SlaveMode::EXT_CLOCK_MODE);
        counter.start();
        let plan = Plan { per_sample: 1, ticks: 1 };
        Self { inputs, counts: false, trigger, counter, plan, reader: RingReader::new(plan.per_sample) }
    }

    /// The sensor's input from the beginning of the ring; gives the trigger behind which its first reading comes.
    /// Should one come just then, the next look finds a reading too many and does this again.
    fn arm(&self) -> u32 {
        let Inputs { converter, quadrature } = &self.inputs;
        converter.stop();
        quadrature.stop();
        if self.counts { quadrature.start(triggers) } else { converter.start(triggers) }
    }

    /// What can be read now, and what had to be left out to get there.
    fn look(&mut self) -> (u32, u32) {
        let (triggers, writes_to) = cortex_m::interrupt::free(|_| {
            let Inputs { converter, quadrature } = &self.inputs;
            let writes_to = if self.counts { quadrature.writes_to() } else { converter.writes_to() };
            (triggers(), writes_to)
        });
        match self.reader.ready(triggers, writes_to) {
            Ok(ready) => (ready, 0),
            Err(Trouble::Overtaken) => (0, self.reader.skip_overtaken(triggers, CAUGHT_UP)),
            Err(Trouble::Stalled) => {
                let triggers = self.arm();
                self.reader.restarted(triggers);
                let lost = self.reader.skip_to(triggers);
                defmt::warn!("the sensor's input stood still: {} samples lost", lost);
                (0, lost)
            }
        }
    }
}

fn triggers() -> u32 {
    pac::TIM2.cnt().read()
}

impl Sampler for Sampling {
    fn nearest_rate(rate_hz: f32) -> f32 {
        plan(rate_hz, TIMER_CLOCK_HZ, MOST_READINGS_PER_S).rate_hz(TIMER_CLOCK_HZ)
    }

    fn can_read(sensor: &Sensor) -> bool {
        matches!(sensor, Sensor::Potentiometer(_) | Sensor::Encoder(_))
    }

    fn start(&mut self, sensor: &Sensor, rate_hz: f32) {
        self.trigger.stop();
        self.counts = matches!(sensor, Sensor::Encoder(_));
        self.plan = plan(rate_hz, TIMER_CLOCK_HZ, MOST_READINGS_PER_S);
        pac::TIM3.psc().write_value(0);
        pac::TIM3.arr().write(|w| w.set_arr((self.plan.ticks - 1) as u16));
        self.trigger.reset();
        self.counter.reset();
        self.arm();
        self.reader = RingReader::new(self.plan.per_sample);
        self.trigger.start();
        defmt::info!("{} samples/s, {} readings each", rate_hz, self.plan.per_sample);
    }

    async fn next(&mut self) -> Batch {
        let mut batch = Batch::default();
        loop {
            let began = cycles();
            let (ready, lost) = self.look();
            batch.lost += lost;
            let n_samples = (ready / self.plan.per_sample).min((batch.codes.capacity()) as u32);
            for _ in 0..n_samples {
                let readings = (0..self.plan.per_sample).map(|i| reading(self.reader.place(i)));
                let code = if self.counts { middle(readings) } else { sample(readings) };
                if !self.reader.is_whole(triggers()) {
                    break;
                }
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
