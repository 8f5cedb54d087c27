//! Times of few digits where frames are missing or late: even in stretches, each of them moved against the one before.
//!
//! In: times, and what the last digit of each is worth. Out: even times with one step throughout, and how many places they are
//! moved at. A tracker skips frames in which it does not find the bob; the rows on either side no longer lie on one line, though
//! their clock goes on.

use super::{LATE_SHARE, ROUNDED};

/// The step is first known from parts of so many rows, of which most have all their frames; half and twice were not tried …
const PARTS: usize = 10;

/// … and then sought among steps that move the last row by this share of its digit; half and twice were not tried …
const SOUGHT_SHARE: f64 = 0.125;

/// … and twice more about the best: first times of four digits are a hundred times as fine as the last ones.
const ROUNDS: usize = 3;

/// So many times as fine each round. Half and twice were not tried.
const FINER: f64 = 16.0;

/// Even times in stretches, and how many places they are moved at, where these are few.
pub(super) fn of_stretches(times: &[f64], digits: &[f64]) -> Option<(Vec<f64>, usize)> {
    let step = likely_step(times, digits)?;
    let starts = starts(times, digits, step);
    let n_places = starts.len() - 1;
    if n_places == 0 || n_places as f64 > LATE_SHARE * times.len() as f64 {
        return None;
    }
    let starts = settled(times, digits, step, &starts);
    let step = common_step(times, digits, &starts);
    let mut even = Vec::with_capacity(times.len());
    for rows in ranges(&starts, times.len()) {
        let offset = offset(times, digits, step, rows.clone());
        even.extend(rows.map(|row| offset + step * row as f64));
    }
    let is_near = |row: usize| (times[row] - even[row]).abs() < (1.0 + ROUNDED) * digits[row];
    ((0..times.len()).all(is_near) && even.windows(2).all(|pair| pair[1] > pair[0])).then_some((even, n_places))
}

/// The step with which they fall into the fewest stretches; of equals the middle one. First times of finer digits want it finer.
fn likely_step(times: &[f64], digits: &[f64]) -> Option<f64> {
    let n = times.len();
    let size = n / PARTS;
    let of_part = |part: &[f64]| (part[size - 1] - part[0]) / (size - 1) as f64;
    let mut of_parts: Vec<f64> = times.chunks_exact(size).map(of_part).collect();
    let last = *digits.last()?;
    let (mut step, mut reach) = (crate::median(&mut of_parts), last / size as f64);
    let mut apart = SOUGHT_SHARE * last / n as f64;
    for _ in 0..ROUNDS {
        step = best_step(times, digits, step, (reach, apart))?;
        (reach, apart) = (2.0 * apart, apart / FINER);
    }
    Some(step)
}

/// The best one within a reach of another one, of steps so far apart.
fn best_step(times: &[f64], digits: &[f64], about: f64, (reach, apart): (f64, f64)) -> Option<f64> {
    let n_aside = (reach / apart).ceil() as i32;
    let tried = (-n_aside..=n_aside).map(|idx| about + f64::from(idx) * apart).filter(|step| *step > 0.0);
    let counted: Vec<(usize, f64)> = tried.map(|step| (starts(times, digits, step).len(), step)).collect();
    let fewest = counted.iter().map(|(n, _)| *n).min()?;
    Some(crate::median(&mut counted.iter().filter(|(n, _)| *n == fewest).map(|(_, step)| *step).collect::<Vec<f64>>()))
}

/// The first row of each stretch, if each goes on for as long as one line of this step is within half a digit of all its rows.
fn starts(times: &[f64], digits: &[f64], step: f64) -> Vec<usize> {
    let mut starts = vec![0];
    let (mut low, mut high) = (f64::MIN, f64::MAX);
    for (row, (time, digit)) in times.iter().zip(digits).enumerate() {
        let at_first = time - step * row as f64;
        let (least, most) = (at_first - ROUNDED * digit, at_first + ROUNDED * digit);
        (low, high) = (low.max(least), high.min(most));
        if low > high {
            starts.push(row);
            (low, high) = (least, most);
        }
    }
    starts
}

/// The same, where what fits either of two stretches is parted in the middle: a missing frame shows some rows late.
fn settled(times: &[f64], digits: &[f64], step: f64, starts: &[usize]) -> Vec<usize> {
    let mut settled = starts.to_vec();
    let all: Vec<_> = ranges(starts, times.len()).collect();
    for (place, pair) in all.windows(2).enumerate() {
        let offset = offset(times, digits, step, pair[1].clone());
        let fits = |row: &usize| (times[*row] - offset - step * *row as f64).abs() < ROUNDED * digits[*row];
        let n_either = pair[0].clone().skip(1).rev().take_while(fits).count();
        settled[place + 1] -= n_either / 2;
    }
    settled
}

fn ranges(starts: &[usize], n: usize) -> impl Iterator<Item = std::ops::Range<usize>> {
    let ends = starts.iter().skip(1).copied().chain([n]);
    starts.iter().copied().zip(ends).map(|(start, end)| start..end)
}

/// Where the line of a stretch begins, by rows that count as their digits are fine.
fn offset(times: &[f64], digits: &[f64], step: f64, rows: std::ops::Range<usize>) -> f64 {
    let weight = |row: usize| digits[row].powi(-2);
    let sum = rows.clone().map(|row| weight(row) * (times[row] - step * row as f64)).sum::<f64>();
    sum / rows.map(weight).sum::<f64>()
}

/// The step of lines that are moved against each other but go on alike.
fn common_step(times: &[f64], digits: &[f64], starts: &[usize]) -> f64 {
    let (mut along, mut across) = (0.0, 0.0);
    for rows in ranges(starts, times.len()) {
        let weight = |row: usize| digits[row].powi(-2);
        let all = rows.clone().map(weight).sum::<f64>();
        let mean = |of: &dyn Fn(usize) -> f64| rows.clone().map(|row| weight(row) * of(row)).sum::<f64>() / all;
        let (row_mean, time_mean) = (mean(&|row| row as f64), mean(&|row| times[row]));
        for row in rows.clone() {
            let off = row as f64 - row_mean;
            along += weight(row) * off * (times[row] - time_mean);
            across += weight(row) * off * off;
        }
    }
    along / across
}

#[cfg(test)]
mod tests {
    use super::super::of_few_digits_past_losses;
    use crate::{AngleUnit, ReadOptions, read_bytes};

    /// Frames of a video at 29.97 Hz, of which some are missing, and what a spreadsheet writes of their times.
    fn skipped(missing: &[u32], n_digits: usize) -> (Vec<f64>, Vec<f64>) {
        let kept = (0..3000_u32).filter(|frame| !missing.contains(frame));
        let truth: Vec<f64> = kept.map(|frame| 0.4 + f64::from(frame) / 29.97).collect();
        let written = truth.iter().map(|time| format!("{time:.*e}", n_digits - 1).parse().unwrap()).collect();
        (truth, written)
    }

    /// Where a tick of the later times covers three frames, some rows fit either side of a frame that is missing.
    #[test]
    fn times_of_few_digits_are_even_on_either_side_of_frames_that_are_missing() {
        for (n_digits, most_off_s, unsure) in [(3, 0.045, 0.07), (4, 0.001, 0.0)] {
            let (truth, times) = skipped(&[150, 900, 901, 1500, 2310], n_digits);
            let (even, found, n_places) = of_few_digits_past_losses(&times).unwrap();
            assert_eq!((found, n_places), (n_digits as i32, 4));
            let off_s: Vec<f64> = even.iter().zip(&truth).map(|(even, truth)| (even - truth).abs()).collect();
            assert!(off_s.iter().all(|off_s| *off_s < most_off_s), "{n_digits}");
            let n_far = off_s.iter().filter(|off_s| **off_s > 0.01).count();
            assert!(n_far as f64 <= unsure * truth.len() as f64, "{n_digits} {n_far}");
        }
    }

    /// Three digits tell 10 s and more to a tenth, which three frames share.
    #[test]
    fn a_file_of_few_digits_is_read_past_frames_that_are_missing() {
        let (truth, times) = skipped(&[700, 1600], 3);
        let angle = |time: f64| 0.3 * (-0.01 * time).exp() * (4.0 * time).cos();
        let row = |(time, written): (&f64, &f64)| format!("{written:.2e},{:.4}\n", angle(*time));
        let text = "t,theta (rad)\n".to_owned() + &truth.iter().zip(&times).map(row).collect::<String>();
        let options = ReadOptions { angle_unit: Some(AngleUnit::Radians), ..ReadOptions::default() };
        let recording = read_bytes("video", text.as_bytes(), &options).unwrap();
        let notes = recording.notes().join("\n");
        assert!(notes.contains("rounded to 3 digits and fit even ones but at 2 places"), "{notes}");
        let samples = recording.times_s().iter().zip(recording.angles_rad());
        let n_off = samples.filter(|(time, found)| (angle(**time) - **found).abs() > 0.01).count();
        assert!(recording.len() > truth.len() - 5 && n_off < 100, "{} {n_off}", recording.len());
    }

    /// Seen in a video: one frame 1.7 ms late, and all behind it as well, of which only the first times have digits enough to tell.
    #[test]
    fn frames_that_are_late_from_one_on_leave_the_others_even() {
        let truth: Vec<f64> =
            (0..1400).map(|row| f64::from(row) / 30.0 + if row < 22 { 0.0 } else { 0.0017 }).collect();
        let times: Vec<f64> = truth.iter().map(|time| format!("{time:.2e}").parse().unwrap()).collect();
        let (even, ..) = of_few_digits_past_losses(&times).unwrap();
        let worst = even.iter().zip(&truth).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        // A twentieth of what the last digit is worth.
        assert!(worst < 0.005, "{worst}");
    }

    /// A logger whose steps are uneven has no even times.
    #[test]
    fn times_that_are_uneven_throughout_stay() {
        let mut time_s = 0.0;
        let uneven = |idx: u32| {
            time_s += 0.02 + 0.03 * f64::from(idx.wrapping_mul(2_654_435_761) >> 16) / 65536.0;
            format!("{time_s:.2e}").parse().unwrap()
        };
        let times: Vec<f64> = (0..2000).map(uneven).collect();
        assert_eq!(of_few_digits_past_losses(&times), None);
    }
}
