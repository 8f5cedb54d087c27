//! The diagnosis on rigs whose missing physics is known: the examples, rigs without any, and pendulums of
//! other laboratories. `discover_many` has a rig for each effect of the list.

use host::diagnose::{Diagnosis, diagnose};
use host::recording::segment::SegmentOptions;
use host::recording::{Recording, read};
use host::swing::Swing;
use shared::motion::Pendulum;
use shared::parameters::Parameters;
use std::path::{Path, PathBuf};
use tests::hidden::Rig;

fn data(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../host/data/recordings").join(path)
}

fn json(path: &Path) -> serde_json::Value {
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

/// A diagnosis of one of the example rigs, and its truth.
fn example(name: &str) -> (Diagnosis, Vec<String>) {
    let folder = data("hidden").join(name);
    let meta = json(&folder.join("meta.json"));
    let releases = meta["releases"].as_array().unwrap();
    let swing = |release: &serde_json::Value| {
        let name = release.as_str().unwrap();
        let recording = read(&folder.join(name), &Default::default()).unwrap();
        Swing::from_recording(name, &recording, &SegmentOptions::default()).unwrap().0
    };
    let swings: Vec<Swing> = releases.iter().map(swing).collect();
    let mut rig = Parameters::paper();
    rig.pendulum.mass_kg = meta["m"].as_f64().unwrap();
    rig.pendulum.length_m = meta["l"].as_f64().unwrap();
    rig.pendulum.inertia_kg_m2 = meta["I_cad"].as_f64().unwrap();
    rig.set_friction(0.0, 0.0, 0.0, 0.0);
    let truth = json(&folder.join("truth.json"));
    let names = truth["effects"].as_array().unwrap().iter().map(|name| name.as_str().unwrap().to_owned());
    (diagnose(&swings, &[], &rig), names.filter(|name| name != "none").collect())
}

fn sorted(names: &[impl AsRef<str>]) -> Vec<&str> {
    let mut names: Vec<&str> = names.iter().map(AsRef::as_ref).collect();
    names.sort_unstable();
    names
}

#[test]
fn the_examples_are_all_recognised() {
    for name in ["p01", "p02", "p03", "p04", "p05", "p06", "p07", "p08"] {
        let (diagnosis, truth) = example(name);
        assert_eq!(sorted(&diagnosis.verdict), sorted(&truth), "{name}");
        let left = diagnosis.rmse_after / diagnosis.noise;
        assert!(left < 1.05 && !diagnosis.unexplained, "{name}: {left} times the noise is left");
        let look = diagnosis.first_look.as_ref().unwrap();
        let could_be: Vec<&str> = look
            .candidates
            .iter()
            .filter(|other| other.tied || look.named.contains(&other.name))
            .map(|it| it.name)
            .collect();
        let is_hidden = |name: &&str| truth.iter().any(|hidden| hidden == name);
        match truth.iter().all(|hidden| hidden == "angle-offset") {
            true => assert!(look.named.is_empty(), "{name}: at first look {:?}", look.named),
            false => {
                assert!(!look.named.is_empty() && could_be.iter().any(is_hidden), "{name}: at first look {look:?}")
            }
        }
    }
}

/// A pendulum that moves so many times more slowly has the same angles at later times. Nothing but these is known of
/// it.
fn slowed(name: &str, factor: f64) -> Diagnosis {
    let folder = data("hidden").join(name);
    let swing = |release: usize| {
        let name = format!("release_{release}.csv");
        let recording = read(&folder.join(&name), &Default::default()).unwrap();
        let times_s: Vec<f64> = recording.times_s().iter().map(|time_s| factor * time_s).collect();
        let recording =
            Recording::new(recording.header().clone(), times_s, recording.angles_rad().to_vec(), None).unwrap();
        Swing::from_recording(&name, &recording, &SegmentOptions::default()).unwrap().0
    };
    let swings: Vec<Swing> = (1..=3).map(swing).collect();
    // As `host init --unknown-geometry` has it: m·g·l is 1 N·m, and the period is taken for a second.
    let (length_m, gravity_m_s2) = (1e-3, 9.81);
    let mass_kg = 1.0 / (gravity_m_s2 * length_m);
    let rig = Parameters::frictionless(Pendulum { mass_kg, length_m, inertia_kg_m2: 0.025, gravity_m_s2 });
    diagnose(&swings, &[], &rig)
}

#[test]
fn slow_and_quick_pendulums_are_known_as_well_as_the_usual_ones() {
    for (name, truth) in [("p01", "backlash"), ("p03", "quadratic-drag"), ("p07", "angle-offset")] {
        for factor in [0.2, 3.0, 12.0] {
            let diagnosis = slowed(name, factor);
            assert_eq!(diagnosis.verdict, [truth], "{name}, {factor} times as slow");
            assert!(!diagnosis.unexplained, "{name}, {factor} times as slow: {} rad", diagnosis.rmse_after);
        }
    }
}

#[test]
fn a_rig_that_lacks_nothing_is_not_accused() {
    let plain = Rig::random(7);
    let cases = [
        ("none", plain.clone()),
        ("a velocity band", Rig { velocity_band: 0.03, ..Rig::random(8) }),
        ("a fast clock", Rig { clock: 1.01, ..plain.clone() }),
        ("the air's lift", Rig { gravity_m_s2: 9.7, ..Rig::random(9) }),
        ("more mass", Rig { inertia_kg_m2: 1.3 * plain.inertia_kg_m2, ..plain }),
    ];
    for (name, rig) in cases {
        let diagnosis = diagnose(&rig.swings(), &[], &rig.known());
        assert!(diagnosis.verdict.is_empty(), "{name}: {:?}", diagnosis.verdict);
        assert!(!diagnosis.unexplained, "{name}: {} of {}", diagnosis.rmse_after, diagnosis.noise);
    }
}

/// A free swing from another laboratory. Its mass and length are not known here and need not be: m·g·l = 1 N·m.
fn real(file: &str, from_s: Option<f64>, to_s: Option<f64>) -> Diagnosis {
    let recording = read(&data("real").join(file), &Default::default()).unwrap();
    let options = SegmentOptions { from_s, to_s };
    let swing = Swing::from_recording(file, &recording, &options).unwrap().0;
    let mut rig = Parameters::paper();
    rig.pendulum.length_m = 0.01;
    rig.pendulum.mass_kg = 1.0 / (9.81 * 0.01);
    let omega = natural_frequency(&swing);
    rig.pendulum.inertia_kg_m2 = 1.0 / (omega * omega);
    rig.set_friction(0.0, 0.0, 0.0, 0.0);
    diagnose(&[swing], &[], &rig)
}

/// From the number of passages through the middle, rad/s.
fn natural_frequency(swing: &Swing) -> f64 {
    let passages = swing.angles_rad.windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count();
    std::f64::consts::PI * passages as f64 / swing.duration_s()
}

fn described(diagnosis: &Diagnosis) -> String {
    let models: Vec<String> = diagnosis
        .candidates
        .iter()
        .map(|c| {
            let values: Vec<String> = c.parameters.iter().map(|p| format!("{} {:.3e}", p.symbol, p.value)).collect();
            format!("{} {:.2e} {}", c.name, c.rmse, values.join(" "))
        })
        .collect();
    format!(
        "{:?}, ranked {:?}, {:e} -> {:e}, noise {:e}: {models:#?} {:?}",
        diagnosis.verdict,
        diagnosis.ranked,
        diagnosis.rmse_before,
        diagnosis.rmse_after,
        diagnosis.noise,
        diagnosis.parameters
    )
}

#[test]
fn an_arm_on_ball_bearings_has_a_drag_that_grows_faster_than_linearly() {
    let diagnosis = real("dynamicslab_single_arm.csv", Some(12.0), Some(93.0));
    let drags = ["quadratic-drag", "power-law-drag"];
    assert!(diagnosis.verdict.iter().any(|name| drags.contains(name)), "{}", described(&diagnosis));
    assert!(diagnosis.rmse_after < diagnosis.rmse_before / 4.0, "{}", described(&diagnosis));
    assert!(diagnosis.unexplained, "{}", described(&diagnosis));
}

#[test]
fn a_cup_on_a_string_has_quadratic_drag_and_no_dry_friction() {
    let diagnosis = real("tylertian_string.csv", None, None);
    // A camera at an angle may well add an uneven scale.
    assert_eq!(diagnosis.verdict.first(), Some(&"quadratic-drag"), "{}", described(&diagnosis));
    let coulomb_nm = diagnosis.parameters.values(shared::parameters::base::COULOMB).unwrap()[0];
    assert!(coulomb_nm < 1e-3, "{}", described(&diagnosis));
}

#[test]
fn a_swing_that_no_effect_explains_stays_unexplained() {
    let diagnosis = real("jensenbenard_free_swing.csv", None, None);
    assert!(diagnosis.verdict.is_empty() && diagnosis.unexplained, "{}", described(&diagnosis));
}
