//! The boards' images, saving: on the slowest chip that the data sheets allow, over everything that flash may hold, and
//! with power lost in the middle.
#![cfg(unix)]

use firmware::ports::FULL_SCALE;
use serde_json::json;
use shared::parameters::Parameters;
use shared::rig::Rig;
use shared::wire::{Answer, Command, Refusal, StoreState};
use std::collections::BTreeSet;
use tests::chance::Chance;
use tests::emulator::{Chip, Emulated, stream};
use tests::image::Board;

/// A save that needs a sector back erases it.
const N_RECYCLES: usize = 3;

/// The store's sectors, and how large each is.
const SECTORS: [u32; 3] = [0x0800_4000, 0x0800_8000, 0x0800_C000];
const SECTOR: usize = 0x4000;

/// Of a sector, 32 bits at once, at worst (DS8626, DS10693).
const ERASE_S: f64 = 0.5;

/// Until the ring that was overtaken meanwhile is read again, s.
const CATCH_UP_S: f64 = 0.06;

/// How many saves at most until everything has been seen.
const MOST_SAVES: usize = 5000;

/// Times that power is lost; `POWER_CUTS=100` takes minutes.
fn n_power_cuts() -> u64 {
    std::env::var("POWER_CUTS").map_or(8, |number| number.parse().expect("a number"))
}

fn parameters(inertia_kg_m2: f32) -> Parameters<f32> {
    let mut parameters = Parameters::paper().map(|value| value as f32);
    parameters.pendulum.inertia_kg_m2 = inertia_kg_m2;
    parameters
}

/// Tells the board parameters, and to keep them.
#[track_caller]
fn save(board: &mut Emulated, inertia_kg_m2: f32) -> f64 {
    board.order(Command::SetParameters((&parameters(inertia_kg_m2)).into()));
    let (answer, took_s) = board.ask_timed(Command::Save);
    assert_eq!(answer, Answer::Done, "after {:?}", board.events.last());
    took_s
}

#[track_caller]
fn kept(board: &mut Emulated) -> Parameters<f32> {
    match board.ask(Command::GetParameters) {
        Answer::Parameters(numbers) => numbers.into(),
        other => panic!("asked for parameters, got {other:?}"),
    }
}

/// What a rig with a store that holds nothing has.
fn defaults() -> Parameters<f32> {
    Rig::new("new", FULL_SCALE, Err(StoreState::Empty)).parameters().clone()
}

/// The rig has what was saved, or its defaults and says why.
#[track_caller]
fn has_what_it_says(board: &mut Emulated, saved: impl Fn(&Parameters<f32>) -> bool) -> StoreState {
    let (state, now) = (board.statistics().health.store, kept(board));
    let as_it_says = if state == StoreState::Loaded { saved(&now) } else { now == defaults() };
    assert!(as_it_says, "{state:?}: {now:?}");
    state
}

fn n_erases(board: &Emulated) -> usize {
    board.events_of("erase").count()
}

fn fill_with_noise(board: &mut Emulated, address: u32, length: usize, chance: &mut Chance) {
    let noise: String = (0..length).map(|_| format!("{:02x}", chance.within(0.0..256.0) as u8)).collect();
    board.obey("poke", json!({ "address": address, "data": noise }));
}

/// Power goes and comes back; the board has to answer.
#[track_caller]
fn cut_power(board: &mut Emulated) {
    board.obey("power", json!({}));
    board.hello();
}

#[test]
fn saving_through_recycles_feeds_the_watchdog_and_tells_every_sample_that_is_missing() {
    let mut board = Emulated::new(&Chip::worst(Board::NucleoF446));
    board.hello();
    board.stream(0);
    let recycles: usize = std::env::var("RECYCLES").map_or(N_RECYCLES, |number| number.parse().expect("a number"));
    let least_saves: usize = std::env::var("SAVES").map_or(0, |number| number.parse().expect("a number"));
    let (mut n_saves, mut longest_s): (usize, f64) = (0, 0.0);
    while n_erases(&board) < recycles || n_saves < least_saves {
        longest_s = longest_s.max(save(&mut board, 2e-3 + 1e-6 * (n_saves % 1000) as f32));
        n_saves += 1;
        assert!(n_saves < MOST_SAVES);
    }
    board.run(0.2);
    let gaps = stream::check(&board.frames, 1e-3).unwrap();
    let statistics = board.statistics();
    let unfed_s = board.look("longest_unfed_s");
    println!(
        "{n_saves} saves, {} erases, {longest_s:.3} s at most, {gaps:?}, the watchdog unfed for {unfed_s:.3} s at most",
        n_erases(&board)
    );
    assert_eq!((statistics.health.resets, board.look("resets")), (0, 0.0));
    assert_eq!(u64::from(statistics.paused), gaps.n_missing, "{gaps:?}");
    assert_eq!((statistics.overruns, statistics.dropped_frames), (0, 0));
    assert!(gaps.longest as f64 * 1e-3 < ERASE_S + CATCH_UP_S, "{gaps:?}");
    assert!(unfed_s < ERASE_S + CATCH_UP_S, "{unfed_s}");
    let widths: BTreeSet<String> = board.events_of("erase").map(|erase| erase["parallelism"].to_string()).collect();
    assert_eq!(widths, BTreeSet::from(["32".to_owned()]), "bits erased at once");

    // The share of the processor in use is right across erases, and again later.
    board.run(2.0);
    let busy_permille = board.statistics().health.cpu_permille;
    assert!((10..=200).contains(&busy_permille), "{busy_permille} permille busy after erases");

    cut_power(&mut board);
    assert_eq!(kept(&mut board), parameters(2e-3 + 1e-6 * ((n_saves - 1) % 1000) as f32));
}

#[test]
fn the_first_save_over_another_firmwares_data_erases_one_sector_at_a_time() {
    let mut board = Emulated::new(&Chip::worst(Board::NucleoF446));
    fill_with_noise(&mut board, SECTORS[0], 3 * SECTOR, &mut Chance::new(5));
    cut_power(&mut board);
    let at_start = has_what_it_says(&mut board, |_| false);
    println!("store at start: {at_start:?}");
    assert_ne!(at_start, StoreState::Loaded);
    board.stream(0);
    board.run(0.1);
    let took_s = save(&mut board, 2.5e-3);
    board.run(0.2);
    let gaps = stream::check(&board.frames, 1e-3).unwrap();
    let unfed_s = board.look("longest_unfed_s");
    println!("the save took {took_s:.3} s, {gaps:?}, the watchdog unfed for {unfed_s:.3} s");
    assert_eq!(board.look("resets"), 0.0);
    assert!(unfed_s < ERASE_S + CATCH_UP_S, "{unfed_s}");
    assert!(gaps.longest as f64 * 1e-3 < ERASE_S + CATCH_UP_S, "{gaps:?}");
    assert_eq!(u64::from(board.statistics().paused), gaps.n_missing, "{gaps:?}");
    cut_power(&mut board);
    assert_eq!(kept(&mut board), parameters(2.5e-3));
}

#[test]
fn power_lost_while_saving_leaves_the_old_or_the_new_parameters() {
    let mut board = Emulated::new(&Chip::of(Board::NucleoF446));
    let mut chance = Chance::new(6);
    board.hello();
    save(&mut board, 2e-3);
    let mut old = parameters(2e-3);
    for i in 0..n_power_cuts() {
        let new = parameters(2.1e-3 + 1e-5 * i as f32);
        board.order(Command::SetParameters((&new).into()));
        board.send(&shared::wire::Frame::Command(u16::MAX, Command::Save));
        board.run(chance.within(0.0..0.02));
        cut_power(&mut board);
        let now = kept(&mut board);
        assert!(now == old || now == new, "cut {i}: {now:?}");
        assert_eq!(board.statistics().health.store, StoreState::Loaded, "cut {i}");
        old = now;
    }
}

#[test]
fn power_lost_in_the_middle_of_an_erase_leaves_a_board_that_starts_and_saves() {
    let mut board = Emulated::new(&Chip::of(Board::NucleoF446));
    let mut chance = Chance::new(7);
    for i in 0..n_power_cuts() {
        fill_with_noise(&mut board, SECTORS[0], 3 * SECTOR, &mut chance);
        cut_power(&mut board);
        let before = n_erases(&board);
        board.send(&shared::wire::Frame::Command(u16::MAX, Command::Save));
        // Until one begins; over noise that looks like an erased sector none does.
        (0..400).for_each(|_| {
            if n_erases(&board) == before {
                board.run(5e-3);
            }
        });
        board.run(chance.within(0.0..0.2));
        cut_power(&mut board);
        let store = has_what_it_says(&mut board, |now| *now == defaults());
        println!("cut {i}: {store:?}");
        save(&mut board, 2e-3 + 1e-5 * i as f32);
        cut_power(&mut board);
        assert_eq!(board.statistics().health.store, StoreState::Loaded, "cut {i}");
        assert_eq!(kept(&mut board), parameters(2e-3 + 1e-5 * i as f32), "cut {i}");
    }
    let n_torn = board.events_of("torn").filter(|torn| torn["work"] == "erase").count();
    assert!(n_torn as u64 > n_power_cuts() / 3, "{n_torn} torn erases");
}

#[test]
fn a_corrupted_sector_is_survived_whichever_it_is() {
    let mut board = Emulated::new(&Chip::of(Board::NucleoF446));
    board.hello();
    let mut chance = Chance::new(8);
    for (i, sector) in SECTORS.into_iter().enumerate() {
        let saved = [0, 1, 2, 3, 4].map(|k| 2e-3 + 1e-5 * k as f32);
        saved.into_iter().for_each(|inertia_kg_m2| _ = save(&mut board, inertia_kg_m2));
        fill_with_noise(&mut board, sector, SECTOR, &mut chance);
        cut_power(&mut board);
        let store = has_what_it_says(&mut board, |now| saved.into_iter().any(|inertia| *now == parameters(inertia)));
        println!("sector {}: {store:?}", i + 1);
        assert_eq!(board.look("resets"), 0.0);
        save(&mut board, 2.6e-3);
        cut_power(&mut board);
        assert_eq!(kept(&mut board), parameters(2.6e-3), "sector {}", i + 1);
    }
}

#[test]
fn a_supply_that_is_too_low_for_the_flash_refuses_the_save() {
    let mut board = Emulated::new(&Chip::of(Board::NucleoF446));
    board.hello();
    save(&mut board, 2e-3);
    board.obey("supply", json!({ "mv": 2900 }));
    assert!(matches!(board.ask(Command::Save), Answer::Refused(_)));
    board.obey("supply", json!({ "mv": 3300 }));
    assert_eq!(board.ask(Command::Save), Answer::Done);
}

#[test]
fn protected_sectors_refuse_the_save_and_the_rig_goes_on() {
    for protected in [&[1, 2, 3][..], &[2]] {
        let mut board = Emulated::new(&Chip { protected, ..Chip::of(Board::NucleoF446) });
        fill_with_noise(&mut board, SECTORS[0], 3 * SECTOR, &mut Chance::new(9));
        cut_power(&mut board);
        board.stream(0);
        (0..2).for_each(|_| assert_eq!(board.ask(Command::Save), Answer::Refused(Refusal::Flash), "{protected:?}"));
        board.run(0.2);
        let gaps = stream::check(&board.frames, 1e-3).unwrap();
        assert!(gaps.n_samples > 150, "{gaps:?}");
        assert_eq!(board.look("resets"), 0.0);
    }
}

/// Option control register of the flash, and its byte that protects against reading (RM0090 3.9.10).
const OPTION_CONTROL: u32 = 0x4002_3C14;
const READ_PROTECTION: [u64; 3] = [0xaa, 0x55, 0xcc];

/// It keeps probes and the bootloader out. The rig's own program is not to be hindered, and has to leave the option bytes
/// alone: at level 2 nobody could ever change them back.
#[test]
fn protection_against_reading_hinders_neither_start_nor_save_nor_load() {
    for kind in [Board::FeatherF405, Board::NucleoF446] {
        for read_protection in [1, 2] {
            let mut board = Emulated::new(&Chip { read_protection, ..Chip::of(kind) });
            let register = board.obey("bus", json!({ "reads": [OPTION_CONTROL] }))["values"][0].as_u64().unwrap();
            assert_eq!(register >> 8 & 0xff, READ_PROTECTION[usize::from(read_protection)]);
            fill_with_noise(&mut board, SECTORS[0], 3 * SECTOR, &mut Chance::new(9));
            cut_power(&mut board);
            board.stream(0);
            save(&mut board, 2.5e-3);
            board.run(0.2);
            let gaps = stream::check(&board.frames, 1e-3).unwrap();
            assert_eq!(u64::from(board.statistics().paused), gaps.n_missing, "{gaps:?}");
            assert!(n_erases(&board) > 0, "{kind:?}, level {read_protection}");
            cut_power(&mut board);
            assert_eq!(kept(&mut board), parameters(2.5e-3), "{kind:?}, level {read_protection}");
            assert_eq!(board.statistics().health.store, StoreState::Loaded, "{kind:?}, level {read_protection}");
            assert_eq!(board.look("resets"), 0.0, "{kind:?}, level {read_protection}");
        }
    }
}

#[test]
fn nothing_rests_on_the_processor_standing_still_while_the_flash_works_or_on_its_interrupt() {
    let mut board = Emulated::new(&Chip { flash_beside: true, ..Chip::of(Board::NucleoF446) });
    fill_with_noise(&mut board, SECTORS[0], 3 * SECTOR, &mut Chance::new(5));
    cut_power(&mut board);
    board.stream(0);
    let before = n_erases(&board);
    save(&mut board, 2.5e-3);
    board.run(0.1);
    let gaps = stream::check(&board.frames, 1e-3).unwrap();
    assert!(n_erases(&board) > before && gaps.n_missing == 0, "{gaps:?}");
    cut_power(&mut board);
    assert_eq!(kept(&mut board), parameters(2.5e-3));
}
