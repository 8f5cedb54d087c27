//! Releases of one rig whose friction level differs while its shape does not: what a diagnosis makes of them, on swings
//! of the independent plant.

use host::diagnose::{Diagnosis, diagnose};
use host::swing::Swing;
use host::verdict::Left;
use tests::hidden::{Hidden, Rig};

/// Few samples, so that each diagnosis takes a second or two.
fn rig(releases_rad: &[f64]) -> Rig {
    let rig = Rig { rate_hz: 60.0, longest_s: 25.0, noise_rad: 1e-3, ..Rig::random(7) };
    Rig { viscous: 4e-4, coulomb_nm: 4e-4, stiction_nm: 5e-4, releases_rad: releases_rad.to_vec(), ..rig }
}

/// Each release with friction so many times the rig's: its dry part, and what grows with the speed.
fn swings(rig: &Rig, factors: &[[f64; 2]]) -> Vec<Swing> {
    let release = |(release_idx, [dry, speed]): (usize, &[f64; 2])| {
        let (coulomb_nm, stiction_nm) = (dry * rig.coulomb_nm, dry * rig.stiction_nm);
        let drags = |hidden: &Hidden| Hidden { size: speed * hidden.size, ..*hidden };
        let hidden = rig.hidden.iter().map(drags).collect();
        let one = Rig { coulomb_nm, stiction_nm, viscous: speed * rig.viscous, hidden, ..rig.clone() };
        one.swings().swap_remove(release_idx)
    };
    factors.iter().enumerate().map(release).collect()
}

fn diagnosed(rig: &Rig, factors: &[[f64; 2]]) -> Diagnosis {
    let found = diagnose(&swings(rig, factors), &[], &rig.known());
    let words = found.levels.as_ref().map(|levels| levels.words.clone());
    println!(
        "{:?} {words:?} {:.2} -> {:.3} noises, {:.1} s",
        found.verdict,
        found.rmse_before / found.noise,
        found.rmse_after / found.noise,
        found.seconds
    );
    found
}

/// Are the levels said, each within three of its ±?
fn assert_said(found: &Diagnosis, factors: &[[f64; 2]]) {
    let levels = found.levels.as_ref().expect("levels that differ");
    for (part_idx, part) in levels.parts.iter().enumerate() {
        let mean = factors.iter().map(|factor| factor[part_idx]).sum::<f64>() / factors.len() as f64;
        for (level, factor) in part.releases.iter().zip(factors) {
            let (off, std) = (level.value - (factor[part_idx] / mean - 1.0), level.std.unwrap());
            println!("{:?} {}: {:.4} ± {std:.4}, off by {off:.4}", part.part, level.recording, level.value);
            assert!(off.abs() < 3.0 * std && std < 0.06, "{:?} of {level:?} is off by {off}", part.part);
        }
    }
}

#[test]
fn friction_levels_that_differ_are_said_and_no_effect_is() {
    for factors in [&[[0.88; 2], [1.0; 2], [1.12; 2]][..], &[[1.12, 1.0], [0.88, 1.0], [1.0, 1.0], [1.05, 1.0]]] {
        let rig = rig(&[1.2, -0.9, 1.0, -1.1][..factors.len()]);
        let found = diagnosed(&rig, factors);
        assert!(found.verdict.is_empty() && found.left == Left::Noise, "{:?} {:?}", found.verdict, found.left);
        // What one friction for all leaves is no less for the levels that were found.
        assert!(found.rmse_before > 1.5 * found.rmse_after, "{} {}", found.rmse_before, found.rmse_after);
        let steps: Vec<&str> = found.staircase.iter().map(|step| step.added).collect();
        assert_eq!(steps, ["base", "friction levels"]);
        assert_said(&found, factors);
        let words = &found.levels.unwrap().words;
        assert!(words.contains("friction level changed by 2"), "{words}");
    }
}

/// Released from different heights they pass the same amplitudes at other times: friction that fades explains that nearly as
/// well, and to the noise in the first of these, but not as well as levels.
#[test]
fn levels_of_two_releases_from_different_heights_are_no_drift() {
    for (coulomb_nm, second_rad, factor) in [(1.8e-3, 0.9, 1.1), (2.5e-3, 1.0, 1.12)] {
        let rig = Rig { coulomb_nm, stiction_nm: 1.3 * coulomb_nm, longest_s: 15.0, ..rig(&[1.2, second_rad]) };
        let found = diagnosed(&rig, &[[1.0, 1.0], [factor, 1.0]]);
        assert!(found.verdict.is_empty() && found.left == Left::Noise, "{:?} {:?}", found.verdict, found.left);
        let dry = &found.levels.expect("levels that differ").parts[0];
        let change = 2.0 * (factor - 1.0) / (factor + 1.0);
        assert!(dry.differs && (dry.change - change).abs() < 0.02, "{} for {change}", dry.change);
    }
}

#[test]
fn of_equal_levels_nothing_is_said() {
    let equal = [[1.0; 2]; 3];
    let plain = diagnosed(&rig(&[1.2, -0.9, 1.0]), &equal);
    assert!(plain.levels.is_none() && plain.verdict.is_empty());
    let drag = diagnosed(&rig(&[1.2, -0.9, 1.0]).with("quadratic-drag"), &equal);
    assert!(drag.levels.is_none() && drag.verdict == ["quadratic-drag"], "{:?}", drag.verdict);
    let drift = diagnosed(&rig(&[1.2, -0.9, 1.0]).with("drifting-friction"), &equal);
    assert!(drift.levels.is_none() && drift.verdict.len() == 1, "{:?}", drift.verdict);
}

/// Something that no law of the list describes looks like other friction in larger swings, but not on every part of
/// them.
#[test]
fn what_no_law_explains_is_no_change_of_the_level() {
    let bump = Hidden { name: "bump", size: 4e-4, shape: [3.0, 0.4], largest: 1.0, is_listed: false };
    // In little noise the windows agree on levels that are all within their own ±.
    let rig = Rig { hidden: vec![bump], noise_rad: 5e-4, ..rig(&[1.2, -0.5, 0.9]) };
    let found = diagnosed(&rig, &[[1.0; 2]; 3]);
    assert!(found.levels.is_none(), "{:?}", found.levels);
}

#[test]
fn a_drag_is_named_beside_levels_that_differ() {
    let factors = [[0.88; 2], [1.0; 2], [1.12; 2]];
    let found = diagnosed(&rig(&[1.3, -1.0, 1.1]).with("quadratic-drag"), &factors);
    assert_eq!(found.verdict, ["quadratic-drag"]);
    assert_said(&found, &factors);
}
