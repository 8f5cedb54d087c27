//! Readings at the end of what a sensor can say, while the pendulum swings beyond: a potentiometer past its track, an amplifier
//! at its supply, a converter at 0 or 4095.
//!
//! In: times and readings in any unit. Out: which readings to leave out, as gaps. Where a swing turns, a coarse sensor says its
//! largest number for a while too; but then the curve beside it bends so that it goes no farther than a step. A parabola that enters
//! at the slope before, and leaves at the one behind, goes beyond by an eighth of their difference times what it takes.

use super::noise::smallest_step;
use super::places::Places;
use super::spikes::{LEAST_SHARE, range};
use super::{GAP_STEPS, median_step_s};
use std::ops::Range;

/// It would go beyond by so many steps of the sensor, where a top that is rounded goes by one. Half and twice were not tried.
const STEPS: f64 = 4.0;

/// A slope is that over so many readings. Half and twice were not tried.
const BESIDE: usize = 4;

/// It leaves as fast as it entered, to this share: one swing loses less. Without it a hand that lifted fast, held and let go at ten
/// readings a second was an end of the sensor. Half and twice were not tried.
const ALIKE: f64 = 0.5;

/// It stays there for so many readings, at least.
const FEWEST: usize = 3;

/// Which readings stand at an end of the sensor while the swing goes on beyond it.
pub(super) fn rails(times: &[f64], readings: &[f64]) -> Vec<bool> {
    let mut is_rail = vec![false; readings.len()];
    if readings.len() < 2 * BESIDE + FEWEST {
        return is_rail;
    }
    let step = smallest_step(readings).unwrap_or(0.0);
    let (longest_s, sure) = (GAP_STEPS * median_step_s(times), LEAST_SHARE * range(readings));
    let (low, high) = readings.iter().fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
    for end in [low, high] {
        let runs: Vec<(Range<usize>, f64)> = runs_at(readings, end)
            .into_iter()
            .filter_map(|run| beyond(times, readings, &run, longest_s).map(|beyond| (run, beyond)))
            .filter(|(_, beyond)| *beyond > STEPS * step)
            .collect();
        // One that is surely cut tells that this is an end.
        if runs.iter().any(|(_, beyond)| *beyond > sure) {
            runs.into_iter().for_each(|(run, _)| is_rail[run].fill(true));
        }
    }
    is_rail
}

/// Where this number stands in a row.
fn runs_at(readings: &[f64], end: f64) -> Vec<Range<usize>> {
    let mut runs = Vec::new();
    let mut from = 0;
    for same in readings.chunk_by(|a, b| a == b) {
        if same[0] == end && same.len() >= FEWEST {
            runs.push(from..from + same.len());
        }
        from += same.len();
    }
    runs
}

/// How far the swing goes beyond, as a parabola would; `None` where it is not seen on both sides, by steps of at most so long.
fn beyond(times: &[f64], readings: &[f64], run: &Range<usize>, longest_s: f64) -> Option<f64> {
    let before = run.start.checked_sub(BESIDE)?..run.start;
    let behind = run.end..run.end + BESIDE;
    let is_whole = |times: &[f64]| times.windows(2).all(|pair| pair[1] - pair[0] <= longest_s);
    if !times.get(before.start..behind.end).is_some_and(is_whole) {
        return None;
    }
    let slope = |part: &Range<usize>| {
        let (first, last) = (part.start, part.end - 1);
        (readings[last] - readings[first]) / (times[last] - times[first])
    };
    let took = times[run.end] - times[run.start - 1];
    let outward = if readings[before.end - 1] < readings[run.start] { 1.0 } else { -1.0 };
    let (enters, leaves) = (outward * slope(&before), -outward * slope(&behind));
    // What is let go from there leaves slowly.
    let is_alike = enters > 0.0 && leaves > 0.0 && (enters - leaves).abs() < ALIKE * enters.max(leaves);
    is_alike.then(|| (enters + leaves) * took / 8.0)
}

/// What is said of them.
pub(super) fn note(is_rail: &[bool], readings: &[f64], times_s: &[f64]) -> Option<String> {
    let places = Places::of(is_rail)?;
    Some(format!(
        "{} readings at {} stand at {}, an end of what the sensor can say, and the swing goes on beyond it, at {:.3} s{}: left out \
         as {}",
        places.n_rows,
        if places.n == 1 { "1 place".to_owned() } else { format!("{} places", places.n) },
        readings[places.first_idx],
        times_s[places.first_idx],
        if places.n == 1 { "" } else { " first" },
        places.as_gaps()
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 40 s at 100 Hz of a swing of 1.1 s in counts.
    fn counts(amplitude: f64) -> (Vec<f64>, Vec<f64>) {
        let times: Vec<f64> = (0..4000_u32).map(|idx| f64::from(idx) / 100.0).collect();
        let count = |t: &f64| (500.0 + amplitude * (-t / 15.0).exp() * (5.7 * t).cos()).round();
        let readings = times.iter().map(count).collect();
        (times, readings)
    }

    #[test]
    fn what_swings_beyond_the_end_of_a_sensor_is_left_out_there_and_no_top_of_a_swing() {
        for amplitude in [4.0, 30.0, 200.0, 480.0] {
            let (times, readings) = counts(amplitude);
            assert!(rails(&times, &readings).iter().all(|is_rail| !is_rail), "{amplitude}");
        }
        let (times, truth) = counts(480.0);
        let readings: Vec<f64> = truth.iter().map(|count| count.clamp(80.0, 900.0)).collect();
        let found = rails(&times, &readings);
        // Its last tops go hardly beyond.
        let is_beyond = |by: f64, idx: &usize| truth[*idx] < 80.0 - by || truth[*idx] > 900.0 + by;
        let n_beyond = |by: f64| (0..truth.len()).filter(|idx| is_beyond(by, idx)).count();
        let n_found = found.iter().filter(|is_rail| **is_rail).count();
        assert!(n_beyond(8.0) < n_found && n_found <= n_beyond(-1.0), "{n_found} {} {}", n_beyond(8.0), n_beyond(-1.0));
        assert!((0..truth.len()).all(|idx| !found[idx] || is_beyond(-1.0, &idx)));
    }

    #[test]
    fn a_stop_and_a_hand_that_holds_are_no_end_of_the_sensor() {
        let (times, mut readings) = counts(300.0);
        let held = readings[0];
        readings.splice(0..0, vec![held; 200]);
        readings.truncate(times.len());
        assert!(rails(&times, &readings).iter().all(|is_rail| !is_rail));
    }
}
