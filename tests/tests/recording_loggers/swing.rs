//! The swing that is written down, and the check that it was read.
//!
//! It is integrated here: `θ̈ = −40 sin θ − 0.06 ω − 0.05 sgn ω`, let go at 1 rad, 100 samples a second.

use host::recording::{ReadOptions, Recording, read_bytes};

pub(crate) const RATE_HZ: usize = 100;

/// Time (s), angle (rad), angular velocity (rad/s).
pub(crate) type Row = (f64, f64, f64);

pub(crate) fn swing(rate_hz: usize, seconds: usize) -> Vec<Row> {
    swing_from(1.0, rate_hz, seconds)
}

/// Twenty steps of the classical fixed-step method a sample.
pub(crate) fn swing_from(start_rad: f64, rate_hz: usize, seconds: usize) -> Vec<Row> {
    let acceleration = |angle: f64, velocity: f64| {
        -40.0 * angle.sin() - 0.06 * velocity - 0.05 * if velocity == 0.0 { 0.0 } else { velocity.signum() }
    };
    let dt = 1.0 / (20 * rate_hz) as f64;
    let (mut angle, mut velocity) = (start_rad, 0.0_f64);
    let mut rows = Vec::new();
    for idx in 0..rate_hz * seconds {
        rows.push((idx as f64 / rate_hz as f64, angle, velocity));
        for _ in 0..20 {
            let (v1, a1) = (velocity, acceleration(angle, velocity));
            let (v2, a2) = (velocity + dt / 2.0 * a1, acceleration(angle + dt / 2.0 * v1, velocity + dt / 2.0 * a1));
            let (v3, a3) = (velocity + dt / 2.0 * a2, acceleration(angle + dt / 2.0 * v2, velocity + dt / 2.0 * a2));
            let (v4, a4) = (velocity + dt * a3, acceleration(angle + dt * v3, velocity + dt * a3));
            angle += dt / 6.0 * (v1 + 2.0 * v2 + 2.0 * v3 + v4);
            velocity += dt / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
        }
    }
    rows
}

pub(crate) fn table(head: &str, row: impl Fn(Row) -> String) -> String {
    format!("{head}{}", swing(RATE_HZ, 20).into_iter().map(|values| row(values) + "\n").collect::<String>())
}

pub(crate) fn open(text: &[u8], options: &ReadOptions) -> Result<Recording, String> {
    read_bytes("swing.csv", text, options).map_err(|error| error.to_string())
}

pub(crate) fn told(columns: &str) -> ReadOptions {
    ReadOptions { columns: Some(columns.parse().unwrap()), ..ReadOptions::default() }
}

/// Half a digit of the angle, and what the angle moves (6.3 rad/s at most) in half a digit of the time.
#[track_caller]
pub(crate) fn check(text: &str, options: &ReadOptions, within_rad: f64, note: &str) -> Recording {
    let recording = open(text.as_bytes(), options).unwrap_or_else(|error| panic!("{error}"));
    let truth = swing(RATE_HZ, 20);
    assert_eq!(recording.len(), truth.len(), "{:?}", recording.notes());
    let begin_s = recording.times_s()[0];
    for (idx, (time_s, angle_rad, _)) in truth.iter().enumerate() {
        let off_s = recording.times_s()[idx] - begin_s - time_s;
        let off_rad = recording.angles_rad()[idx] - angle_rad;
        assert!(
            off_s.abs() < 1e-3 && off_rad.abs() < within_rad,
            "{idx}: {off_s} s {off_rad} rad {:?}",
            recording.notes()
        );
    }
    let notes = recording.notes().join("; ");
    assert!(notes.contains(note), "{notes}");
    recording
}

#[track_caller]
pub(crate) fn check_found(text: &str, within_rad: f64, note: &str) -> Recording {
    check(text, &ReadOptions::default(), within_rad, note)
}

/// Half a hundredth of a degree.
pub(crate) const CENTIDEGREES: f64 = 1e-4;
