//! The noise found in real and simulated recordings.

use std::path::{Path, PathBuf};

use host::noise::{self, Noise};
use host::recording::segment::{SegmentOptions, segment};
use host::recording::{ReadOptions, Recording, read};
use serde_json::Value;

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../host/data/recordings").join(name)
}

fn load(name: &str) -> Recording {
    read(&data(name), &ReadOptions::default()).unwrap()
}

/// Ratios of found to true total noise of every hidden release.
fn ratios(of: impl Fn(&Recording) -> Noise) -> Vec<(String, usize, f64)> {
    let mut ratios = Vec::new();
    for case in 1..=8 {
        let truth = std::fs::read_to_string(data(&format!("hidden/p{case:02}/truth.json"))).unwrap();
        let truth: Value = serde_json::from_str(&truth).unwrap();
        let sigma = truth["sigma_total"].as_f64().unwrap();
        for release in 1..=truth["releases"].as_array().unwrap().len() {
            let name = format!("hidden/p{case:02}/release_{release}.csv");
            let recording = load(&name);
            let noise = of(&recording);
            println!("{name}: {:.4} ({})", noise.total_rms / sigma, noise.method);
            ratios.push((name, recording.len(), noise.total_rms / sigma));
        }
    }
    ratios
}

#[test]
fn noise_of_the_hidden_rigs_is_found_within_three_percent() {
    let ratios = ratios(noise::estimate);
    let n_samples: usize = ratios.iter().map(|(_, n, _)| n).sum();
    let mean_square = ratios.iter().map(|(_, n, ratio)| *n as f64 * ratio * ratio).sum::<f64>() / n_samples as f64;
    println!("all: {:.4}", mean_square.sqrt());
    assert!((mean_square.sqrt() - 1.0).abs() < 0.01, "{mean_square}");
    for (name, _, ratio) in ratios {
        // Chance alone is 1.2 % for the shortest release, so three of its standard deviations.
        assert!((ratio - 1.0).abs() < 0.036, "{name}: {ratio}");
    }
}

#[test]
fn still_parts_agree_with_the_swing() {
    for (name, _, ratio) in ratios(|recording| {
        let segments = segment(recording, &SegmentOptions::default()).unwrap();
        noise::of_still(recording, segments.rest.unwrap()).unwrap()
    }) {
        assert!((ratio - 1.0).abs() < 0.12, "{name}: {ratio}");
    }
}

fn check_real(name: &str, expected_rms: std::ops::Range<f64>) -> Noise {
    let noise = noise::estimate(&load(name));
    println!("{name}: {noise:?}");
    assert!(expected_rms.contains(&noise.total_rms), "{name}: {noise:?}");
    noise
}

#[test]
fn the_encoder_of_the_short_pendulum_has_its_step_and_noise() {
    for name in ["real/jensenbenard_free_swing.csv", "real/jensenbenard_hand_on_start.csv"] {
        let noise = check_real(name, 0.4e-3..1.3e-3);
        assert!((noise.lsb.unwrap() / 1.5708e-3 - 1.0).abs() < 0.02, "{noise:?}");
    }
}

#[test]
fn the_fine_encoder_of_the_arm_has_little_noise() {
    check_real("real/dynamicslab_single_arm.csv", 2e-5..8e-5);
}

#[test]
fn the_filmed_string_pendulum_has_about_one_and_a_half_milliradians() {
    check_real("real/tylertian_string.csv", 1.0e-3..2.5e-3);
}
