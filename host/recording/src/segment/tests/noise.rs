use super::*;

/// A hold, a swing and a rest with noise of 1 mrad rms whose neighbours are alike, by a first-order filter of 50 ms, a
/// mean over four samples or hum, or alternate, by hum of half the sampling rate.
#[test]
fn where_noise_is_not_white_hold_and_rest_are_found_and_its_whole_size_is_known() {
    let whole = [vec![0.8; 100], swing(0.8, 60.0)].concat();
    let unit: Vec<f64> = noisy(&vec![0.0; whole.len() + 3]).angles_rad().to_vec();
    let filtered = |rho: f64| {
        let scale = (1.0 - rho * rho).sqrt();
        let walk = unit.iter().scan(0.0, |last, x| {
            *last = rho * *last + scale * x;
            Some(*last)
        });
        walk.collect::<Vec<f64>>()
    };
    let mean_of_four = unit.windows(4).map(|four| four.iter().sum::<f64>() / 2.0).collect();
    let hum = unit.iter().enumerate().map(|(i, x)| 0.6 * x + 0.8e-3 * 2f64.sqrt() * (0.23 * i as f64).sin()).collect();
    // Of half the sampling rate.
    let alternating = unit.iter().enumerate().map(|(i, x)| 0.6 * x + 0.8e-3 * f64::from(1 - 2 * (i as i32 % 2)));
    let of_kind: [(&str, Vec<f64>); 5] = [
        ("filter", filtered(0.9)),
        ("weaker", filtered(0.5)),
        ("mean", mean_of_four),
        ("hum", hum),
        ("alternating", alternating.collect()),
    ];
    for (kind, noise) in of_kind {
        let angles_rad = whole.iter().zip(&noise).map(|(angle, noise)| angle + noise).collect();
        let recording = Recording::uniform(1.0 / STEP_S, angles_rad).unwrap();
        let segments = segment(&recording, &SegmentOptions::default()).unwrap();
        let late = segments.free.start as f64 * STEP_S - 0.5;
        assert!((0.0..0.06).contains(&late), "{kind}: {late} {segments:?}");
        let rest = segments.rest.clone().unwrap_or_else(|| panic!("{kind}: {segments:?}"));
        assert!((600..5000).contains(&rest.start) && rest.end == whole.len(), "{kind}: {rest:?}");
        let noise = &segments.noise;
        assert!((noise.level_rad() / 1e-3 - 1.0).abs() < 0.1 && noise.colour.is_some(), "{kind}: {noise:?}");
    }
}

/// White noise of a fifth of a step: at rest on the edge between two codes it scatters by half a step, at 1.2 times what it does
/// across many.
#[test]
fn a_rest_between_two_codes_is_no_coloured_noise() {
    let whole = swing(0.8, 60.0);
    let (step_rad, rest_rad) = (5e-3, whole[whole.len() - 1]);
    let code = |angle: &f64| ((angle - rest_rad) / step_rad).floor() + 0.5;
    let angles_rad = noisy(&whole).angles_rad().iter().map(|angle| step_rad * code(angle)).collect();
    let segments = segment(&Recording::uniform(1.0 / STEP_S, angles_rad).unwrap(), &SegmentOptions::default()).unwrap();
    let noise = &segments.noise;
    assert!(noise.still_rms.unwrap() > 1.3 * noise.total_rms && noise.colour.is_none(), "{noise:?}");
}

/// Only where it hangs by itself a wandering angle is the sensor's.
#[test]
fn a_hand_that_trembles_is_no_noise_of_the_sensor() {
    let trembling = (0..400).map(|idx| 0.8 + 4e-3 * (0.11 * f64::from(idx)).sin()).collect();
    let segments = find(&[trembling, swing(0.8, 12.0)].concat());
    assert!(segments.rest.is_none() && segments.noise.colour.is_none(), "{segments:?}");
    assert!(segments.notes.iter().any(|note| note.contains("a hand that trembles")), "{segments:?}");
    assert!((segments.noise.level_rad() / 1e-3 - 1.0).abs() < 0.05, "{segments:?}");
}

/// Three half swings of it are 1.1 s, in which nothing could be unseen: each half swing here is 9 mrad smaller than the one before.
#[test]
fn a_rest_of_a_second_tells_noise_whose_neighbours_are_alike() {
    let whole = swing(0.8, 60.0);
    let rests_from = whole.iter().rposition(|angle| *angle != whole[whole.len() - 1]).unwrap();
    let with_rest = &whole[..rests_from + 230];
    let level_of = |rho: f64, seed: u64| {
        let mut noise = crate::random::Noise::new(seed);
        let (mut last, scale) = (0.0, 1e-3 * (1.0 - rho * rho).sqrt());
        let mut next = || {
            last = rho * last + scale * noise.normal();
            last
        };
        let recording = Recording::uniform(1.0 / STEP_S, with_rest.iter().map(|angle| angle + next()).collect());
        segment(&recording.unwrap(), &SegmentOptions::default()).unwrap().noise
    };
    for seed in 0..10 {
        let noise = level_of(0.8, seed);
        assert!(noise.total_rms < 0.6e-3, "{noise:?}");
        assert!((noise.level_rad() / 1e-3 - 1.0).abs() < 0.35 && noise.colour.is_some(), "{seed}: {noise:?}");
        assert!((level_of(0.0, seed).level_rad() / 1e-3 - 1.0).abs() < 0.1, "{seed}");
    }
}

/// A period takes 0.75 s: three or four samples, or six.
#[test]
fn what_turns_as_often_as_noise_is_doubted() {
    for (every, is_doubted) in [(52, true), (37, true), (25, false)] {
        let angles_rad: Vec<f64> = noisy(&swing(0.5, 40.0)).angles_rad().iter().step_by(every).copied().collect();
        let recording = Recording::uniform(1.0 / (STEP_S * every as f64), angles_rad).unwrap();
        let segments = segment(&recording, &SegmentOptions::default()).unwrap();
        let told = segments.notes.iter().any(|note| note.starts_with("doubtful: from turn to turn it takes "));
        assert_eq!(told, is_doubted, "{every}: {segments:?}");
    }
}
