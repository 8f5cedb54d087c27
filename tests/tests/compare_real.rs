//! Verdicts on recordings of real pendulums and of rigs with a hidden effect.

mod compare_support;

use compare_support::{data, hidden, keep_pictures, measurement, normalised};
use host::compare::measurement::Measurement;
use host::compare::verdict::Answer;
use host::compare::{Comparison, Options, compare};

fn judged(name: &str, from_s: Option<f64>) -> Comparison {
    let measurement = measurement(name, from_s);
    let comparison =
        compare(&normalised(&measurement), &[measurement], &[], &Options { fit_first: true, ..Options::default() })
            .unwrap();
    println!("=== {name}\n{}\nplaces {:?}\n", comparison.verdict.join("\n"), comparison.places);
    println!("missing {:#?}\nmeasured {:?}", comparison.energy.loss_missing, comparison.energy.loss_measured);
    if let Some(map) = &comparison.torque {
        println!("evidence {} explained {} significant {}", map.evidence, map.explained, map.is_significant);
    }
    keep_pictures(name.trim_start_matches("real/"), &comparison);
    comparison
}

#[test]
fn the_arm_lacks_physics_at_large_amplitude_and_its_loss_has_a_bump() {
    let comparison = judged("real/dynamicslab_single_arm.csv", None);
    assert_eq!(comparison.answer, Answer::PhysicsMissing);
    let bump_rad = comparison.energy.bump_rad.unwrap();
    assert!((0.25..0.5).contains(&bump_rad), "{bump_rad}");
    assert!(comparison.verdict.iter().any(|words| words.contains("large amplitude")));
}

#[test]
fn the_string_pendulum_lacks_physics_and_has_no_coulomb_friction() {
    let comparison = judged("real/tylertian_string.csv", None);
    assert_eq!(comparison.answer, Answer::PhysicsMissing);
    assert!(comparison.verdict.iter().any(|words| words.contains("coulomb friction (Mc) to be zero")));
}

#[test]
fn the_short_pendulum_leaves_more_than_noise_but_no_pattern() {
    let comparison = judged("real/jensenbenard_free_swing.csv", None);
    assert_eq!(comparison.answer, Answer::NoPattern);
}

#[test]
fn the_hand_on_the_short_pendulum_is_cut_and_said() {
    let comparison = judged("real/jensenbenard_hand_on_start.csv", None);
    assert!(comparison.recordings[0].notes.iter().any(|note| note.contains("hand")));
    assert!(comparison.recordings[0].from_s > 0.3);
}

#[test]
fn physics_is_missing_where_an_effect_is_hidden_and_nowhere_else() {
    for case in 1..=8 {
        let truth = std::fs::read_to_string(data(&format!("hidden/p{case:02}/truth.json"))).unwrap();
        let truth: serde_json::Value = serde_json::from_str(&truth).unwrap();
        // The zero of the sensor is free in every comparison.
        let is_taken_up = |name: &serde_json::Value| name == "none" || name == "angle-offset";
        let lacks_nothing = truth["effects"].as_array().unwrap().iter().all(is_taken_up);
        let (rig, measurements): (_, Vec<Measurement>) = hidden(case);
        let comparison = compare(&rig, &measurements, &[], &Options { fit_first: true, ..Options::default() }).unwrap();
        println!("=== p{case:02}\n{}\n", comparison.verdict.join("\n"));
        keep_pictures(&format!("p{case:02}"), &comparison);
        let what = format!("p{case:02} hides {}: {:?}", truth["effects"], comparison.verdict);
        assert_eq!(comparison.answer == Answer::NothingMissing, lacks_nothing, "{what}");
        // What leaves little more than the noise need not show where.
        let is_plain = !lacks_nothing && truth["ratio_base"].as_f64().unwrap() > 1.5;
        assert!(!is_plain || comparison.answer == Answer::PhysicsMissing, "{what}");
        if let Some(map) = &comparison.torque {
            println!("evidence {} explained {} significant {}", map.evidence, map.explained, map.is_significant);
        }
    }
}
