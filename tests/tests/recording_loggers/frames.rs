//! Frames of a video that are missing or stand there twice.

use crate::swing::{open, swing_from};
use host::recording::segment::{SegmentOptions, segment};
use host::recording::{ReadOptions, Recording};
use tests::chance::Chance;

/// Which frame a row is of, and how many slips there are.
struct Video {
    frames: Vec<usize>,
    slips: Vec<usize>,
}

impl Video {
    /// Of these frames some are missing and some stand there twice, in turn.
    fn with_slips(n_frames: usize, slips: &[usize]) -> Self {
        let in_turn: Vec<(usize, usize)> = slips.iter().copied().zip([0, 2].into_iter().cycle()).collect();
        Self::with_rows(n_frames, &in_turn)
    }

    /// Of these frames some have another number of rows than one.
    fn with_rows(n_frames: usize, slips: &[(usize, usize)]) -> Self {
        let n_rows_of = |frame: usize| slips.iter().find(|(slip, _)| *slip == frame).map_or(1, |(_, n_rows)| *n_rows);
        let frames = (0..n_frames).flat_map(|frame| std::iter::repeat_n(frame, n_rows_of(frame))).collect();
        Self { frames, slips: slips.iter().map(|(slip, _)| *slip).collect() }
    }

    /// The text of its rows, with noise and times that count on.
    fn rows(&self, angles_rad: &[f64], rate_hz: usize, noise_rad: f64, chance: &mut Chance) -> Vec<String> {
        let row = |(row, frame): (usize, &usize)| {
            let angle_rad = angles_rad[*frame] + noise_rad * chance.normal();
            format!("{:.6},{angle_rad:.6}", row as f64 / rate_hz as f64)
        };
        self.frames.iter().enumerate().map(row).collect()
    }

    /// Times are right to a tenth of a frame, but for those that may lie on the other side of a slip where it turns.
    fn check(&self, recording: &Recording, rate_hz: usize, label: &str) {
        let mut frames = self.frames.clone();
        frames.dedup();
        assert_eq!(recording.len(), frames.len(), "{label}: {:?}", recording.notes());
        let is_near = |frame: usize| self.slips.iter().any(|slip| slip.abs_diff(frame) < rate_hz / 4);
        for (time_s, frame) in recording.times_s().iter().zip(&frames).filter(|(_, frame)| !is_near(**frame)) {
            let off = time_s * rate_hz as f64 - *frame as f64;
            assert!(off.abs() < 0.1, "{label}: {off} frames at {time_s} s, {:?}", recording.notes());
        }
    }
}

fn angles(rate_hz: usize, seconds: usize) -> Vec<f64> {
    swing_from(1.0, rate_hz, seconds).into_iter().map(|(_, angle_rad, _)| angle_rad).collect()
}

fn text(rows: &[String]) -> String {
    format!("t (s),angle (rad)\n{}\n", rows.join("\n"))
}

fn says_frames(recording: &Recording) -> bool {
    recording.notes().iter().any(|note| note.starts_with("frames that"))
}

#[test]
fn frames_that_are_missing_or_stand_there_twice_are_set_right() {
    for rate_hz in [30, 60] {
        let angles_rad = angles(rate_hz, 40);
        for seed in 0..10 {
            let mut chance = Chance::new(seed);
            let place =
                |n: usize, chance: &mut Chance| ((5.0 * n as f64 + chance.within(3.0..5.0)) * rate_hz as f64) as usize;
            let slips: Vec<usize> = (0..6).map(|n| place(n, &mut chance)).collect();
            let video = Video::with_slips(angles_rad.len(), &slips);
            let rows = video.rows(&angles_rad, rate_hz, 3e-4, &mut chance);
            let label = format!("{rate_hz} Hz, {seed}");
            let recording = open(text(&rows).as_bytes(), &ReadOptions::default()).unwrap();
            video.check(&recording, rate_hz, &label);
            let notes = recording.notes().join("; ");
            assert!(notes.contains("that stand there twice: 3 (at") && notes.contains("missing: 3 (at"), "{notes}");
            // Rows that are counted are a video's as well.
            let counted = format!(
                "angle (rad)\n{}\n",
                rows.iter().map(|row| row[row.find(',').unwrap() + 1..].to_owned() + "\n").collect::<String>()
            );
            let options = ReadOptions { rate_hz: Some(rate_hz as f64), ..ReadOptions::default() };
            video.check(&open(counted.as_bytes(), &options).unwrap(), rate_hz, &label);
        }
    }
}

/// As a phone's video does that was converted to another rate.
#[test]
fn a_frame_that_stands_there_twice_every_46_seconds_is_set_right() {
    let angles_rad = angles(30, 62);
    let video = Video::with_rows(angles_rad.len(), &[(13 * 30 + 7, 2), (59 * 30 + 10, 2)]);
    let rows = video.rows(&angles_rad, 30, 2e-4, &mut Chance::new(1));
    let recording = open(text(&rows).as_bytes(), &ReadOptions::default()).unwrap();
    assert!(recording.notes().join("; ").contains("twice: 2 (at "), "{:?}", recording.notes());
    video.check(&recording, 30, "every 46 s");
}

#[test]
fn of_a_hundred_videos_without_a_slip_none_is_changed() {
    for rate_hz in [30, 60] {
        let angles_rad = angles(rate_hz, 20);
        let whole = Video::with_slips(angles_rad.len(), &[]);
        for seed in 0..50 {
            let mut chance = Chance::new(seed);
            let noise_rad = 10_f64.powf(chance.within(-4.0..-2.0));
            let rows = whole.rows(&angles_rad, rate_hz, noise_rad, &mut chance);
            let recording = open(text(&rows).as_bytes(), &ReadOptions::default()).unwrap();
            assert!(!says_frames(&recording), "{rate_hz} Hz, {seed}: {:?}", recording.notes());
        }
    }
}

/// A bus that gives the value before again, one time in a hundred, and counts of 2 mrad that repeat where it turns.
#[test]
fn repeated_readings_that_shift_no_time_keep_their_times() {
    let angles_rad = angles(60, 20);
    for seed in 0..10 {
        let mut chance = Chance::new(seed);
        let mut before = angles_rad[0];
        let mut row = |(idx, angle_rad): (usize, &f64)| {
            let is_stale = chance.within(0.0..1.0) < 0.01;
            before = if is_stale { before } else { (angle_rad / 2e-3).round() * 2e-3 };
            format!("{:.6},{before:.6}", idx as f64 / 60.0)
        };
        let rows: Vec<String> = angles_rad.iter().enumerate().map(&mut row).collect();
        let recording = open(text(&rows).as_bytes(), &ReadOptions::default()).unwrap();
        assert!(!says_frames(&recording), "{seed}: {:?}", recording.notes());
    }
}

/// A tracker that lost its point for a third of a second where it turned, and was told where it was before and behind.
#[test]
fn frames_that_a_tracker_filled_in_along_a_line_are_a_gap_and_the_swing_goes_on() {
    let (rate_hz, n_lost) = (60, 20);
    let mut chance = Chance::new(4);
    let mut points: Vec<[f64; 2]> = angles(rate_hz, 40)
        .into_iter()
        .map(|angle_rad| {
            let [x, y] = [angle_rad.sin(), -angle_rad.cos()].map(|at| 0.7 * at);
            [x + 1e-4 * chance.normal(), y + 1e-4 * chance.normal()]
        })
        .collect();
    let turn = (1200..1260).max_by(|a, b| points[*a][0].total_cmp(&points[*b][0])).unwrap();
    let (first, last) = (turn - n_lost / 2, turn + n_lost / 2 - 1);
    let (from, to) = (points[first], points[last]);
    for idx in first..=last {
        let share = (idx - first) as f64 / (last - first) as f64;
        points[idx] = [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis]));
    }
    let row = |(idx, [x, y]): (usize, &[f64; 2])| format!("{:.6},{x:.8},{y:.8}\n", idx as f64 / rate_hz as f64);
    let rows: String = points.iter().enumerate().map(row).collect();
    let recording = open(format!("t,x,y\n{rows}").as_bytes(), &ReadOptions::default()).unwrap();
    let notes = recording.notes().join("; ");
    let said = format!("{n_lost} readings lie on an exact straight line at {:.3} s", first as f64 / rate_hz as f64);
    assert!(notes.contains(&said), "{said}: {notes}");
    assert_eq!(recording.len(), points.len() - n_lost);
    let segments = segment(&recording, &SegmentOptions::default()).unwrap();
    assert_eq!((segments.free, segments.notes), (0..recording.len(), Vec::new()));
}
