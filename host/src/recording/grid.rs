//! Times that a program rounded: a video of 30 frames a second with times of 0.03, 0.07, 0.10 s.
//!
//! In: times in s. Out: the even ones that they were, where all of them say so. A time that is off by half a hundredth is a
//! bob that is off by some of its speed, which no model explains.

use super::median_step_s;

/// More digits are none that matter.
const MOST_DIGITS: i32 = 6;

/// Fewer times could be even by chance.
const FEWEST: usize = 50;

/// A reading of rounded numbers is off by this share of the last digit.
const READ_SHARE: f64 = 1e-3;

/// Takes the even times that rounded ones were.
pub(super) fn make_even(times_s: &mut [f64], notes: &mut Vec<String>) {
    let Some(digit_s) = last_digit(times_s) else { return };
    let step_s = median_step_s(times_s);
    if times_s.len() < FEWEST || digit_s > step_s {
        return;
    }
    let Some(even) = even(times_s, step_s, digit_s) else { return };
    let moved_s = times_s.iter().zip(&even).map(|(time, even)| (time - even).abs()).fold(0.0, f64::max);
    if moved_s < 10.0 * READ_SHARE * digit_s || moved_s < READ_SHARE * step_s {
        return;
    }
    let rate_hz = (even.len() - 1) as f64 / (even[even.len() - 1] - even[0]);
    notes.push(format!(
        "the times are rounded to {digit_s} s and fit even ones, {rate_hz:.4} a second on the average: these are taken"
    ));
    times_s.copy_from_slice(&even);
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
    let n = places.len() as f64;
    let (mean_place, mean_time) = (places.iter().sum::<f64>() / n, times_s.iter().sum::<f64>() / n);
    let across: f64 = places.iter().map(|place| (place - mean_place).powi(2)).sum();
    let along: f64 = places.iter().zip(times_s).map(|(place, time)| (place - mean_place) * (time - mean_time)).sum();
    let even: Vec<f64> = places.iter().map(|place| mean_time + along / across * (place - mean_place)).collect();
    let offs = times_s.iter().zip(&even).map(|(time, even)| time - even);
    let (low, high) = offs.fold((f64::MAX, f64::MIN), |(low, high), off| (low.min(off), high.max(off)));
    (high - low < (1.0 + 20.0 * READ_SHARE) * digit_s).then_some(even)
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
        }
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
