//! The comparison on simulated rigs, where the truth is known.

mod compare_support;

use compare_support::{Release, keep_pictures, readings, rig, simulated};
use host::compare::measurement::Measurement;
use host::compare::torque::{Bin, TorqueMap};
use host::compare::verdict::Answer;
use host::compare::{Comparison, Options, compare};
use host::noise;
use host::random::Noise;
use host::report::report;
use host::swing::Swing;
use host::zero_phase;
use shared::model::Model;
use shared::parameters::Parameters;

fn compared(rig: &Parameters<f64>, measurements: &[Measurement]) -> Comparison {
    compare(rig, measurements, &[], &Options::default()).unwrap()
}

/// Torque of what `with` has beyond `without`, at a state.
fn missing_nm(with: &Parameters<f64>, without: &Parameters<f64>, angle_rad: f64, velocity_rad_s: f64) -> f64 {
    let torque = |parameters: &Parameters<f64>| {
        let model = Model::new(parameters);
        model.friction_torque_nm(&model.release(angle_rad, velocity_rad_s))
    };
    torque(with) - torque(without)
}

/// There are data where the standard error is below this share of the missing torque's peak.
const KNOWN_SHARE: f64 = 0.04;

/// At least this share of all bins that were passed must be known so well.
const LEAST_KNOWN: f64 = 0.5;

/// Largest error of the map where there are data, as a share of the peak of the missing torque.
fn worst_share(map: &TorqueMap, with: &Parameters<f64>, without: &Parameters<f64>) -> f64 {
    let truth = |bin: &Bin| missing_nm(with, without, bin.angle_rad, bin.velocity_rad_s);
    let peak_nm = map.bins.iter().map(|bin| truth(bin).abs()).fold(0.0, f64::max);
    let known: Vec<&Bin> = map.bins.iter().filter(|bin| bin.spread_nm < KNOWN_SHARE * peak_nm).collect();
    let worst_nm = known.iter().map(|bin| (bin.torque_nm - truth(bin)).abs()).fold(0.0, f64::max);
    println!("{} of {} bins known, worst {:.3} of {peak_nm:.5}", known.len(), map.bins.len(), worst_nm / peak_nm);
    assert!(known.len() as f64 > LEAST_KNOWN * map.bins.len() as f64);
    worst_nm / peak_nm
}

fn check_map(id: u16, values: &[f64], name: &str) {
    let without = rig();
    let mut with = rig();
    with.set(id, values).unwrap();
    let releases: Vec<Measurement> = [1.4, -1.2, 1.0, -0.7]
        .iter()
        .zip(1..)
        .map(|(angle, seed)| simulated(&with, &Release { seconds: 50.0, rate_hz: 1000.0, ..Release::of(*angle, seed) }))
        .collect();
    let comparison = compared(&without, &releases);
    println!("{}", comparison.verdict.join("\n"));
    keep_pictures(name, &comparison);
    assert_eq!(comparison.answer, Answer::PhysicsMissing);
    let map = comparison.torque.unwrap();
    assert!(map.is_significant);
    assert!(worst_share(&map, &with, &without) < 0.1);
}

#[test]
fn the_map_finds_a_drag_that_the_model_lacks() {
    check_map(10, &[1e-4], "drag");
}

#[test]
fn the_map_finds_a_spring_that_the_model_lacks() {
    check_map(14, &[4e-3, 0.0], "spring");
}

#[test]
fn nothing_is_missing_from_data_of_the_model_itself() {
    let rig = rig();
    let mut n_alarms = 0;
    for seed in 0..100 {
        let angle_rad = 0.6 + 0.008 * seed as f64;
        let comparison = compared(&rig, &[simulated(&rig, &Release::of(angle_rad, seed))]);
        let map_alarm = comparison.torque.as_ref().is_some_and(|map| map.is_significant);
        if comparison.answer != Answer::NothingMissing || map_alarm {
            println!("seed {seed}: {:?} {map_alarm} {:?}", comparison.answer, comparison.verdict);
            n_alarms += 1;
        }
    }
    println!("{n_alarms} false alarms");
    assert!(n_alarms <= 2, "{n_alarms}");
}

/// Noise through a filter, as a rig with an analogue or digital filter in its chain makes it; the swing itself is slow
/// enough not to care.
fn filtered(parameters: &Parameters<f64>, release: &Release, cutoff_hz: f64) -> Measurement {
    let quiet = Release { noise_rad: 0.0, lsb_rad: 0.0, ..*release };
    let (times_s, angles_rad) = readings(parameters, &quiet);
    let mut noise = Noise::new(release.seed);
    let white: Vec<f64> = times_s.iter().map(|_| release.noise_rad * noise.normal()).collect();
    let coloured = zero_phase::filter(&white, cutoff_hz, release.rate_hz);
    let angles_rad: Vec<f64> = angles_rad.iter().zip(coloured).map(|(angle, noise)| angle + noise).collect();
    let found = noise::of_samples(&times_s, &angles_rad, None);
    Measurement::of_swing(Swing::new("filtered", &times_s, &angles_rad, found.total_rms))
}

/// Of 100 seeds, how many 95 % intervals contain the truth, by parameter.
fn check_intervals(measured: impl Fn(&Release) -> Measurement) {
    let rig = rig();
    let truth = [5e-4, 8e-4, rig.pendulum.inertia_kg_m2];
    let mut n_inside = [0; 3];
    for seed in 0..100 {
        let release = Release { seconds: 20.0, ..Release::of(1.2, 1000 + seed) };
        let comparison = compared(&rig, &[measured(&release)]);
        let knowledge = comparison.knowledge.unwrap();
        for (k, known) in knowledge.parameters.iter().enumerate() {
            let (low, high) = known.chosen.interval().unwrap();
            n_inside[k] += i32::from((low..high).contains(&truth[k]));
        }
    }
    println!("inside {n_inside:?}");
    assert!(n_inside.iter().all(|n| (90..=99).contains(n)), "{n_inside:?}");
}

#[test]
fn intervals_contain_the_truth_with_white_noise() {
    check_intervals(|release| simulated(&rig(), release));
}

#[test]
fn intervals_contain_the_truth_with_a_filter_in_the_chain() {
    check_intervals(|release| filtered(&rig(), release, 10.0));
}

#[test]
fn the_report_of_four_recordings_of_50_s_at_1_khz_takes_no_more_than_8_mb() {
    let rig = rig();
    let release = |k: u64| Release { seconds: 50.0, rate_hz: 1000.0, ..Release::of(1.4 - 0.2 * k as f64, k) };
    let measurements: Vec<Measurement> = (0..4).map(|k| simulated(&rig, &release(k))).collect();
    let began = std::time::Instant::now();
    let comparison = compared(&rig, &measurements);
    let seconds = began.elapsed().as_secs_f64();
    let page = report(&comparison);
    println!("{seconds:.2} s, report {:.2} MB in {:.2} s", page.len() as f64 / 1e6, began.elapsed().as_secs_f64());
    keep_pictures("four", &comparison);
    assert!(page.len() < 8_000_000, "{}", page.len());
    assert!(serde_json::to_string(&comparison).unwrap().len() < 2_000_000);
}
