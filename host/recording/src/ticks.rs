//! Times as clocks of loggers count them: counters that begin anew, and clocks coarser than the samples.
//!
//! In: times in the file's unit, in the order of the rows. Out: times that increase, and a note; nothing is changed where
//! anything else is wrong with them.

use super::limits::MIN_SAMPLES;

/// Counters of microcontrollers begin anew behind so many.
pub(super) const COUNTERS: [f64; 2] = [65_536.0, 4_294_967_296.0];

/// A step back by more than this share of a counter's range is its new beginning. Encoders move by less than a quarter of
/// theirs between two samples; a clock moves by less still.
const NEW_BEGINNING: f64 = 0.75;

/// From this share of rows on with the time of the row before, the clock is coarse; fewer are errors of the file. Half of it
/// would take a file in which every tenth row is wrong; with twice of it a clock of 1 ms at 1.6 kHz would be refused.
const COARSE_SHARE: f64 = 0.2;

/// A clock that stands still for so many times its usual rows has stopped.
const STOPPED: usize = 4;

/// Steps instead of times: so many rows at least, …
const ROWS_OF_STEPS: usize = 50;

/// … of which this share is less than the one before, which times never are but where two recordings were joined. A logger
/// whose 40 ms scatter by one has 22 %, so that half of it or twice changes nothing.
const FALLING_SHARE: f64 = 0.02;

/// Steps are alike to this factor, but for one in ten: a logger that misses a sample now and then is within it.
const ALIKE: f64 = 2.0;

/// Sums of what stands in the rows, where that is the time since the row before: always about the same, up and down, or the
/// very same if its name says what it is (`dt`).
pub(super) fn of_steps(steps: &[f64], is_named: bool) -> Option<Vec<f64>> {
    let n_falling = steps.windows(2).filter(|pair| pair[1] < pair[0]).count() as f64;
    let typical = super::median(&mut steps.to_vec());
    let is_alike = |step: &&f64| (typical / ALIKE..=typical * ALIKE).contains(*step);
    let n_alike = steps.iter().filter(is_alike).count();
    let are_steps = steps.len() >= ROWS_OF_STEPS
        && (is_named || n_falling > FALLING_SHARE * steps.len() as f64)
        && 10 * n_alike > 9 * steps.len()
        && steps.iter().all(|step| *step > 0.0);
    let mut time = 0.0;
    let mut add = |step: &f64| {
        time += step;
        time
    };
    are_steps.then(|| steps.iter().map(&mut add).collect())
}

/// Adds the range of a 16- or 32-bit counter at each new beginning; gives how often, and how many bits it has. Only where
/// all are whole numbers within that range.
pub(super) fn unwind(counts: &mut [f64]) -> Option<(usize, u32)> {
    let range = COUNTERS.into_iter().find(|range| counts.windows(2).any(|pair| begins_anew(pair, *range)))?;
    if counts.iter().any(|count| count.fract() != 0.0 || count.abs() > range) {
        return None;
    }
    let (mut added, mut n_anew, mut before) = (0.0, 0, counts[0]);
    for count in counts.iter_mut() {
        let here = *count;
        if begins_anew(&[before, here], range) {
            added += range * (before - here).signum();
            n_anew += 1;
        }
        before = here;
        *count += added;
    }
    Some((n_anew, range.log2() as u32))
}

fn begins_anew(pair: &[f64], range: f64) -> bool {
    let step = (pair[1] - pair[0]).abs();
    step > NEW_BEGINNING * range && step <= range
}

/// Times that stand still for several rows are spread evenly until the next one; `None` where that is not what is wrong.
pub(super) fn spread(times: &[f64]) -> Option<Vec<f64>> {
    let n_repeated = times.windows(2).filter(|pair| pair[0] == pair[1]).count();
    let groups: Vec<(f64, usize)> = times.chunk_by(|a, b| a == b).map(|group| (group[0], group.len())).collect();
    let is_coarse = n_repeated as f64 > COARSE_SHARE * times.len() as f64 && groups.len() > 3;
    if !is_coarse || groups.windows(2).any(|pair| pair[1].0 < pair[0].0) {
        return None;
    }
    let mut counts: Vec<usize> = groups.iter().map(|(_, n)| *n).collect();
    counts.sort_unstable();
    let usual = counts[counts.len() / 2];
    if counts.last().is_some_and(|n| *n > STOPPED * usual.max(2)) {
        return None;
    }
    let per_row = (groups[groups.len() - 1].0 - groups[1].0)
        / groups[1..groups.len() - 1].iter().map(|g| g.1).sum::<usize>() as f64;
    // Of the first time only the last rows may be there.
    let (first, n_first) = (groups[1].0, groups[0].1);
    let mut spread: Vec<f64> = (0..n_first).map(|row| first - (n_first - row) as f64 * per_row).collect();
    for pair in groups[1..].windows(2) {
        let ((from, n), (to, _)) = (pair[0], pair[1]);
        spread.extend((0..n).map(|row| from + (to - from) * row as f64 / n as f64));
    }
    let (last, n_last) = groups[groups.len() - 1];
    spread.extend((0..n_last).map(|row| last + row as f64 * per_row));
    Some(spread)
}

/// How many rows there are up to the one at which the clock stops for good, if it rises until then and they are a recording
/// of their own.
pub(super) fn before_stop(times: &[f64], is_doubled: impl Fn(usize) -> bool) -> Option<usize> {
    let last = times.last()?;
    let n_behind = times.iter().rev().take_while(|time| *time == last).count() - 1;
    let n_kept = times.len() - n_behind;
    let rises = (1..n_kept).all(|idx| times[idx] > times[idx - 1] || is_doubled(idx));
    (n_behind > 0 && n_kept > MIN_SAMPLES && rises).then_some(n_kept)
}

/// Is it a coarse clock beside even samples? Every tick is as long as the others and has as many rows but one at either
/// end, which a point that swings would not have, even on a screen of coarse pixels.
pub(super) fn is_even(times: &[f64]) -> bool {
    let groups: Vec<&[f64]> = times.chunk_by(|a, b| a == b).collect();
    let Some(inner) = groups.get(1..groups.len().saturating_sub(1)).filter(|inner| inner.len() > 3) else {
        return false;
    };
    let tick = (inner[inner.len() - 1][0] - inner[0][0]) / (inner.len() - 1) as f64;
    let is_tick = |pair: &[&[f64]]| (pair[1][0] - pair[0][0] - tick).abs() < 1e-6 * tick;
    let sizes = || inner.iter().map(|group| group.len());
    tick > 0.0 && inner.windows(2).all(is_tick) && sizes().max() <= sizes().min().map(|least| least + 2)
}

/// Does it never fall, and lie on a straight line to its longest step? So do times of few digits, the later ones coarser
/// than the rows; a point that swings lies far off one, however slowly.
pub(super) fn is_straight(times: &[f64]) -> bool {
    let (Some(first), Some(last)) = (times.first(), times.last()) else { return false };
    let steps = || times.windows(2).map(|pair| pair[1] - pair[0]);
    let longest = steps().fold(0.0, f64::max);
    let per_row = (last - first) / (times.len() - 1).max(1) as f64;
    let is_near = |(row, time): (usize, &f64)| (time - first - per_row * row as f64).abs() <= longest;
    longest > 0.0 && steps().all(|step| step >= 0.0) && times.iter().enumerate().all(is_near)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counters_of_16_and_32_bits_go_on_where_they_begin_anew() {
        for (range, bits) in [(65_536.0, 16), (4_294_967_296.0, 32)] {
            let truth: Vec<f64> = (0..40).map(|row| range - 200.0 + 10.0 * f64::from(row)).collect();
            let mut unsigned: Vec<f64> = truth.iter().map(|count| count % range).collect();
            assert_eq!((unwind(&mut unsigned), unsigned), (Some((1, bits)), truth.clone()));
            let signed: Vec<f64> = truth.iter().map(|count| (count + range / 2.0) % range - range / 2.0).collect();
            let mut shifted: Vec<f64> = signed.iter().map(|count| count - range / 2.0).collect();
            let begin = shifted[0];
            assert!(unwind(&mut shifted).is_none() || shifted[39] - begin == 390.0);
        }
        // An encoder goes to and fro across its zero.
        let mut to_and_fro = [3.0, 1.0, 65_535.0, 65_530.0, 65_534.0, 2.0];
        assert_eq!(unwind(&mut to_and_fro), Some((2, 16)));
        assert_eq!(to_and_fro, [3.0, 1.0, -1.0, -6.0, -2.0, 2.0]);
        for others in [[0.0, 10.0, 20.0, 5.0], [0.5, 65_000.5, 0.5, 1.0], [0.0, 70_000.0, 10.0, 20.0]] {
            let mut counts = others;
            assert_eq!((unwind(&mut counts), counts), (None, others));
        }
    }

    #[test]
    fn a_coarse_clock_is_told_from_a_point_on_coarse_pixels() {
        let clock: Vec<f64> = (0..200).map(|row| (10.0 * (18.7 + f64::from(row) / 30.0)).round() / 10.0).collect();
        assert!(is_even(&clock));
        for n_period in [400.0, 1000.0, 4000.0] {
            let point =
                (0..200).map(|row| -(40.0 * f64::cos(f64::from(row) / n_period * std::f64::consts::TAU)).round());
            assert!(!is_even(&point.collect::<Vec<_>>()), "{n_period}");
        }
        assert!(!is_even(&[1.0, 1.0, 2.0, 2.0]) && !is_even(&[]));
    }

    #[test]
    fn rows_within_a_tick_of_the_clock_are_spread_and_single_repeats_are_not() {
        let truth: Vec<f64> = (0..1000).map(|row| f64::from(row) / 3.0 + 0.1).collect();
        let ticks: Vec<f64> = truth.iter().map(|time| time.floor()).collect();
        let spread_out = spread(&ticks).unwrap();
        assert!(spread_out.iter().zip(&truth).all(|(found, time)| (found - time).abs() < 0.34));
        assert!(spread_out.windows(2).all(|pair| pair[1] > pair[0]));
        let mut once = truth.clone();
        once[500] = once[499];
        assert_eq!(spread(&once), None);
        let mut stopped = ticks;
        let last = stopped[800];
        stopped[800..].fill(last);
        assert_eq!(spread(&stopped), None);
    }

    #[test]
    fn a_clock_that_stops_for_good_ends_the_recording_and_one_that_goes_on_does_not() {
        let until = |stop: usize, n: usize| (0..n).map(move |row| row.min(stop) as f64).collect::<Vec<_>>();
        let stops = |times: &[f64]| before_stop(times, |_| false);
        assert_eq!(stops(&until(30, 50)), Some(31));
        assert_eq!(stops(&until(30, 32)), Some(31));
        assert_eq!(stops(&until(30, 31)), None);
        assert_eq!(stops(&until(10, 50)), None);
        let mut halts = until(30, 50);
        halts[12] = halts[11];
        assert_eq!(stops(&halts), None);
        assert_eq!(before_stop(&halts, |idx| idx == 12), Some(31));
        halts.push(31.0);
        assert_eq!(stops(&halts), None);
    }

    #[test]
    fn the_first_and_the_last_tick_are_spread_by_the_usual_distance_of_rows() {
        // Three rows a tick; of the first one, the first row is missing.
        let truth: Vec<f64> = (1..30).map(|row| f64::from(row) / 3.0).collect();
        let ticks: Vec<f64> = truth.iter().map(|time| time.floor()).collect();
        let spread_out = spread(&ticks).unwrap();
        assert_eq!(spread_out.len(), truth.len());
        assert!(spread_out.iter().zip(&truth).all(|(found, time)| (found - time).abs() < 1e-9), "{spread_out:?}");
    }
}
