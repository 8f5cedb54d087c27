//! The swings of a cut, from one turning point to the next.

use super::Cut;
use crate::GAP_STEPS;
use crate::median;
use crate::turning::{ROUGH_FALL_SHARE, TurningPoint};
use std::ops::Range;

/// Half swings below this share of the largest say nothing of its order: a pendulum that sticks trembles, and what rests turns by chance.
const COUNTED_SHARE: f64 = 0.2;

/// Half swings change by more than this share of themselves, as a rule, where nothing swings: of 128 recordings of strangers those of
/// hands and of noise change by 0.36 to 2.4, the others by 0.23 at most, which is one of six steps of its sensor. With half of it that
/// one would be doubted, with twice of it two of the hands would not.
const DISORDER: f64 = 0.3;

/// From one turning point to the next.
pub(super) type HalfSwing<'a> = [&'a TurningPoint; 2];

impl Cut<'_> {
    pub(super) fn turns_in(&self, range: &Range<usize>) -> Vec<&TurningPoint> {
        self.turns.iter().filter(|turn| range.contains(&self.recording.index_at(turn.time_s))).collect()
    }

    /// From each turning point to the next where both are seen and it turns to the other side.
    pub(super) fn half_swings_in(&self, range: &Range<usize>) -> Vec<HalfSwing<'_>> {
        let inside = self.turns_in(range);
        let half_swings = inside.windows(2).map(|pair| [pair[0], pair[1]]);
        let is_whole =
            |[from, to]: &HalfSwing| from.is_maximum != to.is_maximum && self.is_seen(from) && self.is_seen(to);
        half_swings.filter(is_whole).collect()
    }

    /// Whether no hole in the rows hides where it turned: what stands at an end of one is no turning point.
    pub(super) fn is_seen(&self, turn: &TurningPoint) -> bool {
        let times_s = &self.times_s()[self.asked.start..];
        let first = times_s.partition_point(|time_s| *time_s < turn.time_s - self.width_s).saturating_sub(1);
        let last = times_s.partition_point(|time_s| *time_s <= turn.time_s + self.width_s).min(times_s.len() - 1);
        times_s[first..=last].windows(2).all(|pair| pair[1] - pair[0] < self.hole_s())
    }

    /// In a hole in the rows as long as this a turn may be hidden.
    pub(super) fn hole_s(&self) -> f64 {
        self.width_s.max(GAP_STEPS * self.recording.step_s())
    }

    /// Swings from one turning point to the next; a tremble is none, however often it turns.
    pub(super) fn count_swings(&self, range: &Range<usize>) -> usize {
        let largest_rad = sizes_rad(&self.turns.iter().collect::<Vec<_>>()).into_iter().fold(0.0, f64::max);
        sizes_rad(&self.turns_in(range)).iter().filter(|size| **size > ROUGH_FALL_SHARE * largest_rad).count()
    }

    /// The shortest and the longest half swing (s), where they come without order. One takes as long as the one before it to the same
    /// side, or less while large swings die away.
    pub(super) fn disorder_s(&self, range: &Range<usize>) -> Option<(f64, f64)> {
        let half_swings = self.half_swings_in(range);
        let largest_rad = half_swings.iter().map(size_rad).fold(0.0, f64::max);
        let counts = |half_swing: &&HalfSwing| size_rad(half_swing) > COUNTED_SHARE * largest_rad;
        let durations = half_swings.iter().filter(counts).map(|[from, to]| to.time_s - from.time_s);
        let durations_s: Vec<f64> = durations.collect();
        let changes_s: Vec<f64> = durations_s.windows(3).map(|three| three[2] - three[0]).collect();
        let limit_s = DISORDER * median(&mut durations_s.clone());
        let typical_s = median(&mut changes_s.iter().map(|change| change.abs()).collect::<Vec<_>>());
        log::debug!("half swings change by {:.3} of themselves", DISORDER * typical_s / limit_s);
        let (shortest, longest) =
            (durations_s.iter().copied().reduce(f64::min)?, durations_s.into_iter().reduce(f64::max)?);
        (typical_s > limit_s && changes_s.iter().any(|change| *change > limit_s)).then_some((shortest, longest))
    }

    /// The largest swing of a range, from one turning point to the next.
    pub(super) fn largest_swing(&self, range: &Range<usize>) -> Option<Range<usize>> {
        let inside = self.turns_in(range);
        let sizes = sizes_rad(&inside);
        let largest = (0..sizes.len()).max_by(|a, b| sizes[*a].total_cmp(&sizes[*b]))?;
        let index_of = |turn: &TurningPoint| self.recording.index_at(turn.time_s);
        Some(index_of(inside[largest])..index_of(inside[largest + 1]))
    }

    /// Over how much it swings at most, from one turning point to the next, rad.
    pub(super) fn largest_rad(&self, range: &Range<usize>) -> Option<f64> {
        sizes_rad(&self.turns_in(range)).into_iter().reduce(f64::max)
    }
}

/// Over how much it goes, rad.
pub(super) fn size_rad([from, to]: &HalfSwing) -> f64 {
    (to.angle_rad - from.angle_rad).abs()
}

/// From each turning point to the next, rad.
pub(super) fn sizes_rad(turns: &[&TurningPoint]) -> Vec<f64> {
    turns.windows(2).map(|pair| size_rad(&[pair[0], pair[1]])).collect()
}
