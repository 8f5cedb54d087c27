//! Readings that jump out of the swing and back: a marker that a tracker lost, a failed bus transfer, a disturbed wire.
//!
//! In: times and readings in any unit. Out: which readings to leave out, as gaps. A reading is suspected where a cubic
//! through its neighbours misses it; it is left out where one smooth curve goes through what stands before and behind it,
//! and not through it. A pendulum that is pushed, stopped or let go does not come back to the curve it was on.
//!
//! What half and twice of a constant would do was seen on 60 simulated swings with 1013 lost readings (0.1 to 1.5 % noise,
//! 15 to 120 samples a period), of which 653 are found and nothing else, and on the real recordings that come with the
//! project and four made-up ones.

use super::noise::{robust_spread, smallest_step};
use super::places::Places;
use super::smooth::LocalFit;
use super::{median, median_step_s, turning};
use std::ops::Range;

/// A suspected reading is off by so many times what is usual. With half of it so much is suspected that 453 are found, and a
/// tracker's wobble is a loss; with twice, 552 …
const SUSPECT: f64 = 8.0;

/// … and by this share of the range of the readings. Half of it would take a tracker's wobble for a loss; with twice of it
/// readings of zero would stay near the lowest point, where they are least wrong.
pub(super) const LEAST_SHARE: f64 = 0.03;

/// A loss is no longer than so many readings: half and twice find the same of up to four lost ones …
const LONGEST: usize = 12;

/// … nor than a quarter of a half swing, with so many on either side to tell where the motion goes on. All together span
/// no more than half a swing, or a quartic through what stands beside a loss would follow any motion: with half as many on
/// a side it follows all, with three 61 good readings are taken too; with twice as many 492 losses are found.
const BESIDE: usize = 4;

/// The curve around a loss leaves this many times what is usual at most: half changes nothing, twice takes two readings
/// more from one tracker.
const CLEAN: f64 = 4.0;

/// It begins and ends abruptly, by this share of how far it goes: what pushes a pendulum begins at nothing. Half changes
/// nothing, with twice 633 are found.
const ABRUPT_SHARE: f64 = 0.3;

/// More than this share of all readings are no losses but the sensor; half and twice change nothing there.
const MOST_SHARE: f64 = 0.05;

/// What a bus makes of a lost transfer may be of any size: beyond so many ranges of the readings it is a loss of just that
/// size, or the half swings would be too small beside it to be seen. Half and twice change nothing.
const FARTHEST_RANGES: f64 = 10.0;

/// Which readings jump out of the swing and back; none where that would be too many.
pub(super) fn spikes(times: &[f64], readings: &[f64]) -> Vec<bool> {
    let none = vec![false; readings.len()];
    if readings.len() < 4 * (LONGEST + BESIDE) {
        return none;
    }
    let readings = &near(readings)[..];
    let misses: Vec<f64> = (0..readings.len()).map(|idx| miss(times, readings, idx)).collect();
    let seen = robust_spread(&misses);
    // A coarse sensor that stays at its steps misses nothing most of the time, and yet rounds all.
    let usual = seen.max(smallest_step(readings).unwrap_or(0.0) / 12_f64.sqrt());
    let least = (SUSPECT * usual).max(LEAST_SHARE * range(readings));
    let Some(half_swing) = turning::half_swing_s(times, readings, usual) else { return none };
    let in_half_swing = (half_swing / median_step_s(times)) as usize;
    let longest = LONGEST.min(in_half_swing / 4).min(in_half_swing.saturating_sub(2 * BESIDE));
    let suspects: Vec<usize> = (0..misses.len()).filter(|idx| misses[*idx].abs() > least / 3.0).collect();
    if suspects.len() as f64 > 3.0 * MOST_SHARE * readings.len() as f64 {
        return none;
    }
    let mut is_spike = none.clone();
    for idx in suspects {
        if !is_spike[idx]
            && let Some(lost) = lost_around(times, readings, &is_spike, idx, (usual, least), longest)
        {
            is_spike[lost].fill(true);
        }
    }
    let n = is_spike.iter().filter(|is_spike| **is_spike).count();
    if n as f64 > MOST_SHARE * readings.len() as f64 { none } else { is_spike }
}

/// What is said of them.
pub(super) fn note(is_spike: &[bool], times_s: &[f64]) -> Option<String> {
    let places = Places::of(is_spike)?;
    Some(format!(
        "{} out of the swing and back, at {:.3} s{}, as when a tracker or a bus loses it: left out as {}",
        match (places.n_rows, places.n) {
            (1, _) => "1 reading jumps".to_owned(),
            (n, 1) => format!("{n} readings at 1 place jump"),
            (n, n_places) => format!("{n} readings at {n_places} places jump"),
        },
        times_s[places.first_idx],
        if places.n == 1 { "" } else { " first" },
        places.as_gaps()
    ))
}

/// How far a reading is from the cubic through two neighbours on either side.
fn miss(times: &[f64], readings: &[f64], idx: usize) -> f64 {
    if idx < 2 || idx + 2 >= readings.len() {
        return 0.0;
    }
    let others = [idx - 2, idx - 1, idx + 1, idx + 2];
    let weight = |i: usize| -> f64 {
        others.iter().filter(|j| **j != i).map(|j| (times[idx] - times[*j]) / (times[i] - times[*j])).product()
    };
    readings[idx] - others.iter().map(|i| weight(*i) * readings[*i]).sum::<f64>()
}

/// The readings, none of them farther than [`FARTHEST_RANGES`] from the middle one.
fn near(readings: &[f64]) -> Vec<f64> {
    let middle = median(&mut readings.to_vec());
    let farthest = FARTHEST_RANGES * range(readings);
    readings.iter().map(|reading| reading.clamp(middle - farthest, middle + farthest)).collect()
}

/// Of the middle 98 % of the readings, so that losses do not count.
pub(super) fn range(readings: &[f64]) -> f64 {
    let mut sorted = readings.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let end = sorted.len() / 100;
    sorted[sorted.len() - 1 - end] - sorted[end]
}

/// The shortest stretch with this reading in it without which a smooth curve goes through its surroundings.
fn lost_around(
    times: &[f64],
    readings: &[f64],
    is_spike: &[bool],
    idx: usize,
    sizes: (f64, f64),
    longest: usize,
) -> Option<Range<usize>> {
    let stretches = (1..=longest).flat_map(|n| (0..n).map(move |before| (before, n)));
    let within = |(before, n): (usize, usize)| {
        let begin = idx.checked_sub(before)?;
        (begin >= BESIDE && begin + n + BESIDE <= readings.len()).then_some(begin..begin + n)
    };
    stretches.filter_map(within).find(|lost| is_lost(times, readings, is_spike, lost, sizes))
}

fn is_lost(
    times: &[f64],
    readings: &[f64],
    is_spike: &[bool],
    lost: &Range<usize>,
    (usual, least): (f64, f64),
) -> bool {
    let kept = |idx: &usize| !is_spike[*idx];
    let before: Vec<usize> = (0..lost.start).rev().filter(kept).take(BESIDE).collect();
    let behind: Vec<usize> = (lost.end..readings.len()).filter(kept).take(BESIDE).collect();
    if before.len() + behind.len() < 2 * BESIDE {
        return false;
    }
    let around: Vec<usize> = before.into_iter().rev().chain(behind).collect();
    let (t, y): (Vec<f64>, Vec<f64>) = around.iter().map(|idx| (times[*idx], readings[*idx])).unzip();
    let (middle, half) = ((t[0] + t[t.len() - 1]) / 2.0, 0.5001 * (t[t.len() - 1] - t[0]));
    let Some(curve) = LocalFit::<5>::new(&t, &y, middle, half) else { return false };
    let squares: f64 = t.iter().zip(&y).map(|(t, y)| (y - curve.angle_rad(*t)).powi(2)).sum();
    let left = (squares / (t.len() - 5) as f64).sqrt();
    let off = |idx: usize| (readings[idx] - curve.angle_rad(times[idx])).abs();
    // What the curve is off by itself in the hole, for the noise of what stands around.
    let noise = |idx: usize| left.max(usual) * (1.0 + curve.angle_spread(times[idx]).powi(2)).sqrt();
    let most = lost.clone().map(off).fold(0.0, f64::max);
    let is_abrupt = off(lost.start).min(off(lost.end - 1)) > ABRUPT_SHARE * most;
    left < CLEAN * usual.max(least / SUSPECT / CLEAN)
        && most > least
        && is_abrupt
        && lost.clone().all(|idx| off(idx) > SUSPECT * noise(idx))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A swing of 1 s at 60 samples a second, with noise of a thousandth.
    pub(in super::super) fn swing() -> (Vec<f64>, Vec<f64>) {
        let noise = |idx: u32| f64::from(idx.wrapping_mul(2_654_435_761) >> 16) / 65536.0 - 0.5;
        let times: Vec<f64> = (0..1200_u32).map(|idx| f64::from(idx) / 60.0).collect();
        let wave = |(idx, t): (usize, &f64)| (-t / 15.0).exp() * (6.3 * t).cos() + 3e-3 * noise(idx as u32);
        let readings = times.iter().enumerate().map(wave).collect();
        (times, readings)
    }

    #[test]
    fn losses_of_one_and_of_several_readings_are_found_and_nothing_else() {
        let (times, mut readings) = swing();
        assert!(spikes(&times, &readings).iter().all(|is_spike| !is_spike));
        let lost = [100..101, 333..337, 640..646, 901..902];
        for (range, value) in lost.iter().zip([0.0, -0.9, 0.7, 5.0]) {
            readings[range.clone()].fill(value);
        }
        let found = spikes(&times, &readings);
        let expected: Vec<usize> = lost.into_iter().flatten().collect();
        let found: Vec<usize> = (0..found.len()).filter(|idx| found[*idx]).collect();
        assert_eq!(found, expected);
    }

    #[test]
    fn a_loss_of_any_size_is_found() {
        for size in [50.0, 1e4, 1e300, -1e300, f64::MAX] {
            let (times, mut readings) = swing();
            readings[333] = size;
            let found = spikes(&times, &readings);
            assert_eq!((0..found.len()).filter(|idx| found[*idx]).collect::<Vec<_>>(), [333], "{size}");
        }
    }

    #[test]
    fn a_push_a_stop_a_release_and_a_step_are_no_losses() {
        let (times, readings) = swing();
        let pushed =
            times.iter().zip(&readings).map(|(t, y)| if *t < 7.0 { *y } else { 1.7 * y }).collect::<Vec<f64>>();
        let stopped: Vec<f64> = readings.iter().map(|y| y.min(0.6)).collect();
        let held: Vec<f64> = readings.iter().enumerate().map(|(idx, y)| if idx < 60 { 1.0 } else { *y }).collect();
        let stepped: Vec<f64> =
            readings.iter().enumerate().map(|(idx, y)| if idx < 600 { *y } else { y + 0.5 }).collect();
        let wrapped: Vec<f64> = readings.iter().map(|y| (y + 0.5).rem_euclid(1.0)).collect();
        for (name, readings) in
            [("pushed", pushed), ("stopped", stopped), ("held", held), ("step", stepped), ("wrap", wrapped)]
        {
            let n = spikes(&times, &readings).iter().filter(|is_spike| **is_spike).count();
            assert_eq!(n, 0, "{name}");
        }
    }

    /// Small swings of a coarse encoder before a long rest: they turn on plateaus of many readings, one step beyond what stands
    /// beside them.
    #[test]
    fn turning_points_one_step_of_an_encoder_beyond_their_neighbours_are_no_losses() {
        for steps in [3.6, 5.6, 7.6] {
            let times: Vec<f64> = (0..6000_u32).map(|idx| f64::from(idx) / 100.0).collect();
            let count = |t: &f64| (steps * (1.0 - t / 12.0).max(0.0) * (6.2 * t).cos()).round();
            let mut readings: Vec<f64> = times.iter().map(count).collect();
            let found = |readings: &[f64]| {
                let found = spikes(&times, readings);
                (0..found.len()).filter(|idx| found[*idx]).collect::<Vec<usize>>()
            };
            assert_eq!(found(&readings), [0_usize; 0], "{steps}");
            // What goes farther than rounding does is lost.
            readings[333..336].fill(-60.0);
            assert_eq!(found(&readings), [333, 334, 335], "{steps}");
        }
    }

    #[test]
    fn where_more_than_a_twentieth_is_lost_all_readings_stay() {
        let n_found = |every: usize| {
            let (times, mut readings) = swing();
            (20..1180).step_by(every).for_each(|begin| readings[begin..begin + 3].fill(5.0));
            spikes(&times, &readings).iter().filter(|is_spike| **is_spike).count()
        };
        assert_eq!([n_found(75), n_found(48)], [48, 0]);
    }
}
