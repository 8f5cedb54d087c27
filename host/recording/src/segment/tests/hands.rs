//! Hands that lift, hold and let go.

use super::*;

/// Moved by some milliradians within some tenths of a second, where what is let go falls ten times as far.
#[test]
fn a_hold_is_one_until_it_falls_however_the_hand_trembles() {
    for samples in [6.0, 9.0, 13.0] {
        let wave = |idx: u32, samples: f64| (f64::from(idx) / samples).sin();
        let held = (0..300).map(|idx| 0.8 + 8e-3 * wave(idx, samples) * wave(idx, 17.0)).collect();
        let segments = find(&[held, swing(0.8, 20.0)].concat());
        let late_s = segments.free.start as f64 * STEP_S - 1.5;
        assert!((0.02..0.06).contains(&late_s), "{samples}: {late_s} {segments:?}");
        assert!(segments.notes[0].contains("held still before the release at 1.50"), "{:?}", segments.notes);
    }
}

/// Two pendulums on one string turn together after one time or another; one alone takes the same time, or less after large swings.
#[test]
fn turns_without_order_are_told_and_large_swings_that_become_shorter_are_not() {
    let disorder_s = |angles: &[f64]| {
        let recording = noisy(angles);
        let all = 0..recording.len();
        Cut::new(&recording, all.clone()).unwrap().disorder_s(&all)
    };
    let together = |idx: u32| {
        let time_s = f64::from(idx) * STEP_S;
        0.3 * (5.0 * time_s).sin() + 0.2 * (12.3 * time_s).sin()
    };
    let found = disorder_s(&(0..4000).map(together).collect::<Vec<_>>());
    assert!(found.is_some_and(|(shortest_s, longest_s)| longest_s > 1.5 * shortest_s), "{found:?}");
    for angle_rad in [0.1, 0.8, 2.0, 3.0] {
        assert_eq!(disorder_s(&swing(angle_rad, 20.0)), None, "{angle_rad}");
        assert!(!find(&swing_to_rest(angle_rad)).notes.iter().any(|note| note.contains("without order")));
    }
}

/// From where it hangs to another angle and held there: with the least jerk, as people move.
fn taken(from_rad: f64, to_rad: f64, duration_s: f64) -> Vec<f64> {
    let n = (duration_s / STEP_S) as usize;
    let share = |s: f64| s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s);
    let way = (1..=n).map(|idx| from_rad + (to_rad - from_rad) * share(idx as f64 / n as f64));
    way.chain(vec![to_rad; 200]).collect()
}

/// Held, let go and hung still for some seconds.
fn swing_to_rest(angle_rad: f64) -> Vec<f64> {
    [vec![angle_rad; 200], swing(angle_rad, 20.0)].concat()
}

#[test]
fn what_hangs_still_ends_before_a_hand_takes_it_however_gently() {
    for (to_rad, duration_s) in [(0.12, 0.8), (-0.4, 0.6), (0.8, 1.2), (1.5, 1.0)] {
        let first = swing_to_rest(0.4);
        let rest_rad = first[first.len() - 1];
        let segments = find(&[first.clone(), taken(rest_rad, to_rad, duration_s), swing(to_rad, 1.0)].concat());
        let rest = segments.rest.clone().unwrap();
        let after_s = (rest.end as f64 - first.len() as f64) * STEP_S;
        assert!((-0.3..0.03).contains(&after_s), "{to_rad} {duration_s}: {after_s} {segments:?}");
        let is_told = |note: &String| note.contains("hanging still at the end, and everything after");
        assert!(segments.notes.iter().any(is_told), "{:?}", segments.notes);
    }
}

/// In air, of which the law knows nothing that the small swings of another release tell.
fn in_air(angle_rad: f64, dry: f64, drag: f64) -> Vec<f64> {
    let (mut angle, mut velocity, mut angles) = (angle_rad, 0.0_f64, Vec::new());
    for step_idx in 0..90_000 {
        if step_idx % 50 == 0 {
            angles.push(angle);
        }
        let gravity = -70.0 * angle.sin();
        let is_stuck = velocity.abs() < 1e-4 && gravity.abs() < dry;
        let friction = dry * velocity.signum() + drag * velocity * velocity.abs();
        velocity = if is_stuck { 0.0 } else { velocity + 1e-4 * (gravity - friction) };
        angle += 1e-4 * velocity;
    }
    angles
}

#[test]
fn limits_that_leave_a_hand_in_it_are_taken_as_told() {
    let first = swing_to_rest(0.4);
    let hand = taken(first[first.len() - 1], 0.8, 1.2);
    let whole = noisy(&[first, hand, swing(0.8, 6.0)].concat());
    let end_s = whole.times_s()[whole.len() - 1] - 1.0;
    for from_s in [None, Some(0.5), Some(3.0)] {
        let options = SegmentOptions { from_s, to_s: Some(end_s) };
        let segments = segment(&whole, &options).unwrap();
        assert_eq!(segments.free.end, whole.index_at(end_s) + 1, "{from_s:?}");
        assert!(segments.notes.iter().any(|note| note.ends_with("s, as told")), "{:?}", segments.notes);
        if let Some(from_s) = from_s {
            assert_eq!(segments.free.start, whole.index_at(from_s));
        }
    }
}

#[test]
fn a_release_is_found_though_a_hand_and_another_swing_follow() {
    for (dry, drag, other_rad) in [(1.0, 0.15, -1.0), (1.0, 0.2, 1.3), (2.0, 0.1, -1.0), (2.0, 0.1, 1.3)] {
        let first = [vec![1.8; 300], in_air(1.8, dry, drag)].concat();
        let hand = taken(first[first.len() - 1], other_rad, 0.9);
        let segments = find(&[first, hand, in_air(other_rad, dry, drag)].concat());
        let late_s = segments.free.start as f64 * STEP_S - 1.5;
        assert!((0.0..0.06).contains(&late_s), "{dry} {drag} {other_rad}: {late_s} {segments:?}");
        assert!(segments.notes[0].contains("held still before the release"), "{:?}", segments.notes);
    }
}

#[test]
fn a_second_release_is_found_though_another_swing_came_before() {
    for (dry, drag, other_rad) in [(1.5, 0.15, -1.0), (1.5, 0.15, 1.3), (2.0, 0.2, 1.3)] {
        let first = [vec![1.8; 300], in_air(1.8, dry, drag)].concat();
        let hand = taken(first[first.len() - 1], other_rad, 0.9);
        let release_s = (first.len() + hand.len()) as f64 * STEP_S;
        let segments = find(&[first, hand, in_air(other_rad, dry, drag)].concat());
        let late_s = segments.free.start as f64 * STEP_S - release_s;
        assert!((0.0..0.08).contains(&late_s), "{dry} {drag} {other_rad}: {late_s} {segments:?}");
    }
}

#[test]
fn a_small_tail_behind_a_longer_motion_is_doubted() {
    let moved = |size_rad: f64| {
        (0..6000).map(move |idx| size_rad * (f64::from(idx) * 0.031).sin() * (f64::from(idx) * 0.0021).cos())
    };
    let doubts = |size_rad: f64| {
        let notes = find(&[moved(size_rad).collect(), swing(0.15, 12.0)].concat()).notes;
        notes.iter().any(|note| note.contains("is that the free swing?"))
    };
    assert!(doubts(1.2) && !doubts(0.2));
}

#[test]
fn a_tiny_tail_behind_some_swings_is_doubted_that_take_no_longer() {
    let moved = (0..1200).map(|idx| 1.2 * (f64::from(idx) * 0.031).sin() * (f64::from(idx) * 0.0021).cos());
    let segments = find(&[moved.collect(), swing(0.15, 12.0)].concat());
    let doubt = segments.notes.iter().find(|note| note.contains("is that the free swing?"));
    assert!(doubt.is_some_and(|doubt| !doubt.contains("takes longer")), "{:?}", segments.notes);
}

/// In step with its own swings, and as large throughout.
#[test]
fn swings_that_a_motor_holds_are_not_called_free_where_they_are_left_out() {
    let driven = (0..3000).map(|idx| 0.3 * (8.3 * STEP_S * f64::from(idx)).sin());
    let segments = find(&[swing(0.9, 12.0), vec![0.0; 200], driven.collect()].concat());
    let told = |words: &str| segments.notes.iter().any(|note| note.contains(words));
    assert!(segments.free.end < 2500 && told("are left out: they don't become smaller"), "{segments:?}");
    assert!(!told("a free swing from"), "{segments:?}");
}

/// Hanging, lifted within 1.4 s, held for 3 s by a hand that sinks a little and trembles or not, and let go: dry friction ends it
/// after some turns. And when it was let go, s.
fn held_in_grease([dry_rad_s2, sinks_rad, trembles_rad]: [f64; 3]) -> (Recording, f64) {
    let lifted = |share: f64| -0.8 * (1.0 - (std::f64::consts::PI * share).cos()) / 2.0;
    let lift = (0..280).map(|idx| lifted(f64::from(idx) / 280.0));
    let trembles = |idx: f64| trembles_rad * (idx / 9.0).sin() * (idx / 17.0).sin();
    let hold = (0..600).map(f64::from).map(|idx| -0.8 - sinks_rad * idx / 600.0 + trembles(idx));
    let mut angles_rad: Vec<f64> = std::iter::repeat_n(0.0, 320).chain(lift).chain(hold).collect();
    let released_s = angles_rad.len() as f64 * STEP_S;
    angles_rad.extend(in_grease(angles_rad[angles_rad.len() - 1], dry_rad_s2));
    let rounded = angles_rad.iter().map(|angle_rad| (angle_rad / 1.5e-3).round() * 1.5e-3).collect();
    (Recording::uniform(1.0 / STEP_S, rounded).unwrap(), released_s)
}

#[test]
fn few_swings_behind_a_long_hold_are_found() {
    let cases = [[12.0, 0.02, 8e-3], [15.0, 0.02, 2e-3], [15.0, 0.05, 8e-3], [20.0, 0.02, 0.0], [16.0, 0.05, 2e-3]];
    for case in cases {
        let (recording, released_s) = held_in_grease(case);
        let found = segment(&recording, &SegmentOptions::default());
        let segments = found.unwrap_or_else(|fault| panic!("{case:?} {fault}"));
        let late_s = segments.free.start as f64 * STEP_S - released_s;
        assert!((-0.01..0.1).contains(&late_s) && segments.rest.is_some(), "{case:?} {late_s} {segments:?}");
    }
}

/// Of three turns nothing can be found, and of the hand before them nothing that anybody wants.
#[test]
fn a_hand_that_trembles_before_too_few_swings_is_doubted() {
    let is_doubted = |recording: &Recording| {
        let segments = segment(recording, &SegmentOptions::default()).unwrap();
        segments.notes.iter().any(|note| note.contains("and this a hand that holds it?"))
    };
    let (recording, released_s) = held_in_grease([20.0, 0.02, 8e-3]);
    assert!(is_doubted(&recording));
    // What a motor swings further is no free swing that was missed.
    let pwm = |time_s: &f64| if *time_s < released_s { 0.0 } else { 80.0 * (9.0 * time_s).sin() };
    let drive = crate::drive::Drive::of("pwm".to_owned(), recording.times_s().iter().map(pwm).collect());
    assert!(!is_doubted(&recording.with_others((drive.into_iter().collect(), Vec::new()))));
}

/// With so much dry friction (ω0² = 200/s²), until long after it stuck.
fn in_grease(angle_rad: f64, dry_rad_s2: f64) -> Vec<f64> {
    let (mut angle, mut velocity, mut angles) = (angle_rad, 0.0_f64, Vec::new());
    for step_idx in 0..80_000 {
        if step_idx % 50 == 0 {
            angles.push(angle);
        }
        let gravity = -200.0 * angle.sin();
        let is_stuck = velocity.abs() < 2e-3 && gravity.abs() < dry_rad_s2;
        velocity = if is_stuck { 0.0 } else { velocity + 1e-4 * (gravity - dry_rad_s2 * velocity.signum()) };
        angle += 1e-4 * velocity;
    }
    angles
}
