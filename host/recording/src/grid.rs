//! Times that a program rounded: a video of 30 frames a second with times of 0.03, 0.07, 0.10 s.
//!
//! In: times in s. Out: the even ones that they were, where all of them say so. A time that is off by half a hundredth
//! is a bob that is off by some of its speed, which no model explains. Spreadsheets keep a number of digits instead,
//! `9.97E+00` and `1.00E+01`, so that later times are coarser.

mod stretches;

use super::median_step_s;

/// More digits are none that matter.
const MOST_DIGITS: i32 = 6;

/// Fewer times could be even by chance.
const FEWEST: usize = 50;

/// A reading of rounded numbers is off by this share of the last digit.
const READ_SHARE: f64 = 1e-3;

/// Few digits are at most so many: five tell 100 s to 1 ms.
const FEW_DIGITS: i32 = 5;

/// What a camera's frames are off by, in steps; of the first times even few digits say more. With half of it a clock of
/// 30 Hz may be off by 0.3 ms, with twice of it by 1.3 ms, which a bob of 1 rad/s shows.
const UNEVEN_SHARE: f64 = 0.02;

/// Rounding moves even times by half a digit to either side, and a camera's frames are uneven by a little: up to a
/// twentieth of the digit the even times are still ten times nearer to the truth than the rounded ones. Three recordings
/// of a phone want 1.02 to 1.03. With half of it frames uneven by 0.2 ms stay rounded to 10 ms, with twice of it even
/// times are off by a tenth.
const NEARLY_EVEN: f64 = 1.1;

/// What rounding moves a time by at most, in digits: half of one, and what the line through all of them is off. With half of
/// it no time would be a rounded one, with twice of it lost rows would pass.
const ROUNDED: f64 = 0.55;

/// At most so many frames are late. One of 2,700 by 3 ms kept all others rounded; where one of seven is, none is even.
const LATE_SHARE: f64 = 0.01;

/// Takes the even times that rounded ones were.
pub(super) fn make_even(times_s: &mut [f64], notes: &mut Vec<String>) {
    if times_s.len() < FEWEST {
        return;
    }
    let step_s = median_step_s(times_s);
    let of_places = || {
        let digit_s = last_digit(times_s).filter(|digit_s| *digit_s <= 1.01 * step_s)?;
        Some((even(times_s, step_s, digit_s)?, digit_s, format!("{digit_s} s"), 0))
    };
    let of_digits = || {
        let (even, n_digits) = of_few_digits(times_s)?;
        Some((even, step_s, format!("{n_digits} digits"), 0))
    };
    let past_losses = || {
        let (even, n_digits, n_places) = of_few_digits_past_losses(times_s)?;
        Some((even, step_s, format!("{n_digits} digits"), n_places))
    };
    let Some((even, digit_s, to, n_places)) = of_places().or_else(of_digits).or_else(past_losses) else { return };
    let moved_s = times_s.iter().zip(&even).map(|(time, even)| (time - even).abs()).fold(0.0, f64::max);
    if moved_s < 10.0 * READ_SHARE * digit_s || moved_s < READ_SHARE * step_s {
        return;
    }
    // Of the grid: where rows are missing there are fewer.
    let rate_hz = median_step_s(&even).recip();
    let but = but_at(n_places);
    notes.push(format!("the times are rounded to {to} and fit even ones{but}, {rate_hz:.4} a second: these are taken"));
    times_s.copy_from_slice(&even);
}

/// The even times of rows whose times have so few digits that the later ones are coarser, and how many digits they have.
pub(super) fn of_few_digits(times: &[f64]) -> Option<(Vec<f64>, i32)> {
    let n = times.len() as f64;
    let (digits, n_digits) = few_digits(times)?;
    // A row that is a digit off must not move the line of the others.
    let near = weighted_line(times, &digits, |_| true);
    let even = weighted_line(times, &digits, |row| (times[row] - near[row]).abs() < digits[row]);
    let is_rounded = |row: &usize| (times[*row] - even[*row]).abs() < ROUNDED * digits[*row];
    let is_near = |row: usize| (times[row] - even[row]).abs() < (1.0 + ROUNDED) * digits[row];
    if !(0..times.len()).all(is_near) {
        return None;
    }
    let n_odd = (0..times.len()).filter(|row| !is_rounded(row)).count();
    // An odd one keeps its time where that lies between its neighbours.
    let is_in_order = |row: usize| {
        let before = row.checked_sub(1).is_none_or(|before| is_rounded(&before) && even[before] < times[row]);
        before && even.get(row + 1).is_none_or(|next| is_rounded(&(row + 1)) && times[row] < *next)
    };
    let time = |row: usize| if is_rounded(&row) || !is_in_order(row) { even[row] } else { times[row] };
    (n_odd as f64 <= LATE_SHARE * n).then(|| ((0..times.len()).map(time).collect(), n_digits))
}

/// The same where frames are missing or late at a few places, and at how many.
pub(super) fn of_few_digits_past_losses(times: &[f64]) -> Option<(Vec<f64>, i32, usize)> {
    let (digits, n_digits) = few_digits(times)?;
    let (even, n_places) = stretches::of_stretches(times, &digits)?;
    Some((even, n_digits, n_places))
}

/// What was done with times of few digits.
pub(super) fn in_words(n_digits: i32, n_places: usize) -> String {
    let but = but_at(n_places);
    format!("the times are rounded to {n_digits} digits and fit even ones{but}: these are taken")
}

fn but_at(n_places: usize) -> String {
    match n_places {
        0 => String::new(),
        1 => " but at one place, where frames are missing or late".to_owned(),
        n => format!(" but at {n} places, where frames are missing or late"),
    }
}

/// What the last digit of each time is worth, where they are so few that those of later times are worth more, and how many they
/// are.
fn few_digits(times: &[f64]) -> Option<(Vec<f64>, i32)> {
    let step = (times.last()? - times.first()?) / (times.len() as f64 - 1.0);
    let coarse = |time: f64, n_digits: i32| {
        // What a logarithm lacks to a whole number must not take a digit away.
        let tens = (time.abs() * (1.0 + 1e-9)).log10().floor().max(-9.0) as i32;
        10_f64.powi(tens + 1 - n_digits)
    };
    let has = |n_digits: &i32| {
        let off = |time: &f64| (time / coarse(*time, *n_digits) - (time / coarse(*time, *n_digits)).round()).abs();
        times.iter().all(|time| off(time) < READ_SHARE)
    };
    let n_digits = (1..=FEW_DIGITS).find(has).filter(|_| times.len() >= FEWEST && step > 0.0)?;
    let digits: Vec<f64> = times.iter().map(|time| coarse(*time, n_digits).max(UNEVEN_SHARE * step)).collect();
    // Where all are as coarse as the last one, they are rounded to a place.
    let is_coarser = digits.iter().any(|digit| *digit != digits[digits.len() - 1]);
    is_coarser.then_some((digits, n_digits))
}

/// A line through times that are as sure as their last digits are fine, as far as they count; its times at all rows.
fn weighted_line(times: &[f64], digits: &[f64], counts: impl Fn(usize) -> bool) -> Vec<f64> {
    let rows = || (0..times.len()).filter(|row| counts(*row));
    let sum = |of: &dyn Fn(usize) -> f64| rows().map(|row| of(row) / digits[row].powi(2)).sum::<f64>();
    let all = sum(&|_| 1.0);
    let (row, time) = (sum(&|row| row as f64) / all, sum(&|row| times[row]) / all);
    let across = sum(&|idx| (idx as f64 - row).powi(2));
    let slope = sum(&|idx| (idx as f64 - row) * (times[idx] - time)) / across;
    (0..times.len()).map(|idx| time + slope * (idx as f64 - row)).collect()
}

/// The even times of rows whose clock ticks less often than they come: all rows lie on one line to within a tick, as they
/// would not if some were lost.
pub(super) fn of_slow_clock(times: &[f64]) -> Option<Vec<f64>> {
    let (first, last) = (times.first()?, times.last()?);
    let step = (last - first) / (times.len() - 1) as f64;
    // The middle of the rows of each tick; of the first and the last tick some may be missing.
    let mut middles: Vec<(f64, f64)> = Vec::new();
    let mut row = 0;
    for ticks in times.chunk_by(|a, b| a == b) {
        middles.push((row as f64 + (ticks.len() - 1) as f64 / 2.0, ticks[0]));
        row += ticks.len();
    }
    let inner = middles.get(1..middles.len() - 1).filter(|inner| inner.len() > 2)?;
    let tick = inner.windows(2).map(|pair| pair[1].1 - pair[0].1).fold(f64::INFINITY, f64::min);
    let is_tick = |time: &f64| ((time - first) / tick - ((time - first) / tick).round()).abs() < READ_SHARE;
    let is_slow = times.len() >= FEWEST && step > 0.0 && step < tick && times.iter().all(is_tick);
    let even = is_slow.then(|| line(inner, (0..times.len()).map(|row| row as f64)))?;
    // A row that is a tick off has the time of the others.
    let is_on = |idx: &usize| (times[*idx] - even[*idx]).abs() < tick;
    let (on, fitting): (Vec<f64>, Vec<f64>) = (0..times.len()).filter(is_on).map(|idx| (times[idx], even[idx])).unzip();
    let are_near = times.iter().zip(&even).all(|(time, even)| (time - even).abs() < 2.0 * tick);
    let are_few_off = are_near && (times.len() - on.len()) as f64 <= LATE_SHARE * times.len() as f64;
    (are_few_off && lies_on(&on, &fitting, tick)).then_some(even)
}

/// The power of ten of which all times are multiples.
fn last_digit(times_s: &[f64]) -> Option<f64> {
    let is_multiple = |digit: f64| {
        let off = |time: &f64| (time / digit - (time / digit).round()).abs() < READ_SHARE;
        times_s.iter().all(off)
    };
    (0..=MOST_DIGITS).map(|digits| 10_f64.powi(-digits)).find(|digit| is_multiple(*digit))
}

/// Times of even steps, some of them left out, that become the given ones when they are rounded or cut off.
fn even(times_s: &[f64], step_s: f64, digit_s: f64) -> Option<Vec<f64>> {
    let plain = |pair: &&[f64]| (pair[1] - pair[0]) < 1.5 * step_s;
    let (sum, n) =
        times_s.windows(2).filter(plain).fold((0.0, 0.0), |(sum, n), pair| (sum + pair[1] - pair[0], n + 1.0));
    let mean_s = sum / n;
    let mut place = 0.0;
    let mut places = vec![0.0];
    for pair in times_s.windows(2) {
        place += ((pair[1] - pair[0]) / mean_s).round();
        places.push(place);
    }
    let times_at = |places: Vec<f64>| -> Vec<(f64, f64)> { places.into_iter().zip(times_s.iter().copied()).collect() };
    // Steps of 0.0125 s are 0.01 and 0.02 s in hundredths, and no row is left out.
    let all_are_there = even_on(&times_at((0..times_s.len()).map(|row| row as f64).collect()), digit_s);
    all_are_there.or_else(|| even_on(&times_at(places), digit_s))
}

/// The same of rows at known places.
fn even_on(all: &[(f64, f64)], digit_s: f64) -> Option<Vec<f64>> {
    let (places, times_s): (Vec<f64>, Vec<f64>) = all.iter().copied().unzip();
    let even = line(all, places.into_iter());
    if lies_on(&times_s, &even, digit_s) { Some(even) } else { even_but_a_few(all, &even, digit_s) }
}

/// The same where a few frames came late, or were said to: these keep their times. `near` is a line through all.
fn even_but_a_few(all: &[(f64, f64)], near: &[f64], digit_s: f64) -> Option<Vec<f64>> {
    let is_on = |idx: &usize| (all[*idx].1 - near[*idx]).abs() < digit_s;
    let on: Vec<(f64, f64)> = (0..all.len()).filter(is_on).map(|idx| all[idx]).collect();
    if (all.len() - on.len()) as f64 > LATE_SHARE * all.len() as f64 {
        return None;
    }
    let even = line(&on, all.iter().map(|(place, _)| *place));
    let (times, fitting): (Vec<f64>, Vec<f64>) =
        (0..all.len()).filter(is_on).map(|idx| (all[idx].1, even[idx])).unzip();
    let time = |idx: usize| if is_on(&idx) { even[idx] } else { all[idx].1 };
    lies_on(&times, &fitting, digit_s).then(|| (0..all.len()).map(time).collect())
}

/// The times at these places on the line through some times at theirs.
fn line(pairs: &[(f64, f64)], places: impl Iterator<Item = f64>) -> Vec<f64> {
    let mean = |of: fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / pairs.len() as f64;
    let (mean_place, mean_time) = (mean(|pair| pair.0), mean(|pair| pair.1));
    let across: f64 = pairs.iter().map(|(place, _)| (place - mean_place).powi(2)).sum();
    let along: f64 = pairs.iter().map(|(place, time)| (place - mean_place) * (time - mean_time)).sum();
    places.map(|place| mean_time + along / across * (place - mean_place)).collect()
}

/// Are times even ones but for what a digit or a tick takes?
fn lies_on(times: &[f64], even: &[f64], digit: f64) -> bool {
    let offs = times.iter().zip(even).map(|(time, even)| time - even);
    let (low, high) = offs.fold((f64::MAX, f64::MIN), |(low, high), off| (low.min(off), high.max(off)));
    high - low < NEARLY_EVEN * digit
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rounded(rate_hz: f64, digit_s: f64, keep: impl Fn(u32) -> bool) -> (Vec<f64>, Vec<f64>) {
        let truth: Vec<f64> = (0..900).filter(|idx| keep(*idx)).map(|idx| 2.0 + f64::from(idx) / rate_hz).collect();
        let times = truth.iter().map(|time| (time / digit_s).round() * digit_s).collect();
        (truth, times)
    }

    #[test]
    fn rounded_times_of_a_video_become_even_past_lost_frames() {
        for (rate_hz, digit_s) in [(30.0, 0.01), (29.97, 0.001), (59.94, 0.001), (240.0, 0.001)] {
            let (truth, mut times) = rounded(rate_hz, digit_s, |idx| idx % 97 != 5);
            let mut notes = Vec::new();
            make_even(&mut times, &mut notes);
            let off_s = times.iter().zip(&truth).map(|(time, truth)| (time - truth).abs()).fold(0.0, f64::max);
            assert!(off_s < 0.1 * digit_s && notes.len() == 1, "{rate_hz} {off_s} {notes:?}");
            let said: f64 =
                notes[0].split(", ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap().parse().unwrap();
            assert!((said / rate_hz - 1.0).abs() < 1e-4, "{rate_hz} {notes:?}");
        }
    }

    /// As a spreadsheet writes them: `1.87E+01`.
    /// Steps of 12.5 and 14.3 ms are 10 and 20 ms then, and none is a row that was lost.
    #[test]
    fn times_whose_last_digit_is_most_of_a_step_become_even() {
        for (rate_hz, digit_s) in [(80.0, 0.01), (70.0, 0.01), (60.0, 0.01), (800.0, 1e-3)] {
            let (truth, mut times) = rounded(rate_hz, digit_s, |_| true);
            make_even(&mut times, &mut Vec::new());
            let late = times.iter().zip(&truth).map(|(time, truth)| time - truth);
            let (low, high) = late.fold((f64::MAX, f64::MIN), |(low, high), late| (low.min(late), high.max(late)));
            assert!(high - low < 0.05 * digit_s, "{rate_hz} {digit_s} {low} {high}");
        }
    }

    fn of_digits(n_digits: usize, begin_s: f64, n: u32) -> (Vec<f64>, Vec<f64>) {
        let truth: Vec<f64> = (0..n).map(|idx| begin_s + f64::from(idx) / 29.97).collect();
        let written = truth.iter().map(|time| format!("{time:.*e}", n_digits - 1).parse().unwrap()).collect();
        (truth, written)
    }

    #[test]
    fn times_of_few_digits_become_even_however_coarse_the_last_ones_are() {
        for (n_digits, begin_s) in [(3, 0.0), (3, 18.7), (4, 0.5), (4, 90.0)] {
            let (truth, times) = of_digits(n_digits, begin_s, 4000);
            let (even, found) = of_few_digits(&times).unwrap();
            let off_s = even.iter().zip(&truth).map(|(time, truth)| (time - truth).abs()).fold(0.0, f64::max);
            assert!(found == n_digits as i32 && off_s < 0.005, "{n_digits} {begin_s} {off_s}");
        }
        let (_, lost) = of_digits(3, 0.0, 4000);
        let lost: Vec<f64> =
            lost.iter().enumerate().filter(|(idx, _)| !(900..1000).contains(idx)).map(|t| *t.1).collect();
        assert_eq!(of_few_digits(&lost), None);
        // A row that is one digit off leaves the others even, among those of several rows a time as well.
        for odd in [200, 1200] {
            let (truth, mut times) = of_digits(3, 0.0, 1350);
            times[odd] += if odd == 200 { 0.01 } else { -0.1 };
            let (even, _) = of_few_digits(&times).unwrap();
            let off_s = |row: usize| (even[row] - truth[row]).abs();
            assert!((0..1350).filter(|row| *row != odd).map(off_s).fold(0.0, f64::max) < 0.005);
            assert!(off_s(odd) < 0.02 && even.windows(2).all(|pair| pair[1] > pair[0]), "{}", even[odd]);
        }
        let (truth, mut times) = of_digits(4, 0.0, 2500);
        let mut notes = Vec::new();
        make_even(&mut times, &mut notes);
        assert!(times.iter().zip(&truth).all(|(time, truth)| (time - truth).abs() < 1e-3), "{notes:?}");
    }

    #[test]
    fn frames_that_are_uneven_by_far_less_than_they_are_rounded_become_even() {
        let uneven = |idx: u32| 0.8e-3 * (f64::from(idx.wrapping_mul(2_654_435_761) >> 16) / 65536.0 - 0.5);
        let truth: Vec<f64> = (0..9625).map(|idx| f64::from(idx) / 30.0835 + uneven(idx)).collect();
        let mut times: Vec<f64> = truth.iter().map(|time| (time / 0.01).round() * 0.01).collect();
        let mut notes = Vec::new();
        make_even(&mut times, &mut notes);
        let off_s = times.iter().zip(&truth).map(|(time, truth)| (time - truth).abs()).fold(0.0, f64::max);
        assert!(off_s < 1e-3, "{off_s} {notes:?}");
    }

    /// Two decimals at 200 Hz: every other time lies on the edge between two of them, and goes either way.
    #[test]
    fn rows_that_come_oftener_than_the_clock_ticks_become_even() {
        let truth: Vec<f64> = (0..3000).map(|idx| f64::from(idx) * 0.005).collect();
        let times: Vec<f64> = truth.iter().map(|time| format!("{time:.2}").parse().unwrap()).collect();
        let even = of_slow_clock(&times).unwrap();
        // Where the first row lies within its tick is nothing that shows.
        let off_s = even.iter().zip(&truth).map(|(time, truth)| (time - even[0] - truth).abs()).fold(0.0, f64::max);
        assert!(off_s < 2e-4, "{off_s}");
        let mut odd = times.clone();
        let last_of_tick = (1000..).find(|row| times[*row] < times[row + 1]).unwrap();
        odd[last_of_tick] = times[last_of_tick + 1];
        let with_odd = of_slow_clock(&odd).unwrap();
        assert!(with_odd.iter().zip(&even).all(|(time, even)| (time - even).abs() < 2e-4));
        let lost: Vec<f64> = [&times[..1000], &times[1010..]].concat();
        assert_eq!(of_slow_clock(&lost), None);
        assert_eq!(of_slow_clock(&truth), None);
    }

    #[test]
    fn a_late_frame_keeps_its_time_and_does_not_keep_the_others_rounded() {
        let (truth, mut times) = rounded(60.0, 0.001, |idx| idx % 97 != 5);
        times[400] += 0.003;
        times[700] -= 0.004;
        let written = times.clone();
        make_even(&mut times, &mut Vec::new());
        let off_s = |idx: usize| (times[idx] - truth[idx]).abs();
        let others = (0..times.len()).filter(|idx| ![400, 700].contains(idx));
        assert!(others.map(off_s).fold(0.0, f64::max) < 1e-4);
        assert_eq!([times[400], times[700]], [written[400], written[700]]);
    }

    #[test]
    fn exact_and_uneven_times_stay() {
        let (_, exact) = rounded(100.0, 0.01, |_| true);
        let (_, fine) = rounded(30.0, 1e-9, |_| true);
        let (_, mut uneven) = rounded(30.0, 0.001, |_| true);
        uneven.iter_mut().step_by(7).for_each(|time| *time += 0.004);
        for times in [exact, fine, uneven] {
            let (mut kept, mut notes) = (times.clone(), Vec::new());
            make_even(&mut kept, &mut notes);
            assert_eq!((kept, notes.len()), (times, 0), "{notes:?}");
        }
    }
}
