//! Frames of a video that are missing or stand there twice, where a swing has too few samples for `lost.rs`.
//!
//! In: times of even steps (s) and readings. Out: the places where the frames slipped by one. What is said by a free swing
//! on either side (`swing.rs`) is how much later the swing goes on than the times do: a frame that stands there twice is one
//! frame, one that is missing is minus one, and a sensor that repeats a reading and then catches up is none. That alone
//! could be a push where it turns; so the two readings beside a place where it is fast must say the same, once in a
//! recording. Of normal noise one place in 1e15 passes as a step of the time and one in 1e6 as a pair of readings.
//! Measured: none in 500 simulated videos without a slip, nor in 150 each with pushes, stale readings or outliers, nor in
//! some hundred real recordings of encoders and videos but one. In that one the eight doubled frames, one each 46.1 s, are
//! found. Missing ones are found in five of seven other videos; in four of these rows fall behind the rounded times likewise.

mod glance;
pub(super) mod swing;

use super::noise;
use super::slip::Slip;
use super::turning;
use super::{median, median_step_s};
use rayon::prelude::*;
use std::ops::Range;
use swing::{STEPS, Steps, Swing};

/// Periods on either side of a step. With half of it drift and harmonics are nearly a step of the offset, and of 191 planted
/// slips 9 are found in place of 138; with twice of it 129, because more than one slip is in a window.
const BESIDE: f64 = 1.5;

/// Samples a period: with fewer a window has hardly more than twice as many samples as there are unknowns.
const FEWEST: f64 = 12.0;

/// With so many samples a period the windows of `lost.rs` are short enough.
const MOST: f64 = 224.0;

/// Periods of a recording that say what is usual in it: two windows beside each other.
const SHORTEST: f64 = 6.0;

/// Samples next to a step that are left out on either side, one that stands there twice among them.
const SKIPPED: usize = 1;

/// Windows are looked at so many times a period. A step is as large as it gets up to a quarter of a period from its place.
const LOOKS: usize = 8;

/// A place is where the rest is least, at most this share of a period from where the step is largest; half and twice of it
/// find the same.
const NEAR: f64 = 0.25;

/// A frame is told from none by so many standard deviations. With half of it twice as many are found in videos whose times
/// show them; with twice of it none of those and six of the eight doubled ones.
const SURE: f64 = 8.0;

/// When a frame is set right, a step of the time, of the size or of the offset that is larger than so many standard
/// deviations is something else. With half of it a third of the planted ones is missed, with twice of it 3 % more are found.
const CLEAN: f64 = 3.0;

/// Two neighbouring readings contradict even times by so many standard deviations. With half of it slow swings of 196
/// samples a period are judged, where a step is three noises; with twice of it a fifth of the planted ones is missed.
const SEEN: f64 = 5.0;

/// Fast is this share of the fastest: nearer to where it turns a push might delay the swing by a frame without making it
/// larger or smaller by more than such a share of that.
const FAST: f64 = 0.5;

/// Steps that differ by less of themselves are the same: no digit of a time says less.
const SAME_STEP: f64 = 1e-6;

/// So many places are told.
const TOLD: usize = 12;

/// Steps of even times that are written with some digits are of three lengths, and with fewer digits later on of three for
/// each number of them; those of a clock are of nearly as many as there are rows. Half and twice were not tried.
const MOST_STEPS: usize = 24;

/// The places where one frame is missing or stands there twice, in order of time. A clock of its own shows what is missing, and
/// goes on where a reading is repeated.
pub(super) fn slips(times_s: &[f64], readings: &[f64]) -> Vec<Slip> {
    if are_of_clock(times_s) {
        return Vec::new();
    }
    let lsb = noise::smallest_step(readings);
    let noise_rms = noise::of_samples(times_s, readings, lsb).total_rms;
    let Some(half_swing_s) = turning::half_swing_s(times_s, readings, noise_rms) else { return Vec::new() };
    let step_s = median_step_s(times_s);
    let period = 2.0 * half_swing_s / step_s;
    if !(FEWEST..MOST).contains(&period) || (times_s.len() as f64) < SHORTEST * period {
        return Vec::new();
    }
    if !glance::may_slip(times_s, readings, noise_rms, step_s, period) {
        return Vec::new();
    }
    let look = Look { times_s, readings, step_s, period, beside: (BESIDE * period).ceil() as usize };
    let windows = look.windows();
    let Some(usual) = Usual::of(&windows) else { return Vec::new() };
    let surest = |idx: usize| {
        let is_near = |other: &&(usize, Steps)| other.0.abs_diff(windows[idx].0) <= look.beside;
        let n_near = look.beside / look.hop();
        let others = &windows[idx.saturating_sub(n_near)..windows.len().min(idx + n_near + 1)];
        let sureness = usual.sureness(&windows[idx].1);
        others.iter().filter(is_near).all(|other| usual.sureness(&other.1) <= sureness)
    };
    let about = (0..windows.len()).filter(|idx| usual.sureness(&windows[*idx].1) > SURE / 2.0 && surest(*idx));
    let mut found: Vec<(Slip, bool)> =
        about.filter_map(|idx| look.slip(windows[idx].0, &windows[idx].1, &usual)).collect();
    found.dedup_by_key(|(slip, _)| slip.idx);
    let is_seen = |n_samples: isize| found.iter().any(|(slip, seen)| *seen && slip.n_samples == n_samples);
    found.iter().filter(|(slip, _)| is_seen(slip.n_samples)).map(|(slip, _)| *slip).collect()
}

/// What is said of them.
pub(super) fn note(slips: &[Slip], times_s: &[f64]) -> Option<String> {
    let of = |n_samples: isize, what: &str, done: &str| {
        let those = slips.iter().filter(|slip| slip.n_samples == n_samples);
        let at: Vec<String> = those.map(|slip| format!("{:.2}", times_s[slip.idx])).collect();
        let more = if at.len() > TOLD { ", …" } else { "" };
        let told = at[..at.len().min(TOLD)].join(", ");
        (!at.is_empty()).then(|| format!("frames {what}: {} (at {told}{more} s), {done}", at.len()))
    };
    let doubled = of(-1, "that stand there twice", "of which one is left out and what follows is a frame earlier");
    let missing = of(1, "that are missing", "where what follows is a frame later");
    let told: Vec<String> = doubled.into_iter().chain(missing).collect();
    (!told.is_empty()).then(|| format!("{}; the swing before and after shows it", told.join("; ")))
}

/// Are the steps from row to row of many lengths?
fn are_of_clock(times_s: &[f64]) -> bool {
    let step_s = median_step_s(times_s);
    let steps = times_s.windows(2).map(|pair| (pair[1] - pair[0]) / step_s);
    let mut lengths: Vec<u32> =
        steps.filter(|step| (0.5..1.5).contains(step)).map(|step| (step / SAME_STEP).round() as u32).collect();
    lengths.sort_unstable();
    lengths.dedup();
    lengths.len() > MOST_STEPS
}

/// The recording that is looked at.
struct Look<'a> {
    times_s: &'a [f64],
    readings: &'a [f64],
    step_s: f64,
    /// Samples a period.
    period: f64,
    /// Samples on either side of a step.
    beside: usize,
}

/// What windows say where nothing happens: their scatter, and by how much more than it the steps vary.
struct Usual {
    scatter: f64,
    excess: [f64; STEPS],
}

impl Usual {
    fn of(windows: &[(usize, Steps)]) -> Option<Self> {
        let mut scatters: Vec<f64> = windows.iter().map(|(_, steps)| steps.scatter).collect();
        if scatters.is_empty() {
            return None;
        }
        let scatter = median(&mut scatters);
        let excess = |step: usize| {
            let own =
                |(_, seen): &(usize, Steps)| seen.steps[step] / (seen.per_scatter[step] * seen.scatter.max(scatter));
            noise::robust_spread(&windows.iter().map(own).collect::<Vec<_>>()).max(1.0)
        };
        Some(Self { scatter, excess: std::array::from_fn(excess) })
    }

    fn spread(&self, seen: &Steps, step: usize) -> f64 {
        seen.per_scatter[step] * seen.scatter.max(self.scatter) * self.excess[step]
    }

    /// The step of the time in its standard deviations.
    fn sureness(&self, seen: &Steps) -> f64 {
        seen.steps[0].abs() / self.spread(seen, 0)
    }

    fn is_clean(&self, seen: &Steps) -> bool {
        (0..STEPS).all(|step| seen.steps[step].abs() < CLEAN * self.spread(seen, step))
    }
}

impl Look<'_> {
    /// From one window to the next.
    fn hop(&self) -> usize {
        (self.period as usize / LOOKS).max(1)
    }

    fn windows(&self) -> Vec<(usize, Steps)> {
        let margin = self.beside + SKIPPED;
        let ends = self.readings.len().saturating_sub(margin);
        let places = (margin..ends).into_par_iter().step_by(self.hop());
        places.filter_map(|idx| Some((idx, self.steps(idx, 0)?))).collect()
    }

    /// Times of a range from the middle between a sample and the one before it, in samples; `None` where they are uneven.
    fn places(&self, range: &Range<usize>, idx: usize) -> Option<Vec<f64>> {
        let times_s = self.times_s.get(range.clone())?;
        let is_whole = |pair: &[f64]| {
            let steps = (pair[1] - pair[0]) / self.step_s;
            steps > 0.5 && (steps - steps.round()).abs() < 0.1 && steps < self.period / 4.0
        };
        let middle_s = (self.times_s[idx - 1] + self.times_s[idx]) / 2.0;
        times_s
            .windows(2)
            .all(is_whole)
            .then(|| times_s.iter().map(|time_s| (time_s - middle_s) / self.step_s).collect())
    }

    /// The swing about a sample, so many frames being lost just before it.
    fn swing(&self, range: &Range<usize>, idx: usize, n_samples: isize, skipped: usize) -> Option<Swing> {
        let places = self.places(range, idx)?;
        let shifted = |place: f64| if place > 0.0 { place + n_samples as f64 } else { place };
        let is_used = |place: &usize| *place + skipped < idx || *place >= idx + skipped;
        let used = || range.clone().filter(is_used);
        let places: Vec<f64> = used().map(|place| shifted(places[place - range.start])).collect();
        let readings: Vec<f64> = used().map(|place| self.readings[place]).collect();
        Swing::fit(places, readings, std::f64::consts::TAU / self.period, self.beside as f64)
    }

    fn about(&self, idx: usize) -> Option<Range<usize>> {
        let margin = self.beside + SKIPPED;
        Some(idx.checked_sub(margin)?..idx + margin).filter(|range| range.end <= self.readings.len())
    }

    fn steps(&self, idx: usize, n_samples: isize) -> Option<Steps> {
        self.swing(&self.about(idx)?, idx, n_samples, SKIPPED)?.steps()
    }

    /// The slip near a sample, if there is one, and whether the readings beside it show it.
    fn slip(&self, near: usize, seen: &Steps, usual: &Usual) -> Option<(Slip, bool)> {
        let n_samples = if seen.steps[0] > 0.0 { 1 } else { -1 };
        let range = self.about(near)?;
        let reach = (NEAR * self.period) as usize;
        let is_next = |idx: &usize| ((self.times_s[*idx] - self.times_s[idx - 1]) / self.step_s).round() == 1.0;
        let rest = |idx: usize| Some((idx, self.swing(&range, idx, n_samples, 0)?.scatter));
        let (idx, _) =
            (near - reach..near + reach).filter(is_next).filter_map(rest).min_by(|a, b| a.1.total_cmp(&b.1))?;
        let closed = self.steps(idx, n_samples)?;
        let scatter = closed.scatter.max(usual.scatter);
        let is_sure = 1.0 > SURE * closed.per_scatter[0] * scatter * usual.excess[0];
        if !is_sure || !usual.is_clean(&closed) {
            return None;
        }
        Some((Slip { idx, n_samples }, self.is_seen(idx, n_samples, scatter)?))
    }

    /// Do the readings on either side of a slip show it? `None` where they contradict it.
    fn is_seen(&self, idx: usize, n_samples: isize, scatter: f64) -> Option<bool> {
        let swing = self.swing(&self.about(idx)?, idx, n_samples, SKIPPED)?;
        let moved = self.readings[idx] - self.readings[idx - 1];
        let noise = scatter * std::f64::consts::SQRT_2;
        let slipped = swing.at(0.5 + n_samples as f64) - swing.at(-0.5);
        let even = swing.at(0.5) - swing.at(-0.5);
        let is_slip = (moved - slipped).abs() < CLEAN * noise;
        let around = (0..self.period as usize).map(|place| place as f64 - self.period / 2.0);
        let fastest = around.map(|place| swing.slope(place).abs()).fold(0.0, f64::max);
        let is_fast = even.abs() > FAST * fastest;
        is_slip.then_some(is_fast && (moved - even).abs() > SEEN * noise)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A swing of 1.2 s, 30 frames a second, with a little noise.
    fn seen(frames: impl Iterator<Item = usize>) -> (Vec<f64>, Vec<f64>) {
        let angle = |frame: usize| {
            let time_s = frame as f64 / 30.0;
            0.4 * (-time_s / 60.0).exp() * (5.2 * time_s).cos()
        };
        let noise = |row: usize| f64::from((row as u32).wrapping_mul(2_654_435_761) >> 16) / 65536.0 - 0.5;
        frames.enumerate().map(|(row, frame)| (row as f64 / 30.0, angle(frame) + 1e-3 * noise(row))).unzip()
    }

    fn found(frames: impl Iterator<Item = usize>) -> Vec<(usize, isize)> {
        let (times_s, readings) = seen(frames);
        slips(&times_s, &readings).iter().map(|slip| (slip.idx, slip.n_samples)).collect()
    }

    /// Where it hangs after 32.5 half swings, and where it turns after 33.
    const FAST_AT: usize = 589;
    const TURN_AT: usize = 598;

    #[test]
    fn a_frame_that_stands_there_twice_and_one_that_is_missing_are_found_where_they_are() {
        assert_eq!(found((0..FAST_AT).chain(FAST_AT - 1..1200)), [(FAST_AT, -1)]);
        assert_eq!(found((0..FAST_AT).chain(FAST_AT + 1..1200)), [(FAST_AT, 1)]);
        assert_eq!(found(0..1200), []);
    }

    #[test]
    fn a_delay_where_it_turns_may_be_a_push_until_another_one_is_seen() {
        let turned = || (0..TURN_AT).chain(TURN_AT - 1..1200);
        assert_eq!(found(turned()), []);
        let both: Vec<usize> = turned().filter(|frame| *frame != 0).chain(1200..1600).collect();
        let fast = both.iter().position(|frame| *frame == FAST_AT + 181).unwrap();
        let both = both[..fast].iter().chain(&both[fast - 1..]).copied();
        assert_eq!(found(both).len(), 2);
    }

    /// A sensor that is asked oftener than it measures repeats a reading; the times are those of the one who asks.
    #[test]
    fn a_clock_of_its_own_is_not_moved() {
        let (times_s, readings) = seen((0..FAST_AT).chain(FAST_AT - 1..1200));
        let mut noise = crate::random::Noise::new(1);
        let of_clock: Vec<f64> = times_s.iter().map(|time_s| time_s + 1e-5 * noise.normal()).collect();
        assert_eq!(slips(&of_clock, &readings), []);
        // However few digits even times have, and however many.
        for digit in [1e-6, 1e-5, 1e-4, 1e-3] {
            let rounded: Vec<f64> = times_s.iter().map(|time_s| (time_s / digit).round() * digit).collect();
            assert_eq!(slips(&rounded, &readings).len(), 1, "{digit}");
        }
    }

    #[test]
    fn a_reading_that_is_repeated_while_the_times_go_on_is_none() {
        let (times_s, mut readings) = seen(0..1200);
        readings[FAST_AT] = readings[FAST_AT - 1];
        assert_eq!(slips(&times_s, &readings), []);
    }

    #[test]
    fn a_sensor_that_slips_by_what_a_frame_moves_and_a_push_are_none() {
        let (times_s, readings) = seen(0..1200);
        let mut slipped = readings.clone();
        let step = readings[FAST_AT] - readings[FAST_AT - 1];
        slipped[FAST_AT..].iter_mut().for_each(|reading| *reading += step);
        assert_eq!(slips(&times_s, &slipped), []);
        let mut pushed = readings;
        pushed[FAST_AT..].iter_mut().for_each(|reading| *reading *= 1.1);
        assert_eq!(slips(&times_s, &pushed), []);
    }

    #[test]
    fn a_repeated_reading_after_which_it_is_late_by_half_a_frame_is_none() {
        let (times_s, mut readings) = seen(0..1200);
        for idx in (FAST_AT..1200).rev() {
            readings[idx] = f64::midpoint(readings[idx - 1], readings[idx]);
        }
        readings[FAST_AT] = readings[FAST_AT - 1];
        assert_eq!(slips(&times_s, &readings), []);
    }

    #[test]
    fn all_frames_are_counted_and_the_first_twelve_are_told() {
        let times_s: Vec<f64> = (0..1000).map(|row| f64::from(row) / 100.0).collect();
        let slip = |idx: usize, n_samples: isize| Slip { idx, n_samples };
        let slips: Vec<Slip> = (1..=14).map(|k| slip(50 * k, -1)).chain([slip(900, 1)]).collect();
        let said = note(&slips, &times_s).unwrap();
        assert!(said.starts_with("frames that stand there twice: 14 (at 0.50, 1.00, "), "{said}");
        assert!(said.contains("6.00, … s), of which one is left out"), "{said}");
        assert!(said.contains("frames that are missing: 1 (at 9.00 s), where what follows is a frame later"), "{said}");
    }

    /// The same with one reading that is off where it is fast, so that a glance tells nothing.
    fn found_behind_a_glance(frames: impl Iterator<Item = usize>, spoilt: impl Fn(&mut [f64])) -> Vec<(usize, isize)> {
        let (times_s, mut readings) = seen(frames);
        readings[200] += 0.04;
        spoilt(&mut readings);
        slips(&times_s, &readings).iter().map(|slip| (slip.idx, slip.n_samples)).collect()
    }

    #[test]
    fn one_reading_that_is_off_hides_no_slip_and_makes_none() {
        assert_eq!(found_behind_a_glance(0..1200, |_| ()), []);
        assert_eq!(found_behind_a_glance((0..FAST_AT).chain(FAST_AT - 1..1200), |_| ()), [(FAST_AT, -1)]);
    }

    #[test]
    fn a_delay_where_it_is_slow_is_none_though_a_reading_elsewhere_is_off() {
        // Where it turns, and where it has two fifths of its speed.
        for at in [TURN_AT, TURN_AT + 3] {
            assert_eq!(found_behind_a_glance((0..at).chain(at - 1..1200), |_| ()), [], "{at}");
        }
    }

    #[test]
    fn a_slip_one_way_is_no_witness_for_one_the_other_way() {
        let turned: Vec<usize> = (0..TURN_AT).chain(TURN_AT - 1..1600).collect();
        let fast = turned.iter().position(|frame| *frame == FAST_AT + 181).unwrap();
        let both = turned[..fast].iter().chain(&turned[fast + 1..]).copied();
        assert_eq!(found(both), [(fast, 1)]);
    }

    #[test]
    fn a_slip_beside_which_something_else_happens_is_none() {
        let doubled = || (0..FAST_AT).chain(FAST_AT - 1..1200);
        // A push, and a reading that neither stands there twice nor moves on.
        let pushed = |readings: &mut [f64]| readings[FAST_AT..].iter_mut().for_each(|reading| *reading *= 1.01);
        assert_eq!(found_behind_a_glance(doubled(), pushed), []);
        let moved = |readings: &mut [f64]| readings[FAST_AT] -= 0.02;
        assert_eq!(found_behind_a_glance(doubled(), moved), []);
    }
}
