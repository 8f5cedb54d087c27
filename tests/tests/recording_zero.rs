//! Readings of a sensor whose zero is not where the pendulum hangs.

use host::recording::{ReadOptions, Recording, read};
use tests::chance::Chance;
use tests::plant::{Plant, Scenario};

const RATE_HZ: usize = 1000;

/// Angles of a released pendulum at 100 Hz with 0.5 mrad of noise, rad.
fn swing(release_rad: f64, seconds: usize) -> Vec<f64> {
    let scenario = Scenario { release_rad, rest_s: 0.5, lift_s: 1.0, ..Scenario::default() };
    let mut plant = Plant::new(scenario);
    let mut chance = Chance::new(1);
    let mut angle_rad = || {
        (0..RATE_HZ / 100).for_each(|_| {
            plant.next_code();
        });
        plant.angle_rad() + 5e-4 * chance.normal()
    };
    (0..seconds * 100).map(|_| angle_rad()).collect()
}

/// The same file as somebody else's: without a word on units and zero.
fn reads(angles: &[f64], options: &ReadOptions) -> (Recording, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("swing.csv");
    let rows: String =
        angles.iter().enumerate().map(|(idx, angle)| format!("{:.2},{angle:.6}\n", idx as f64 / 100.0)).collect();
    std::fs::write(&path, format!("t,theta\n{rows}")).unwrap();
    let recording = read(&path, options).unwrap();
    let notes = recording.notes().to_vec();
    (recording, notes)
}

/// At rest at the end, rad.
fn hangs_at(recording: &Recording) -> f64 {
    let last = &recording.angles_rad()[recording.len() - 100..];
    last.iter().sum::<f64>() / last.len() as f64
}

#[test]
fn whatever_the_zero_is_the_middle_of_the_swings_is_taken_off_and_said() {
    for zero_rad in [0.6, 2.2, -0.8, 4.0] {
        let shifted: Vec<f64> = swing(0.9, 40).iter().map(|angle| angle + zero_rad).collect();
        let (recording, notes) = reads(&shifted, &ReadOptions::default());
        assert!(hangs_at(&recording).abs() < 0.03, "{zero_rad}: {} {notes:?}", hangs_at(&recording));
        assert!(notes.iter().any(|note| note.contains("is taken off")), "{zero_rad}: {notes:?}");
        let told = ReadOptions { zero: Some(zero_rad), ..ReadOptions::default() };
        let (recording, notes) = reads(&shifted, &told);
        assert!(hangs_at(&recording).abs() < 0.01, "{zero_rad}: {notes:?}");
        assert!(!notes.iter().any(|note| note.contains("swings about")), "{zero_rad}: {notes:?}");
    }
}

/// A hand that holds it trembles more often than it swings.
#[test]
fn trembling_of_the_hand_that_holds_it_is_no_middle() {
    let held = (0..3000).map(|idx| 1.2 + 0.05 * (f64::from(idx) / 40.0).sin());
    let shifted: Vec<f64> = held.chain(swing(1.2, 12).into_iter().skip(150)).map(|angle| angle + 2.2).collect();
    let told = ReadOptions { zero: Some(2.2), ..ReadOptions::default() };
    let (_, notes) = reads(&shifted, &told);
    assert!(!notes.iter().any(|note| note.contains("swings about")), "{notes:?}");
}

#[test]
fn an_encoder_that_has_turned_before_is_read_in_radians() {
    let turned: Vec<f64> = swing(2.0, 40).iter().map(|angle| angle - 2.0 * std::f64::consts::TAU).collect();
    let (recording, notes) = reads(&turned, &ReadOptions::default());
    assert!(hangs_at(&recording).abs() < 0.01, "{notes:?}");
    assert!(notes.iter().any(|note| note.contains("whole turns")), "{notes:?}");
    // From upright, and once around.
    let upright: Vec<f64> = swing(2.0, 40).iter().map(|angle| angle + 3.0 * std::f64::consts::PI).collect();
    let (recording, notes) = reads(&upright, &ReadOptions::default());
    assert!(hangs_at(&recording).abs() < 0.01, "{notes:?}");
    assert!(notes.iter().any(|note| note.contains("from upright")), "{notes:?}");
    // With the zero told nothing has to be found out.
    let told = ReadOptions { zero: Some(-2.0 * std::f64::consts::TAU), ..ReadOptions::default() };
    assert!(hangs_at(&reads(&turned, &told).0).abs() < 0.01);
}

/// A potentiometer whose zero is off by a little more than the swing is wide: no pendulum that hangs at 0 stays on one side.
#[test]
fn a_swing_that_never_passes_zero_is_about_its_own_middle_however_near() {
    for (release_rad, zero_rad) in [(0.15, 0.21), (-0.05, -0.08), (0.15, -0.3)] {
        let angles: Vec<f64> = swing(release_rad, 20).iter().map(|angle| angle + zero_rad).collect();
        let (recording, notes) = reads(&angles, &ReadOptions::default());
        assert!(notes.iter().any(|note| note.contains("which is taken off: it must hang at 0")), "{notes:?}");
        assert!(hangs_at(&recording).abs() < 0.02, "{release_rad} {zero_rad}: {}", hangs_at(&recording));
    }
    // It passes 0, so that 0 may be where it hangs.
    let angles: Vec<f64> = swing(0.3, 20).iter().map(|angle| angle + 0.2).collect();
    let (recording, notes) = reads(&angles, &ReadOptions::default());
    assert!((hangs_at(&recording) - 0.2).abs() < 0.02, "{notes:?}");
}

/// Accelerations in thousandths of g scatter about 1000, which no angle of a pendulum is.
#[test]
fn a_middle_beyond_a_turn_and_at_no_half_turn_is_doubted() {
    let options = ReadOptions { angle_unit: Some(host::recording::AngleUnit::Degrees), ..ReadOptions::default() };
    for (middle_deg, is_doubted) in [(1051.7, true), (-500.0, true), (720.0, false), (900.0, false), (60.0, false)] {
        let angles: Vec<f64> = swing(0.5, 20).iter().map(|angle| angle.to_degrees() + middle_deg).collect();
        let (_, notes) = reads(&angles, &options);
        let says =
            notes.iter().any(|note| note.contains("doubtful: it swings about") && note.contains("accelerations"));
        assert_eq!(says, is_doubted, "{middle_deg}: {notes:?}");
    }
}
