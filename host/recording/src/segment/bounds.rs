//! Where the free swing begins and ends within its stretch.

use super::start::Start;
use super::{Cut, MIN_TURNING_POINTS, SegmentOptions};
use std::ops::Range;

/// The free swing, and what lies about it.
pub(super) struct Bounds<'a> {
    /// How it begins.
    pub(super) start: Start,
    /// The first sample from there on at which it has left upright.
    pub(super) fallen: usize,
    /// The first sample from there on at which what carries it stands too, and its column, where it moved before.
    pub(super) carried: Option<(usize, &'a str)>,
    pub(super) free: Range<usize>,
    /// Where it hangs still behind it.
    pub(super) rest: Option<Range<usize>>,
}

impl<'a> Bounds<'a> {
    /// What the user says stands, whatever lies in it.
    pub(super) fn of(cut: &'a Cut, stretch: &Range<usize>, asked: &Range<usize>, options: &SegmentOptions) -> Self {
        let [is_begin_told, is_end_told] = [options.from_s, options.to_s].map(|limit_s| limit_s.is_some());
        let rest = if is_end_told { None } else { cut.rest(stretch) };
        let end = match &rest {
            Some(rest) => rest.start,
            None if is_end_told => asked.end,
            None => stretch.end,
        };
        let mut start = if is_begin_told { Start::at(cut, asked.start) } else { cut.start(stretch) };
        let fallen = if is_begin_told { start.free_idx } else { cut.fallen(start.free_idx, end) };
        let is_enough = |(idx, _): &(usize, &str)| cut.count_turns(&(*idx..end)) >= MIN_TURNING_POINTS;
        let carried = if is_begin_told { None } else { cut.carried_until(fallen, end).filter(is_enough) };
        let begin = carried.map_or(fallen, |(idx, _)| idx);
        let free = cut.between_hands(begin..end.max(begin), [!is_begin_told, !is_end_told && rest.is_none()]);
        if free.start > begin && begin == start.free_idx {
            start.moved_to(free.start, cut.times_s()[free.start]);
        }
        Self { start, fallen, carried, free, rest }
    }
}
