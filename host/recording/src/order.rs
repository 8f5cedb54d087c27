//! A few rows out of the order of time, while the clock went on: written late, or with a wrong time.
//!
//! In: times in the order of the rows. Out: which rows to keep, so that the fewest are left out (a longest increasing
//! subsequence). None where a clock was set back and counts on from there: then two recordings stand in one file.

use super::median_step_s;

/// Up to one row, and of long files one of so many more, may be out of order. Half and twice of it come to the same: of 90
/// recordings one has two such rows in 18,000, and three a clock that was set back.
const ROWS_A_STRAY: usize = 100;

/// A step is ordinary up to so many usual ones: two are a row that is missing.
const ORDINARY: f64 = 1.5;

/// In so many rows the clock stands or nearly does, at least: fewer are a clock that was held up. Seen in one file, of 1,000 in
/// 27,000 rows, and in two simulated ones, where 5 and 9 of 700 such rows share their time; half and twice come to the same there.
const FEWEST_TWINS: usize = 10;

/// It nearly stands where it goes on by less than this share of its usual step: an uneven clock then does so as easily by less
/// than its last digit. Half and twice come to the same in those three.
const NEARLY_STANDS: f64 = 0.25;

/// One of so many rows, at most: of more it is a clock of too few digits, and half of it or twice come to the same there.
const ROWS_A_TWIN: usize = 10;

/// Which rows to keep, where those that are left out are few and the clock goes on around them; what is no row of its own
/// (`is_doubled`) counts for nothing and is kept.
pub(super) fn kept(times: &[f64], is_doubled: impl Fn(usize) -> bool) -> Option<Vec<bool>> {
    let rows: Vec<usize> = (0..times.len()).filter(|idx| !is_doubled(*idx)).collect();
    let own: Vec<f64> = rows.iter().map(|idx| times[*idx]).collect();
    let rising = longest_rise(&own);
    let n_strays = own.len() - rising.len();
    let step = median_step_s(&rising.iter().map(|idx| own[*idx]).collect::<Vec<_>>());
    let begins_and_ends = rising.first() == Some(&0) && rising.last() == own.len().checked_sub(1).as_ref();
    let is_bridged = |pair: &[usize]| pair[1] == pair[0] + 1 || goes_on(&own[pair[0]..=pair[1]], step);
    if n_strays > 1 + own.len() / ROWS_A_STRAY || !begins_and_ends || !rising.windows(2).all(is_bridged) {
        return None;
    }
    let mut kept = vec![true; times.len()];
    rising.windows(2).flat_map(|pair| pair[0] + 1..pair[1]).for_each(|stray| kept[rows[stray]] = false);
    Some(kept)
}

/// Which rows to keep, where the time stands for a row now and then and never for two, and never goes back: a sensor that
/// writes whenever it moves, beside its clock, or uneven times of too few digits. A logger of even steps that loses its clock
/// has the same time at one place.
pub(super) fn first_of_twins(times: &[f64]) -> Option<Vec<bool>> {
    let stands: Vec<bool> = times.windows(2).map(|pair| pair[1] == pair[0]).collect();
    let n = stands.iter().filter(|stands| **stands).count();
    let least = NEARLY_STANDS * median_step_s(times);
    let n_nearly = times.windows(2).filter(|pair| pair[1] - pair[0] < least).count();
    let goes_on =
        times.windows(2).all(|pair| pair[1] >= pair[0]) && stands.windows(2).all(|pair| !(pair[0] && pair[1]));
    let are_some = n_nearly >= FEWEST_TWINS && (1..=times.len() / ROWS_A_TWIN).contains(&n);
    (goes_on && are_some).then(|| std::iter::once(true).chain(stands.into_iter().map(|stands| !stands)).collect())
}

/// From a row over strays to the next one: no ordinary step leads to the strays or away from them. Where one does, the
/// clock was set.
fn goes_on(times: &[f64], step: f64) -> bool {
    let is_ordinary = |pair: &[f64]| pair[1] > pair[0] && pair[1] - pair[0] <= ORDINARY * step;
    !is_ordinary(&times[..2]) && !is_ordinary(&times[times.len() - 2..])
}

/// Places of a longest strictly rising selection (M. L. Fredman, Discrete Math. 11 (1975) 29).
fn longest_rise(values: &[f64]) -> Vec<usize> {
    // Of each length the selection that ends lowest, by its last place.
    let mut ends: Vec<usize> = Vec::new();
    let mut before = vec![usize::MAX; values.len()];
    for (idx, value) in values.iter().enumerate() {
        let length = ends.partition_point(|end| values[*end] < *value);
        if length > 0 {
            before[idx] = ends[length - 1];
        }
        if length == ends.len() {
            ends.push(idx);
        } else if values[ends[length]] > *value {
            ends[length] = idx;
        }
    }
    let mut rise = Vec::new();
    let mut idx = ends.last().copied().unwrap_or(usize::MAX);
    while let Some(next) = before.get(idx) {
        rise.push(idx);
        idx = *next;
    }
    rise.reverse();
    rise
}

#[cfg(test)]
mod tests {
    use super::*;

    fn left_out(times: &[f64]) -> Option<Vec<f64>> {
        let kept = kept(times, |_| false)?;
        Some(times.iter().zip(kept).filter(|(_, kept)| !kept).map(|(time, _)| *time).collect())
    }

    #[test]
    fn a_row_behind_or_ahead_of_its_time_is_left_out() {
        assert_eq!(left_out(&[1.0, 2.0, 3.0, 2.0, 5.0, 6.0]), Some(vec![2.0]));
        assert_eq!(left_out(&[1.0, 2.0, 3.0, 99.0, 5.0, 6.0]), Some(vec![99.0]));
        assert_eq!(left_out(&[1.0, 2.0, 3.0, 3.0, 5.0, 6.0]), Some(vec![3.0]));
        assert_eq!(left_out(&[1.0, 2.0, 3.0]), Some(vec![]));
    }

    #[test]
    fn of_rows_that_share_their_time_now_and_then_the_first_is_kept() {
        // Every 20th time stands there again, or twice again, or but for a few rows.
        let times =
            |again: u32| (0..400_u32).flat_map(move |row| (0..=again * u32::from(row % 20 == 7)).map(move |_| row));
        let kept = |times: &[f64]| first_of_twins(times).map(|kept| kept.iter().filter(|kept| **kept).count());
        let of = |again: u32| times(again).map(f64::from).collect::<Vec<f64>>();
        assert_eq!([kept(&of(0)), kept(&of(1)), kept(&of(2)), kept(&of(1)[..150])], [None, Some(400), None, None]);
        let back: Vec<f64> = of(1).into_iter().chain([3.0]).collect();
        assert_eq!(kept(&back), None);
        // Uneven times, of which two are the same to the last digit; and even ones.
        let rows = || (0..400_u32).map(f64::from);
        let ahead = |time: &mut f64, row: f64| Some(std::mem::replace(time, *time + 1.0 + 0.999 * (1.7 * row).sin()));
        let uneven: Vec<f64> = rows().scan(0.0, ahead).map(|time| (200.0 * time).round() / 200.0).collect();
        let n_twins = uneven.windows(2).filter(|pair| pair[0] == pair[1]).count();
        assert!((1..FEWEST_TWINS).contains(&n_twins), "no case: {n_twins}");
        assert_eq!(kept(&uneven), Some(400 - n_twins));
        assert_eq!(kept(&rows().map(|row| row - f64::from(u8::from(row > 200.0))).collect::<Vec<_>>()), None);
    }

    #[test]
    fn a_clock_that_was_set_back_or_many_rows_are_none() {
        let back: Vec<f64> = (0..300).map(|row| f64::from(row) - if row > 150 { 2.4 } else { 0.0 }).collect();
        assert_eq!(left_out(&back), None);
        let twice: Vec<f64> = (0..300).map(|row| f64::from(row % 150)).collect();
        assert_eq!(left_out(&twice), None);
        assert_eq!(left_out(&[1.0, 2.0, 3.0, 4.0, 1.0]), None);
        assert_eq!(left_out(&[1.0, 2.0, 3.0, 3.0, 4.0, 5.0]), None);
        let often: Vec<f64> = (0..300).map(|row| f64::from(if row % 30 == 9 { row - 4 } else { row })).collect();
        assert_eq!(left_out(&often), None);
    }
}
