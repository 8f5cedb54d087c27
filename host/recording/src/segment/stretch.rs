//! The stretch that is swung freely, and the rest at its end.

use super::super::carrier::Carrier;
use super::super::chance;
use super::super::drive::{self, Drive};
use super::super::turning::{ROUGH_FALL_SHARE, TurningPoint};
use super::super::{Measured, median};
use super::start::BEGINS_TO_MOVE;
use super::{Cut, MIN_TURNING_POINTS, STILL_SPREADS, SegmentError, mean};
use crate::noise::{GAP_STEPS, rms_about_line};
use crate::number::significant;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::Range;

/// Half swings at the end that may be too small to be seen.
const N_UNSEEN: f64 = 3.0;

/// Digits of a motor's numbers that a message shows.
const N_DIGITS: usize = 4;

/// Swings from turn to turn below this many noise rms are too uncertain to say that they grew.
const GROWTH_NOISE: f64 = 20.0;

/// Standard deviations that a growth or a motor wants.
const SURE: f64 = 6.0;

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

/// A swing that goes on turns again within one half swing; with twice of it the rest after a swing would often be lost.
const HUNG_HALF_SWINGS: f64 = 2.0;

/// A hand that takes it from rest is seen by its acceleration within so many half swings of where it begins: with half and with
/// twice of it the same are cut of 264 simulated recordings, in 53 of which a hand takes it again.
const TAKEN_HALF_SWINGS: f64 = 2.0;

/// And scatters by less than so many times the noise; with half of it chance would deny it, with twice of it a slow hand
/// would pass for it.
const HUNG_NOISES: f64 = 1.5;

/// So many swings beside the free ones are worth a word.
pub(super) const WORTH_A_LOOK: usize = 2 * MIN_TURNING_POINTS;

/// Quality factor of the best clocks; with half of it a clock would be doubted, with twice of it a motor that holds its swing
/// to a thousandth in thirty periods would not.
const BEST_QUALITY: f64 = 2e4;

/// Half swings in each third, at least, before it is said that they don't become smaller.
const FADING_SWINGS: usize = 6;

/// Of fewer half swings it is said where they grow by more than this share, because a top between few samples is off by
/// 4 %. With half of it chance would do so at eight samples a period; with twice of it a motor that adds 1 % each time
/// is seen after 20 half swings and not after 10.
const GROWN_SHARE: f64 = 0.1;

/// Does a half swing lie beyond a right angle, with no lowest point on its way? Whole turns apart it hangs as well.
fn is_about_upright(from: &TurningPoint, to: &TurningPoint) -> bool {
    let is_high = |turn: &TurningPoint| (turn.angle_rad - TAU * (turn.angle_rad / TAU).round()).abs() > FRAC_PI_2;
    let [low, high] = if from.is_maximum { [to, from] } else { [from, to] }.map(|turn| turn.angle_rad / TAU);
    from.is_maximum != to.is_maximum && is_high(from) && is_high(to) && low.ceil() > high
}

impl Cut<'_> {
    /// What is swung freely: of what was left alone long enough to tell, what becomes smaller and has the most swings.
    pub(super) fn undisturbed(&self) -> Result<Range<usize>, SegmentError> {
        let worth = |part: &Range<usize>| {
            (self.count_turns(part) >= MIN_TURNING_POINTS, self.fades(part), self.count_swings(part))
        };
        let best = |stretches: Vec<Range<usize>>| self.parts_of(stretches).max_by_key(worth).unwrap_or(0..0);
        let mut part = best(self.undriven_stretches());
        if self.count_turns(&part) < MIN_TURNING_POINTS {
            part = best(self.stretches());
        }
        match self.count_turns(&part) {
            n if n >= MIN_TURNING_POINTS => Ok(part),
            n_turning_points => Err(self.grows().unwrap_or_else(|| SegmentError::TooFewSwings {
                n_turning_points,
                duration_s: self.duration_s(&part),
            })),
        }
    }

    /// Between disturbances, between growths, and behind a motor.
    pub(super) fn parts_left_alone(&self) -> impl Iterator<Item = Range<usize>> {
        self.parts_of(self.undriven_stretches())
    }

    /// Of these stretches what lies between growths and behind a motor.
    fn parts_of(&self, stretches: Vec<Range<usize>>) -> impl Iterator<Item = Range<usize>> {
        let hanging = stretches.into_iter().flat_map(|range| self.hanging_parts(range));
        let parts = hanging.flat_map(|range| self.releases_in(range)).flat_map(|range| self.fading_parts(range));
        parts.map(|part| self.left_alone(&part)).map(|part| part.start..self.taken_from_rest(&part).unwrap_or(part.end))
    }

    /// Between the disturbances, and where no motor is on as far as the file tells.
    fn undriven_stretches(&self) -> Vec<Range<usize>> {
        let drives = &self.recording.drives;
        match drives.is_empty() {
            true => self.stretches(),
            false => self.stretches().into_iter().flat_map(|range| drive::undriven(drives, range)).collect(),
        }
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

    /// Index ranges between the disturbances.
    pub(super) fn stretches(&self) -> Vec<Range<usize>> {
        if self.states.is_empty() {
            return vec![self.asked.clone()];
        }
        let n_states = self.states.len();
        let mut stretches = Vec::new();
        let mut start = None;
        for state_idx in 0..=n_states {
            let is_free = self.disturbed.get(state_idx).is_some_and(|disturbed| !disturbed);
            match (start, is_free) {
                (None, true) => start = Some(state_idx),
                (Some(from), false) => {
                    stretches.push(self.index_range(from, state_idx - 1));
                    start = None;
                }
                _ => {}
            }
        }
        stretches
    }

    /// Samples between two states; the ends of the recording belong to the first and the last.
    fn index_range(&self, first: usize, last: usize) -> Range<usize> {
        let start = match first {
            0 => self.asked.start,
            _ => self.recording.index_at(self.states[first].time_s),
        };
        let end = match last + 1 {
            n if n == self.states.len() => self.asked.end,
            _ => self.recording.index_at(self.states[last].time_s),
        };
        start..end.max(start)
    }

    /// What lies between the stretches about upright, in order: a pendulum that is left alone falls from there and passes its lowest
    /// point before it turns again, so that a motor holds what turns without.
    pub(super) fn hanging_parts(&self, range: Range<usize>) -> Vec<Range<usize>> {
        let mut parts = Vec::new();
        let mut start = range.start;
        let is_angle = self.recording.measured() == Measured::Angle;
        for pair in self.turns_in(&range).windows(2).filter(|pair| is_angle && is_about_upright(pair[0], pair[1])) {
            let [from, to] = [pair[0], pair[1]].map(|turn| self.recording.index_at(turn.time_s));
            parts.push(start..from.max(start));
            start = to;
        }
        parts.push(start..range.end);
        parts
    }

    /// What lies between the growths, in order: a free swing never grows, so that somebody pushed there.
    fn fading_parts(&self, range: Range<usize>) -> Vec<Range<usize>> {
        let half_swings = self.half_swings_in(&range);
        let mut parts = Vec::new();
        let mut start = range.start;
        for pair in half_swings.windows(2) {
            let Some(limit_rad) = self.growth(&pair[0], &pair[1]) else { continue };
            let pushed = self.recording.index_at(pair[0][1].time_s)..self.recording.index_at(pair[1][1].time_s);
            let is_beyond = |idx: &usize| (self.angles_rad()[*idx] - pair[1][0].angle_rad).abs() > limit_rad;
            let beyond = pushed.clone().find(is_beyond).unwrap_or(pushed.start);
            let end = if self.hung(&(pushed.start..beyond)) { beyond } else { pushed.start };
            parts.push(start..end.max(start));
            start = pushed.end;
        }
        let last = start..range.end;
        parts.push(start..self.lifted_at(&last).unwrap_or(range.end));
        parts
    }

    /// Where the free part ends if, behind its last turning point, it goes further to either side than its last swing: a hand
    /// lifts it that has not turned yet.
    fn lifted_at(&self, part: &Range<usize>) -> Option<usize> {
        let [.., before, last] = self.turns_in(part)[..] else { return None };
        if !(self.is_seen(before) && self.is_seen(last)) {
            return None;
        }
        let size_rad = (last.angle_rad - before.angle_rad).abs();
        let grown_rad = (1.0 + GROWN_SHARE) * size_rad;
        let limit_rad = self.limit_of_growth(grown_rad, [before, last]).max(GROWTH_NOISE * self.noise_rms_rad);
        let from = |turn: &TurningPoint, idx: usize| (self.angles_rad()[idx] - turn.angle_rad).abs();
        let turned = self.recording.index_at(last.time_s);
        let beyond = (turned..part.end).find(|idx| from(before, *idx).max(from(last, *idx)) > limit_rad)?;
        Some(if self.hung(&(turned..beyond)) { beyond } else { turned })
    }

    /// Did it hang still between its last turn and where it was pushed? That tells where it stopped.
    fn hung(&self, between: &Range<usize>) -> bool {
        let third = between.len() / 3;
        let middle = &self.angles_rad()[between.start + third..between.end - third];
        self.duration_s(between) > HUNG_HALF_SWINGS * self.half_swing_s
            && rms_about_line(middle) < HUNG_NOISES * self.noise_rms_rad
            && (middle[0] - middle[middle.len() - 1]).abs() < SURE * self.noise_rms_rad
    }

    /// That the swings of what was asked for grow more often than not, where none of them can be free.
    fn grows(&self) -> Option<SegmentError> {
        let half_swings = self.half_swings_in(&self.asked);
        let pairs = || half_swings.windows(2);
        let growing: Vec<_> = pairs().filter(|pair| self.growth(&pair[0], &pair[1]).is_some()).collect();
        let (first, last) = (growing.first()?, growing.last()?);
        let (from, to) = (size_rad(&first[0]) / 2.0, size_rad(&last[1]) / 2.0);
        let unit = self.recording.measured().unit();
        (2 * growing.len() > pairs().len()).then_some(SegmentError::Grows { from, to, unit })
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
    fn is_seen(&self, turn: &TurningPoint) -> bool {
        let times_s = &self.times_s()[self.asked.start..];
        let first = times_s.partition_point(|time_s| *time_s < turn.time_s - self.width_s).saturating_sub(1);
        let last = times_s.partition_point(|time_s| *time_s <= turn.time_s + self.width_s).min(times_s.len() - 1);
        times_s[first..=last].windows(2).all(|pair| pair[1] - pair[0] < self.hole_s())
    }

    /// In a hole in the rows as long as this a turn may be hidden.
    pub(super) fn hole_s(&self) -> f64 {
        self.width_s.max(GAP_STEPS * self.recording.step_s())
    }

    /// How far from where the second of two half swings begins a free swing reaches at most (rad), where it ends beyond.
    pub(super) fn growth(&self, before: &HalfSwing, after: &HalfSwing) -> Option<f64> {
        let limit_rad = self.limit_of_growth(size_rad(before), [before[0], after[1]]);
        let after_rad = size_rad(after);
        (after_rad > GROWTH_NOISE * self.noise_rms_rad && after_rad > limit_rad).then_some(limit_rad)
    }

    /// How far a free swing goes at most where the one before went so far, rad.
    fn limit_of_growth(&self, before_rad: f64, turns: [&TurningPoint; 2]) -> f64 {
        before_rad * 1.02 + SURE * (turns[0].spread_rad.hypot(turns[1].spread_rad) + self.noise_rms_rad)
    }

    /// What is left when a motor in front is cut off. What a free swing loses from turn to turn depends on its size,
    /// which is the same just before and just after a moment: where it loses many times as much after, a motor was
    /// switched off.
    fn left_alone(&self, part: &Range<usize>) -> Range<usize> {
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

    /// Swings from one turning point to the next; a tremble is none, however often it turns.
    pub(super) fn count_swings(&self, range: &Range<usize>) -> usize {
        let largest_rad = sizes_rad(&self.turns.iter().collect::<Vec<_>>()).into_iter().fold(0.0, f64::max);
        sizes_rad(&self.turns_in(range)).iter().filter(|size| **size > ROUGH_FALL_SHARE * largest_rad).count()
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

    pub(super) fn turns_in(&self, range: &Range<usize>) -> Vec<&TurningPoint> {
        self.turns.iter().filter(|turn| range.contains(&self.recording.index_at(turn.time_s))).collect()
    }

    /// What swings beside the free part, where it is worth a look.
    pub(super) fn other_swings(&self, free: &Range<usize>) -> Vec<Range<usize>> {
        let is_apart = |range: &Range<usize>| range.end <= free.start || range.start >= free.end;
        let is_worth = |range: &Range<usize>| is_apart(range) && self.count_swings(range) >= WORTH_A_LOOK;
        self.parts_left_alone().filter(is_worth).collect()
    }

    /// The one with the most swings.
    pub(super) fn longest_of(&self, ranges: Vec<Range<usize>>) -> Option<Range<usize>> {
        ranges.into_iter().max_by_key(|range| self.count_swings(range))
    }

    /// Do the swings become smaller, as without a motor they must? From the first and the last third of many.
    pub(super) fn fades(&self, free: &Range<usize>) -> bool {
        let turns = self.turns_in(free);
        let Some(Thirds { n, early, late, n_between }) = Thirds::of(&turns) else { return true };
        if n < FADING_SWINGS {
            let spread_rad = median(&mut turns.iter().map(|turn| turn.spread_rad).collect::<Vec<f64>>());
            return late < early * (1.0 + GROWN_SHARE) + SURE * spread_rad;
        }
        (early / late).ln() > n_between * PI / (2.0 * BEST_QUALITY)
    }

    /// From what to what amplitude the swings grow, if they do clearly.
    pub(super) fn grown(&self, free: &Range<usize>) -> Option<(f64, f64)> {
        let Thirds { early, late, .. } = Thirds::of(&self.turns_in(free))?;
        (late > early * (1.0 + GROWN_SHARE)).then_some((early / 2.0, late / 2.0))
    }

    /// Hanging still at the end: from some half swings after the last motion that can be seen, because the very last
    /// ones may be smaller than the noise, or hidden in the play of the sensor.
    pub(super) fn rest(&self, stretch: &Range<usize>) -> Option<Range<usize>> {
        self.still_after(self.last_motion(stretch)?.idx, N_UNSEEN, stretch.end)
    }

    /// The part at the end that tells of the noise: fewer may be unseen where each swing is so much smaller than the one before.
    pub(super) fn quiet_end(&self, stretch: &Range<usize>) -> Option<Range<usize>> {
        let last = self.last_motion(stretch)?;
        let n_unseen = self.lost_each_half_swing_rad(stretch).map_or(N_UNSEEN, |lost_rad| last.limit_rad / lost_rad);
        self.still_after(last.idx, n_unseen.min(N_UNSEEN), stretch.end)
    }

    fn still_after(&self, last_motion: usize, n_unseen: f64, end: usize) -> Option<Range<usize>> {
        let start_s = self.times_s()[last_motion] + n_unseen * self.half_swing_s;
        let still = self.recording.index_at(start_s)..end;
        (still.start < still.end && still.len() >= self.n_in(self.half_swing_s / 4.0)).then_some(still)
    }

    /// The last motion of a stretch that can be seen.
    fn last_motion(&self, stretch: &Range<usize>) -> Option<LastMotion> {
        let after = self.last_turn(stretch)?..stretch.end;
        let angles_rad = &self.angles_rad()[after.clone()];
        let n_window = self.n_in(self.half_swing_s / 4.0);
        let n_final = (4 * n_window).max(angles_rad.len() / 4).min(angles_rad.len());
        let final_rad = mean(&angles_rad[angles_rad.len() - n_final..]);
        // Among the windows of an hour some are further off by chance.
        let spreads = STILL_SPREADS.max(chance::reach((angles_rad.len() / n_window).max(1) as f64));
        let limit_rad = spreads * self.noise_rms_rad / (n_window as f64).sqrt();
        let moves = |window: &[f64]| (mean(window) - final_rad).abs() > limit_rad;
        let last_motion = angles_rad.windows(n_window).rposition(moves).map_or(0, |idx| idx + n_window);
        Some(LastMotion { idx: (after.start + last_motion).min(stretch.end - 1), limit_rad })
    }

    /// By how much the amplitude falls from one half swing to the next in the last ones of a stretch, if it does.
    fn lost_each_half_swing_rad(&self, stretch: &Range<usize>) -> Option<f64> {
        let turns = self.turns_in(stretch);
        let [.., a, b, c] = turns[..] else { return None };
        let ranges =
            [a, b, c].windows(2).map(|pair| (pair[1].angle_rad - pair[0].angle_rad).abs()).collect::<Vec<f64>>();
        // From one way to the next both ends come nearer.
        Some((ranges[0] - ranges[1]) / 2.0).filter(|lost_rad| *lost_rad > 0.0)
    }

    /// The sample at the last turning point of a stretch.
    fn last_turn(&self, stretch: &Range<usize>) -> Option<usize> {
        self.turns.iter().rev().map(|turn| self.recording.index_at(turn.time_s)).find(|idx| stretch.contains(idx))
    }

    /// Where a hand takes it that hung still: behind a last turn it is still for longer than a swing turns, and leaves that
    /// place just before something is seen to move it. A hand begins so gently that its acceleration shows late.
    fn taken_from_rest(&self, stretch: &Range<usize>) -> Option<usize> {
        if stretch.end == self.asked.end {
            return None;
        }
        let is_further = |left_rad: f64, later_rad: Option<f64>| later_rad.is_none_or(|later| later / left_rad > 1.0);
        let still_behind = |turn: &&TurningPoint| {
            let hangs = self.recording.index_at(turn.time_s + N_UNSEEN * self.half_swing_s)..stretch.end;
            (hangs.len() > self.n_still_window()).then(|| self.still_from(hangs, is_further))
        };
        let is_near = |still: &Range<usize>| {
            let more_s = self.duration_s(&(still.end..stretch.end));
            still.end < stretch.end && more_s < TAKEN_HALF_SWINGS * self.half_swing_s
        };
        let is_long = |still: &Range<usize>| self.duration_s(still) > HUNG_HALF_SWINGS * self.half_swing_s;
        // Noise turns too: of what hangs still the last turn may be one of it.
        let turned = self.turns_in(stretch).into_iter().rev();
        let still = turned.filter_map(|turn| still_behind(&turn)).take_while(is_near).find(is_long)?;
        Some(still.end - self.n_in(BEGINS_TO_MOVE * self.half_swing_s).min(still.len()))
    }
}

/// Where motion is last seen.
struct LastMotion {
    idx: usize,
    /// How far means over a quarter of a half swing may be off where it hangs still, rad.
    limit_rad: f64,
}

/// How far the swings of the first and the last third go from turn to turn, as a rule.
struct Thirds {
    n: usize,
    early: f64,
    late: f64,
    /// Half swings from the one third to the other.
    n_between: f64,
}

impl Thirds {
    /// `None` where there are none.
    fn of(turns: &[&TurningPoint]) -> Option<Self> {
        let mut sizes = sizes_rad(turns);
        let n = sizes.len() / 3;
        let n_between = (sizes.len() - n) as f64;
        let late = median(&mut sizes.split_off(sizes.len() - n));
        (n > 0).then(|| Self { n, early: median(&mut sizes[..n]), late, n_between })
    }
}

/// Whole numbers as they are, others with few digits.
pub(super) fn shown(number: f64) -> String {
    if number.fract() == 0.0 { number.to_string() } else { significant(number, N_DIGITS) }
}

/// From one turning point to the next.
pub(super) type HalfSwing<'a> = [&'a TurningPoint; 2];

fn size_rad([from, to]: &HalfSwing) -> f64 {
    (to.angle_rad - from.angle_rad).abs()
}

/// From each turning point to the next, rad.
fn sizes_rad(turns: &[&TurningPoint]) -> Vec<f64> {
    turns.windows(2).map(|pair| size_rad(&[pair[0], pair[1]])).collect()
}
