//! The Live view says what the rig's model lacks while it swings: bars of evidence, a name, and adding it.
//! Pictures are kept in `target/page-pictures`.
#![cfg(target_os = "linux")]

use serde_json::{Value, json};
use std::path::Path;
use tests::browser::Browser;
use tests::page::Server;

/// The simulated rig runs so many times faster than real time.
const SPEED: f64 = 16.0;

fn server(folder: &tempfile::TempDir, scenario: &str) -> Server {
    Server::start(folder.path(), &format!("--port {scenario} --sim-speed {SPEED}"))
}

/// Bars and what they say, as the page shows them.
const BARS: &str = "return [...document.querySelectorAll('#evidence-bars li')].map((bar) => ({
    name: bar.dataset.name, p: Number(bar.dataset.p), kind: bar.className, can_be_added: !!bar.querySelector('.add'),
    width: bar.querySelector('.bar i').getBoundingClientRect().width / bar.querySelector('.bar').clientWidth }))";

/// Waits until a swing has ended and was looked at so many releases long; gives what is said then.
async fn ended(browser: &Browser, after: &str) -> String {
    let is_still = "document.getElementById('evidence-stage').textContent.startsWith('Still')";
    let is_told = format!("document.getElementById('evidence-words').textContent.includes('after {after}')");
    browser.wait_for(&format!("{is_still} && {is_told}")).await;
    browser.text("#evidence-words").await
}

/// The bars once they have stopped growing.
async fn bars(browser: &Browser) -> Vec<Value> {
    browser.wait_for("document.getAnimations().length === 0").await;
    browser.run(BARS).await.as_array().unwrap().clone()
}

/// On light friction that fades one release looks like several laws of speed: long bars, and no claim.
#[test]
fn bars_grow_a_name_appears_and_once_it_is_added_the_next_swing_is_not_suspect() {
    let folder = tempfile::tempdir().unwrap();
    let server = server(&folder, "sim:mystery-6");
    tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap().block_on(async {
        let browser = Browser::open(&format!("{}#live", server.url), 1440, 900).await;
        let told = ended(&browser, "one release").await;
        assert!(told.starts_with("Nothing is named after one release: too few swings"), "{told}");
        let unnamed = bars(&browser).await;
        assert!(unnamed.len() >= 3 && unnamed[0]["p"].as_f64() < Some(1e-6), "{unnamed:?}");
        assert!(unnamed.iter().all(is_no_claim), "{unnamed:?}");
        assert!(unnamed[0]["width"].as_f64() > Some(0.4), "{unnamed:?}");
        assert_eq!(browser.text("#evidence-judge").await, "Judged by the rig itself.");
        browser.keep_picture("16-bars-without-a-name").await;
        keep_for_docs(&browser, "bars").await;

        browser.click("#again").await;
        browser.wait_for("document.querySelector('#evidence.named')").await;
        browser.keep_picture("17-named-while-it-swings").await;
        let told = ended(&browser, "2 releases").await;
        let named = bars(&browser).await;
        assert!(told.starts_with("The rig itself names what is missing: drifting-friction (rc = ("), "{told}");
        assert!(!browser.text("#evidence-meaning").await.is_empty());
        assert_eq!(
            (&named[0]["name"], &named[0]["kind"]),
            (&json!("drifting-friction"), &json!("claimed")),
            "{named:?}"
        );
        assert_eq!(browser.text("#evidence-judge").await, "Judged by the rig itself.");
        browser.keep_picture("17-named").await;
        keep_for_docs(&browser, "named").await;

        browser.click("#evidence-bars .claimed .add").await;
        browser.wait_for("document.getElementById('push-dialog').open").await;
        let table = browser.text("#push-table").await;
        assert!(table.contains("rc") && table.contains("absent"), "{table}");
        browser.keep_picture("18-added").await;
        browser.click("#push-yes").await;
        let told = ended(&browser, "3 releases").await;
        let after = bars(&browser).await;
        assert!(told.starts_with("Nothing is named after 3 releases: nothing is missing"), "{told}");
        assert!(after.iter().all(is_no_claim), "{after:?}");
        assert!(after.iter().all(|bar| bar["name"] != "drifting-friction"), "{after:?}");
        let widest = |bars: &[Value]| bars.iter().filter_map(|bar| bar["width"].as_f64()).fold(0.0, f64::max);
        assert!(widest(&after) < 0.6 * widest(&named), "{after:?}");
        browser.keep_picture("19-not-suspect").await;
        keep_for_docs(&browser, "after").await;
        assert_eq!(browser.run("return document.getElementById('failure').hidden").await, true);

        // Paused, a simulated rig lets go anew, whatever the button was called before.
        browser.click("#listen").await;
        browser.wait_for("document.getElementById('listen').innerText === 'Let go again'").await;
        assert_eq!(browser.run("return document.getElementById('again').hidden").await, true);
        browser.close().await;
    });
}

/// With UPDATE_DOCS=1 the pictures of docs/diagnosis.md are made anew: the card with the bars.
async fn keep_for_docs(browser: &Browser, what: &str) {
    if std::env::var_os("UPDATE_DOCS").is_none() {
        return;
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    // All of the card is shown, and the page's head covers none of it.
    browser.resize(1440, 1300).await;
    browser.run("document.querySelector('header').style.position = 'static'").await;
    std::fs::write(folder.join(format!("live-{what}.png")), browser.picture_of("#evidence").await).unwrap();
}

fn is_no_claim(bar: &Value) -> bool {
    bar["kind"] == "" && bar["can_be_added"] == false
}

/// The state once a rig's swing has ended and was looked at `n` releases long.
fn looked_at(server: &Server, n: &str) -> Value {
    let after = format!("after {n}");
    server.tab().wait_for(|state| {
        let is_ended = state["evidence"]["stage"] == "waiting" && state["evidence"]["is_rig_due"] == false;
        is_ended && state["evidence"]["sentence"].as_str().is_some_and(|told| told.contains(&after))
    })
}

/// Another rig is there, and what was found of the one before is gone.
fn met(server: &Server, port: &str) {
    server.tab().wait_for(|state| state["rig"]["port"] == port && !state["rig"]["firmware"].is_null());
}

/// The simulated rig's own friction and inertia are those of a drawing. With older firmware the program judges.
#[test]
fn numbers_that_are_wrong_are_fitted_from_the_live_view_and_nothing_is_missing_then() {
    for (scenario, judge) in [("sim", "rig"), ("sim:old-firmware", "program")] {
        fits_wrong_numbers(scenario, judge);
    }
}

fn fits_wrong_numbers(scenario: &str, judge: &str) {
    let folder = tempfile::tempdir().unwrap();
    let server = server(&folder, scenario);
    let evidence = &looked_at(&server, "one release")["evidence"];
    assert!(evidence["sentence"].as_str().unwrap().contains("numbers are wrong"), "{evidence}");
    assert_eq!(
        (&evidence["named"], &evidence["asks_for_a_fit"], &evidence["judge"]),
        (&json!([]), &json!(true), &json!(judge))
    );
    assert_eq!(server.post("/api/rig/suspect", "{\"effect\":null}").status, 204);
    assert_eq!(server.post("/api/rig/push", "{}").status, 204);
    let state = looked_at(&server, "2 releases");
    assert!(state["evidence"]["sentence"].as_str().unwrap().contains("nothing is missing"), "{}", state["evidence"]);
    assert_eq!((&state["evidence"]["asks_for_a_fit"], &state["evidence"]["judge"]), (&json!(false), &json!(judge)));
}

#[test]
fn a_wire_that_breaks_names_no_effect_but_the_wire() {
    let folder = tempfile::tempdir().unwrap();
    let server = server(&folder, "sim:loose-wire");
    let state = server.tab().wait_for(|state| state["evidence"]["trouble"].is_array());
    let evidence = &state["evidence"];
    let [what, next] = [0, 1].map(|part| evidence["trouble"][part].as_str().unwrap());
    assert!(what.contains("code 0") && next.contains("wires"), "{evidence}");
    assert_eq!((&evidence["named"], &evidence["candidates"]), (&json!([]), &json!([])));
}

/// A pendulum's releases and the model that its rig reports say nothing of the next one.
#[test]
fn another_rig_brings_its_own_model_and_takes_along_what_was_listened_to() {
    let folder = tempfile::tempdir().unwrap();
    let server = server(&folder, "sim:mystery-3");
    let state = looked_at(&server, "one release");
    assert_eq!(state["evidence"]["named"], json!(["backlash"]));
    assert_eq!(server.post("/api/rig/suspect", "{\"effect\":\"backlash\"}").status, 204);
    let has = |state: &Value, effect| state["model"]["effects"].as_array().unwrap().contains(&json!(effect));
    let state = server.tab().wait_for(|state| state["recordings"].as_array().is_some_and(|all| all.len() == 1));
    assert!(has(&state, "backlash"), "{}", state["model"]);
    server.post("/api/rig/suspect", "{\"effect\":\"magic\"}").refused(422, "no effect called magic");

    assert_eq!(server.post("/api/rig/connect", "{\"port\":\"sim:drag\"}").status, 204);
    met(&server, "sim:drag");
    let state = looked_at(&server, "one release");
    assert_eq!(state["rig"]["port"], "sim:drag");
    assert!(!has(&state, "backlash") && state["recordings"] == json!([]), "{}", state["model"]);
}

/// A pause ends what is listened to, not what was found; what is recorded is looked at like what is only listened to.
#[test]
fn a_pause_keeps_what_was_found_and_a_recording_feeds_the_bars() {
    let folder = tempfile::tempdir().unwrap();
    let server = server(&folder, "sim:old-firmware");
    let found = looked_at(&server, "one release")["evidence"].clone();
    assert_eq!(server.post("/api/rig/pause", "{}").status, 204);
    let paused = server.tab().wait_for(|state| state["evidence"]["stage"].is_null());
    assert_eq!((&paused["evidence"]["sentence"], &paused["rig"]["listening"]), (&found["sentence"], &json!(false)));
    assert_eq!(server.post("/api/rig/record", "{}").status, 204);
    let state = looked_at(&server, "2 releases");
    let state = match state["recordings"].as_array().map(Vec::len) {
        Some(0) => server.tab().wait_for(|state| state["recordings"].as_array().is_some_and(|all| !all.is_empty())),
        _ => state,
    };
    assert_eq!(state["recordings"].as_array().map(Vec::len), Some(1));
}
