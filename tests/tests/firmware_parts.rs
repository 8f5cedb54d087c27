//! The firmware's parts on the PC: the store under power cuts, the wire under faults, the queue, the converter's
//! bookkeeping, and the application on a board made of memory.

use firmware::frame_queue::{CAPACITY, Encoded, FrameQueue};
use firmware::oversampling::{plan, sample};
use firmware::ports::FULL_SCALE;
use firmware::ring::{RingReader, Trouble};
use shared::units::Code;
use shared::wire::{Deframer, Frame, Live, MAX_FRAME, POINTS_PER_FRAME, Point, SAMPLES_PER_FRAME, Samples, encode};
use target_tests::checks::count_power_cuts;
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
    let frame = |i: u32| if i % 3 == 0 { live(i) } else { samples(i) };
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
        embassy_futures::block_on(queue.take(&mut encoded));
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
