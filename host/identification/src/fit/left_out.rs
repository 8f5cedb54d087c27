//! Swings cut into blocks, every third of which is left out: what is fitted to the others is asked for these.

use super::phase::parted_at;
use super::problem::Problem;
use std::ops::Range;

/// Every so many-th block is left out at a time.
pub(super) const FOLDS: usize = 3;

/// Fewer blocks are no basis for a choice: each third has to show all speeds.
pub(super) const FEWEST: usize = 6;

/// Blocks are of two periods, or of one where the swings have fewer than so many.
const PERIODS_FOR_TWO: usize = 24;

/// Periods in a block, at least, of swings with so many together.
pub(super) fn least_periods(n_periods: usize) -> usize {
    if n_periods < PERIODS_FOR_TWO { 1 } else { 2 }
}

/// The blocks of a swing with samples behind these crossings; where it stops, no linearisation is to be trusted.
pub(super) fn ranges(
    on: &Problem,
    swing_idx: usize,
    crossings: &[usize],
    periods: usize,
    n_samples: usize,
) -> Vec<Range<usize>> {
    let mut ranges = cut(crossings, periods, n_samples);
    if on.swings[swing_idx].comes_to_rest() {
        ranges.pop();
    }
    ranges
}

/// Ranges of so many periods; what is before the first and behind the last belongs to these.
fn cut(crossings: &[usize], periods: usize, n_samples: usize) -> Vec<Range<usize>> {
    let mut bounds: Vec<usize> = crossings.iter().copied().step_by(periods).skip(1).collect();
    // The last one may be short, and holds the rest.
    bounds.pop();
    parted_at(bounds.into_iter(), n_samples)
}
