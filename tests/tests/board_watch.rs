//! `host watch` on the Feather's own image: the board itself names what its model lacks, over USB, and the program says
//! that it was the board.
#![cfg(unix)]

use serde_json::{Value, json};
use shared::effect::Effect;
use std::path::Path;
use tests::emulator::{Chip, Terminal};
use tests::image::Board;
use tests::plant::Scenario;
use tests::program::host;

const DRAG: &str = "quadratic-drag";

/// Hidden in the pendulum, N·m·s²/rad²; the paper's friction and this end a swing within half a minute.
const DRAG_SIZE: f64 = 4e-4;

#[test]
#[ignore = "takes more than a minute: tests/more boards"]
fn what_a_feathers_model_lacks_is_named_by_the_feather() {
    let mut scenario = Scenario { rest_s: 1.5, lift_s: 0.7, release_rad: 1.3, ..Scenario::default() };
    scenario.parameters.set(Effect::<f64>::by_name(DRAG).unwrap().id, &[DRAG_SIZE]).unwrap();
    let board = Terminal::start(&Chip::of(Board::FeatherF405), scenario).unwrap();
    let run = host(Path::new("."), &format!("watch --port {} --json", board.port()));
    println!("{}", run.stderr);
    let look: Value = serde_json::from_str(run.succeeded()).unwrap();
    println!("{look:#}");
    assert_eq!((&look["named"], &look["judge"]), (&json!([DRAG]), &json!("rig")), "{look:#}");
    let number = &look["candidates"][0]["values"][0];
    let (size, std) = (number["value"].as_f64().unwrap(), number["std"].as_f64().unwrap());
    assert!((size / DRAG_SIZE - 1.0).abs() < 0.1 && std > 0.0, "{size} ± {std}");
    assert!(run.stderr.contains("the rig itself looks"), "{}", run.stderr);
    let events = board.events();
    assert_eq!(events.iter().find(|event| event["event"] == "failure" || event["event"] == "reset"), None);
}
