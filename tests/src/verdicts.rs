//! How often a diagnosis is right: what counts as right, in one place.
//!
//! A rig's truth is what is hidden in it. Judged is the object that `host diagnose --json` prints.

use crate::hidden::{LSB_RAD, Rig};
use crate::rates::fewest_hits;
use serde_json::Value;
use shared::effect::Effect;

/// The effect named first is hidden in the rig, in at least this share of rigs that hide something.
pub const NAMED_FIRST: f64 = 0.97;

/// Both of two hidden effects are named, in at least this share of such rigs.
pub const BOTH_NAMED: f64 = 0.85;

/// No more than `NOISES_LEFT` noises are left, or the rest is said to be unexplained, in at least this share of rigs.
pub const SETTLED: f64 = 0.93;

/// So many noises count as nothing but noise.
pub const NOISES_LEFT: f64 = 1.05;

/// The zero's error is claimed from one step of the converter on; a rig with less than half a step has none.
const OFFSET_IS_THERE_RAD: f64 = 0.5 * LSB_RAD;

/// What became of one rig.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Effects hidden in it.
    pub n_hidden: usize,
    /// What stands first is hidden in it.
    pub named_first: bool,
    /// All that is hidden is named.
    pub all_named: bool,
    /// All that is hidden is named, or told as what free swings cannot tell from it.
    pub all_told: bool,
    /// All that is hidden is named, and nothing else.
    pub exact: bool,
    /// Only noise is left, or it is said that more is.
    pub settled: bool,
    /// The error of the base model, as a multiple of the noise.
    pub noises_before: f64,
    /// The error left, likewise.
    pub noises_left: f64,
    /// Everything about it, on a line.
    pub words: String,
}

impl Outcome {
    /// Judges a diagnosis of a rig.
    pub fn of(rig: &Rig, diagnosis: &Value) -> Self {
        let truth: Vec<&str> = rig.hidden.iter().map(|hidden| canonical(rig, hidden.name)).collect();
        let verdict: Vec<&str> = names(rig, diagnosis, "verdict");
        let undecided = names(rig, diagnosis, "undecided");
        let ranked = names(rig, diagnosis, "ranked");
        let number = |key: &str| diagnosis[key].as_f64().unwrap_or(f64::NAN);
        let [noises_before, noises_left] = ["rmse_before", "rmse_after"].map(|key| number(key) / rig.total_noise_rad());
        let all_named = truth.iter().all(|name| verdict.contains(name));
        let nothing_else = verdict.iter().all(|name| truth.contains(name) || is_part_of(name, &truth));
        Self {
            n_hidden: truth.len(),
            named_first: ranked.first().is_some_and(|first| truth.contains(first)),
            all_named,
            all_told: truth.iter().all(|name| verdict.contains(name) || undecided.contains(name)),
            exact: all_named && nothing_else,
            settled: noises_left <= NOISES_LEFT || diagnosis["unexplained"] == true,
            noises_before,
            noises_left,
            words: format!(
                "{truth:?} -> {verdict:?}, undecided {}, first {:?}; \
                 {noises_before:.2} -> {noises_left:.3} noises; {} million steps, {:.2} s",
                diagnosis["undecided"],
                ranked.first(),
                diagnosis["effort"]["million_steps"],
                number("seconds"),
            ),
        }
    }

    /// Was a rig accused that lacks nothing?
    pub fn accused(&self) -> bool {
        self.n_hidden == 0 && !self.exact
    }
}

/// Names of a list; the zero's error is not judged where the rig has one that nobody hid.
fn names<'a>(rig: &Rig, diagnosis: &'a Value, key: &str) -> Vec<&'a str> {
    let has_offset = rig.offset_rad.abs() >= OFFSET_IS_THERE_RAD && rig.hidden("angle-offset").is_none();
    let list = diagnosis[key].as_array().map_or(&[][..], Vec::as_slice);
    let names = list.iter().filter_map(Value::as_str).map(|name| canonical(rig, name));
    names.filter(|name| !(has_offset && *name == "angle-offset")).collect()
}

/// Drag that grows with the square of the speed, or nearly: either name will do; and so will that of a law for its wider
/// form. The plant's stiff stand has a mass, so that it swings too, some ten times as fast as the pendulum.
fn canonical<'a>(rig: &Rig, name: &'a str) -> &'a str {
    match Effect::<f64>::by_name(name) {
        Some(wide) if wide.rules.follows_special_case => wide.generalises.unwrap_or(name),
        _ if name == "power-law-drag" => "quadratic-drag",
        _ if name == "resonant-support" && rig.hidden("pivot-compliance").is_some() => "pivot-compliance",
        _ => name,
    }
}

/// An uneven characteristic has a gain with it.
fn is_part_of(name: &str, truth: &[&str]) -> bool {
    name == "sensor-gain" && truth.contains(&"sensor-nonlinearity")
}

/// How many of something were right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Share {
    n_right: usize,
    n_all: usize,
}

fn share<'a>(of: impl Iterator<Item = &'a Outcome>, is_right: impl Fn(&Outcome) -> bool) -> Share {
    let all: Vec<&Outcome> = of.collect();
    Share { n_right: all.iter().filter(|outcome| is_right(outcome)).count(), n_all: all.len() }
}

/// The rates hold within chance: each bound is broken by a true rate in one of a thousand runs.
#[track_caller]
pub fn check_within_chance(outcomes: &[Outcome]) {
    check(outcomes, fewest_hits);
}

/// The rates themselves are reached.
#[track_caller]
pub fn check_in_full(outcomes: &[Outcome]) {
    check(outcomes, |n_all, rate| (rate * n_all as f64).ceil() as usize);
}

#[track_caller]
fn check(outcomes: &[Outcome], fewest: impl Fn(usize, f64) -> usize) {
    let hiding = |n_hidden: usize| outcomes.iter().filter(move |outcome| outcome.n_hidden >= n_hidden);
    let shares = [
        ("what is named first is hidden", share(hiding(1), |outcome| outcome.named_first), NAMED_FIRST),
        ("both of two are named", share(hiding(2), |outcome| outcome.all_named), BOTH_NAMED),
        ("noise is left, or more is said to be", share(hiding(0), |outcome| outcome.settled), SETTLED),
    ];
    let mut broken = Vec::new();
    for (what, Share { n_right, n_all }, rate) in shares {
        let least = fewest(n_all, rate);
        println!("{what}: {n_right} of {n_all}, at least {least}");
        if n_all == 0 || n_right < least {
            broken.push(format!("{what} in {n_right} of {n_all} rigs, at least {least} expected"));
        }
    }
    let innocents = share(outcomes.iter().filter(|outcome| outcome.n_hidden == 0), |outcome| !outcome.accused());
    let exact = share(hiding(0), |outcome| outcome.exact);
    println!(
        "accused {} of {}; exact {} of {}",
        innocents.n_all - innocents.n_right,
        innocents.n_all,
        exact.n_right,
        exact.n_all
    );
    if innocents.n_all == 0 || innocents.n_right < innocents.n_all {
        broken.push(format!(
            "of {} rigs that lack nothing {} are accused",
            innocents.n_all,
            innocents.n_all - innocents.n_right
        ));
    }
    assert!(broken.is_empty(), "{broken:#?}");
}
