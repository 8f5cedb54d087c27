//! Samples that the logger lost or wrote twice while its times count on evenly.
//!
//! In: times of even steps (s) and readings. Out: times set right, repeated samples left out, a note. A pendulum never
//! jumps: where the reading steps by what it moves in a whole number of samples, the clock is wrong and not the sensor.
//! Over a window that is short beside a period the motion is a cubic; least squares for its coefficients and a step in
//! the middle find the places, and the number of samples is the one that leaves the least of the step.

use super::frames;
use super::median_step_s;
use super::noise;
use super::samples::keep;
use super::slip::Slip;
use super::turning;
use super::zero_step;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// Samples of a window on either side of a step: few enough to lie within half of a swing …
const BESIDE: usize = 12;

/// … and so many next to it are left out, because a late sample is often followed by one that catches up.
const SKIPPED: usize = 2;

/// A window spans at most this share of a half swing, which takes 224 samples a period: a sine then makes a step of 2e-5 of
/// its amplitude at most. Half of it would take 448 samples and make 6e-7, twice of it 112 and 6e-4.
const WIDEST: f64 = 0.25;

/// A step is believed from so many of its standard deviations on, by the scatter of its own window. On ten real
/// recordings every step beyond 7.3 is a whole number of samples; with half of it some that are chance would be taken,
/// with twice of it two of three would be left.
const SURE: f64 = 8.0;

/// Where more than so many standard deviations of a step are left behind it, it was not the clock. With 1.5 a seventh of
/// the true ones are missed; with 6 a sensor that slips by what the pendulum moves in half a sample passes.
const CLEAN: f64 = 3.0;

/// More samples than this share of a half swing are no hole that a cubic spans. Half of it would leave holes of a
/// sixteenth of a period and less, with twice of it the hole is longer than what the fifth power of the motion allows.
const LONGEST: f64 = 0.25;

/// From so many samples on a hole is counted anew over the widest window: what a cubic through two dozen samples says
/// beyond its ends grows with the cube of the distance. Half of it would do so where it is not needed; with twice of it one
/// of 8 samples at 1.2 rad/s, seen by an encoder of 14,400 lines, is counted wrongly now and then.
const LARGE: isize = 4;

/// Beside a clock's step the pendulum moves as fast on the one side as on the other, to this share: at a turning point a
/// sensor with play stands still for some samples, as if they stood there twice. With half of it some of those would pass;
/// twice of it leaves what is lost up to a twelfth of a half swing from the turn.
const STEADY: f64 = 0.25;

/// Within a half swing a pendulum turns once, or twice where it begins at a turn; what a hand does to it trembles more often.
const MOST_TURNS: usize = 2;

/// A note lists so many numbers at most.
const MOST_LISTED: usize = 8;

/// Sets times right; readings that stand there twice are left out: which samples are kept. Rows that are counted have no
/// clock that is off, but a video may lack a frame all the same.
pub(super) fn set_right(
    times_s: &mut Vec<f64>,
    readings: &mut Vec<f64>,
    are_counted: bool,
    notes: &mut Vec<String>,
) -> Vec<bool> {
    let step_s = median_step_s(times_s);
    let (mut slips, jumps_s) = if are_counted { Default::default() } else { slips(times_s, readings, step_s) };
    notes.extend(zero_step::note(&jumps_s));
    if let Some(first) = slips.first().map(|slip| times_s[slip.idx]) {
        notes.push(note(&slips, first));
    } else {
        slips = frames::slips(times_s, readings);
        notes.extend(frames::note(&slips, times_s));
    }
    let mut kept = vec![true; times_s.len()];
    for slip in slips {
        times_s[slip.idx..].iter_mut().for_each(|time_s| *time_s += slip.n_samples as f64 * step_s);
        let n_doubled = slip.n_samples.min(0).unsigned_abs();
        kept[slip.idx..slip.idx + n_doubled].fill(false);
    }
    for list in [times_s, readings] {
        keep(list, &kept);
    }
    kept
}

fn note(slips: &[Slip], first_s: f64) -> String {
    let numbers = in_words(slips.iter().map(|slip| slip.n_samples).collect());
    format!(
        "the clock is off at {} places, at {first_s:.3} s first, by {numbers} samples: they were lost (+) or stand there twice \
         (-), which the motion shows; the times are set right",
        slips.len(),
    )
}

/// Each of them, or of many how often each: `+1 (56 times), +2 (twice)`.
fn in_words(mut numbers: Vec<isize>) -> String {
    if numbers.len() <= MOST_LISTED {
        return numbers.iter().map(|number| format!("{number:+}")).collect::<Vec<_>>().join(", ");
    }
    numbers.sort_unstable();
    let mut alike: Vec<(usize, isize)> = numbers.chunk_by(|a, b| a == b).map(|run| (run.len(), run[0])).collect();
    alike.sort_by_key(|(n, number)| (std::cmp::Reverse(*n), *number));
    let times = |n: usize| match n {
        1 => "once".to_owned(),
        2 => "twice".to_owned(),
        _ => format!("{n} times"),
    };
    let n_others: usize = alike.iter().skip(MOST_LISTED).map(|(n, _)| n).sum();
    let shown = alike.iter().take(MOST_LISTED).map(|(n, number)| format!("{number:+} ({})", times(*n)));
    let others = (n_others > 0).then(|| format!("another ({})", times(n_others)));
    shown.chain(others).collect::<Vec<_>>().join(", ")
}

/// Where the clock slipped, and when the zero moved.
fn slips(times_s: &[f64], readings: &[f64], step_s: f64) -> (Vec<Slip>, Vec<f64>) {
    let lsb = noise::smallest_step(readings);
    let noise_rms = noise::of_samples(times_s, readings, lsb).total_rms;
    let Some(half_swing_s) = turning::half_swing_s(times_s, readings, noise_rms) else { return Default::default() };
    let window = Window::new(BESIDE);
    if window.length() as f64 * step_s > WIDEST * half_swing_s {
        return Default::default();
    }
    let parts = || readings.windows(window.length());
    let steps: Vec<f64> = parts().map(|part| window.step(part)).collect();
    let quiet = (noise::robust_spread(&steps) / window.step_noise).max(lsb.unwrap_or(0.0) / 12f64.sqrt());
    // Few are worth a look at their own scatter.
    let sure = |(part, step): (&[f64], &f64)| match step / (window.step_noise * quiet) {
        at_most if at_most.abs() > SURE => step / (window.step_noise * window.scatter(part, *step).max(quiet)),
        at_most => at_most,
    };
    let sureness: Vec<f64> = parts().zip(&steps).map(sure).collect();
    let most = (LONGEST * half_swing_s / step_s) as isize;
    let is_even = |start: usize| times_s[start..start + window.length()].windows(2).all(|pair| is_one(pair, step_s));
    let sure_steps: Vec<usize> = (0..steps.len())
        .filter(|start| sureness[*start].abs() > SURE && is_highest(&sureness, *start) && is_even(*start))
        .filter(|start| window.is_steady(&readings[*start..*start + window.length()]))
        .collect();
    let turns = match sure_steps.is_empty() {
        true => Vec::new(),
        false => turning::turning_points(times_s, readings, noise_rms),
    };
    let time_of = |start: &usize| times_s[start + BESIDE + SKIPPED];
    let swings_there = |start: &usize| {
        let about = ((half_swing_s / 2.0) / step_s) as usize;
        let (from, to) = ((start + BESIDE + SKIPPED).saturating_sub(about), start + BESIDE + SKIPPED + about);
        let near = from..to.min(readings.len());
        turning::n_turns(&times_s[near.clone()], &readings[near], noise_rms, readings) <= MOST_TURNS
    };
    let (jumps, lost): (Vec<usize>, Vec<usize>) = sure_steps
        .into_iter()
        .filter(swings_there)
        .partition(|start| zero_step::moves_the_middle(&turns, time_of(start), steps[*start]));
    let slips = lost.into_iter().filter_map(|start| {
        let slip = window.slip(readings, start, steps[start], quiet, most)?;
        let is_large = slip.n_samples.abs() >= LARGE;
        if is_large { over_widest(times_s, readings, &slip, half_swing_s / step_s, quiet, most) } else { Some(slip) }
    });
    (slips.collect(), jumps.iter().map(time_of).collect())
}

/// The same hole counted with as many samples beside it as the motion, the ends and other holes allow.
fn over_widest(
    times_s: &[f64],
    readings: &[f64],
    slip: &Slip,
    half_swing: f64,
    quiet: f64,
    most: isize,
) -> Option<Slip> {
    let step_s = median_step_s(times_s);
    let widest = (WIDEST * half_swing / 2.0) as usize;
    let beside = (widest.saturating_sub(SKIPPED)).max(BESIDE).min(slip.idx.checked_sub(SKIPPED)?);
    let window = Window::new(beside);
    let start = slip.idx.checked_sub(beside + SKIPPED)?;
    let part = readings.get(start..start + window.length());
    let is_even = |part: &[f64]| part.windows(2).all(|pair| is_one(pair, step_s));
    let is_whole = part.is_some() && times_s.get(start..start + window.length()).is_some_and(is_even);
    if !is_whole {
        return Some(*slip);
    }
    window.slip(readings, start, window.step(part?), quiet, most)
}

fn is_one(pair: &[f64], step_s: f64) -> bool {
    (0.9..1.1).contains(&((pair[1] - pair[0]) / step_s))
}

/// The largest step among its neighbours; of equal ones the first.
fn is_highest(steps: &[f64], idx: usize) -> bool {
    let here = steps[idx].abs();
    let beside = |range: Range<usize>| steps.get(range).unwrap_or_default().iter();
    here > 0.0
        && beside(idx.saturating_sub(BESIDE)..idx).all(|step| step.abs() < here)
        && beside(idx + 1..(idx + 1 + BESIDE).min(steps.len())).all(|step| step.abs() <= here)
}

/// The places of the samples about a step, in samples from it, and what finds step and slope.
struct Window {
    /// Samples on either side.
    beside: usize,
    places: Vec<f64>,
    for_slope: DVector<f64>,
    for_step: DVector<f64>,
    /// How much larger a scatter is in the step than in a sample.
    step_noise: f64,
    /// What makes of samples their distances from a cubic.
    off_cubic: DMatrix<f64>,
}

impl Window {
    fn new(beside: usize) -> Self {
        let after = (SKIPPED..SKIPPED + beside).map(|place| place as f64 + 0.5);
        let places: Vec<f64> = after.clone().rev().map(|place| -place).chain(after).collect();
        let row = |place: f64| [1.0, place, place * place, place.powi(3), f64::from(place > 0.0)];
        let design = DMatrix::from_fn(places.len(), STEP + 1, |row_idx, column| row(places[row_idx])[column]);
        // The columns are far from dependent.
        let found = design.clone().pseudo_inverse(0.0).unwrap_or_else(|_| DMatrix::zeros(STEP + 1, places.len()));
        let (for_slope, for_step) = (found.row(1).transpose(), found.row(STEP).transpose());
        let cubic = design.columns(0, STEP).into_owned();
        let onto = cubic.clone().pseudo_inverse(0.0).unwrap_or_else(|_| DMatrix::zeros(STEP, places.len()));
        let off_cubic = DMatrix::identity(places.len(), places.len()) - cubic * onto;
        let step_noise = for_step.norm();
        Self { beside, places, for_slope, for_step, step_noise, off_cubic }
    }

    /// Samples from the first to the last.
    fn length(&self) -> usize {
        2 * (self.beside + SKIPPED)
    }

    fn samples<'a>(&self, part: &'a [f64]) -> impl Iterator<Item = &'a f64> {
        part[..self.beside].iter().chain(&part[self.beside + 2 * SKIPPED..])
    }

    fn step(&self, part: &[f64]) -> f64 {
        self.samples(part).zip(self.for_step.iter()).map(|(reading, weight)| reading * weight).sum()
    }

    /// Does it go on the same way on both sides?
    fn is_steady(&self, part: &[f64]) -> bool {
        let half = self.beside / 2;
        let mean = |readings: &[f64]| readings.iter().sum::<f64>() / readings.len() as f64;
        let moved = |side: &[f64]| mean(&side[side.len() - half..]) - mean(&side[..half]);
        let (before, after) = (moved(&part[..self.beside]), moved(&part[self.beside + 2 * SKIPPED..]));
        before * after > 0.0 && before.abs().min(after.abs()) > STEADY * before.abs().max(after.abs())
    }

    /// What scatters about a cubic with such a step (rms).
    fn scatter(&self, part: &[f64], step: f64) -> f64 {
        let values = DVector::from_iterator(self.places.len(), self.samples(part).copied());
        let off = (&self.off_cubic * values).norm_squared() - step * step / self.step_noise.powi(2);
        (off.max(0.0) / (self.places.len() - STEP - 1) as f64).sqrt()
    }

    /// The whole number of samples that makes a cubic of a window with a step, if one does.
    fn slip(&self, readings: &[f64], start: usize, step: f64, quiet: f64, most: isize) -> Option<Slip> {
        let part = readings.get(start..start + self.length())?;
        let slope: f64 = self.samples(part).zip(self.for_slope.iter()).map(|(reading, weight)| reading * weight).sum();
        let about = step / slope;
        if !about.is_finite() || about.abs() < 0.5 || about.abs() > most as f64 {
            return None;
        }
        let reach = 1 + (about.abs() / 3.0) as isize;
        // More that stand there twice would reach beyond the window, and into the next one.
        let least = (about as isize - reach).max(-(BESIDE as isize));
        let tried = (least..=about as isize + reach).filter(|n| *n != 0);
        let closed = tried.filter_map(|n_samples| Some((n_samples, self.closed(part, n_samples)?)));
        let (n_samples, left) = closed.min_by(|a, b| a.1.step.abs().total_cmp(&b.1.step.abs()))?;
        let is_clean = left.step.abs() < CLEAN * left.scatter.max(quiet) * left.step_noise;
        is_clean.then_some(Slip { idx: start + self.beside + SKIPPED, n_samples })
    }

    /// What is left of the step when so many samples lie in the middle.
    fn closed(&self, part: &[f64], n_samples: isize) -> Option<Left> {
        let shifted = |place: f64| if place > 0.0 { place + n_samples as f64 } else { place };
        let scale = self.length() as f64;
        let cell = |row: usize, column: usize| match column {
            STEP => f64::from(self.places[row] > 0.0),
            power => (shifted(self.places[row]) / scale).powi(power as i32),
        };
        let design = DMatrix::from_fn(self.places.len(), STEP + 1, cell);
        let values = DVector::from_iterator(self.places.len(), self.samples(part).copied());
        let inverse = design.tr_mul(&design).try_inverse()?;
        let found = &inverse * design.tr_mul(&values);
        let scatter = ((values - design * &found).norm_squared() / (self.places.len() - STEP - 1) as f64).sqrt();
        Some(Left { step: found[STEP], step_noise: inverse[(STEP, STEP)].sqrt(), scatter })
    }
}

/// The step's place behind the powers of the cubic.
const STEP: usize = 4;

/// What is left of a step, what the noise of a sample makes of itself in it, and what scatters about the rest.
struct Left {
    step: f64,
    step_noise: f64,
    scatter: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_S: f64 = 1e-3;
    const LINES: f64 = 14_400.0;

    /// A swing of 1.2 s seen by an encoder at these multiples of 1 ms.
    fn seen(ticks: impl Iterator<Item = u32>) -> Vec<f64> {
        let line = std::f64::consts::TAU / LINES;
        let angle = |tick: u32| {
            let time_s = f64::from(tick) * STEP_S;
            (-time_s / 50.0).exp() * (5.2 * time_s).cos()
        };
        ticks.map(|tick| (angle(tick) / line).round() * line).collect()
    }

    fn nominal(n: usize) -> Vec<f64> {
        (0..n).map(|idx| idx as f64 * STEP_S).collect()
    }

    #[test]
    fn lost_and_doubled_samples_are_found_and_the_times_are_those_of_the_motion() {
        let lost = [3100, 3101, 7600];
        let mut ticks: Vec<u32> =
            (0..20_000).filter(|tick| !lost.contains(tick) && !(12_300..12_320).contains(tick)).collect();
        let doubled = ticks.iter().position(|tick| *tick == 15_000).unwrap();
        ticks.insert(doubled, 15_000);
        let mut readings = seen(ticks.iter().copied());
        let (mut times_s, mut notes) = (nominal(readings.len()), Vec::new());
        set_right(&mut times_s, &mut readings, false, &mut notes);
        ticks.remove(doubled);
        assert_eq!((times_s.len(), readings.len()), (ticks.len(), ticks.len()));
        let is_right = |(time_s, tick): (&f64, &u32)| (time_s - f64::from(*tick) * STEP_S).abs() < 0.5 * STEP_S;
        // Where exactly samples are missing is known to the few that are left out beside the step.
        let wrong: Vec<u32> =
            times_s.iter().zip(&ticks).filter(|pair| !is_right(*pair)).map(|(_, tick)| *tick).collect();
        assert!(wrong.len() <= 4 * SKIPPED, "{} {notes:?}", wrong.len());
        assert!(
            notes[0].contains("4 places, at 3.099 s first") && notes[0].contains("+2, +1, +20, -1 samples"),
            "{notes:?}"
        );
    }

    #[test]
    fn of_many_places_a_note_says_how_often_each_number() {
        assert_eq!(in_words(vec![2, 1, 20, -1]), "+2, +1, +20, -1");
        let many = [vec![1; 56], vec![-3], vec![2; 2]].concat();
        assert_eq!(in_words(many), "+1 (56 times), +2 (twice), -3 (once)");
        let all = in_words((1..=10).collect());
        assert!(all.starts_with("+1 (once), +2 (once)") && all.ends_with("+8 (once), another (twice)"), "{all}");
    }

    #[test]
    fn a_large_hole_in_small_swings_is_counted_right() {
        for lost in [6_u32, 9, 14, 22, 35] {
            for begin in [2620_u32, 5040, 7455, 9870] {
                // After 75 s the swings have a fifth of their size; here the pendulum hangs nearly straight.
                let mut readings =
                    seen((75_000..90_000).filter(|tick| !(75_000 + begin..75_000 + begin + lost).contains(tick)));
                let (mut times_s, mut notes) = (nominal(readings.len()), Vec::new());
                set_right(&mut times_s, &mut readings, false, &mut notes);
                let end_s = times_s[times_s.len() - 1];
                assert!((end_s - 14.999).abs() < 0.5 * STEP_S, "{lost} at {begin}: {end_s} {notes:?}");
            }
        }
    }

    #[test]
    fn a_motion_that_goes_back_further_than_a_window_is_left_alone() {
        let mut readings = seen((0..12_300).chain(12_260..12_276));
        let (mut times_s, mut notes) = (nominal(readings.len()), Vec::new());
        set_right(&mut times_s, &mut readings, false, &mut notes);
        assert_eq!((times_s.len(), readings.len(), notes.len()), (12_316, 12_316, 0), "{notes:?}");
    }

    /// A magnetic encoder waits for some counts before it turns with the shaft.
    #[test]
    fn play_that_shows_where_it_turns_is_no_clock() {
        for play in [1e-3, 2e-3, 4e-3] {
            let mut held = 1.0;
            let mut with_play = |tick: u32| {
                let time_s = f64::from(tick) * STEP_S;
                let angle = (-time_s / 50.0).exp() * (5.2 * time_s).cos();
                held = f64::clamp(held, angle - play / 2.0, angle + play / 2.0);
                (held * 1e5).round() / 1e5
            };
            let mut readings: Vec<f64> = (0..20_000).map(&mut with_play).collect();
            let (mut times_s, mut notes) = (nominal(readings.len()), Vec::new());
            set_right(&mut times_s, &mut readings, false, &mut notes);
            assert_eq!((times_s.len(), notes.len()), (20_000, 0), "{play} {notes:?}");
        }
    }

    #[test]
    fn a_swing_a_spike_and_a_sensor_that_shakes_are_left_alone() {
        let whole = seen(0..20_000);
        let mut spike = whole.clone();
        spike[9000] += 0.05;
        // Half a sample's way where it is fastest.
        let mut shaken = whole.clone();
        let random = |idx: usize| f64::from((idx as u32).wrapping_mul(2_654_435_761) >> 16) / 65536.0 - 0.5;
        (8710..8810).for_each(|idx| shaken[idx] += 0.01 * random(idx));
        for readings in [whole, spike, shaken] {
            let (mut times_s, mut kept, mut notes) = (nominal(readings.len()), readings.clone(), Vec::new());
            set_right(&mut times_s, &mut kept, false, &mut notes);
            assert_eq!((kept.len(), notes.len(), times_s.len()), (readings.len(), 0, readings.len()), "{notes:?}");
        }
    }

    /// A phone is carried and hung up before it swings: there its readings step, and no clock and no zero does.
    #[test]
    fn what_steps_in_a_hand_that_trembles_is_no_clock_and_no_zero() {
        let trembles = |time_s: f64| 0.3 * (38.0 * time_s).sin() * (-4.0 * (time_s - 2.0).powi(2)).exp();
        let carried = |time_s: f64| trembles(time_s) + if time_s > 2.05 { 0.05 } else { 0.0 };
        let swings = |time_s: f64| 0.8 * (-(time_s - 4.0) / 30.0).exp() * (5.2 * (time_s - 4.0)).sin();
        let reading = |idx: usize| match idx as f64 * STEP_S {
            time_s if time_s < 4.0 => carried(time_s),
            time_s => 0.05 + swings(time_s),
        };
        let line = std::f64::consts::TAU / LINES;
        let mut readings: Vec<f64> = (0..20_000).map(|idx| (reading(idx) / line).round() * line).collect();
        let (mut times_s, mut notes) = (nominal(readings.len()), Vec::new());
        set_right(&mut times_s, &mut readings, false, &mut notes);
        assert_eq!((times_s.len(), notes.len()), (20_000, 0), "{notes:?}");
    }

    /// By half of what the swing moves in a sample there, and by as much as it moves in one or two, as a clock's step would be.
    #[test]
    fn a_zero_that_moves_is_said_and_the_clock_is_left_alone() {
        let whole = seen(0..20_000);
        for (idx, n_samples) in [(5000, 0.5), (5000, 1.0), (5000, -2.0), (7600, 1.0), (12_400, -1.0)] {
            let step = n_samples * (whole[idx] - whole[idx - 1]);
            let mut readings = whole.clone();
            readings[idx..].iter_mut().for_each(|angle| *angle += step);
            let (mut times_s, mut notes) = (nominal(readings.len()), Vec::new());
            set_right(&mut times_s, &mut readings, false, &mut notes);
            assert_eq!(
                (times_s.len(), times_s[19_999], notes.len()),
                (20_000, nominal(20_000)[19_999], 1),
                "{notes:?}"
            );
            let at = format!("the readings jump at {:.2} s, and the middle", idx as f64 * STEP_S);
            assert!(notes[0].contains(&at), "{n_samples} {notes:?}");
        }
    }
}
