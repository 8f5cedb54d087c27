//! Where a swing turns and where it passes its middle: a quarter of a period apart, however slow it becomes.

use std::ops::Range;

/// Where values go upward through the middle: through zero, or halfway where a zero that drifts has carried a swing beyond
/// it. A rise by less than `seen` is none.
pub(super) fn upward_crossings(values: &[f64], seen: f64) -> Vec<usize> {
    let passes = |i: &usize, level: f64| values[i - 1] < level && values[*i] >= level;
    let halfway = |rise: Range<usize>| {
        let level = 0.5 * (values[rise.start] + values[rise.end]);
        (rise.start + 1..=rise.end).find(|i| passes(i, level))
    };
    // Where the values begin they need not turn.
    let is_beyond = |rise: &Range<usize>| rise.start > 0 && (values[rise.start] >= 0.0 || values[rise.end] < 0.0);
    let beyond = rises(values, seen).into_iter().filter(is_beyond).filter_map(halfway);
    let mut crossings: Vec<usize> = (1..values.len()).filter(|i| passes(i, 0.0)).chain(beyond).collect();
    crossings.sort_unstable();
    crossings
}

/// From a lowest value to the next highest one, where at least so much lies between them and behind it.
fn rises(values: &[f64], least: f64) -> Vec<Range<usize>> {
    let mut found = Vec::new();
    let (mut low, mut high, mut is_rising) = (0, 0, false);
    for (i, value) in values.iter().enumerate() {
        if is_rising {
            high = if *value > values[high] { i } else { high };
            if values[high] - value > least {
                found.push(low..high);
                (low, is_rising) = (i, false);
            }
        } else {
            low = if *value < values[low] { i } else { low };
            if value - values[low] > least {
                (high, is_rising) = (i, true);
            }
        }
    }
    found
}

/// Where values turn and where they pass the middle, in order. A turn that the values end before is none.
pub(super) fn quarters(values: &[f64], seen: f64) -> Vec<usize> {
    let negated: Vec<f64> = values.iter().map(|value| -value).collect();
    let upward = upward_crossings(values, seen).into_iter().map(|i| (i, 1.0));
    let mut crossings: Vec<(usize, f64)> =
        upward.chain(upward_crossings(&negated, seen).into_iter().map(|i| (i, -1.0))).collect();
    crossings.sort_unstable_by_key(|(i, _)| *i);
    let (Some(first), Some(last)) = (crossings.first(), crossings.last()) else { return Vec::new() };
    // Upward is followed by a highest value and preceded by a lowest one.
    let turn = |range: Range<usize>, sign: f64| {
        range.max_by(|a, b| (sign * values[*a]).total_cmp(&(sign * values[*b])).then(b.cmp(a)))
    };
    let before = turn(0..first.0, -first.1);
    let behind = turn(last.0..values.len(), last.1).filter(|i| i + 1 < values.len());
    let between = crossings.windows(2).filter(|pair| pair[0].1 != pair[1].1);
    let between = between.filter_map(|pair| turn(pair[0].0..pair[1].0, pair[0].1));
    let mut found: Vec<usize> = before.into_iter().chain(between).chain(behind).collect();
    found.extend(crossings.iter().map(|(i, _)| *i));
    found.sort_unstable();
    found.dedup();
    found
}

/// Quarters of a period.
const A_PERIOD: usize = 4;

/// Ranges of so many periods; the last one also holds what is left, as a rest, which is no swing.
pub(super) fn windows(quarters: &[usize], periods: usize, n_samples: usize) -> Vec<Range<usize>> {
    let n_windows = (quarters.len().saturating_sub(1) / (A_PERIOD * periods)).max(1);
    parted_at((1..n_windows).map(|k| quarters[A_PERIOD * periods * k]), n_samples)
}

/// So many samples, parted before each of these.
pub(super) fn parted_at(inner: impl Iterator<Item = usize>, n_samples: usize) -> Vec<Range<usize>> {
    let bounds: Vec<usize> = std::iter::once(0).chain(inner).chain([n_samples]).collect();
    bounds.windows(2).map(|pair| pair[0]..pair[1]).filter(|range| !range.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    /// Periods of 100 samples that begin at a phase.
    fn swing(begin: f64, periods: f64) -> Vec<f64> {
        let n_samples = (100.0 * periods) as usize;
        (0..n_samples).map(|i| (begin + TAU * (i as f64 + 0.5) / 100.0).cos()).collect()
    }

    #[test]
    fn a_period_has_four_quarters_wherever_it_begins() {
        for begin in [0.0, 0.2 * PI, 0.7 * PI, 1.1 * PI, 1.8 * PI] {
            let found = quarters(&swing(begin, 3.0), 0.01);
            assert!((12..=13).contains(&found.len()), "{begin}: {found:?}");
            let inner = &found[1..found.len() - 1];
            assert!(inner.windows(2).all(|pair| (24..=26).contains(&(pair[1] - pair[0]))), "{begin}: {found:?}");
        }
    }

    #[test]
    fn a_turn_that_the_values_end_before_is_none() {
        let upward = |n: usize| (0..n).map(|i| (TAU * (i as f64 - 50.5) / 100.0).sin()).collect::<Vec<f64>>();
        assert_eq!(quarters(&upward(60), 0.01).last(), Some(&51));
        assert_eq!(quarters(&upward(90), 0.01).last(), Some(&75));
    }

    #[test]
    fn a_swing_beyond_zero_has_quarters_too() {
        let beyond: Vec<f64> = swing(0.0, 4.0).into_iter().map(|value| value + 3.0).collect();
        assert!(quarters(&beyond, 0.01).len() >= 10);
    }

    #[test]
    fn as_many_windows_as_whole_periods_and_none_of_a_rest() {
        let mut values = swing(0.0, 6.6);
        let last = *values.last().unwrap();
        values.extend([last; 1000]);
        let found = windows(&quarters(&values, 0.01), 1, values.len());
        assert_eq!(found.len(), 6);
        assert_eq!((found[0].start, found[5].end), (0, values.len()));
        assert_eq!(windows(&quarters(&values, 0.01), 3, values.len()).len(), 2);
        assert_eq!(windows(&[], 1, 50).len(), 1);
    }
}
