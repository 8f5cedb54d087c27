//! The boards' images at other sampling rates: each is made exactly, or the nearest one is reported and kept to.
#![cfg(unix)]

use firmware::ports::BATCH;
use serde_json::json;
use shared::wire::{Answer, Command, Refusal, Settings};
use tests::chance::Chance;
use tests::emulator::{Chip, Emulated, stream};
use tests::image::Board;

const BOARDS: [Board; 2] = [Board::FeatherF405, Board::NucleoF446];

/// Whole divisors of the timer's clock of 84 MHz and of the least and most conversions a sample.
const EXACT_HZ: [f32; 4] = [50.0, 100.0, 1000.0, 10_000.0];

/// Rates that the timer's 16 bits cannot make. 192 Hz was once made as 479, 160 and 320 as a thousand times as much; the
/// others are primes and what sound cards take.
const NEAREST_HZ: [f32; 7] = [50.3, 160.0, 192.0, 320.0, 441.0, 997.0, 9973.0];

/// Of 84 MHz in at least four conversions: half a tick of 2,100 at 10 kHz, and less below.
const NEAREST: f32 = 0.5 / 2100.0;

/// Virtual seconds; the timer's own period says more than a longer stream.
const SECONDS: f64 = 0.5;

/// What an `f32` rounds.
const ROUNDED: f64 = 1e-7;

/// Changes of the rate, and overruns.
const N_CHANGES: usize = 20;

/// Samples behind a change of the rate that the converter's ring and the frame hold back.
const IN_WORK_S: f64 = 0.1;

fn settings(board: &mut Emulated) -> Settings {
    match board.ask(Command::GetSettings) {
        Answer::Settings(settings) => settings,
        other => panic!("asked for settings, got {other:?}"),
    }
}

/// Orders a rate; gives the one that the board then reports.
#[track_caller]
fn order(board: &mut Emulated, rate_hz: f32) -> f32 {
    let wanted = settings(board).at_rate(rate_hz);
    board.order(Command::SetSettings(wanted));
    board.run(IN_WORK_S);
    settings(board).rate_hz
}

/// Streams for a while. The potentiometer counts milliseconds: the samples have to be as far apart as was reported.
#[track_caller]
fn keeps_to(board: &mut Emulated, made_hz: f32) {
    board.stream(0);
    board.run(SECONDS);
    board.order(Command::Stop);
    let rate_hz = f64::from(made_hz);
    let gaps = stream::check(&board.frames, 1.0 / rate_hz).unwrap_or_else(|reason| panic!("{made_hz} Hz: {reason}"));
    let least = (SECONDS - IN_WORK_S) * rate_hz - 16.0;
    assert!(gaps.n_samples as f64 > least && gaps.n_missing == 0, "{made_hz} Hz: {gaps:?}");
}

/// The converter's trigger has to divide the reported rate into 4 to 64 conversions a sample.
#[track_caller]
fn is_triggered_at(board: &mut Emulated, made_hz: f32) {
    let per_sample = 1.0 / (f64::from(made_hz) * board.look("sampling_s"));
    let nearest = per_sample.round();
    assert!((per_sample / nearest - 1.0).abs() < ROUNDED, "{made_hz} Hz: {per_sample} conversions a sample");
    assert!((4..=64).contains(&(nearest as u32)) && (nearest as u32).is_power_of_two(), "{made_hz} Hz: {nearest}");
}

#[test]
fn a_rate_is_made_exactly_or_the_nearest_one_is_reported_and_kept_to() {
    for kind in BOARDS {
        let mut board = Emulated::new(&Chip::of(kind));
        board.hello();
        for asked_hz in EXACT_HZ.into_iter().chain(NEAREST_HZ) {
            let made_hz = order(&mut board, asked_hz);
            println!("{kind:?}: {asked_hz} Hz asked for, {made_hz} Hz made");
            let is_exact = EXACT_HZ.contains(&asked_hz);
            assert_eq!(made_hz == asked_hz, is_exact, "{made_hz} Hz");
            assert!((made_hz / asked_hz - 1.0).abs() <= NEAREST, "{asked_hz} Hz became {made_hz} Hz");
            is_triggered_at(&mut board, made_hz);
            keeps_to(&mut board, made_hz);
        }
        let statistics = board.statistics();
        assert_eq!((statistics.overruns, statistics.paused, statistics.health.resets), (0, 0, 0));
    }
}

#[test]
fn a_rate_that_is_none_is_refused_by_its_place_and_sampling_goes_on() {
    for kind in BOARDS {
        let mut board = Emulated::new(&Chip::of(kind));
        board.hello();
        let before = settings(&mut board);
        for rate_hz in [49.9, 10_001.0, 0.0, -1000.0, f32::NAN, f32::INFINITY] {
            let answer = board.ask(Command::SetSettings(Settings { rate_hz, ..before }));
            assert_eq!(answer, Answer::Refused(Refusal::Setting { index: 0 }), "{rate_hz} Hz");
        }
        assert_eq!(settings(&mut board), before);
        keeps_to(&mut board, before.rate_hz);
    }
}

#[test]
fn a_rate_that_was_made_is_kept_through_a_power_cut() {
    let mut board = Emulated::new(&Chip::of(Board::NucleoF446));
    board.hello();
    let made_hz = order(&mut board, 192.0);
    board.order(Command::Save);
    board.obey("power", json!({}));
    board.hello();
    assert_eq!(settings(&mut board).rate_hz, made_hz);
    keeps_to(&mut board, made_hz);
}

#[test]
fn a_change_of_the_rate_loses_nothing_and_starts_the_converter_once() {
    let rates_hz = [10_000.0, 1000.0, 5000.0, 50.0, 2500.0];
    for kind in BOARDS {
        let mut board = Emulated::new(&Chip::of(kind));
        board.hello();
        let mut chance = Chance::new(11);
        let wanted = settings(&mut board);
        for rate_hz in rates_hz.into_iter().cycle().take(N_CHANGES) {
            board.run(chance.within(0.0..25e-6) + 0.02);
            board.order(Command::SetSettings(wanted.at_rate(rate_hz)));
            board.run(0.05);
            let statistics = board.statistics();
            assert_eq!((statistics.overruns, statistics.paused), (0, 0), "{kind:?} at {rate_hz} Hz");
        }
        assert_eq!(board.look("converter_starts") as usize, 1 + N_CHANGES, "{kind:?}");
    }
}

/// Control register of the DMA stream that carries the results, and its enable bit (RM0090 10.5.5).
const STREAM_CONTROL: u32 = 0x4002_6410;
const ENABLED: u64 = 1;

#[test]
fn a_converter_that_overran_is_started_again_once_and_what_it_lost_is_counted() {
    let mut board = Emulated::new(&Chip::of(Board::NucleoF446));
    board.hello();
    let mut chance = Chance::new(12);
    order(&mut board, 10_000.0);
    board.stream(0);
    let before = board.look("converter_starts");
    for _ in 0..N_CHANGES {
        // At any moment of the 25 us between two conversions, one of which takes 7: it may be under way when it is
        // started anew, and must not be taken for one of the new ones.
        board.run(chance.within(0.0..2e-3) + 0.05);
        let control = board.obey("bus", json!({ "reads": [STREAM_CONTROL] }))["values"][0].as_u64().unwrap();
        board.obey("bus", json!({ "writes": [[STREAM_CONTROL, control & !ENABLED]] }));
    }
    board.run(0.2);
    let gaps = stream::check(&board.frames, 1e-4).unwrap();
    let statistics = board.statistics();
    println!("{gaps:?}, {} overruns", statistics.overruns);
    assert_eq!((u64::from(statistics.overruns), statistics.paused), (gaps.n_missing, 0));
    assert!(gaps.n_missing >= N_CHANGES as u64, "{gaps:?}");
    assert_eq!((board.look("converter_starts") - before) as usize, N_CHANGES);
}

/// Times that the processor stands still, each longer than the converter's ring lasts.
const N_STALLS: usize = 20;
const STALL_S: f64 = 0.12;

/// A flash erase stops it wherever it needs its next instruction from there.
#[test]
fn of_what_the_converter_did_while_the_processor_stood_still_the_last_samples_are_not_lost() {
    let mut board = Emulated::new(&Chip::of(Board::NucleoF446));
    board.hello();
    let mut chance = Chance::new(13);
    board.stream(0);
    for _ in 0..N_STALLS {
        board.run(chance.within(0.0..2e-3) + 0.05);
        board.obey("stall", json!({ "s": STALL_S }));
        board.run(STALL_S);
    }
    board.run(0.2);
    let gaps = stream::check(&board.frames, 1e-3).unwrap();
    let statistics = board.statistics();
    println!("{gaps:?}, {} overruns", statistics.overruns);
    assert_eq!((u64::from(statistics.overruns), statistics.paused), (gaps.n_missing, 0));
    assert_eq!((statistics.dropped_frames, statistics.health.resets), (0, 0));
    assert!(gaps.n_missing >= N_STALLS as u64, "{gaps:?}");
    // Up to the next look, 2 ms, and in whole samples.
    assert!(gaps.longest as f64 * 1e-3 <= STALL_S - BATCH as f64 * 1e-3 + 3e-3, "{gaps:?}");
}
