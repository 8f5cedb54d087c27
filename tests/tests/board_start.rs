//! The boards' images, starting: from power, from the bootloader, without a crystal, after faults.
#![cfg(unix)]

use serde_json::json;
use shared::wire::{Command as Order, ResetCause};
use std::process::Command;
use tests::emulator::{Chip, Emulated};
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

#[test]
fn prefetch_and_instruction_cache_are_on() {
    for kind in BOARDS {
        let mut board = Emulated::new(&Chip::of(kind));
        board.hello();
        let last = board.events_of("flash").next_back().expect("the wait states are set").clone();
        assert_eq!((&last["prefetch"], &last["instructions"]), (&json!(true), &json!(true)), "{kind:?}: {last}");
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
    assert_eq!(board.events_of("bootloader").count(), 1);
    board.obey("leave", json!({}));
    board.hello();
    assert_eq!(board.events_of("fault").count(), 0);
}

#[test]
fn without_its_outside_clock_the_nucleo_runs_and_without_its_crystal_the_feather_blinks() {
    let mut nucleo = Emulated::new(&Chip { crystal: false, ..Chip::of(Board::NucleoF446) });
    nucleo.hello();
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

#[test]
fn a_program_that_stands_still_is_restarted_by_the_watchdog() {
    let mut board = Emulated::new(&Chip { lsi_hz: 47_000, cpi: 4.0, ..Chip::of(Board::NucleoF446) });
    board.hello();
    // An endless loop in RAM with interrupts masked.
    board.obey("poke", json!({ "address": 0x2001_8000_u32, "data": "72b6fee7" }));
    board.obey("jump", json!({ "address": 0x2001_8000_u32 }));
    board.run(5.0);
    board.hello();
    assert_eq!(board.statistics().health.cause, ResetCause::Watchdog);
}
