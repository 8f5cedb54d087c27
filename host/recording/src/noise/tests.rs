use super::*;
use crate::{Calibration, Header};

/// A small generator with a seed, good enough for noise (Knuth's MMIX constants, upper bits, sum of twelve).
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

const LSB: f64 = 0.001_448_74;

/// Twenty seconds and more of an anharmonic decaying swing with noise and steps.
fn swing(rate_hz: f64, angular_hz: f64, sigma_rad: f64, lsb: f64, seed: u64) -> Recording {
    let mut random = Random(seed);
    let n = (rate_hz * 40.0).clamp(10000.0, 20000.0) as usize;
    let angle = |time_s: f64| {
        let phase = angular_hz * time_s;
        1.3 * (-0.02 * time_s).exp() * (phase.cos() + 0.01 * (3.0 * phase).cos())
    };
    let angles_rad: Vec<f64> = (0..n)
        .map(|idx| angle(idx as f64 / rate_hz) + sigma_rad * random.normal())
        .map(|angle_rad| if lsb > 0.0 { (angle_rad / lsb).round() * lsb } else { angle_rad })
        .collect();
    Recording::uniform(rate_hz, angles_rad).unwrap()
}

#[test]
fn noise_of_half_to_three_steps_is_found_within_three_percent() {
    for rate_hz in [100.0, 200.0, 500.0, 1000.0] {
        for n_steps in [0.5, 1.0, 3.0] {
            let noise = estimate(&swing(rate_hz, 8.5, n_steps * LSB, LSB, 7));
            let expected = LSB * (n_steps * n_steps + 1.0 / 12.0_f64).sqrt();
            let ratio = noise.total_rms / expected;
            assert!((ratio - 1.0).abs() < 0.03, "{rate_hz} Hz, {n_steps} steps: {ratio} ({})", noise.method);
            assert!((noise.lsb.unwrap() / LSB - 1.0).abs() < 1e-6);
        }
    }
}

#[test]
fn slow_sampling_is_answered_by_a_higher_order() {
    let noise = estimate(&swing(20.0, 4.0, 1.5e-3, 0.0, 11));
    assert!((noise.total_rms / 1.5e-3 - 1.0).abs() < 0.06, "{noise:?}");
    assert_eq!(noise.lsb, None);
}

#[test]
fn six_to_twelve_samples_a_period_are_enough() {
    // A swing from 1 rad: a pendulum's third harmonic is θ³/192 of it, and its frequency falls by θ²/16.
    let angle = |time_s: f64| {
        let size = (-time_s / 300.0_f64).exp();
        let phase = 6.0 * (time_s - 300.0 / 32.0 * (1.0 - size * size));
        size * phase.cos() - size.powi(3) / 192.0 * (3.0 * phase).cos()
    };
    for n_samples in [6.0, 6.5, 7.0, 8.0, 10.0, 12.0] {
        for sigma_rad in [5e-4, 5e-3] {
            let mut random = Random(13);
            let times_s: Vec<f64> =
                (0..600).map(|idx| f64::from(idx) * std::f64::consts::TAU / 6.0 / n_samples).collect();
            let angles_rad: Vec<f64> = times_s.iter().map(|t| angle(*t) + sigma_rad * random.normal()).collect();
            let noise = of_samples(&times_s, &angles_rad, None);
            let ratio = noise.total_rms / sigma_rad;
            assert!((0.9..1.1).contains(&ratio), "{n_samples} a period, {sigma_rad}: {ratio} ({})", noise.method);
        }
    }
}

#[test]
fn a_swing_without_noise_has_the_noise_of_its_steps() {
    let noise = estimate(&swing(200.0, 8.5, 0.0, LSB, 1));
    assert!((noise.total_rms / (LSB / 12f64.sqrt()) - 1.0).abs() < 0.1, "{noise:?}");
}

#[test]
fn jitter_of_the_clock_does_not_become_noise_when_the_times_are_true() {
    let mut random = Random(3);
    let times_s: Vec<f64> = (0..4000).map(|idx| 0.005 * f64::from(idx) + 0.001 * random.uniform()).collect();
    let angles_rad: Vec<f64> = times_s.iter().map(|t| (8.0 * t).sin() + 1e-3 * random.normal()).collect();
    let noise = of_samples(&times_s, &angles_rad, None);
    assert!((noise.total_rms / 1e-3 - 1.0).abs() < 0.03, "{noise:?}");
}

#[test]
fn numbers_that_are_not_in_steps_have_no_smallest_step() {
    let mut random = Random(5);
    let values: Vec<f64> = (0..3000).map(|_| (random.normal() * 1e6).round() / 1e6).collect();
    assert_eq!(smallest_step(&values), None);
    assert_eq!(smallest_step(&[1.0; 30]), None);
}

#[test]
fn still_samples_give_their_scatter_and_a_drift_does_not_count() {
    let mut random = Random(9);
    let angles_rad = (0..5000).map(|idx| 0.3 + 1e-6 * f64::from(idx) + 1e-3 * random.normal()).collect();
    let recording = Recording::uniform(500.0, angles_rad).unwrap();
    let noise = of_still(&recording, 0..5000).unwrap();
    assert!((noise.total_rms / 1e-3 - 1.0).abs() < 0.03, "{noise:?}");
    assert!(of_still(&recording, 0..MIN_STILL).is_some());
    assert_eq!(of_still(&recording, 0..MIN_STILL - 1), None);
}

/// One in two hundred is a thousand noises off, as where a tracker takes another point.
#[test]
fn what_few_samples_add_counts_only_where_it_outweighs_all_others() {
    let mut random = Random(21);
    let times_s: Vec<f64> = (0..4000).map(|idx| 0.01 * f64::from(idx)).collect();
    let angle = |time_s: &f64| 0.5 * (6.0 * time_s).cos() + 1e-3 * random.normal();
    let clean: Vec<f64> = times_s.iter().map(angle).collect();
    let noise = of_samples(&times_s, &clean, None);
    assert_eq!(of_most_samples(&times_s, &clean, &noise), noise.total_rms);
    let jumps = |(idx, angle_rad): (usize, &f64)| if idx % 200 == 100 { angle_rad + 1.0 } else { *angle_rad };
    let jumping: Vec<f64> = clean.iter().enumerate().map(jumps).collect();
    let noise = of_samples(&times_s, &jumping, None);
    let most = of_most_samples(&times_s, &jumping, &noise);
    assert!(noise.total_rms > 2e-2 && (most / 1e-3 - 1.0).abs() < 0.1, "{} {most}", noise.total_rms);
}

/// Two orders are apart by chance as well, the more so the fewer windows there are.
#[test]
fn few_samples_of_white_noise_need_no_higher_order() {
    let mut random = Random(23);
    let times_s: Vec<f64> = (0..60).map(|idx| 0.01 * f64::from(idx)).collect();
    let mut order = || {
        let angles_rad: Vec<f64> = times_s.iter().map(|_| 1e-3 * random.normal()).collect();
        differences::agreeing_order(&times_s, &angles_rad, &[false; 60]).0
    };
    let orders: Vec<usize> = (0..40).map(|_| order()).collect();
    assert!(orders.iter().filter(|order| **order == 4).count() >= 36, "{orders:?}");
}

/// Half swinging across many steps, half held about an angle, all in steps; so many steps of noise where it is held.
fn held_after_a_swing(noise_steps: impl Fn(usize) -> f64) -> Recording {
    let angle_steps = |idx: usize| {
        if idx < 2000 { (500.0 * (0.05 * idx as f64).sin()).round() } else { (100.0 + noise_steps(idx)).round() }
    };
    Recording::uniform(200.0, (0..4000).map(|idx| LSB * angle_steps(idx)).collect()).unwrap()
}

#[test]
fn still_samples_in_steps_have_white_noise_beside_that_of_the_steps() {
    let mut random = Random(15);
    let noise_steps: Vec<f64> = (0..4000).map(|_| 0.7 * random.normal()).collect();
    let noise = of_still(&held_after_a_swing(|idx| noise_steps[idx]), 2000..4000).unwrap();
    // Chance alone is 1.6 % for 2000 samples.
    assert!((noise.white_rms / (0.7 * LSB) - 1.0).abs() < 0.05, "{noise:?}");
    assert!((noise.quantisation_rms / (LSB / 12f64.sqrt()) - 1.0).abs() < 1e-6, "{noise:?}");
    assert!((noise.total_rms - noise.white_rms.hypot(noise.quantisation_rms)).abs() < 1e-12);
}

#[test]
fn still_samples_within_one_step_tell_no_noise() {
    // One of forty is a step off: the scatter is √(1/40 · 39/40) = 0.16 steps.
    let recording = held_after_a_swing(|idx| f64::from(idx % 40 == 0));
    assert_eq!(of_still(&recording, 2000..4000), None);
    assert_eq!(of_still(&held_after_a_swing(|_| 0.0), 2000..4000), None);
}

#[test]
fn a_rest_within_one_step_does_not_dilute_the_noise_of_the_swing() {
    let mut random = Random(17);
    let angle_steps = |idx: usize| {
        let size_steps = 500.0 * (1.0 - idx as f64 / 4000.0);
        if idx < 4000 { size_steps * (0.05 * idx as f64).sin() + random.normal() } else { 0.0 }
    };
    let steps: Vec<f64> = (0..8000).map(angle_steps).collect();
    let recording = Recording::uniform(200.0, steps.iter().map(|n| LSB * n.round()).collect()).unwrap();
    let noise = estimate(&recording);
    let expected = LSB * (1.0 + 1.0 / 12.0_f64).sqrt();
    assert!((noise.total_rms / expected - 1.0).abs() < 0.04, "{noise:?}");
}

#[test]
fn recorded_codes_tell_the_step_by_the_calibration() {
    let codes: Vec<u16> = (0..400).map(|idx| (2000.0 + 300.0 * (0.1 * f64::from(idx)).sin()) as u16).collect();
    let calibration = Calibration { zero_code: 2000.0, radians_per_code: -0.002 };
    let angles_rad: Vec<f64> = codes.iter().map(|code| calibration.angle_rad(*code)).collect();
    let times_s = (0..400).map(|idx| f64::from(idx) / 100.0).collect();
    let header = Header { calibration: Some(calibration), ..Header::default() };
    let recording = Recording::new(header, times_s, angles_rad, Some(codes)).unwrap();
    assert!((estimate(&recording).lsb.unwrap() / 0.002 - 1.0).abs() < 1e-9);
}
