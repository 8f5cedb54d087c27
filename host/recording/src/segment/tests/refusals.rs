//! What is refused, and in which words.

use super::*;

#[test]
fn one_swing_is_too_few_and_the_message_says_so() {
    let error = segment(&noisy(&swing(1.0, 0.8)), &SegmentOptions::default()).unwrap_err();
    assert!(error.to_string().contains("two swings"), "{error}");
}

#[test]
fn a_still_pendulum_has_too_few_swings() {
    let error = segment(&noisy(&vec![0.2; 1000]), &SegmentOptions::default()).unwrap_err();
    assert!(matches!(error, SegmentError::TooFewSwings { n_turning_points: 0, .. }), "{error}");
}

#[test]
fn limits_of_the_user_are_taken_as_they_are() {
    let recording = noisy(&swing(1.0, 12.0));
    let options = SegmentOptions { from_s: Some(2.0), to_s: Some(8.0) };
    let segments = segment(&recording, &options).unwrap();
    assert_eq!(segments.free, 400..1601);
    assert_eq!(segments.notes.len(), 2);
}

#[test]
fn limits_outside_the_recording_are_refused_with_its_times() {
    let recording = noisy(&swing(1.0, 12.0));
    let options = SegmentOptions { from_s: Some(20.0), to_s: None };
    let error = segment(&recording, &options).unwrap_err().to_string();
    assert!(error.contains("from 0 s to 11.995 s"), "{error}");
}

#[test]
fn one_turning_point_is_told_as_one() {
    let told = |n_turning_points| SegmentError::TooFewSwings { n_turning_points, duration_s: 1.25 }.to_string();
    assert!(told(1).starts_with("only one turning point of free swing in 1.25 s"), "{}", told(1));
    assert!(told(2).starts_with("only 2 turning points of free swing in 1.25 s"), "{}", told(2));
}

#[test]
fn turning_points_alone_are_told_from_few_readings() {
    let turns: Vec<f64> =
        (0..200).map(|idx| 0.5 * f64::from(idx % 2 * 2 - 1) * (-0.005 * f64::from(idx)).exp()).collect();
    let told =
        |angles_rad| segment(&Recording::uniform(2.0, angles_rad).unwrap(), &SegmentOptions::default()).unwrap_err();
    let alone = told(turns);
    assert_eq!(alone, SegmentError::OnlyTurns { n_samples: 200 });
    assert!(alone.to_string().starts_with("of 200 readings nearly each is a turning point"), "{alone}");
    // Of noise two of three are.
    let mut noise = crate::random::Noise::new(3);
    let noise = told((0..200).map(|_| noise.normal()).collect());
    assert!(matches!(noise, SegmentError::TooFewSwings { .. }), "{noise}");
}

/// To and fro by two steps of an encoder of 0.25°, and by ten.
#[test]
fn ways_of_one_or_two_steps_of_the_sensor_are_no_swings() {
    let step_rad = 0.25_f64.to_radians();
    let stepped = |steps: f64| {
        let times_s = (0..6000).map(|idx| STEP_S * f64::from(idx));
        let angles = times_s.map(|t| steps * (-0.01 * t).exp() * (2.0 * t).cos());
        let angles_rad = angles.map(|angle| step_rad * angle.round()).collect();
        segment(&Recording::uniform(1.0 / STEP_S, angles_rad).unwrap(), &SegmentOptions::default())
    };
    let refused = stepped(1.2).unwrap_err();
    assert!(matches!(refused, SegmentError::WithinSteps { n_seen: 0, .. }), "{refused:?}");
    assert!(refused.to_string().contains("four steps of its sensor (4.36e-3 rad)"), "{refused}");
    assert!(stepped(5.0).is_ok());
}
