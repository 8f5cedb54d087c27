//! Swings beyond a right angle, of a sensor that lies askew, and motors that hold a pendulum upright.

use super::*;
use std::f64::consts::PI;

/// As an encoder of 4096 steps reads it whose magnet lies askew.
fn askew(angle_rad: f64, askew_rad: f64) -> f64 {
    let step_rad = 2.0 * PI / 4096.0;
    ((angle_rad + askew_rad * (2.0 * angle_rad + 0.3).sin()) / step_rad).round() * step_rad
}

#[test]
fn the_largest_swings_of_a_sensor_that_lies_askew_are_no_hand() {
    // Most of it is small, and tells nothing of what the large ones do to such a sensor.
    let free = swing(2.7, 60.0);
    for askew_rad in [0.0, 0.043, -0.043] {
        let read = free.iter().map(|angle| askew(*angle, askew_rad)).collect();
        let segments = segment(&Recording::uniform(1.0 / STEP_S, read).unwrap(), &SegmentOptions::default()).unwrap();
        assert_eq!(segments.free.start, 0, "{askew_rad}: {:?}", segments.notes);
    }
}

/// Balanced about upright for some seconds.
fn balanced(duration_s: f64) -> Vec<f64> {
    let time_s = |idx: usize| idx as f64 * STEP_S;
    (0..(duration_s / STEP_S) as usize)
        .map(|idx| PI + 0.1 * (4.0 * time_s(idx)).sin() + 0.05 * (2.3 * time_s(idx)).sin())
        .collect()
}

#[test]
fn what_a_motor_holds_upright_is_no_free_swing() {
    let free = swing(1.0, 5.0);
    // Longer than the free swing, before it, behind it, and whole turns away.
    for turns in [0.0, 1.0] {
        let balanced: Vec<f64> = balanced(40.0).iter().map(|angle| angle + 2.0 * PI * turns).collect();
        let before = [balanced.clone(), free.clone()].concat();
        let segments = find(&before);
        let start_s = segments.free.start as f64 * STEP_S;
        assert!((40.0..40.9).contains(&start_s), "{turns}: {start_s} {:?}", segments.notes);
        let behind = find(&[free.clone(), balanced].concat());
        let end_s = behind.free.end as f64 * STEP_S;
        assert!(behind.free.start == 0 && (4.5..5.1).contains(&end_s), "{turns}: {end_s} {:?}", behind.notes);
    }
    let alone = segment(&noisy(&balanced(40.0)), &SegmentOptions::default());
    assert!(alone.is_err(), "{alone:?}");
}

/// Over the top and on: whole turns away it hangs as well.
#[test]
fn a_swing_that_has_gone_over_the_top_hangs_as_any_other() {
    let turned: Vec<f64> = swing(2.5, 20.0).iter().map(|angle| angle + 2.0 * PI).collect();
    assert_eq!(find(&turned).free.start, 0);
}
