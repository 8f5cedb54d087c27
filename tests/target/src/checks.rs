//! Statements that must hold on the microcontroller: physics with a tolerance, messages, the store.

use crate::cut_flash::{CutFlash, SIZE};
use crate::noise::Noise;
use crate::traces::{codes, parameters};
use embassy_futures::block_on;
use firmware::store::Store;
use shared::filter::{Butterworth, FilterState};
use shared::model::Model;
use shared::observer::Observer;
use shared::parameters::Parameters;
use shared::potentiometer::Potentiometer;
use shared::rig::Rig;
use shared::units::Code;
use shared::wire::{Deframer, Frame, MAX_FRAME, SAMPLES_PER_FRAME, Samples, StoreState, encode};

/// One statement; it panics if it does not hold.
pub struct Check {
    /// The statement.
    pub name: &'static str,
    /// Looks.
    pub run: fn(),
}

/// All of them.
pub const ALL: &[Check] = &[
    Check { name: "energy_falls_in_every_step", run: energy_falls_in_every_step },
    Check { name: "half_the_step_gives_the_same_swing", run: half_the_step_gives_the_same_swing },
    Check { name: "a_stuck_pendulum_stays_and_a_steeper_one_does_not", run: a_stuck_pendulum_stays },
    Check { name: "the_filter_passes_slow_and_stops_fast", run: the_filter_passes_slow_and_stops_fast },
    Check { name: "the_observer_finds_the_velocity", run: the_observer_finds_the_velocity },
    Check { name: "a_frame_with_any_wrong_bit_is_refused", run: a_frame_with_any_wrong_bit_is_refused },
    Check { name: "the_store_keeps_what_it_was_given", run: the_store_keeps_what_it_was_given },
    Check { name: "foreign_content_is_refused_and_then_replaced", run: foreign_content_is_refused_and_then_replaced },
    Check { name: "a_power_cut_leaves_the_old_or_the_new", run: || power_cuts(200, 5) },
];

const DT_S: f32 = 1e-3;

fn energy_falls_in_every_step() {
    let model = Model::new(&parameters());
    let mut state = model.release(1.2, 0.0);
    let mut before_j = model.energy_j(&state);
    for _ in 0..20_000 {
        model.step(&mut state, DT_S);
        let now_j = model.energy_j(&state);
        // Rounding of f32: 2^-23 of the energy at the start, 0.29 J.
        assert!(now_j <= before_j + 1e-7, "{now_j} after {before_j}");
        before_j = now_j;
    }
}

fn half_the_step_gives_the_same_swing() {
    let model = Model::new(&parameters());
    let (mut whole, mut half) = (model.release(1.0, 0.0), model.release(1.0, 0.0));
    for _ in 0..5000 {
        model.step(&mut whole, DT_S);
        model.step(&mut half, 0.5 * DT_S);
        model.step(&mut half, 0.5 * DT_S);
    }
    // The fourth-order error of 1 ms is far below what rounding adds over 10,000 steps.
    assert!((whole.angle_rad - half.angle_rad).abs() < 5e-5);
}

fn a_stuck_pendulum_stays() {
    let mut sticky = parameters();
    let values = [5e-3, 0.01];
    assert!(sticky.set(shared::parameters::base::STICTION, &values).is_ok());
    let model = Model::new(&sticky);
    let breakaway_rad = values[0] / sticky.pendulum.gravity_torque_nm();
    for (share, stays) in [(0.99, true), (1.01, false)] {
        let start_rad = share * breakaway_rad;
        let mut state = model.release(start_rad, 0.0);
        (0..5000).for_each(|_| model.step(&mut state, DT_S));
        assert_eq!(state.angle_rad == start_rad, stays);
    }
}

fn the_filter_passes_slow_and_stops_fast() {
    let filter = Butterworth::<f32>::new(50.0, 1000.0).expect("a usual cut-off");
    let mut state = FilterState::settled_at(0.0);
    (0..1000).for_each(|_| {
        state.step(&filter, 1.0);
    });
    assert!((state.step(&filter, 1.0) - 1.0).abs() < 1e-5);
    // At half the rate the bilinear transform has its zero.
    let alternating = |i: i32| if i % 2 == 0 { 1.0 } else { -1.0 };
    (0..1000).for_each(|i| {
        state.step(&filter, alternating(i));
    });
    assert!(state.step(&filter, 1.0).abs() < 1e-4);
}

fn the_observer_finds_the_velocity() {
    let model = Model::new(&parameters());
    let mut state = model.release(1.0, 0.0);
    let mut observer = Observer::new(&parameters(), 3.0);
    let potentiometer = Potentiometer::nominal(firmware::ports::FULL_SCALE);
    let mut worst = 0.0_f32;
    let mut n_seen = 0;
    let each = |code: Code| {
        let estimate = observer.on_measurement(potentiometer.angle(code).0, DT_S);
        n_seen += 1;
        if n_seen > 2000 {
            worst = worst.max((estimate.velocity_rad_s - state.velocity_rad_s).abs());
        }
        model.step(&mut state, DT_S);
    };
    codes(each, 10_000);
    assert!(worst < 0.01, "{worst} rad/s");
}

fn a_frame_with_any_wrong_bit_is_refused() {
    let frame = Frame::Samples(Samples {
        sequence: 7,
        first_sample: 112,
        status: 0,
        codes: [8190; SAMPLES_PER_FRAME].into_iter().collect(),
    });
    let mut buffer = [0; MAX_FRAME];
    let n_bytes = encode(&frame, &mut buffer).expect("a frame fits").len();
    for bit in 0..8 * n_bytes {
        let mut bytes = buffer;
        bytes[bit / 8] ^= 1 << (bit % 8);
        let mut deframer = Deframer::new();
        let wrong = bytes[..n_bytes].iter().chain(&[0]).filter_map(|byte| deframer.push(*byte)).any(|got| got.is_ok());
        assert!(!wrong, "bit {bit}");
    }
    let mut deframer = Deframer::new();
    assert_eq!(buffer.iter().find_map(|byte| deframer.push(*byte)), Some(Ok(frame)));
}

fn stored(inertia_kg_m2: f32) -> shared::rig::Stored {
    let rig = Rig::new("store", firmware::ports::FULL_SCALE, Err(StoreState::Empty));
    let mut parameters: Parameters<f32> = rig.parameters().clone();
    parameters.pendulum.inertia_kg_m2 = inertia_kg_m2;
    shared::rig::Stored { parameters, settings: *rig.settings() }
}

fn the_store_keeps_what_it_was_given() {
    let mut flash = CutFlash::new(1);
    assert_eq!(block_on(Store::new(&mut flash, 0..SIZE as u32).load()), Err(StoreState::Empty));
    for i in 1..100 {
        let given = stored(i as f32 * 1e-4);
        assert_eq!(block_on(Store::new(&mut flash, 0..SIZE as u32).save(&given)), Ok(()));
        assert_eq!(block_on(Store::new(&mut flash, 0..SIZE as u32).load()), Ok(given));
    }
}

fn foreign_content_is_refused_and_then_replaced() {
    for seed in 1..20 {
        let mut flash = CutFlash::foreign(seed);
        assert!(block_on(Store::new(&mut flash, 0..SIZE as u32).load()).is_err());
        let given = stored(2e-3);
        assert_eq!(block_on(Store::new(&mut flash, 0..SIZE as u32).save(&given)), Ok(()));
        assert_eq!(block_on(Store::new(&mut flash, 0..SIZE as u32).load()), Ok(given));
    }
}

/// A save takes about this many operations: 36 words, and now and then the erase and the marks of a page.
const SAVE_OPERATIONS: u32 = 44;

/// How often a cut hit what.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cuts {
    /// Words being programmed.
    pub in_writes: u32,
    /// Sectors being erased.
    pub in_erases: u32,
    /// Saves that had got far enough.
    pub kept_new: u32,
}

/// Saves again and again, with a power cut at a random operation of each save, and looks what is left.
pub fn power_cuts(n_cuts: u32, seed: u32) {
    let _ = count_power_cuts(n_cuts, seed);
}

/// The same, and counts.
pub fn count_power_cuts(n_cuts: u32, seed: u32) -> Cuts {
    let mut flash = CutFlash::new(seed);
    let mut noise = Noise::new(seed.wrapping_mul(77));
    let mut present = stored(1e-3);
    let mut counted = Cuts::default();
    assert_eq!(block_on(Store::new(&mut flash, 0..SIZE as u32).save(&present)), Ok(()));
    let mut i = 0;
    while counted.in_writes + counted.in_erases < n_cuts {
        i += 1;
        let next = stored(1e-3 + i as f32 * 1e-7);
        // A third of the saves go through unless they erase, so that the cuts move on from page to page.
        match noise.below(3) {
            0 => flash.cut_at_an_erase(),
            _ => flash.cut_after(noise.below(SAVE_OPERATIONS)),
        }
        let outcome = block_on(Store::new(&mut flash, 0..SIZE as u32).save(&next));
        let cut = flash.cut;
        flash.restore_power();
        let left = block_on(Store::new(&mut flash, 0..SIZE as u32).load());
        let kept_new = left.as_ref() == Ok(&next);
        assert!(kept_new || left.as_ref() == Ok(&present), "cut {i} during {cut:?} left {left:?}");
        assert!(cut.is_some() || outcome == Ok(()), "save {i} failed without a cut");
        match cut {
            Some(crate::cut_flash::During::Write) => counted.in_writes += 1,
            Some(crate::cut_flash::During::Erase) => counted.in_erases += 1,
            None => {}
        }
        counted.kept_new += u32::from(kept_new && cut.is_some());
        present = if kept_new { next } else { present };
    }
    counted
}
