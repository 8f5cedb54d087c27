//! What a diagnosis may claim: ties are told, friction never drives, and the limits of the noise are where the documents
//! say they are. Read from what the program prints about recordings of the independent plant.

use host::compare::measurement::Measurement;
use host::recording::{Existing, Recording, save};
use shared::model::Model;
use shared::parameters::Parameters;
use tests::hidden::{Hidden, LSB_RAD, Rig};
use tests::program::host;
use tests::workbench::{Workbench, number, texts};

/// Few samples, so that each diagnosis takes a second or two.
fn quick(seed: u64, releases_rad: &[f64]) -> Rig {
    Rig { rate_hz: 100.0, releases_rad: releases_rad.to_vec(), ..Rig::random(seed) }
}

/// A spring k·θ beside gravity m·g·l·sin θ is, up to θ⁵, a pendulum whose angle is read too large by √(1 + k/mgl): below
/// 0.55 rad the two readings differ by less than the noise. Nobody can tell them apart, so whichever is named, the other
/// one is told beside it.
#[test]
fn two_laws_that_no_free_swing_can_tell_apart_are_both_told() {
    for name in ["torsional-spring", "sensor-gain"] {
        let rig = Rig { noise_rad: 5e-4, rate_hz: 200.0, ..quick(11, &[0.55, -0.45]) };
        let weight_nm = rig.mass_kg * rig.gravity_m_s2 * rig.length_m;
        let size = if name == "sensor-gain" { 1.12_f64.sqrt() - 1.0 } else { 0.12 * weight_nm };
        let rig = Rig { hidden: vec![Hidden { name, size, shape: [0.0; 2], largest: size, is_listed: false }], ..rig };
        let (bench, swings) = Workbench::with_recordings(&rig);
        let found = bench.json(&format!("diagnose {swings}"));
        let (verdict, undecided) = (texts(&found, "verdict"), texts(&found, "undecided"));
        let told = |other: &str| verdict.contains(&other) || undecided.contains(&other);
        assert!(told("torsional-spring") && told("sensor-gain"), "{name}: {verdict:?}, undecided {undecided:?}");
        assert!(!undecided.is_empty() && !verdict.is_empty(), "{name}: {verdict:?}, undecided {undecided:?}");
    }
}

/// Where a spring relaxes a little beyond the swing its pull still changes along the way, so that it is no constant torque.
/// Notches of three numbers, which imitate it, are not named in its place.
#[test]
fn a_spring_that_relaxes_beyond_the_swing_is_named() {
    for relaxed_rad in [0.65, -0.6] {
        let rig = Rig { noise_rad: 1e-3, rate_hz: 200.0, ..quick(11, &[0.5]) };
        let size = 0.04 * rig.mass_kg * rig.gravity_m_s2 * rig.length_m;
        let shape = [relaxed_rad, 0.0];
        let spring = Hidden { name: "torsional-spring", size, shape, largest: size, is_listed: true };
        let (bench, swings) = Workbench::with_recordings(&Rig { hidden: vec![spring], ..rig });
        let found = bench.json(&format!("diagnose {swings}"));
        assert!(texts(&found, "verdict").contains(&"torsional-spring"), "{relaxed_rad}: {}", found["verdict"]);
    }
}

/// Friction at a state while the pendulum swings, N·m; positive where it drives.
fn driving_nm(parameters: &Parameters<f64>, angle_rad: f64, velocity_rad_s: f64) -> f64 {
    let model = Model::new(parameters);
    model.friction_torque_nm(&model.release(angle_rad, velocity_rad_s)) * velocity_rad_s.signum()
}

/// Two rigs with something like a motor: "friction" that grows to what it should be from less than nothing, and that is
/// less than nothing one way. A law of the list would explain either to the noise, with numbers that no bearing has.
#[test]
fn friction_that_drives_the_pendulum_is_not_claimed() {
    for (name, share) in [("drifting-friction", -1.6), ("asymmetric-coulomb", 1.5)] {
        let rig = quick(21, &[1.2, -0.8]);
        let size = if name == "drifting-friction" { share } else { share * rig.coulomb_nm };
        let rig = Rig { hidden: vec![Hidden { name, size, shape: [8.0, 0.0], largest: 9.0, is_listed: false }], ..rig };
        let (bench, swings) = Workbench::with_recordings(&rig);
        host(bench.folder(), &format!("improve {swings} -o improved.toml")).succeeded();
        let improved = bench.model("improved.toml");
        let states =
            (-4..=4).flat_map(|place| [-6.0, -2.0, -0.1, 0.1, 2.0, 6.0].map(|speed| (0.25 * f64::from(place), speed)));
        let torques: Vec<f64> = states.map(|(angle, speed)| driving_nm(&improved, angle, speed)).collect();
        let (braking, driving) = torques.iter().fold((0.0_f64, 0.0_f64), |(a, b), nm| (a.min(*nm), b.max(*nm)));
        println!("{name}: from {braking:.1e} to {driving:.1e} N·m: {:?}", improved.effects);
        // The numbers have uncertainties.
        assert!(driving <= -0.05 * braking, "{name}: friction drives with {driving} N·m: {:?}", improved.effects);
    }
}

/// A drag that leaves a tenth more than the noise is seen with certainty over thousands of samples, so it is named.
#[test]
fn a_drag_just_above_the_noise_is_named() {
    for (seed, ratio) in [(32, 1.07), (32, 1.12)] {
        let rig = Rig { rate_hz: 200.0, ..quick(seed, &[1.3, -0.9]) };
        let (rig, left) = rig.with("quadratic-drag").scaled_to(ratio);
        assert!((1.04..1.16).contains(&left), "the base model leaves {left} noises");
        let (bench, swings) = Workbench::with_recordings(&rig);
        let found = bench.json(&format!("diagnose {swings}"));
        let verdict = texts(&found, "verdict");
        assert!(verdict.contains(&"quadratic-drag") || verdict.contains(&"power-law-drag"), "{left}: {verdict:?}");
        let noises = number(&found, "rmse_after") / rig.total_noise_rad();
        assert!(noises < 1.03 && found["unexplained"] == false, "{noises}");
    }
}

/// A wave on the sensor that no law of a pendulum has: with an amplitude of √2·s noises √(1 + s²) noises remain, whatever
/// is fitted. Above 1.10 that is said to be unexplained.
#[test]
fn what_no_law_explains_is_called_unexplained_from_a_tenth_above_the_noise_on() {
    for (share, is_unexplained) in [(0.2_f64, false), (0.75, true)] {
        let rig = quick(41, &[1.3]);
        let (bench, name) = Workbench::with_recordings(&rig);
        let recording = rig.recording(0);
        let amplitude_rad = std::f64::consts::SQRT_2 * share * rig.total_noise_rad();
        let wave = |(time_s, angle_rad): (&f64, &f64)| {
            angle_rad + amplitude_rad * (std::f64::consts::TAU * 3.3 * time_s).sin()
        };
        let angles_rad = recording.times_s().iter().zip(recording.angles_rad()).map(wave).collect();
        let spoilt = Recording::uniform(rig.rate_hz, angles_rad).unwrap();
        save(&spoilt, &bench.folder().join(&name), Existing::Overwrite).unwrap();
        let found = bench.json(&format!("diagnose {name}"));
        let noises = number(&found, "rmse_after") / rig.total_noise_rad();
        let expected = (1.0 + share * share).sqrt();
        println!("{share}: {noises:.3} noises left, {expected:.3} expected");
        assert!((noises / expected - 1.0).abs() < 0.03, "{noises} noises left, {expected} expected");
        assert_eq!(found["unexplained"], is_unexplained, "{noises} noises left: {found}");
    }
}

/// Codes can't tell a zero that is off by less than one of them, however many are averaged: the step is taken from the
/// readings themselves, since these files have no codes. Above a step the same offset is named.
#[test]
fn an_offset_below_the_step_of_the_sensor_is_not_named() {
    for (steps, is_named) in [(0.75, false), (1.5, true)] {
        let rig = Rig { noise_rad: 6e-4, offset_rad: steps * LSB_RAD, ..quick(51, &[1.2, -0.8]) };
        assert!(rig.offset_rad > 1.2 * rig.total_noise_rad(), "the noise would hide it without any step");
        let (bench, swings) = Workbench::with_recordings(&rig);
        let found = bench.json(&format!("diagnose {swings}"));
        let verdict = texts(&found, "verdict");
        assert_eq!(verdict.contains(&"angle-offset"), is_named, "{steps} steps: {verdict:?}");
    }
}

/// The files of rigs whose zero wanders: in each from where it was when the file began, by so many rad/s.
fn wandering(bench: &Workbench, rig: &Rig, zeros_rad: &[f64], drift_rad_s: f64) {
    for (release_idx, zero_rad) in zeros_rad.iter().enumerate() {
        let recording = rig.recording(release_idx);
        let read = |(time_s, angle_rad): (&f64, &f64)| angle_rad + zero_rad + drift_rad_s * time_s;
        let angles_rad = recording.times_s().iter().zip(recording.angles_rad()).map(read).collect();
        let file = bench.folder().join(format!("swing{}.csv", release_idx + 1));
        save(&Recording::uniform(rig.rate_hz, angles_rad).unwrap(), &file, Existing::Overwrite).unwrap();
    }
}

/// An integrated gyroscope, or a track that warms up: its readings keep the gain, and no torque of the angle is there.
/// Where the zero was at the release comes out beside it, of every release its own.
#[test]
fn a_zero_that_wanders_is_named_and_nothing_in_its_place() {
    for (releases_rad, zeros_rad, degrees_s, named) in [
        (&[0.9][..], &[0.02][..], 0.1, &["zero-drift", "angle-offset"][..]),
        (&[0.9], &[0.05], -0.5, &["zero-drift", "angle-offset"]),
        (&[1.2, -0.8], &[0.03, -0.1], 0.1, &["zero-drift"]),
        (&[1.2, -0.8], &[0.03, -0.1], 0.0, &[]),
    ] {
        let rig = Rig { coulomb_nm: 4e-4, stiction_nm: 4e-4, ..quick(61, releases_rad) };
        let (bench, swings) = Workbench::with_recordings(&rig);
        let drift_rad_s = f64::to_radians(degrees_s);
        wandering(&bench, &rig, zeros_rad, drift_rad_s);
        let found = bench.json(&format!("diagnose {swings}"));
        assert_eq!(texts(&found, "verdict"), named, "{degrees_s} °/s: {found}");
        let noises = number(&found, "rmse_after") / rig.total_noise_rad();
        assert!(noises < 1.05, "{degrees_s} °/s: {noises} noises left");
        let of_drift = found["values"].as_array().unwrap().iter().find(|value| value["symbol"] == "dz");
        for value in of_drift.into_iter() {
            let (size, std) = (number(value, "value"), number(value, "std"));
            assert!((size - drift_rad_s).abs() < 3.5 * std && std < 1e-4, "{size} ± {std} for {drift_rad_s}");
        }
    }
}

/// A motor that gives back what friction takes: fit and diagnosis say so, and take no friction for what it is not.
#[test]
fn a_pendulum_that_is_driven_is_said_to_be() {
    let rig = quick(71, &[0.8]);
    let bench = Workbench::new(&rig);
    let own_rad_s = 0.97
        * (rig.mass_kg * rig.gravity_m_s2 * rig.length_m
            / (rig.inertia_kg_m2 + rig.mass_kg * rig.length_m * rig.length_m))
            .sqrt();
    for (name, growth_s) in [("steady", f64::INFINITY), ("grows", 60.0)] {
        let angle = |t: f64| 0.5 * (t / growth_s).exp() * (own_rad_s * t).cos();
        let angles_rad = (0..3000).map(|idx| (angle(f64::from(idx) / 100.0) / 1e-4).round() * 1e-4).collect();
        let file = format!("{name}.csv");
        save(&Recording::uniform(100.0, angles_rad).unwrap(), &bench.folder().join(&file), Existing::Keep).unwrap();
        let fit = bench.json(&format!("fit {file} --method least-squares"));
        let warnings = texts(&fit, "warnings").join("; ");
        assert!(
            warnings.contains("a motor or a hand drives") && !warnings.contains("physics is missing"),
            "{warnings}"
        );
        let found = bench.json(&format!("diagnose {file}"));
        assert_eq!(texts(&found, "driven"), [file.as_str()]);
        let said = host(bench.folder(), &format!("diagnose {file}"));
        assert!(said.succeeded().starts_with(&format!("The swings of {file} don't become smaller")), "{said:?}");
    }
}

#[test]
fn readings_of_a_simulation_are_judged_by_what_ours_is_accurate_to() {
    for (hidden, missing) in [(None, &[] as &[&str]), (Some("quadratic-drag"), &["quadratic-drag"])] {
        let rig = Rig { noise_rad: 0.0, offset_rad: 0.0, ..quick(31, &[1.2]) };
        let rig = hidden.map_or(rig.clone(), |name| rig.with(name));
        let (bench, _) = Workbench::with_recordings(&rig);
        let exact = rig.recording_in_steps(0, 1e-12);
        save(&exact, &bench.folder().join("exact.csv"), Existing::Keep).unwrap();
        let found = bench.json("diagnose exact.csv");
        assert_eq!(texts(&found, "verdict"), missing, "{found:#}");
        assert_eq!((number(&found, "noise"), &found["first_look"]), (2e-5, &serde_json::Value::Null));
        // As the page and a comparison take it.
        let measured = Measurement::from_recording("exact", &exact, &Default::default()).unwrap();
        assert_eq!((measured.swing.noise_rad, measured.noise.level_rad()), (2e-5, 2e-5));
    }
}
