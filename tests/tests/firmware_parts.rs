//! The firmware's parts on the PC: the store under power cuts, the wire under faults, the queue, the converter's
//! bookkeeping, and the application on a board made of memory.

use embassy_futures::select::select;
use embassy_futures::{block_on, yield_now};
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embedded_io_async::{ErrorType, Read, Write};
use firmware::frame_queue::{CAPACITY, Encoded, FrameQueue};
use firmware::oversampling::{middle, plan, sample};
use firmware::ports::{BATCH, Batch, Board, FULL_SCALE, Sampler, System};
use firmware::ring::{RingReader, Trouble};
use firmware::spare::Spare;
use shared::bank::tape::Tape;
use shared::rig::Rig;
use shared::sensor::{Encoder, Sensor};
use shared::units::Code;
use shared::wire::{
    Answer, Chip, Command, Deframer, Frame, Health, Live, MAX_FRAME, POINTS_PER_FRAME, Point, Refusal,
    SAMPLES_PER_FRAME, Samples, Settings, StoreState, Stream, encode,
};
use std::cell::{Cell, RefCell};
use std::collections::VecDeque;
use std::convert::Infallible;
use target_tests::checks::count_power_cuts;
use target_tests::cut_flash::{CutFlash, SIZE};
use target_tests::noise::Noise;

#[test]
fn five_thousand_power_cuts_leave_the_old_or_the_new_parameters() {
    let cuts = count_power_cuts(5000, 11);
    println!("{cuts:?}");
    assert!(cuts.in_writes > 1000 && cuts.in_erases > 100 && cuts.kept_new > 0, "{cuts:?}");
}

fn samples(i: u32) -> Frame {
    let codes = (0..SAMPLES_PER_FRAME as u32).map(|k| (8000 + (i * 7 + k * 13) % 400) as u16).collect();
    Frame::Samples(Samples { sequence: i, first_sample: u64::from(i) * SAMPLES_PER_FRAME as u64, status: 0, codes })
}

fn live(i: u32) -> Frame {
    let angle_rad = i as f32 * 1e-3;
    let point =
        Point { filtered_rad: angle_rad, angle_rad, velocity_rad_s: 1.0, innovation_rad: 1e-3, friction_nm: 0.0 };
    let points = [point; POINTS_PER_FRAME].into_iter().collect();
    Frame::Live(Live { sequence: i, first_sample: u64::from(i), every: 1, status: 0, points })
}

/// What a bad line does to bytes, one fault in about `every` bytes; gives the number of faults.
fn spoil(bytes: &[u8], noise: &mut Noise, every: u32) -> (Vec<u8>, u32) {
    let mut n_faults = 0;
    let mut spoiled = Vec::with_capacity(bytes.len());
    for byte in bytes {
        if noise.below(every) != 0 {
            spoiled.push(*byte);
            continue;
        }
        n_faults += 1;
        match noise.below(3) {
            0 => spoiled.push(byte ^ (1 << noise.below(8))),
            1 => {}
            _ => spoiled.extend([*byte, noise.bits() as u8]),
        }
    }
    (spoiled, n_faults)
}

#[test]
fn of_a_hundred_thousand_frames_none_passes_wrong_and_each_fault_costs_at_most_two() {
    let mut noise = Noise::new(5);
    let mut deframer = Deframer::new();
    let (mut n_faults, mut n_received, mut last) = (0, 0_u32, None);
    let frame = |i: u32| if i.is_multiple_of(3) { live(i) } else { samples(i) };
    let n_frames = 100_000;
    for i in 0..n_frames {
        let mut buffer = [0; MAX_FRAME];
        let (bytes, faults) = spoil(encode(&frame(i), &mut buffer).unwrap(), &mut noise, 500);
        n_faults += faults;
        for byte in bytes {
            let Some(Ok(got)) = deframer.push(byte) else { continue };
            let number = match &got {
                Frame::Samples(samples) => samples.sequence,
                Frame::Live(live) => live.sequence,
                other => panic!("nobody sent {other:?}"),
            };
            assert_eq!(got, frame(number));
            assert!(last.is_none_or(|last| last < number));
            last = Some(number);
            n_received += 1;
        }
    }
    let n_lost = n_frames - n_received;
    println!("{n_faults} faults, {n_lost} frames lost, none wrong");
    assert!(n_faults > 10_000 && n_lost > 0 && n_lost <= 2 * n_faults);
}

#[test]
fn a_full_queue_drops_the_oldest_whole_frames_and_counts_them() {
    let queue = FrameQueue::new();
    let n_pushed = 300;
    let n_dropped: u32 = (0..n_pushed).map(|i| queue.push(&samples(i))).sum();
    let mut numbers = Vec::new();
    let mut encoded = Encoded::new();
    let mut deframer = Deframer::new();
    let mut n_bytes = 0;
    for _ in 0..n_pushed - n_dropped {
        block_on(queue.take(&mut encoded));
        n_bytes += encoded.len();
        let frame = encoded.iter().find_map(|byte| deframer.push(*byte));
        let Some(Ok(Frame::Samples(samples))) = frame else { panic!("{frame:?}") };
        numbers.push(samples.sequence);
    }
    assert!(n_dropped > 0 && n_bytes <= CAPACITY && n_bytes > CAPACITY - 2 * MAX_FRAME);
    assert_eq!(numbers, (n_dropped..n_pushed).collect::<Vec<_>>());
}

#[test]
fn usual_rates_are_met_exactly_within_the_converters_limit() {
    for rate_hz in [100.0, 200.0, 500.0, 1000.0, 2000.0, 5000.0, 10_000.0_f32] {
        let plan = plan(rate_hz, 84_000_000, 40_000);
        let made_hz = 84e6 / f64::from(plan.ticks * plan.per_sample);
        assert_eq!(made_hz, f64::from(rate_hz), "{plan:?}");
        assert!(plan.ticks <= 0x1_0000 && plan.ticks >= 2100 && plan.per_sample >= 4, "{plan:?}");
    }
    assert_eq!(plan(1000.0, 84_000_000, 40_000).per_sample, 32);
}

/// The best that a timer of 16 bits can do for a rate: its error, as a share, over every plan there is.
fn least_error(rate_hz: f64) -> f64 {
    let mut least = f64::INFINITY;
    for per_sample in [4.0, 8.0, 16.0, 32.0, 64.0] {
        // The converter takes four conversions at the highest rate.
        if per_sample > 4.0 && per_sample * rate_hz > 40_000.0 {
            continue;
        }
        let exact = 84e6 / (per_sample * rate_hz);
        for ticks in [exact.floor(), exact.ceil()] {
            if (1.0..=65_536.0).contains(&ticks) {
                least = least.min((84e6 / (per_sample * ticks) / rate_hz - 1.0).abs());
            }
        }
    }
    least
}

#[test]
fn every_rate_is_made_exactly_or_as_near_as_the_crystal_or_the_timer_allows() {
    let mut n_exact = 0;
    for rate in 50..=10_000_u32 {
        let rate_hz = f64::from(rate);
        let plan = plan(rate as f32, 84_000_000, 40_000);
        assert!((1..=65_536).contains(&plan.ticks) && (4..=64).contains(&plan.per_sample), "{rate} Hz: {plan:?}");
        let conversions_per_s = 84e6 / f64::from(plan.ticks);
        assert!(conversions_per_s <= 40_010.0, "{rate} Hz: {conversions_per_s} conversions/s");
        let made_hz = conversions_per_s / f64::from(plan.per_sample);
        let error = (made_hz / rate_hz - 1.0).abs();
        let least = least_error(rate_hz);
        n_exact += u32::from(error == 0.0);
        assert!(error <= f64::max(50e-6, least * 1.000_001), "{rate} Hz: {made_hz}");
        assert!(least > 0.0 || error == 0.0, "{rate} Hz can be made exactly, not as {made_hz}");
        let told_hz = f64::from(plan.rate_hz(84_000_000));
        assert!((told_hz / made_hz - 1.0).abs() < 1e-7, "{rate} Hz: told {told_hz}, made {made_hz}");
        // What is told and stored makes the same plan again.
        assert_eq!(
            firmware::oversampling::plan(told_hz as f32, 84_000_000, 40_000).rate_hz(84_000_000),
            told_hz as f32
        );
    }
    println!("{n_exact} of 9951 rates are exact");
}

#[test]
fn a_sample_is_the_mean_of_its_conversions_on_the_firmwares_scale() {
    assert_eq!(sample([4095; 32].into_iter()), Code(FULL_SCALE));
    assert_eq!(sample([0; 4].into_iter()), Code(0));
    assert_eq!(sample([1000, 1000, 1000, 1001].into_iter()), Code(4001));
}

#[test]
fn the_ring_is_read_in_step_with_its_triggers_over_their_wrap() {
    let mut reader = RingReader::<2048>::new(32);
    let mut n_samples = 0;
    let mut triggers = 0_u32;
    for step in 0..10_000 {
        triggers += 7 + step % 90;
        let ready = reader.ready(triggers, (triggers - 2) % 2048).unwrap();
        for _ in 0..ready / 32 {
            assert_eq!(reader.place(0), n_samples * 32 % 2048);
            reader.advance();
            n_samples += 1;
        }
    }
    assert_eq!(n_samples as u32, (triggers - 2) / 32);
}

#[test]
fn an_overtaken_reader_skips_whole_samples_and_keeps_the_grid() {
    let mut reader = RingReader::<2048>::new(32);
    // Half a second without the processor, as during an erase: 16,010 triggers.
    assert_eq!(reader.ready(16_010, 16_010 % 2048), Err(Trouble::Overtaken));
    assert_eq!(reader.skip_to(16_010), 501);
    assert_eq!(reader.ready(16_010, 16_010 % 2048), Ok(0));
    assert_eq!(reader.ready(16_064, 16_064 % 2048), Ok(32));
    assert_eq!(reader.place(0), 16_032 % 2048);
}

#[test]
fn a_converter_that_stopped_is_noticed_and_started_again_on_the_grid() {
    let mut reader = RingReader::<2048>::new(32);
    assert_eq!(reader.ready(500, 100), Err(Trouble::Stalled));
    reader.restarted(500);
    assert_eq!(reader.skip_to(500), 16);
    assert_eq!(reader.ready(544, 44), Ok(32));
    assert_eq!(reader.place(0), 12);
}

/// A board made of memory, seen from outside.
#[derive(Default)]
struct Bench {
    to_rig: RefCell<VecDeque<u8>>,
    from_rig: RefCell<Vec<u8>>,
    link_takes: Cell<bool>,
    n_batches: Cell<u64>,
    n_fed: Cell<u64>,
    supply_is_low: Cell<bool>,
    spare: NoSpareTime,
}

/// Nobody carries out what is ordered here.
struct NoSpareTime(Spare<NoopRawMutex>);

impl Default for NoSpareTime {
    fn default() -> Self {
        Self(Spare::new(Box::leak(Box::new(Tape::new()))))
    }
}

struct MemorySampler<'b>(&'b Bench);

impl Sampler for MemorySampler<'_> {
    /// It makes every whole rate.
    fn nearest_rate(rate_hz: f32) -> f32 {
        rate_hz.round()
    }

    fn can_read(sensor: &Sensor) -> bool {
        matches!(sensor, Sensor::Potentiometer(_))
    }

    fn start(&mut self, _: &Sensor, _: f32) {}

    async fn next(&mut self) -> Batch {
        yield_now().await;
        self.0.n_batches.set(self.0.n_batches.get() + 1);
        Batch { lost: 0, cycles: 32 * 100, codes: [Code(8190); BATCH].into_iter().collect() }
    }
}

struct MemoryLink<'b>(&'b Bench);

impl ErrorType for MemoryLink<'_> {
    type Error = Infallible;
}

impl Read for MemoryLink<'_> {
    async fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
        yield_now().await;
        let mut waiting = self.0.to_rig.borrow_mut();
        let n_bytes = waiting.len().min(bytes.len());
        bytes[..n_bytes].iter_mut().zip(waiting.drain(..n_bytes)).for_each(|(to, from)| *to = from);
        Ok(n_bytes)
    }
}

impl Write for MemoryLink<'_> {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        while !self.0.link_takes.get() {
            yield_now().await;
        }
        self.0.from_rig.borrow_mut().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    async fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

struct MemoryChip<'b>(&'b Bench);

impl System for MemoryChip<'_> {
    type Lock = NoopRawMutex;
    const HAS_BOOTLOADER: bool = false;

    fn since_power_up(&mut self) -> Health {
        Health::default()
    }

    fn measure(&mut self, _: &mut Health) {}

    fn chip(&self) -> Chip {
        Chip { clock_hz: 1_000_000, ..Chip::default() }
    }

    fn cycles() -> u32 {
        0
    }

    fn can_save(&self) -> bool {
        !self.0.supply_is_low.get()
    }

    fn feed_watchdog(&mut self) {
        self.0.n_fed.set(self.0.n_fed.get() + 1);
    }

    fn spare(&self) -> &Spare<NoopRawMutex> {
        &self.0.spare.0
    }

    fn light(&mut self, _: bool) {}

    async fn pause(_: u32) {}

    fn reset(&mut self) -> ! {
        panic!("nobody asked")
    }

    fn bootloader(&mut self) -> ! {
        panic!("nobody asked")
    }
}

impl Bench {
    /// Runs the application on this board while a script plays.
    fn run(&self, script: impl Future<Output = ()>) {
        let mut flash = CutFlash::new(1);
        let board = Board {
            name: "memory",
            most_points_per_s: 100.0,
            sampler: MemorySampler(self),
            receiver: MemoryLink(self),
            sender: MemoryLink(self),
            flash: &mut flash,
            store: 0..SIZE as u32,
            system: MemoryChip(self),
        };
        block_on(select(firmware::app::run(board), script));
    }

    /// What came out of the link.
    fn frames(&self) -> Vec<Frame> {
        let mut deframer = Deframer::new();
        self.from_rig.borrow().iter().filter_map(|byte| deframer.push(*byte)).map(Result::unwrap).collect()
    }

    fn send(&self, command: Command) {
        let mut buffer = [0; MAX_FRAME];
        let bytes = encode(&Frame::Command(1, command), &mut buffer).unwrap();
        self.to_rig.borrow_mut().extend(bytes);
    }

    /// Lets the application go on for so many batches.
    async fn pass(&self, n_batches: u64) {
        let end = self.n_batches.get() + n_batches;
        while self.n_batches.get() < end {
            yield_now().await;
        }
    }
}

#[test]
fn a_link_that_takes_nothing_for_a_while_costs_frames_but_no_samples() {
    let bench = Bench::default();
    let script = async {
        bench.link_takes.set(true);
        bench.send(Command::Start(Stream { raw: true, live_every: 0 }));
        bench.pass(50).await;
        bench.link_takes.set(false);
        bench.pass(1000).await;
        bench.link_takes.set(true);
        bench.pass(1000).await;
        bench.send(Command::Stop);
        bench.send(Command::Statistics);
        bench.pass(300).await;
    };
    bench.run(script);

    let frames = bench.frames();
    let n_dropped = frames.iter().find_map(|frame| match frame {
        Frame::Answer(_, Answer::Statistics(statistics)) => Some(statistics.dropped_frames),
        _ => None,
    });
    let sequences: Vec<u32> = frames
        .iter()
        .filter_map(|frame| if let Frame::Samples(samples) = frame { Some(samples.sequence) } else { None })
        .collect();
    let n_missing: u32 = sequences.windows(2).map(|pair| pair[1] - pair[0] - 1).sum();
    let n_gaps = sequences.windows(2).filter(|pair| pair[1] != pair[0] + 1).count();
    assert_eq!(n_dropped, Some(n_missing));
    // One gap for the pause, and one if a frame stood between queue and link when it began.
    assert!(n_missing > 1000 && (1..=2).contains(&n_gaps), "{n_missing} in {n_gaps} gaps");
    assert_eq!(bench.n_fed.get(), bench.n_batches.get());
}

/// Answers to commands, in order.
fn answers(bench: &Bench) -> Vec<Answer> {
    let answer = |frame| if let Frame::Answer(_, answer) = frame { Some(answer) } else { None };
    bench.frames().into_iter().filter_map(answer).collect()
}

#[test]
fn the_rate_that_is_made_is_told_kept_and_loaded() {
    let bench = Bench::default();
    bench.link_takes.set(true);
    bench.run(async {
        let odd = Settings { rate_hz: 333.4, ..*Rig::new("", FULL_SCALE, Err(StoreState::Empty)).settings() };
        let slow = Settings { rate_hz: 50.4, cutoff_hz: 22.6, ..odd };
        for settings in [odd, slow] {
            bench.send(Command::SetSettings(settings));
            bench.send(Command::Save);
            bench.send(Command::Load);
            bench.send(Command::GetSettings);
            bench.pass(100).await;
        }
        bench.send(Command::SetSettings(Settings { rate_hz: 49.9, ..slow }));
        bench.send(Command::SetSettings(Settings { rate_hz: 10_001.0, ..slow }));
        bench.pass(20).await;
    });
    let answers = answers(&bench);
    let given: Vec<Settings> = answers
        .iter()
        .filter_map(|answer| if let Answer::Settings(settings) = answer { Some(*settings) } else { None })
        .collect();
    assert_eq!(given.iter().map(|settings| settings.rate_hz).collect::<Vec<_>>(), [333.0, 50.0]);
    // The cut-off goes with it: at most 0.45 of the rate.
    assert_eq!(given.iter().map(|settings| settings.cutoff_hz).collect::<Vec<_>>(), [50.0, 22.5]);
    let refused = Answer::Refused(Refusal::Setting { index: 0 });
    assert_eq!(answers[answers.len() - 2..], [refused.clone(), refused]);
}

#[test]
fn a_board_without_an_input_for_a_sensor_says_so_and_goes_on_with_its_own() {
    let bench = Bench::default();
    bench.link_takes.set(true);
    bench.run(async {
        let settings = *Rig::new("", FULL_SCALE, Err(StoreState::Empty)).settings();
        bench.send(Command::SetSettings(settings.with_sensor(Encoder::new(4096).into())));
        bench.send(Command::GetSettings);
        bench.pass(20).await;
    });
    let refused = Answer::Refused(Refusal::NoSuchSensor);
    let settings = Settings { rate_hz: 1000.0, ..*Rig::new("", FULL_SCALE, Err(StoreState::Empty)).settings() };
    assert_eq!(answers(&bench), [refused, Answer::Settings(settings)]);
}

#[test]
fn of_counts_the_one_in_the_middle_is_the_sample() {
    assert_eq!(middle([65_533, 65_534, 65_535, 0].into_iter()), Code(65_535));
    assert_eq!(middle([7].into_iter()), Code(7));
}

#[test]
fn with_too_low_a_supply_nothing_is_saved() {
    let bench = Bench::default();
    bench.link_takes.set(true);
    bench.run(async {
        bench.supply_is_low.set(true);
        bench.send(Command::Save);
        bench.pass(20).await;
        bench.send(Command::Load);
        bench.pass(20).await;
        bench.supply_is_low.set(false);
        bench.send(Command::Save);
        bench.pass(20).await;
    });
    let expected = [Answer::Refused(Refusal::Supply), Answer::Refused(Refusal::NothingStored), Answer::Done];
    assert_eq!(answers(&bench), expected);
}

#[test]
fn the_chip_tells_what_its_stages_took() {
    let bench = Bench::default();
    bench.link_takes.set(true);
    bench.run(async {
        bench.send(Command::Save);
        bench.pass(20).await;
        bench.send(Command::Chip);
        bench.pass(20).await;
    });
    let [Answer::Done, Answer::Chip(chip)] = &answers(&bench)[..] else { panic!("{:?}", answers(&bench)) };
    assert_eq!((chip.sample.mean, chip.sample.worst, chip.clock_hz), (100.0, 100, 1_000_000));
    assert!(chip.sample.count >= 20 * BATCH as u32 && chip.observer.count == chip.sample.count && chip.save.count == 1);
}

#[test]
fn more_live_points_than_the_link_carries_are_refused() {
    let bench = Bench::default();
    bench.link_takes.set(true);
    bench.run(async {
        // At 1 kHz this board carries every tenth.
        bench.send(Command::Start(Stream { raw: true, live_every: 9 }));
        bench.pass(20).await;
        bench.send(Command::Start(Stream { raw: true, live_every: 10 }));
        bench.pass(20).await;
    });
    let answers: Vec<Frame> = bench.frames().into_iter().filter(|frame| matches!(frame, Frame::Answer(..))).collect();
    assert_eq!(answers, [Frame::Answer(1, Answer::Refused(Refusal::NotHere)), Frame::Answer(1, Answer::Done)]);
}
