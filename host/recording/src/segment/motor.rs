//! Where a motor drives it, as the file says or as what it loses tells.

use super::half_swing::size_rad;
use super::{Cut, SURE};
use crate::carrier::Carrier;
use crate::drive::{self, Drive};
use crate::median;
use crate::number::significant;
use std::ops::Range;

/// After a motor is switched off a swing loses more than so many times what it lost before. Free ones that lose the
/// same energy from turn to turn, whatever their size, lose 2.4 times as much; with twice of it a motor would have to
/// hold them to a hundredth where they lose a tenth by themselves.
const LOST_AFTER_A_MOTOR: f64 = 4.0;

/// In the first half of the time behind a motor a swing loses half of what it loses in all of it, or more. With twice of this dry
/// friction alone would deny it; half was not tried.
const LOST_AT_ONCE: f64 = 0.25;

/// A motor holds a swing: where it had been so many times as large in the same stretch, it came down freely, and what it loses in the
/// end is a tail that a tracker follows in steps. A motor that begins beats up to twice as far as it then holds; with half of it no
/// motor would be seen that had begun so, with twice of it a tail of a fourth would still be cut off.
const FALLEN_BEFORE: f64 = 2.0;

/// Half swings before and after a motor is switched off that tell it; with half of them dry friction that changes with the place
/// would be a motor.
const STEADY_SWINGS: usize = 8;

/// So many tell it too where the loss is as many times larger as they are fewer. Of 188 recordings, most of them of strangers, that
/// cuts a motor from two more, of which one is driven to its end; with twice of it none of them is cut. Half was not tried.
const FEW_SWINGS: usize = 4;

/// Digits of a motor's numbers that a message shows.
const N_DIGITS: usize = 4;

impl Cut<'_> {
    /// Between the disturbances, and where no motor is on as far as the file tells.
    pub(super) fn undriven_stretches(&self) -> Vec<Range<usize>> {
        let drives = &self.recording.drives;
        match drives.is_empty() {
            true => self.stretches(),
            false => self.stretches().into_iter().flat_map(|range| drive::undriven(drives, range)).collect(),
        }
    }

    /// What is left when a motor in front is cut off. What a free swing loses from turn to turn depends on its size,
    /// which is the same just before and just after a moment: where it loses many times as much after, a motor was
    /// switched off.
    pub(super) fn left_alone(&self, part: &Range<usize>) -> Range<usize> {
        let half_swings = self.half_swings_in(part);
        let sizes: Vec<f64> = half_swings.iter().map(size_rad).collect();
        // All readings at a turn are rounded alike.
        let spread_rad = median(&mut half_swings.iter().map(|[from, _]| from.spread_rad).collect::<Vec<f64>>())
            .hypot(self.whole_noise.quantisation_rms);
        // Of more neighbours where there are many, which scatter less together; of hours of swings no more than it takes.
        let median_at = |idx: usize, n_beside: usize| median(&mut sizes[idx - n_beside..=idx + n_beside].to_vec());
        let time_s = |idx: usize| half_swings[idx][0].time_s;
        let larger = |largest: &mut f64, size: &f64| {
            *largest = largest.max(*size);
            Some(*largest)
        };
        let largest_before: Vec<f64> = sizes.iter().scan(0.0, larger).collect();
        let knee = |idx: usize| {
            let n_to_end = idx.min(sizes.len() - 1 - idx);
            let n_beside = (n_to_end / (STEADY_SWINGS + 1)).clamp(1, 4 * STEADY_SWINGS);
            let n = n_to_end - n_beside;
            let size_at = |idx: usize| median_at(idx, n_beside);
            let (lost_before, lost_after) = (size_at(idx - n) - size_at(idx), size_at(idx) - size_at(idx + n));
            // Of equal times: there may be gaps.
            let (before_s, after_s) = (time_s(idx) - time_s(idx - n), time_s(idx + n) - time_s(idx));
            let many_times = LOST_AFTER_A_MOTOR * (STEADY_SWINGS as f64 / n as f64).max(1.0);
            let more_rad = lost_after - many_times * lost_before.max(0.0) * after_s / before_s;
            // From the start on: a tracker that loses the last swings makes these small.
            let at_once = size_at(idx) - size_at(idx + n / 2) > LOST_AT_ONCE * lost_after;
            let was_held = largest_before[idx] < FALLEN_BEFORE * size_at(idx);
            let spread_rad = spread_rad * (3.0 / (2 * n_beside + 1) as f64).sqrt();
            let is_seen = more_rad > SURE * many_times * spread_rad && at_once && was_held;
            // What medians of many can't tell, the last turn as large as those tells.
            let held = (idx..idx + 2 * n_beside - 1).rev().find(|turn| median_at(*turn, 1) >= size_at(idx));
            is_seen.then_some((more_rad / after_s, held.unwrap_or(idx)))
        };
        // Beside each end stands a median of three.
        let knees = (FEW_SWINGS + 1..sizes.len().saturating_sub(FEW_SWINGS + 1)).filter_map(knee);
        let off = knees.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, idx)| self.recording.index_at(time_s(idx)));
        off.unwrap_or(part.start)..part.end
    }

    /// What the file says of a motor, or of what carries the pendulum: that it moves in the free swing, or beside it.
    pub(super) fn driven_in_words(&self, free: &Range<usize>) -> Vec<String> {
        let drives = &self.recording.drives;
        let inside = |drive: &Drive| {
            let (low, high, share) = drive.within(free)?;
            let (low, high) = (shown(low), shown(high));
            let moves =
                if low != high { format!("goes from {low} to {high}") } else { format!("is {low}, and not off,") };
            Some(format!(
                "doubtful: {} {moves} in {:.0} % of the free swing; where a motor drives it the friction \
                 can't be found: --from and --to choose a stretch in which it stands still",
                drive.column,
                (100.0 * share).ceil()
            ))
        };
        let beside = |drive: &Drive| {
            let mut on = self.asked.clone().filter(|idx| drive.moves_at(*idx));
            let first = on.next()?;
            let (from_s, to_s) = (self.times_s()[first], self.times_s()[on.next_back().unwrap_or(first)]);
            Some(format!(
                "{} moves between {from_s:.2} and {to_s:.2} s: the free swing is taken where it stands still",
                drive.column
            ))
        };
        let carried = |carrier: &Carrier| {
            let (low, high) = carrier.within(free, &self.angles_rad()[free.clone()])?;
            Some(format!(
                "doubtful: {} goes from {} to {} in the free swing: what carries the pendulum moves too, and the friction of \
                 both is found; hold it fast",
                carrier.column,
                shown(low),
                shown(high)
            ))
        };
        let of_drives = drives.iter().filter_map(|drive| inside(drive).or_else(|| beside(drive)));
        of_drives.chain(self.recording.carriers.iter().filter_map(carried)).collect()
    }
}

/// Whole numbers as they are, others with few digits.
pub(super) fn shown(number: f64) -> String {
    if number.fract() == 0.0 { number.to_string() } else { significant(number, N_DIGITS) }
}
