//! Readings that nobody took: a tracker that froze, or that drew a straight line from one frame to another.
//!
//! In: times and all lists of readings of a swing, in any unit. Out: which rows to leave out, as gaps. Rows lie on an exact
//! line where the second differences of every list vanish beside its noise; a sensor whose step is not far below its noise
//! has plateaus everywhere, and of its rows none is asked for. They are left out where the swing before and behind is one
//! swing, as it is elsewhere, and that swing does not go along the line.
//!
//! The first two constants are derived; half and twice of the others were not tried.

use super::frames::swing::Swing;
use super::noise::{self, smallest_step};
use super::places::Places;
use super::{median, median_step_s, turning};
use std::f64::consts::TAU;
use std::ops::Range;

/// A second difference is none below this share of the noise. White noise alone makes one so small in 0.33 of this share of
/// all rows (the density of N(0, √6) at 0), once in 300.
const EXACT: f64 = 1e-2;

/// So many of them in a row are no chance: by itself one place in 1e15 has six; half would be one in 3e7, and twice of it would
/// leave lines of 13 rows.
const FEWEST: usize = 6;

/// More than this share of all rows is how the file was made: held, resampled, saturated.
const MOST_SHARE: f64 = 0.05;

/// Periods before and behind a line that say whether the swing goes on: one at least …
const LEAST_BESIDE: f64 = 1.0;

/// … and so many where they are there.
const BESIDE: f64 = 1.5;

/// Samples a period: a window has then twice as many as there are unknowns.
const FEWEST_A_PERIOD: f64 = 12.0;

/// The swing goes on where its window scatters at most by so many times what others with such a hole do.
const CLEAN: f64 = 4.0;

/// So many other windows on either side say what is usual.
const OTHERS: usize = 4;

/// A line is off the swing somewhere by so many times what the window scatters.
const OFF: f64 = 8.0;

/// Which rows lie on a line that the swing does not go along.
pub(super) fn drawn(times_s: &[f64], lists: &[&[f64]]) -> Vec<bool> {
    let none = vec![false; times_s.len()];
    let Some(lines) = lines(lists).filter(|lines| !lines.is_empty()) else { return none };
    let mut is_on_line = none.clone();
    lines.iter().for_each(|line| is_on_line[line.clone()].fill(true));
    if share(&is_on_line) > MOST_SHARE {
        return none;
    }
    let readings = lists[0];
    let noise = white(readings);
    let Some(half_swing_s) = turning::half_swing_s(times_s, readings, noise) else { return none };
    let (step_s, period_s) = (median_step_s(times_s), 2.0 * half_swing_s);
    if period_s < FEWEST_A_PERIOD * step_s {
        return none;
    }
    let look = Look { times_s, readings, is_on_line: &is_on_line, step_s, period_s, noise };
    let mut is_drawn = none.clone();
    let stay = look.saturated(&lines);
    for line in lines.into_iter().filter(|line| !stay.contains(line) && look.is_drawn(line)) {
        is_drawn[line].fill(true);
    }
    is_drawn
}

/// What is said of them.
pub(super) fn note(is_drawn: &[bool], times_s: &[f64]) -> Option<String> {
    let places = Places::of(is_drawn)?;
    let (n, first_s) = (places.n_rows, times_s[places.first_idx]);
    let at = match places.n {
        1 => format!("at {first_s:.3} s"),
        n_places => format!("at {n_places} places, at {first_s:.3} s first"),
    };
    Some(format!(
        "{n} readings lie on an exact straight line {at}, as when a tracker froze or filled frames in, while the swing \
         goes on: left out as {}",
        places.as_gaps()
    ))
}

fn share(marks: &[bool]) -> f64 {
    marks.iter().filter(|mark| **mark).count() as f64 / marks.len() as f64
}

/// The white noise of readings, by their fourth differences.
pub(super) fn white(readings: &[f64]) -> f64 {
    let difference = |w: &[f64]| (w[0] - 4.0 * w[1] + 6.0 * w[2] - 4.0 * w[3] + w[4]) / 70_f64.sqrt();
    noise::robust_spread(&readings.windows(5).map(difference).collect::<Vec<f64>>())
}

/// Rows of exact lines in all lists, with both ends; `None` where the step of a list is no small part of its noise.
fn lines(lists: &[&[f64]]) -> Option<Vec<Range<usize>>> {
    let n_rows = lists.first()?.len();
    let limits: Vec<f64> = lists.iter().map(|list| EXACT * white(list)).collect();
    let is_fine = |(list, limit): (&&[f64], &f64)| *limit > 0.0 && smallest_step(list).is_none_or(|step| step < *limit);
    if !lists.iter().zip(&limits).all(is_fine) {
        return None;
    }
    let bend = |list: &[f64], idx: usize| (list[idx - 1] - 2.0 * list[idx] + list[idx + 1]).abs();
    let is_straight = |idx: usize| lists.iter().zip(&limits).all(|(list, limit)| bend(list, idx) < *limit);
    let inner: Vec<usize> = (1..n_rows.saturating_sub(1)).filter(|idx| is_straight(*idx)).collect();
    let runs = inner.chunk_by(|a, b| a + 1 == *b).filter(|run| run.len() >= FEWEST);
    Some(runs.map(|run| run[0] - 1..run[run.len() - 1] + 2).collect())
}

/// The swing about lines.
struct Look<'a> {
    times_s: &'a [f64],
    readings: &'a [f64],
    is_on_line: &'a [bool],
    step_s: f64,
    period_s: f64,
    noise: f64,
}

impl Look<'_> {
    /// Flat lines at an end of the range, or at the level of another flat one: the sensor ends there.
    fn saturated(&self, lines: &[Range<usize>]) -> Vec<Range<usize>> {
        let alike = |a: f64, b: f64| (a - b).abs() < EXACT * self.noise;
        let level = |line: &Range<usize>| self.readings[line.start];
        let is_flat = |line: &&Range<usize>| alike(level(line), self.readings[line.end - 1]);
        let flat: Vec<&Range<usize>> = lines.iter().filter(is_flat).collect();
        let highest = self.readings.iter().copied().fold(f64::MIN, f64::max);
        let lowest = self.readings.iter().copied().fold(f64::MAX, f64::min);
        let is_end = |line: &Range<usize>| alike(level(line), highest) || alike(level(line), lowest);
        let is_met_again =
            |line: &Range<usize>| flat.iter().filter(|other| alike(level(line), level(other))).count() > 1;
        flat.iter().filter(|line| is_end(line) || is_met_again(line)).map(|line| (*line).clone()).collect()
    }

    fn is_drawn(&self, line: &Range<usize>) -> bool {
        let (begin_s, end_s) = (self.times_s[line.start], self.times_s[line.end - 1]);
        let (swing, middle_s) = match self.swing(begin_s, end_s) {
            Some(swing) if end_s - begin_s < self.period_s => (swing, (begin_s + end_s) / 2.0),
            _ => return false,
        };
        let window_s = end_s - begin_s + 2.0 * BESIDE * self.period_s;
        let shifts_s = (1..=OTHERS).flat_map(|n| [-1.0, 1.0].map(|sign| sign * n as f64 * window_s / 2.0));
        let others = shifts_s.filter_map(|shift_s| self.swing(begin_s + shift_s, end_s + shift_s));
        let mut scatters: Vec<f64> = others.map(|swing| swing.scatter).collect();
        if scatters.is_empty() {
            return false;
        }
        let scatter = swing.scatter.max(self.noise);
        let off = |idx: usize| (self.readings[idx] - swing.at(self.place(idx, middle_s))).abs();
        swing.scatter < CLEAN * median(&mut scatters).max(self.noise)
            && line.clone().any(|idx| off(idx) > OFF * scatter)
    }

    /// The swing beside a hole and whatever else lies on a line.
    fn swing(&self, begin_s: f64, end_s: f64) -> Option<Swing> {
        let beside_s = BESIDE * self.period_s;
        let first = self.times_s.partition_point(|time_s| *time_s < begin_s - beside_s);
        let last = self.times_s.partition_point(|time_s| *time_s <= end_s + beside_s);
        let is_used = |idx: &usize| !self.is_on_line[*idx] && !(begin_s..=end_s).contains(&self.times_s[*idx]);
        let used: Vec<usize> = (first..last).filter(is_used).collect();
        let (from, to) = (*used.first()?, *used.last()?);
        let least_s = LEAST_BESIDE * self.period_s;
        if begin_s - self.times_s[from] < least_s || self.times_s[to] - end_s < least_s {
            return None;
        }
        let middle_s = (begin_s + end_s) / 2.0;
        let (places, readings) = used.iter().map(|idx| (self.place(*idx, middle_s), self.readings[*idx])).unzip();
        let half_window = (beside_s + (end_s - begin_s) / 2.0) / self.step_s;
        Swing::fit(places, readings, TAU * self.step_s / self.period_s, half_window)
    }

    /// Samples from a moment.
    fn place(&self, idx: usize, middle_s: f64) -> f64 {
        (self.times_s[idx] - middle_s) / self.step_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_of_nothing_but_codes_has_no_lines() {
        assert_eq!(drawn(&[0.0, 0.1, 0.2], &[]), [false; 3]);
    }

    /// A swing of 1.2 s at 60 samples a second with noise of a thousandth, of which these rows are on the line between their ends.
    fn swing(line: Range<usize>) -> (Vec<f64>, Vec<f64>) {
        let mut noise = crate::random::Noise::new(3);
        let times_s: Vec<f64> = (0..2400_u32).map(|idx| f64::from(idx) / 60.0).collect();
        let wave = |t: &f64| (-t / 40.0).exp() * (TAU / 1.2 * t).cos() + 1e-3 * noise.normal();
        let mut readings: Vec<f64> = times_s.iter().map(wave).collect();
        let (first, last) = (readings[line.start], readings[line.end - 1]);
        let slope = (last - first) / (line.len() - 1).max(1) as f64;
        line.clone().enumerate().for_each(|(n, idx)| readings[idx] = first + slope * n as f64);
        (times_s, readings)
    }

    fn found(times_s: &[f64], readings: &[f64]) -> Vec<usize> {
        let is_drawn = drawn(times_s, &[readings]);
        (0..is_drawn.len()).filter(|idx| is_drawn[*idx]).collect()
    }

    /// It turns at 1080, 1116 …, and hangs in the middle between.
    #[test]
    fn a_line_over_a_turning_point_and_one_over_most_of_a_period_are_found_and_nothing_else() {
        for line in [1070..1090, 1110..1122, 1085..1145, 1060..1079] {
            let (times_s, readings) = swing(line.clone());
            assert_eq!(found(&times_s, &readings), line.clone().collect::<Vec<usize>>(), "{line:?}");
        }
        let (times_s, readings) = swing(0..1);
        assert_eq!(found(&times_s, &readings), [0_usize; 0]);
    }

    #[test]
    fn readings_that_stop_for_a_while_are_found() {
        let (times_s, mut readings) = swing(0..1);
        let frozen = readings[1075];
        readings[1075..1105].fill(frozen);
        assert_eq!(found(&times_s, &readings), (1075..1105).collect::<Vec<usize>>());
    }

    /// A point that moves straight on while y does not, or a line along the motion, is measured.
    #[test]
    fn a_line_in_one_list_alone_and_one_that_the_swing_goes_along_stay() {
        let (times_s, drawn_x) = swing(1070..1090);
        let (_, y) = swing(0..1);
        assert!(drawn(&times_s, &[&drawn_x, &y]).iter().all(|is_drawn| !is_drawn));
        let (times_s, readings) = swing(1094..1102);
        assert_eq!(found(&times_s, &readings), [0_usize; 0]);
    }

    #[test]
    fn what_ends_rests_is_held_stops_or_steps_stays() {
        let (times_s, readings) = swing(0..1);
        let map = |of: &dyn Fn(usize, f64) -> f64| -> Vec<f64> {
            readings.iter().enumerate().map(|(idx, reading)| of(idx, *reading)).collect()
        };
        let held = map(&|idx, reading| if idx < 72 { 1.0 } else { reading });
        let resting = map(&|idx, reading| if idx < 2300 { reading } else { 0.0 });
        // It goes on elsewhere: a hand held it for half a second.
        let stopped = map(&|idx, reading| match idx {
            ..1075 => reading,
            1075..1105 => readings[1075],
            _ => readings[idx - 30],
        });
        let saturated = map(&|_, reading| reading.min(0.7));
        let once = map(&|idx, reading| if idx < 60 { reading.min(0.97) } else { reading.clamp(-0.9, 0.9) });
        let coarse = map(&|_, reading| (reading / 0.02).round() * 0.02);
        let on_change = map(&|idx, _| readings[idx / 12 * 12]);
        let resampled = map(&|idx, _| {
            let (before, share) = (idx / 12 * 12, (idx % 12) as f64 / 12.0);
            readings[before] * (1.0 - share) + readings[(before + 12).min(2399)] * share
        });
        let all = [held, resting, stopped, saturated, once, coarse, on_change, resampled];
        for (case, readings) in all.iter().enumerate() {
            assert_eq!(found(&times_s, readings), [0_usize; 0], "{case}");
        }
    }
}
