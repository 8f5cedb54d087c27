//! How often the diagnosis is right, over many random rigs with nothing, one or two effects hidden. What counts as right,
//! and the rates, stand in `tests::verdicts`.
//!
//! Forty rigs in the usual run; `cargo test -p tests --test discover_many -- --ignored --nocapture` takes hundreds, with
//! ROUNDS (8) of about 30 rigs each, FROM a round (0), and only those whose label contains PICK.

use host::diagnose::diagnose;
use shared::effect::Effect;
use tests::hidden::{Random, Rig};
use tests::sizes::{Sizes, seed_of};
use tests::verdicts::{NAMED_FIRST, NOISES_LEFT, Outcome, check_in_full, check_within_chance};

/// So many noises a base model leaves without the one effect that is hidden …
const ONE_LEAVES: [f64; 4] = [1.5, 2.2, 3.0, 5.0];

/// … and without each of two.
const EACH_OF_TWO_LEAVES: [f64; 2] = [2.5, 4.0];

/// So many noises a base model leaves on a light bearing without the one effect that is hidden; 0: nothing is hidden.
const LIGHT_LEAVES: [f64; 4] = [0.0, 3.0, 6.0, 15.0];

/// Effects that one or two releases of a light pendulum show. The others look like the zero of the sensor, or like a law
/// of the amplitude.
const LIGHT: [&str; 8] = [
    "quadratic-drag",
    "torsional-spring",
    "presliding",
    "backlash",
    "sensor-nonlinearity",
    "sensor-gain",
    "sensor-lag",
    "angle-offset",
];

/// What is no missing effect: nothing, a velocity band, a wrong clock, air's lift, a wrong mass.
const INNOCENT: [&str; 8] = ["none", "none", "band", "band", "band", "clock", "buoyancy", "mass"];

const PAIRS: [[&str; 2]; 12] = [
    ["quadratic-drag", "torsional-spring"],
    ["quadratic-drag", "sensor-gain"],
    ["stribeck", "backlash"],
    ["drifting-friction", "torsional-spring"],
    ["sensor-nonlinearity", "quadratic-drag"],
    ["asymmetric-coulomb", "quadratic-drag"],
    ["detent", "stribeck"],
    ["angle-offset", "quadratic-drag"],
    ["eddy-brake", "sensor-lag"],
    ["load-dependent-coulomb", "torsional-spring"],
    ["quadratic-drag", "backlash"],
    ["detent", "drifting-friction"],
];

/// A rig to be made, by its label.
struct Case {
    label: String,
    make: Box<dyn Fn(&Sizes) -> Rig>,
}

/// How large what is hidden has to be, for the rigs of the usual run.
const SIZES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/discover_many/sizes.txt");

fn innocent(round: u64, place: usize) -> Case {
    let (kind, seed) = (INNOCENT[place], 1000 * round + place as u64);
    let make = move |_: &Sizes| {
        let (mut rig, mut random) = (Rig::random(seed), Random::new(seed + 77));
        match kind {
            "band" => rig.velocity_band = random.log_between(0.01, 0.05),
            "clock" => rig.clock = 1.0 + 0.01 * random.sign(),
            "buoyancy" => rig.gravity_m_s2 *= 0.99,
            "mass" => rig.inertia_kg_m2 *= 1.3,
            _ => {}
        }
        rig
    };
    Case { label: format!("innocent-{kind}-{round}-{place}"), make: Box::new(make) }
}

fn one(round: u64, name: &'static str) -> Case {
    let seed = 1000 * round + 400 + seed_of(name);
    let ratio = ONE_LEAVES[(round + seed_of(name)) as usize % ONE_LEAVES.len()];
    let label = format!("one-{name}-{round}");
    let own = label.clone();
    let make = move |kept: &Sizes| kept.of(&own, Rig::random(seed).with(name), |rig| rig.scaled_to(ratio).0);
    Case { label, make: Box::new(make) }
}

fn one_with_band(round: u64, place: usize, name: &'static str) -> Case {
    let seed = 1000 * round + 300 + place as u64;
    let make = move |_: &Sizes| {
        let velocity_band = Random::new(seed).log_between(0.01, 0.05);
        Rig { velocity_band, ..Rig::random(seed) }.with(name).scaled_to(3.0).0
    };
    Case { label: format!("band-{name}-{round}"), make: Box::new(make) }
}

/// Each is as large as it has to be for the base model to leave so much of it alone.
fn two(round: u64, place: usize) -> Case {
    let seed = 1000 * round + 200 + place as u64;
    let ratio = EACH_OF_TWO_LEAVES[(round as usize / 2 + place) % EACH_OF_TWO_LEAVES.len()];
    let [a, b] = PAIRS[place];
    let label = format!("two-{a}+{b}-{round}");
    let own = label.clone();
    let make = move |kept: &Sizes| {
        let rig = Rig::random(seed);
        kept.of(&own, rig.clone().with(a).with(b), |mut both| {
            let sizes = [a, b].map(|name| rig.clone().with(name).scaled_to(ratio).0.hidden[0].size);
            both.hidden.iter_mut().zip(sizes).for_each(|(hidden, size)| hidden.size = size);
            both
        })
    };
    Case { label, make: Box::new(make) }
}

/// The same on a light bearing, and in one of four rounds nothing hidden.
fn light(round: u64, name: &'static str) -> Case {
    let seed = 1000 * round + 500 + seed_of(name);
    let ratio = LIGHT_LEAVES[(round + seed_of(name)) as usize % LIGHT_LEAVES.len()];
    let label = format!("light-{name}-{round}");
    let own = label.clone();
    let make = move |kept: &Sizes| match ratio {
        0.0 => Rig::light(seed),
        _ => kept.of(&own, Rig::light(seed).with(name), |rig| rig.scaled_to(ratio).0),
    };
    Case { label, make: Box::new(make) }
}

fn effects() -> Vec<&'static str> {
    Effect::<f64>::usual().map(|effect| effect.name).collect()
}

fn cases(round: u64) -> Vec<Case> {
    let innocents = (0..INNOCENT.len()).map(|place| innocent(round, place));
    let ones = effects().into_iter().map(|name| one(round, name));
    let is_its_turn = |place: &usize| (*place as u64 + round).is_multiple_of(2);
    let twos = (0..PAIRS.len()).filter(is_its_turn).map(|place| two(round, place));
    let bands = ["quadratic-drag", "torsional-spring"];
    let with_band = bands.into_iter().enumerate().map(|(place, name)| one_with_band(round, place, name));
    innocents.chain(ones).chain(twos).chain(with_band).collect()
}

fn judged(case: &Case, change: impl Fn(Rig) -> Rig) -> Outcome {
    let rig = change((case.make)(&Sizes::kept(SIZES)));
    let diagnosis = serde_json::to_value(diagnose(&rig.swings(), &[], &rig.known())).unwrap();
    let outcome = Outcome::of(&rig, &diagnosis);
    let mark = if outcome.exact { "exact" } else { "     " };
    println!("{mark} {:<46} {}", case.label, outcome.words);
    outcome
}

/// Eight that lack nothing, each effect alone, all pairs, and two of a band: of rounds that the long form has too.
fn forty() -> Vec<Case> {
    let effects = effects();
    let n_others = 40_usize.saturating_sub(effects.len() + PAIRS.len());
    let mut chosen: Vec<Case> = effects.into_iter().map(|name| one(0, name)).collect();
    chosen.extend((0..PAIRS.len()).map(|place| two(place as u64 % 2, place)));
    chosen.extend((0..n_others.max(INNOCENT.len())).map(|place| innocent(place as u64 / 8, place % INNOCENT.len())));
    chosen
}

/// At the paper's rate; more samples a second would only take longer.
fn slower(rig: Rig) -> Rig {
    Rig { rate_hz: rig.rate_hz.min(100.0), ..rig }
}

#[test]
fn forty_rigs() {
    let chosen = forty();
    assert!(chosen.len() >= 37);
    let outcomes: Vec<Outcome> = chosen.iter().map(|case| judged(case, slower)).collect();
    check_within_chance(&outcomes);
    check_every_effect_is_told(&outcomes);
}

/// An effect that is hidden alone is missed by the base model and told of, whatever the rates are: none of the list is
/// lost.
#[track_caller]
fn check_every_effect_is_told(outcomes: &[Outcome]) {
    let is_told = |rig: &&Outcome| rig.noises_before > NOISES_LEFT && rig.all_told && rig.noises_left <= NOISES_LEFT;
    let (told, lost): (Vec<_>, Vec<_>) = outcomes.iter().filter(|rig| rig.n_hidden == 1).partition(is_told);
    let lost: Vec<&str> = lost.iter().map(|rig| rig.words.as_str()).collect();
    assert!(lost.is_empty(), "{lost:#?}");
    assert_eq!(told.len(), effects().len(), "rigs with one effect");
}

/// A rig that is not kept is made as the long form makes it.
#[test]
#[ignore = "takes a minute: tests/more discover-many"]
fn the_kept_sizes_are_those_that_are_found() {
    let found = Sizes::unknown();
    forty().into_iter().chain(LIGHT.map(|name| light(0, name))).for_each(|case| drop((case.make)(&found)));
    found.check_kept_in(SIZES);
}

/// Bearings so light that the pendulum swings for minutes.
#[test]
fn eight_light_rigs() {
    let outcomes = LIGHT.map(|name| judged(&light(0, name), slower));
    let wrong: Vec<&str> = outcomes.iter().filter(|rig| !rig.exact).map(|rig| rig.words.as_str()).collect();
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
#[ignore = "takes minutes: tests/more discover-many"]
fn many_light_rigs() {
    let pick = std::env::var("PICK").unwrap_or_default();
    let all = (0..number("ROUNDS", 8)).flat_map(|round| LIGHT.map(|name| light(round, name)));
    let outcomes: Vec<Outcome> =
        all.filter(|case| case.label.contains(&pick)).map(|case| judged(&case, |rig| rig)).collect();
    let (n_all, n_exact) = (outcomes.len(), outcomes.iter().filter(|rig| rig.exact).count());
    assert!(n_all > 0 && n_exact as f64 >= NAMED_FIRST * n_all as f64, "{n_exact} of {n_all}");
}

fn number(name: &str, usual: u64) -> u64 {
    std::env::var(name).map_or(usual, |text| text.parse().unwrap())
}

#[test]
#[ignore = "takes half an hour: tests/more discover-many"]
fn many_rigs() {
    let pick = std::env::var("PICK").unwrap_or_default();
    let from = number("FROM", 0);
    let all = (from..from + number("ROUNDS", 8)).flat_map(cases);
    let is_wanted = |case: &Case| pick.is_empty() || pick.split(',').any(|part| case.label.contains(part));
    let outcomes: Vec<Outcome> = all.filter(is_wanted).map(|case| judged(&case, |rig| rig)).collect();
    assert!(!outcomes.is_empty(), "no rig has {pick:?} in its label");
    // A choice is looked at; only the whole is judged.
    if pick.is_empty() {
        check_in_full(&outcomes);
    }
}
