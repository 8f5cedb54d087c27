//! The page beside the real firmware: the rig itself says what is missing, it is added and pushed by plain requests, and
//! the rig suspects nothing any longer.

use serde_json::{Value, json};
use shared::effect::Effect;
use shared::parameters::Parameters;
use tests::image::{Board, firmware};
use tests::page::{Server, Tab};
use tests::plant::Scenario;
use tests::qemu::Qemu;

const DRAG: &str = "quadratic-drag";

/// Hidden in the pendulum, N·m·s²/rad².
const DRAG_SIZE: f64 = 1.0e-4;

/// What the rig itself says once it has looked at more releases than these.
fn judged_by_the_rig(tab: &mut Tab, n_before: u64) -> Value {
    let n_releases = |evidence: &Value| {
        let (_, after) = evidence["sentence"].as_str()?.split_once(" after ")?;
        let number = after.split([' ', ':']).next()?;
        if number == "one" { Some(1) } else { number.parse::<u64>().ok() }
    };
    let is_new = |evidence: &Value| n_releases(evidence).is_some_and(|n| n > n_before);
    let state = tab.wait_for(|state| state["evidence"]["judge"] == "rig" && is_new(&state["evidence"]));
    state["evidence"].clone()
}

#[test]
fn what_the_rig_itself_names_is_added_by_the_page_and_suspected_no_more() {
    let mut truth = Parameters::paper();
    truth.set(Effect::<f64>::by_name(DRAG).unwrap().id, &[DRAG_SIZE]).unwrap();
    let scenario =
        Scenario { parameters: truth, release_rad: 1.3, swing_s: 45.0, alternate: true, ..Scenario::default() };
    let qemu = Qemu::start(&firmware(Board::Qemu).unwrap(), scenario).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let server = Server::start(folder.path(), &format!("--port {}", qemu.port()));
    let mut tab = server.tab();
    let named = judged_by_the_rig(&mut tab, 0);
    println!("{named}");
    assert_eq!((&named["named"], &named["trouble"]), (&json!([DRAG]), &Value::Null), "{named}");
    assert!(named["sentence"].as_str().unwrap().starts_with("The rig itself names what is missing"), "{named}");

    assert_eq!(server.post("/api/rig/suspect", &format!("{{\"effect\":\"{DRAG}\"}}")).status, 204);
    assert_eq!(server.post("/api/rig/push", "{}").status, 204);
    let after = judged_by_the_rig(&mut tab, 1);
    println!("{after}");
    assert_eq!(after["named"], json!([]), "{after}");
    assert!(after["candidates"].as_array().unwrap().iter().all(|one| one["name"] != DRAG), "{after}");
}
