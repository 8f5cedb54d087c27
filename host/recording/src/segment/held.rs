//! Whether something holds a swing in the end: friction of whatever kind takes of small swings too.
//!
//! In: the sizes of the half swings from first to last. What a half swing loses, as a share of itself, is the same for viscous
//! friction, more of small ones for dry friction, and for the drag of the air in proportion to the size, which is the least of all.

use super::growth::{FADING_SWINGS, MEDIAN_SCATTER, scatter};
use super::half_swing::size_rad;
use super::{Cut, SURE};
use crate::median;
use std::f64::consts::SQRT_2;
use std::ops::Range;

/// The last half, or the last third.
const TAILS: [usize; 2] = [2, 3];

/// A tail is held where it loses less than this share of what drag would take of it at least. Of 39 recordings of a pendulum that a motor
/// drives 20 are so, with half of it 18 and with twice of it 21; of 585 files of strangers two with each of them, of which one is noise
/// and one was read by hand and grows.
const HELD_SHARE: f64 = 0.5;

impl Cut<'_> {
    /// Where the tail begins that something holds, and how far it swings there to either side, rad.
    pub(super) fn held(&self, free: &Range<usize>) -> Option<(f64, f64)> {
        let half_swings = self.half_swings_in(free);
        let sizes: Vec<f64> = half_swings.iter().map(size_rad).collect();
        let step_rad = self.whole_noise.quantisation_rms * 12_f64.sqrt();
        let (begins, size) = TAILS.iter().find_map(|part| held_tail(&sizes, *part, step_rad))?;
        Some((half_swings[begins][0].time_s, size / 2.0))
    }
}

/// The last of so many parts and how far its half swings go, where they stay too large, and not because a sensor of such steps rounds
/// them.
fn held_tail(sizes: &[f64], n_parts: usize, step_rad: f64) -> Option<(usize, f64)> {
    let quarter = sizes.len() / 4;
    let begins = sizes.len() - sizes.len() / n_parts;
    let n = (sizes.len() - begins) / 2;
    if quarter < FADING_SWINGS {
        return None;
    }
    let median_of = |range: Range<usize>| median(&mut sizes[range].to_vec());
    let (first, second) = (median_of(0..quarter), median_of(quarter..2 * quarter));
    let (before, last) = (median_of(begins..begins + n), median_of(sizes.len() - n..sizes.len()));
    let share_at_first = (first / second).ln() / quarter as f64;
    let least = share_at_first * n as f64 * last / (first * second).sqrt();
    let lost = (before / last).ln();
    let chance = SQRT_2 * MEDIAN_SCATTER * scatter(&sizes[begins..]) / (n as f64).sqrt();
    // Each of two turns may be off by half a step, before and in the end.
    let rounded = 2.0 * step_rad / last;
    (least > 0.0 && lost < HELD_SHARE * least && least - lost > f64::max(SURE * chance, rounded))
        .then_some((begins, last))
}

#[cfg(test)]
mod tests {
    use crate::Recording;
    use crate::random::Noise;
    use crate::segment::{SegmentOptions, segment};
    use std::f64::consts::TAU;

    fn doubts(angle: impl Fn(f64) -> f64) -> Vec<String> {
        let mut noise = Noise::new(28);
        doubts_of((0..180 * 50).map(|idx| angle(f64::from(idx) / 50.0) + 1e-3 * noise.normal()).collect())
    }

    fn doubts_of(readings: Vec<f64>) -> Vec<String> {
        let recording = Recording::uniform(50.0, readings).unwrap();
        let notes = segment(&recording, &SegmentOptions::default()).unwrap().notes;
        notes.into_iter().filter(|note| note.contains("stay as large")).collect()
    }

    /// The pendulum's own swing dies away, and what the motor makes of another frequency is left.
    #[test]
    fn a_swing_that_a_motor_holds_in_the_end_is_doubted() {
        let driven = |time_s: f64| {
            0.15 * (-time_s / 25.0).exp() * (TAU * time_s / 1.35).cos() + 8e-3 * (TAU * time_s / 1.5).sin()
        };
        let said = doubts(driven);
        assert!(said.len() == 1 && said[0].contains("e-3 rad to either side"), "{said:?}");
    }

    #[test]
    fn a_swing_that_friction_of_any_kind_takes_is_not() {
        let swing = |time_s: f64| (TAU * time_s / 1.4).cos();
        let viscous = |time_s: f64| 0.4 * (-time_s / 60.0).exp() * swing(time_s);
        let drag = |time_s: f64| swing(time_s) / (1.0 / 0.8 + time_s / 5.0);
        let dry = |time_s: f64| (0.4 - time_s / 500.0) * swing(time_s);
        assert_eq!(doubts(viscous), Vec::<String>::new());
        assert_eq!(doubts(drag), Vec::<String>::new());
        assert_eq!(doubts(dry), Vec::<String>::new());
    }

    /// A swing from 1.4 to 0.6 steps to either side reads one step throughout.
    #[test]
    fn nor_is_one_that_a_coarse_sensor_rounds_to_the_same_steps() {
        let step = 0.02;
        let swing = |time_s: f64| 0.155 * (-time_s / 70.0).exp() * (TAU * time_s / 1.4).cos();
        let readings = (0..180 * 50).map(|idx| (swing(f64::from(idx) / 50.0) / step).round() * step).collect();
        assert_eq!(doubts_of(readings), Vec::<String>::new());
    }
}
