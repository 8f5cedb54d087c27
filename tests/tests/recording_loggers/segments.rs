//! The swing in what was read: lost readings, few samples, several releases.

use crate::swing::{RATE_HZ, open, swing, table};
use host::recording::segment::{SegmentOptions, Segments, segment};
use host::recording::{ReadOptions, Recording};

fn cut(recording: &Recording) -> Segments {
    segment(recording, &SegmentOptions::default()).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn readings_that_a_tracker_or_a_bus_lost_are_gaps_and_their_neighbours_stay() {
    let lost = |t: f64| [3.17, 7.44, 7.45, 7.46, 12.0].iter().any(|at| (t - at).abs() < 1e-3);
    for wrong in ["0.0", "-1.0", "2.5"] {
        let text =
            table("t,theta\n", |(t, a, _)| if lost(t) { format!("{t:.2},{wrong}") } else { format!("{t:.2},{a:.5}") });
        let recording = open(text.as_bytes(), &ReadOptions::default()).unwrap();
        let notes = recording.notes().join("; ");
        assert!(notes.contains("5 readings at 3 places jump out of the swing and back, at 3.170 s first"), "{notes}");
        assert_eq!(recording.len(), 1995);
        assert!(recording.times_s().iter().all(|time_s| !lost(*time_s)));
    }
}

#[test]
fn eight_samples_a_period_are_a_swing() {
    for rate_hz in [8, 12] {
        let rows = swing(rate_hz, 40).into_iter().map(|(t, a, _)| format!("{t:.4},{a:.5}\n")).collect::<String>();
        let recording = open(format!("t,theta\n{rows}").as_bytes(), &ReadOptions::default()).unwrap();
        let segments = cut(&recording);
        assert!((0.45..0.55).contains(&segments.half_swing_s), "{segments:?}");
        assert!(segments.n_turning_points > 60 && segments.free.start == 0, "{segments:?}");
    }
}

#[test]
fn a_second_release_is_offered_and_a_driven_swing_doubted() {
    let again = |t: f64| 25.0 + t;
    let (first, second) = (swing(RATE_HZ, 20), swing(RATE_HZ, 15));
    let held = (0..500).map(|idx| {
        // Lifted by hand from where the first one ends.
        let (end, share) = (first[1999].1, f64::from(idx.min(200)) / 200.0);
        (20.0 + f64::from(idx) / 100.0, end + (1.0 - end) * (3.0 - 2.0 * share) * share * share, 0.0)
    });
    let rows = first.iter().copied().chain(held).chain(second.iter().map(|(t, a, v)| (again(*t), *a, *v)));
    let text = rows.map(|(t, a, _)| format!("{t:.2},{a:.5}\n")).collect::<String>();
    let recording = open(format!("t,theta\n{text}").as_bytes(), &ReadOptions::default()).unwrap();
    let notes = cut(&recording).notes.join("; ");
    let cut_s = notes.split("cut everything after ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
    assert!((19.0..20.3).contains(&cut_s.parse::<f64>().unwrap()), "{notes}");
    assert!(notes.contains("a free swing from 25.") && notes.contains("--from 25."), "{notes}");
    let driven = (0..3000).map(|idx| f64::from(idx) / 100.0).map(|t| format!("{t:.2},{:.5}\n", 0.8 * (6.0 * t).cos()));
    let options = ReadOptions { angle_unit: Some(host::recording::AngleUnit::Radians), ..ReadOptions::default() };
    let driven = open(format!("t,theta\n{}", driven.collect::<String>()).as_bytes(), &options).unwrap();
    assert!(cut(&driven).notes.join("; ").contains("don't become smaller"));
    let free =
        open(table("t,theta\n", |(t, a, _)| format!("{t:.2},{a:.5}")).as_bytes(), &ReadOptions::default()).unwrap();
    assert!(cut(&free).notes.is_empty(), "{:?}", cut(&free).notes);
}
