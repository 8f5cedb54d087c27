//! Is this a pendulum at all? Signs of a saturated converter, a broken wire, a pendulum that does not move.
//!
//! In: a recording. Out: a list of problems in words; an empty list means that nothing speaks against it.

use std::fmt;

use super::{Recording, median};

/// Full scale of the 12-bit converter on the board.
const FULL_SCALE_CODE: u16 = 4095;

/// This many samples in a row at an end of the converter are no turning point.
const N_PINNED: usize = 4;

/// No laboratory pendulum turns faster, rad/s: ten times a 0.1 m pendulum falling from the top.
const IMPOSSIBLE_SPEED_RAD_S: f64 = 200.0;

/// Smaller jumps than this may be noise, rad.
const SMALLEST_JUMP_RAD: f64 = 0.1;

/// A jump is this many times larger than the typical step around it.
const JUMP_TO_STEP: f64 = 8.0;

/// How many steps on either side are "around it".
const N_AROUND: usize = 8;

/// A range below this many median steps is noise, not motion: white noise of any shape stays below.
const STILL_RANGE_TO_STEP: f64 = 20.0;

/// Motion below this range cannot be told from a still pendulum by eye, rad.
const STILL_RANGE_RAD: f64 = 0.05;

/// Something that speaks against the recording.
#[derive(Debug, Clone, PartialEq)]
pub enum Problem {
    /// The angle was cut off at one value: the end of the converter or of the potentiometer's travel.
    Saturated {
        /// The value at which it stays, rad.
        angle_rad: f64,
        /// How many samples stay there.
        n_samples: usize,
        /// When for the first time, s.
        first_s: f64,
    },
    /// One value, or noise around one value, from beginning to end.
    NothingMoves {
        /// That value, rad.
        angle_rad: f64,
        /// Largest minus smallest angle, rad.
        range_rad: f64,
    },
    /// Steps that no pendulum makes.
    Jumps {
        /// How many.
        n_jumps: usize,
        /// The first: time after it, s.
        first_s: f64,
        /// Angle before, rad.
        from_rad: f64,
        /// Angle after, rad.
        to_rad: f64,
    },
}

impl fmt::Display for Problem {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Saturated { angle_rad, n_samples, first_s } => write!(
                out,
                "the sensor stays at its end: {n_samples} samples at {angle_rad:.3} rad, first at {first_s:.3} s; \
                 release from a smaller angle, or turn the potentiometer so that hanging is in its middle"
            ),
            Self::NothingMoves { angle_rad, range_rad } => write!(
                out,
                "nothing moves: {angle_rad:.3} rad throughout, within {range_rad:.4} rad; check that the pendulum was \
                 released, that the potentiometer turns with it and that its wiper is wired to the converter"
            ),
            Self::Jumps { n_jumps, first_s, from_rad, to_rad } if is_full_turn(to_rad - from_rad) => write!(
                out,
                "the angle jumps by a full turn {n_jumps} times, first at {first_s:.3} s from {from_rad:.3} to \
                 {to_rad:.3} rad; the sensor wraps around: turn it so that hanging is in the middle of its range"
            ),
            Self::Jumps { n_jumps, first_s, from_rad, to_rad } => write!(
                out,
                "{n_jumps} jumps that no pendulum makes, first at {first_s:.3} s from {from_rad:.3} to {to_rad:.3} rad; \
                 look for a loose or broken wire, a worn track or the gap of the potentiometer, or lost rows"
            ),
        }
    }
}

/// Everything that speaks against the recording.
pub fn problems(recording: &Recording) -> Vec<Problem> {
    if let Some(still) = nothing_moves(recording.angles_rad()) {
        return vec![still];
    }
    saturated(recording).into_iter().chain(jumps(recording)).collect()
}

fn is_full_turn(step_rad: f64) -> bool {
    (step_rad.abs() - std::f64::consts::TAU).abs() < 0.5
}

/// Compares the range with the noise, seen in the median step: motion in 100 and more samples makes a range of many.
fn nothing_moves(angles_rad: &[f64]) -> Option<Problem> {
    let lowest = angles_rad.iter().copied().fold(f64::INFINITY, f64::min);
    let highest = angles_rad.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let range_rad = highest - lowest;
    let mut steps: Vec<f64> = angles_rad.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    let noise_only = range_rad < STILL_RANGE_RAD && range_rad <= STILL_RANGE_TO_STEP * median(&mut steps);
    let angle_rad = median(&mut angles_rad.to_vec());
    (range_rad == 0.0 || noise_only).then_some(Problem::NothingMoves { angle_rad, range_rad })
}

/// With codes: rows of samples at 0 or full scale. Without: a flat stretch at an extreme which is entered at speed.
fn saturated(recording: &Recording) -> Vec<Problem> {
    let angles_rad = recording.angles_rad();
    let extremes = |keys: &[f64]| {
        let lowest = keys.iter().copied().fold(f64::INFINITY, f64::min);
        let highest = keys.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        [lowest, highest]
    };
    let (keys, ends, needs_speed): (Vec<f64>, _, _) = match recording.codes() {
        Some(codes) => (codes.iter().map(|code| f64::from(*code)).collect(), [0.0, f64::from(FULL_SCALE_CODE)], false),
        None => (angles_rad.to_vec(), extremes(angles_rad), true),
    };
    ends.into_iter().filter_map(|end| pinned_at(recording, &keys, end, needs_speed)).collect()
}

fn pinned_at(recording: &Recording, keys: &[f64], end: f64, needs_speed: bool) -> Option<Problem> {
    let pinned: Vec<_> = runs_at(keys, end)
        .into_iter()
        .filter(|run| run.len() >= N_PINNED && (!needs_speed || hits_at_speed(recording.angles_rad(), run)))
        .collect();
    let first = pinned.first()?.start;
    Some(Problem::Saturated {
        angle_rad: recording.angles_rad()[first],
        n_samples: pinned.iter().map(ExactSizeIterator::len).sum(),
        first_s: recording.times_s()[first],
    })
}

fn runs_at(keys: &[f64], end: f64) -> Vec<std::ops::Range<usize>> {
    let mut runs = Vec::new();
    let mut start = None;
    for (idx, key) in keys.iter().enumerate() {
        match (start, *key == end) {
            (None, true) => start = Some(idx),
            (Some(from), false) => {
                runs.push(from..idx);
                start = None;
            }
            _ => {}
        }
    }
    runs.extend(start.map(|from| from..keys.len()));
    runs
}

/// A free turning point is approached ever more slowly; a stop is hit with steps as large as those before.
/// At a turning point of `n` equal samples the step before is about 2/n of the fall over the next `n` samples, so a
/// step larger than half of that fall is a hit.
fn hits_at_speed(angles_rad: &[f64], run: &std::ops::Range<usize>) -> bool {
    let n_back = run.len().min(N_AROUND);
    let Some(before) = run.start.checked_sub(1 + n_back) else { return false };
    let last_step = (angles_rad[run.start] - angles_rad[run.start - 1]).abs();
    let typical_step = (angles_rad[run.start] - angles_rad[before]).abs() / (n_back + 1) as f64;
    let smallest_step = smallest_step(angles_rad);
    last_step > 0.5 * typical_step && typical_step > 3.0 * smallest_step
}

fn smallest_step(angles_rad: &[f64]) -> f64 {
    let steps = angles_rad.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    steps.filter(|step| *step > 0.0).fold(f64::INFINITY, f64::min)
}

fn jumps(recording: &Recording) -> Option<Problem> {
    let (times_s, angles_rad) = (recording.times_s(), recording.angles_rad());
    let steps: Vec<f64> = angles_rad.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let jumps: Vec<usize> = (0..steps.len())
        .filter(|idx| steps[*idx].abs() > SMALLEST_JUMP_RAD)
        .filter(|idx| {
            let duration_s = times_s[idx + 1] - times_s[*idx];
            steps[*idx].abs() > IMPOSSIBLE_SPEED_RAD_S * duration_s
                || steps[*idx].abs() > JUMP_TO_STEP * typical_step_around(times_s, &steps, *idx)
        })
        .collect();
    let first = *jumps.first()?;
    Some(Problem::Jumps {
        n_jumps: jumps.len(),
        first_s: times_s[first + 1],
        from_rad: angles_rad[first],
        to_rad: angles_rad[first + 1],
    })
}

/// Median size of the steps around one, scaled to its duration; never below a tenth of the smallest jump.
fn typical_step_around(times_s: &[f64], steps: &[f64], idx: usize) -> f64 {
    let around = idx.saturating_sub(N_AROUND)..(idx + N_AROUND + 1).min(steps.len());
    let speed = |at: usize| steps[at].abs() / (times_s[at + 1] - times_s[at]);
    let mut speeds: Vec<f64> = around.filter(|at| *at != idx).map(speed).collect();
    (median(&mut speeds) * (times_s[idx + 1] - times_s[idx])).max(SMALLEST_JUMP_RAD / 10.0)
}

#[cfg(test)]
mod tests {
    use super::super::{Calibration, Header};
    use super::*;

    fn swing() -> Vec<f64> {
        (0..2000).map(|idx| (idx as f64 * 0.04).cos() * (-idx as f64 / 1500.0).exp()).collect()
    }

    fn check(angles_rad: Vec<f64>) -> Vec<Problem> {
        problems(&Recording::uniform(200.0, angles_rad).unwrap())
    }

    #[test]
    fn a_healthy_swing_has_no_problems() {
        assert_eq!(check(swing()), []);
    }

    #[test]
    fn a_coarse_encoder_is_not_saturated() {
        assert_eq!(check(swing().iter().map(|angle| (angle * 200.0).round() / 200.0).collect()), []);
    }

    #[test]
    fn a_swing_cut_off_at_one_end_is_saturated() {
        let problems = check(swing().iter().map(|angle| angle.min(0.7)).collect());
        assert!(matches!(problems[..], [Problem::Saturated { angle_rad: 0.7, .. }]), "{problems:?}");
    }

    #[test]
    fn codes_at_full_scale_are_saturated() {
        let calibration = Calibration { zero_code: 2048.0, radians_per_code: 3e-4 };
        let codes: Vec<u16> = swing().iter().map(|angle| (2048.0 + angle / 3e-4).clamp(0.0, 4095.0) as u16).collect();
        let angles_rad: Vec<f64> = codes.iter().map(|code| calibration.angle_rad(*code)).collect();
        let times_s = (0..2000).map(|idx| f64::from(idx) * 0.005).collect();
        let header = Header { calibration: Some(calibration), ..Header::default() };
        let recording = Recording::new(header, times_s, angles_rad, Some(codes)).unwrap();
        assert_eq!(problems(&recording).len(), 2);
    }

    #[test]
    fn a_constant_value_is_nothing_that_moves() {
        assert!(matches!(check(vec![0.3; 500])[..], [Problem::NothingMoves { .. }]));
    }

    #[test]
    fn noise_around_one_value_is_nothing_that_moves() {
        let noise = |idx: usize| f64::from((idx as u32).wrapping_mul(2_654_435_761) >> 16) / 65536.0;
        assert!(matches!(
            check((0..500).map(|idx| 0.3 + 0.004 * noise(idx)).collect())[..],
            [Problem::NothingMoves { .. }]
        ));
    }

    #[test]
    fn a_swing_of_one_degree_about_a_far_angle_moves() {
        assert_eq!(check(swing().iter().map(|angle| 1.5 + 0.02 * angle).collect()), []);
    }

    #[test]
    fn a_floating_wire_jumps() {
        let mut angles_rad = swing();
        angles_rad[700] = 2.9;
        let problems = check(angles_rad);
        assert!(matches!(problems[..], [Problem::Jumps { n_jumps: 2, first_s: 3.5, .. }]), "{problems:?}");
    }

    #[test]
    fn a_sensor_that_wraps_around_is_named_so() {
        let problems = check((0..2000).map(|idx| (f64::from(idx) * 0.01) % std::f64::consts::TAU).collect());
        assert!(problems[0].to_string().contains("wraps around"), "{problems:?}");
    }
}
