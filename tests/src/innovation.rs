//! How well the rig's model follows a swing, seen through the link.

use crate::link::Link;
use shared::wire::{Command, Frame, Stream};

/// A live point every so many samples.
const EVERY: u16 = 4;

/// Samples looked at after the pendulum has passed zero; the observer settles in their first half.
const N_SAMPLES: usize = 10_000;

/// Held beyond this angle the pendulum is about to be let go, rad.
const LIFTED_RAD: f32 = 0.9;

/// Points in a row, a quarter of a second, that lie within this band (rad) while a hand holds the pendulum. A swing
/// turns round within it in half that time, however high it still goes when the stream begins in its middle.
const N_HELD: usize = 64;
const HELD_WITHIN_RAD: f32 = 0.05;

/// On this side it has been let go, rad.
const RELEASED_RAD: f32 = -0.1;

/// Root mean square of the innovation in the second half of the next swing that begins at a positive angle, rad.
pub fn of_the_next_swing(link: &mut Link) -> Result<f64, String> {
    link.frames.clear();
    link.ask(Command::Start(Stream { raw: false, live_every: EVERY }))?;
    let n_points = N_SAMPLES / usize::from(EVERY);
    let mut points = Vec::new();
    let mut n_read = 0;
    let mut rms_rad = None;
    link.collect(|frames| {
        frames[n_read..].iter().for_each(|frame| points.extend(points_of(frame)));
        n_read = frames.len();
        rms_rad = after_a_release(&points, n_points);
        rms_rad.is_some()
    })?;
    link.ask(Command::Stop)?;
    rms_rad.ok_or_else(|| "no swing that begins at a positive angle".to_owned())
}

/// The same of points (angle and innovation, rad), the swing being that many points after their first release from a
/// positive angle; none before all of them are there.
pub fn after_a_release(points: &[(f32, f32)], n_points: usize) -> Option<f64> {
    let at = released(points)?;
    let second_half = points.get(at + n_points / 2..at + n_points)?;
    let sum: f64 = second_half.iter().map(|(_, innovation_rad)| f64::from(*innovation_rad).powi(2)).sum();
    Some((sum / second_half.len() as f64).sqrt())
}

fn points_of(frame: &Frame) -> Vec<(f32, f32)> {
    match frame {
        Frame::Live(live) => live.points.iter().map(|point| (point.filtered_rad, point.innovation_rad)).collect(),
        _ => Vec::new(),
    }
}

fn released(points: &[(f32, f32)]) -> Option<usize> {
    let held = points.windows(N_HELD).position(is_held)?;
    points[held..].iter().position(|(angle_rad, _)| *angle_rad < RELEASED_RAD).map(|i| held + i)
}

fn is_held(points: &[(f32, f32)]) -> bool {
    let angles = || points.iter().map(|(angle_rad, _)| *angle_rad);
    let (lowest, highest) = (angles().fold(f32::INFINITY, f32::min), angles().fold(f32::NEG_INFINITY, f32::max));
    lowest > LIFTED_RAD && highest - lowest < HELD_WITHIN_RAD
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_swing_that_already_goes_on_is_not_the_next_one() {
        let swing = |k: usize| 1.35 * (0.03 * k as f32).cos();
        let mut points: Vec<(f32, f32)> = (0..500).map(|k| (swing(k), 0.0)).collect();
        assert_eq!(released(&points), None);
        points.extend((0..100).map(|_| (1.35, 0.0)).chain((0..100).map(|k| (swing(k), 0.0))));
        assert!(released(&points).unwrap() > 600);
    }
}
