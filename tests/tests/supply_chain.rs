//! Every dependency comes from crates.io under a licence that deny.toml allows, also where cargo-deny is not installed.

use serde_json::Value;
use spdx::{Expression, ParseMode};
use std::process::Command;
use tests::image::workspace;

const CRATES_IO: &str = "registry+https://github.com/rust-lang/crates.io-index";

fn packages() -> Vec<Value> {
    let output = Command::new(env!("CARGO"))
        .current_dir(workspace())
        .args(["metadata", "--format-version", "1", "--locked", "--all-features"])
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    metadata["packages"].as_array().unwrap().clone()
}

fn allowed() -> Vec<String> {
    let rules: toml::Table = std::fs::read_to_string(workspace().join("deny.toml")).unwrap().parse().unwrap();
    rules["licenses"]["allow"].as_array().unwrap().iter().map(|name| name.as_str().unwrap().to_owned()).collect()
}

fn is_allowed(licence: &str, allowed: &[String]) -> bool {
    let expression =
        Expression::parse_mode(licence, ParseMode::LAX).unwrap_or_else(|error| panic!("{licence}: {error}"));
    expression.evaluate(|wanted| wanted.license.id().is_some_and(|id| allowed.iter().any(|name| name == id.name)))
}

#[test]
fn every_dependency_is_from_crates_io_under_an_allowed_licence() {
    let allowed = allowed();
    let packages = packages();
    assert!(packages.len() > 100, "{}", packages.len());
    for package in packages {
        let name = &package["name"];
        let licence = package["license"].as_str().unwrap_or_else(|| panic!("{name} names no licence"));
        assert!(is_allowed(licence, &allowed), "{name}: {licence}");
        let source = package["source"].as_str();
        let is_ours = source.is_none() && package["publish"] == serde_json::json!([]);
        assert!(source == Some(CRATES_IO) || is_ours, "{name} comes from {source:?}");
    }
}

#[test]
fn other_licences_are_refused() {
    let allowed = allowed();
    assert!(is_allowed("MIT OR GPL-3.0-only", &allowed) && is_allowed("MIT/Apache-2.0", &allowed));
    assert!(!is_allowed("GPL-3.0-only", &allowed) && !is_allowed("MIT AND AGPL-3.0-only", &allowed));
}

/// The boards' registers need some; what runs on both sides, and on the PC, needs none.
#[test]
fn what_runs_on_the_pc_is_without_unsafe_code() {
    let ours =
        ["shared", "host/identification", "host/recording", "host/simulation", "host/python", "host", "firmware"]
            .map(|folder| format!("{folder}/src/lib.rs"));
    for file in ours.iter().map(String::as_str).chain(["host/src/main.rs"]) {
        let text = std::fs::read_to_string(workspace().join(file)).unwrap();
        assert!(text.lines().any(|line| line == "#![forbid(unsafe_code)]"), "{file}");
    }
}

#[test]
fn tests_notice_overflow() {
    let overflow = std::panic::catch_unwind(|| std::hint::black_box(u8::MAX) + std::hint::black_box(1));
    assert!(overflow.is_err());
}
