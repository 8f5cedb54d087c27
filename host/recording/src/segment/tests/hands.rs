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
