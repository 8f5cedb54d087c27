//! The boards' images, starting: from power, from the bootloader, without a crystal, after faults.
#![cfg(unix)]

use serde_json::json;
use shared::wire::{Answer, Clock, Command as Order, ResetCause};
use std::process::Command;
use tests::emulator::{Chip, Emulated, stream};
use tests::image::{Board, workspace};

const BOARDS: [Board; 2] = [Board::FeatherF405, Board::NucleoF446];

#[test]
fn the_emulator_counts_instructions_as_a_hook_on_each_does() {
    let folder = workspace().join("tests/emulator");
    let packages = std::fs::read_to_string(folder.join("requirements.txt")).unwrap();
    let python = tests::python::python(&packages.split_whitespace().collect::<Vec<&str>>());
    let output = Command::new(python).arg("-B").arg(folder.join("counting.py")).output().unwrap();
    println!("{}", String::from_utf8_lossy(&output.stdout));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// A place in RAM for instructions, far from stack and statics of both boards.
const IN_RAM: u32 = 0x2001_8000;

/// The first register of TIM6, which no board uses.
const NO_MODEL: u32 = 0x4000_1000;

/// What is not modelled has not been tested: it ends the run instead of reading as zero.
#[test]
fn a_register_that_no_model_knows_ends_the_run_with_its_address() {
    // ldr r0, [pc, #4]; ldr or str r1, [r0]; an endless loop; the address.
    for (access, verb) in [("0168", "read"), ("0160", "wrote")] {
        let mut board = Emulated::new(&Chip::of(Board::NucleoF446));
        board.hello();
        let address = NO_MODEL.to_le_bytes().map(|byte| format!("{byte:02x}")).concat();
        board.obey("poke", json!({ "address": IN_RAM, "data": format!("0148{access}fee700bf{address}") }));
        board.obey("jump", json!({ "address": IN_RAM }));
        let reason = board.ends_with("run", json!({ "s": 0.1 }));
        assert!(reason.contains(&format!("{verb} {NO_MODEL:#010x}")), "{reason}");
    }
}

#[test]
fn prefetch_and_caches_are_on() {
    for kind in BOARDS {
        let mut board = Emulated::new(&Chip::of(kind));
        board.hello();
        let last = board.events_of("flash").next_back().expect("the wait states are set").clone();
        for what in ["prefetch", "instructions", "data"] {
            assert_eq!(last[what], true, "{kind:?}: {last}");
        }
    }
}

/// The F405's first revision, as the manual has it and as it says itself: as an STM32F2.
const FIRST_REVISION: [u32; 2] = [0x1000_6413, 0x2000_6411];

#[test]
fn the_prefetch_stays_off_on_the_first_revision_of_the_chip() {
    for id in FIRST_REVISION {
        let mut board = Emulated::new(&Chip { device_id: Some(id), ..Chip::of(Board::FeatherF405) });
        board.hello();
        let last = board.events_of("flash").next_back().expect("the wait states are set").clone();
        let on = ["prefetch", "instructions", "data"].map(|what| last[what] == true);
        assert_eq!(on, [false, true, true], "{id:#010x}: {last}");
    }
}

#[test]
fn the_bootloader_can_start_it() {
    for kind in BOARDS {
        let mut board = Emulated::new(&Chip { left_by_bootloader: true, ..Chip::of(kind) });
        board.hello();
        assert_eq!(board.events_of("bootloader").count(), 0, "{kind:?}: an interrupt went to the ROM");
        // It starts with what the bootloader has left running, and not only after the watchdog has reset that.
        assert_eq!(board.look("resets"), 0.0, "{kind:?}");
    }
}

#[test]
fn it_goes_into_the_bootloader_and_comes_back() {
    let mut board = Emulated::new(&Chip::of(Board::FeatherF405));
    board.hello();
    board.order(Order::Bootloader);
    board.run(1.0);
    let entered: Vec<_> = board.events_of("bootloader").collect();
    assert!(entered.len() == 1 && entered[0]["vectors"] == 0, "{entered:?}: its interrupts are the program's");
    board.obey("leave", json!({}));
    board.hello();
    assert_eq!(board.events_of("fault").count(), 0);
}

/// By the reset pin it was asked to, as by command; a short power cut, which memory outlasts, is power that came on.
#[test]
fn why_it_started_is_told_and_restarts_are_counted_from_when_power_came_on() {
    let mut board = Emulated::new(&Chip::of(Board::NucleoF446));
    let told = |board: &mut Emulated| {
        board.hello();
        let health = board.statistics().health;
        (health.cause, health.resets, !health.last_fault.is_empty())
    };
    assert_eq!(told(&mut board), (ResetCause::Power, 0, false));
    board.obey("reset", json!({}));
    board.run(0.5);
    assert_eq!(told(&mut board), (ResetCause::Asked, 1, false));
    board.order(Order::Reset);
    board.run(0.5);
    assert_eq!(told(&mut board), (ResetCause::Asked, 2, false));
    board.obey("jump", json!({ "address": 0xefff_fff0_u32 }));
    board.run(0.5);
    assert_eq!(told(&mut board), (ResetCause::HardFault, 3, true));
    board.obey("power", json!({ "keeps_memory": true }));
    assert_eq!(told(&mut board), (ResetCause::Power, 0, false));
}

/// Longer than the watchdog waits at its highest speed.
const HALT_S: f64 = 4.0;

#[test]
fn a_debugger_that_halts_the_processor_is_not_taken_for_a_program_that_stands_still() {
    for kind in BOARDS {
        let mut board = Emulated::new(&Chip { lsi_hz: 47_000, ..Chip::of(kind) });
        board.hello();
        board.obey("halt", json!({ "s": HALT_S }));
        board.run(HALT_S + 0.5);
        assert_eq!(board.look("resets"), 0.0, "{kind:?}");
        board.hello();
        assert_eq!(board.statistics().health.cause, ResetCause::Power, "{kind:?}");
        // It bites as ever.
        board.obey("stall", json!({ "s": HALT_S }));
        board.run(HALT_S);
        assert_eq!(board.look("resets"), 1.0, "{kind:?}");
    }
}

fn with_crystal() -> Emulated {
    let mut board = Emulated::new(&Chip::of(Board::NucleoF446));
    board.hello();
    board
}

#[test]
fn without_its_outside_clock_the_nucleo_runs_and_without_its_crystal_the_feather_blinks() {
    let mut nucleo = Emulated::new(&Chip { crystal: false, ..Chip::of(Board::NucleoF446) });
    nucleo.hello();
    let clock = |board: &mut Emulated| match board.ask(Order::Chip) {
        Answer::Chip(chip) => chip.clock,
        other => panic!("asked for the chip, got {other:?}"),
    };
    assert_eq!(clock(&mut nucleo), Clock::Internal);
    assert_eq!(clock(&mut with_crystal()), Clock::Crystal);
    nucleo.stream(0);
    nucleo.run(1.0);
    let gaps = stream::check(&nucleo.frames, 1e-3).unwrap();
    assert!(gaps.n_samples > 900 && gaps.n_missing == 0, "{gaps:?}");

    let mut feather = Emulated::new(&Chip { crystal: false, ..Chip::of(Board::FeatherF405) });
    feather.run(1.25);
    assert!(feather.events_of("watchdog").count() > 0, "the watchdog runs before the clocks");
    assert!(feather.events_of("pins").count() > 4, "{:?}", feather.events);
}

#[test]
fn a_hard_fault_restarts_the_rig_and_its_place_is_kept() {
    for kind in BOARDS {
        let mut board = Emulated::new(&Chip::of(kind));
        board.hello();
        board.obey("jump", json!({ "address": 0xefff_fff0_u32 }));
        board.run(0.5);
        board.hello();
        let health = board.statistics().health;
        assert_eq!((health.cause, health.resets), (ResetCause::HardFault, 1));
        assert!(health.last_fault.starts_with("pc 0xefffff"), "{}", health.last_fault);
        board.obey("reset", json!({}));
        board.run(0.5);
        board.hello();
        let later = board.statistics().health;
        assert_eq!((later.resets, &later.last_fault), (2, &health.last_fault));
    }
}

#[test]
fn a_stack_that_grows_into_its_guard_restarts_the_rig_which_says_so() {
    for kind in BOARDS {
        // The next interrupt has no room for its frame, 104 bytes; or it does, and its handler has none for the rest.
        for left in [8, 112] {
            let mut board = Emulated::new(&Chip::of(kind));
            board.hello();
            board.obey("stack_above_guard", json!({ "bytes": left }));
            board.run(0.5);
            board.hello();
            let health = board.statistics().health;
            println!("{kind:?}, {left} bytes left: {}", health.last_fault);
            assert_eq!((health.cause, health.resets), (ResetCause::HardFault, 1), "{kind:?}, {left} bytes");
            assert!(health.last_fault.starts_with("stack overflow"), "{kind:?}, {left}: {}", health.last_fault);
            assert_eq!(board.events_of("lockup").count(), 0);
        }
    }
}

/// The watchdog's oscillator, and the period that 2000 · 64 of its cycles make: longer than the longest erase.
const WATCHDOGS: [(u32, f64); 3] = [(17_000, 7.53), (32_000, 4.0), (47_000, 2.72)];

#[test]
fn a_program_that_stands_still_is_restarted_by_the_watchdog_at_whichever_speed_its_oscillator_runs() {
    for (lsi_hz, period_s) in WATCHDOGS {
        // So slow that there is not much of the loop to emulate.
        let mut board = Emulated::new(&Chip { lsi_hz, cpi: 20.0, ..Chip::of(Board::NucleoF446) });
        board.hello();
        // An endless loop with interrupts masked.
        board.obey("poke", json!({ "address": IN_RAM, "data": "72b6fee7" }));
        board.obey("jump", json!({ "address": IN_RAM }));
        let began_s = board.now_s;
        board.run(period_s + 0.5);
        let took_s = board.events_of("reset").next_back().unwrap()["at_s"].as_f64().unwrap() - began_s;
        assert!((period_s - 0.1..period_s + 0.1).contains(&took_s), "{lsi_hz} Hz: {took_s} s");
        board.hello();
        assert_eq!(board.statistics().health.cause, ResetCause::Watchdog);
    }
}
