//! The firmware's parts on the PC: the store under power cuts, the wire under faults, the queue, the converter's
//! bookkeeping, and the application on a board made of memory.

#[path = "firmware_parts/application.rs"]
mod application;
#[path = "firmware_parts/bench.rs"]
mod bench;
#[path = "firmware_parts/converter.rs"]
mod converter;

use embassy_futures::block_on;
use firmware::frame_queue::{CAPACITY, Encoded, FrameQueue};
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
