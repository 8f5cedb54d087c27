//! A free swing never grows: where somebody pushed, and whether the swings become smaller as they must.

use super::half_swing::{HalfSwing, size_rad, sizes_rad};
use super::{Cut, SURE, SegmentError};
use crate::median;
use crate::turning::TurningPoint;
use std::f64::consts::{PI, SQRT_2};
use std::ops::Range;

/// Swings from turn to turn below this many noise rms are too uncertain to say that they grew.
const GROWTH_NOISE: f64 = 20.0;

/// Quality factor of the best clocks; with half of it a clock would be doubted, with twice of it a motor that holds its swing
/// to a thousandth in thirty periods would not.
const BEST_QUALITY: f64 = 2e4;

/// Half swings in each third, at least, before it is said that they don't become smaller.
pub(super) const FADING_SWINGS: usize = 6;

/// They become smaller where that is more than so many standard deviations of chance: a coarse sensor scatters the turns, and of
/// two thirds that a motor holds one is smaller. Of 24 simulated swings that a motor holds, seen with noise in steps of 1/36 of
/// them, 16 are doubted without this, 22 with half of it, and all with it and with twice of it. Of as many free ones that lose 0.08 %
/// from swing to swing two are, of 0.16 % none; with twice of it 19 and one.
const FADES_SPREADS: f64 = 3.0;

/// A step so many times the usual one is that of a hole in the rows; of Gaussian ones two in a thousand are beyond half of it.
const OUTLIER: f64 = 9.0;

/// The median of a Gaussian sample scatters more than its mean by this factor.
pub(super) const MEDIAN_SCATTER: f64 = 1.25;

/// A swing that is seen well does not grow by more than this share.
const SEEN_SHARE: f64 = 0.02;

/// Of fewer half swings it is said where they grow by more than this share, because a top between few samples is off by
/// 4 %. With half of it chance would do so at eight samples a period; with twice of it a motor that adds 1 % each time
/// is seen after 20 half swings and not after 10.
pub(super) const GROWN_SHARE: f64 = 0.1;

impl Cut<'_> {
    /// What lies between the growths, in order: a free swing never grows, so that somebody pushed there.
    pub(super) fn fading_parts(&self, range: Range<usize>) -> Vec<Range<usize>> {
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

    /// That the swings of what was asked for grow more often than not, where none of them can be free.
    pub(super) fn grows(&self) -> Option<SegmentError> {
        let half_swings = self.half_swings_in(&self.asked);
        let pairs = || half_swings.windows(2);
        let growing: Vec<_> = pairs().filter(|pair| self.growth(&pair[0], &pair[1]).is_some()).collect();
        let (first, last) = (growing.first()?, growing.last()?);
        let (from, to) = (size_rad(&first[0]) / 2.0, size_rad(&last[1]) / 2.0);
        let unit = self.recording.measured().unit();
        (2 * growing.len() > pairs().len()).then_some(SegmentError::Grows { from, to, unit })
    }

    /// How far from where the second of two half swings begins a free swing reaches at most (rad), where it ends beyond.
    pub(super) fn growth(&self, before: &HalfSwing, after: &HalfSwing) -> Option<f64> {
        let limit_rad = self.limit_of_growth(size_rad(before), [before[0], after[1]]);
        let after_rad = size_rad(after);
        (after_rad > GROWTH_NOISE * self.noise_rms_rad && after_rad > limit_rad).then_some(limit_rad)
    }

    /// How far a free swing goes at most where the one before went so far, rad; the top of either may be off where samples are few.
    fn limit_of_growth(&self, before_rad: f64, turns: [&TurningPoint; 2]) -> f64 {
        let share = if self.has_few_samples() { GROWN_SHARE } else { SEEN_SHARE };
        before_rad * (1.0 + share) + SURE * (turns[0].spread_rad.hypot(turns[1].spread_rad) + self.noise_rms_rad)
    }

    /// Do the swings become smaller, as without a motor they must, and by more than chance? From the first and the last third of many.
    pub(super) fn fades(&self, free: &Range<usize>) -> bool {
        self.fades_by(free, FADES_SPREADS)
    }

    /// Do they become smaller, or is it chance? Of several parts the one that is free is sought so.
    pub(super) fn may_fade(&self, free: &Range<usize>) -> bool {
        self.fades_by(free, 0.0)
    }

    fn fades_by(&self, free: &Range<usize>, n_spreads: f64) -> bool {
        let turns = self.turns_in(free);
        let Some(Thirds { n, early, late, n_between, scatter }) = Thirds::of(&turns) else { return true };
        if n < FADING_SWINGS {
            let spread_rad = median(&mut turns.iter().map(|turn| turn.spread_rad).collect::<Vec<f64>>());
            return late < early * (1.0 + GROWN_SHARE) + SURE * spread_rad;
        }
        let chance = MEDIAN_SCATTER * scatter / (n as f64).sqrt();
        (early / late).ln() > n_between * PI / (2.0 * BEST_QUALITY) + n_spreads * chance
    }

    /// From what to what amplitude the swings grow, if they do clearly.
    pub(super) fn grown(&self, free: &Range<usize>) -> Option<(f64, f64)> {
        let Thirds { early, late, .. } = Thirds::of(&self.turns_in(free))?;
        (late > early * (1.0 + GROWN_SHARE)).then_some((early / 2.0, late / 2.0))
    }
}

/// How far the swings of the first and the last third go from turn to turn, as a rule.
struct Thirds {
    n: usize,
    early: f64,
    late: f64,
    /// Half swings from the one third to the other.
    n_between: f64,
    /// By what share a half swing of the one third and one of the other is too long or too short, together.
    scatter: f64,
}

impl Thirds {
    /// `None` where there are none.
    fn of(turns: &[&TurningPoint]) -> Option<Self> {
        let mut sizes = sizes_rad(turns);
        let n = sizes.len() / 3;
        let n_between = (sizes.len() - n) as f64;
        let scatter = scatter(&sizes[..n]).hypot(scatter(&sizes[sizes.len() - n..]));
        let late = median(&mut sizes.split_off(sizes.len() - n));
        (n > 0).then(|| Self { n, early: median(&mut sizes[..n]), late, n_between, scatter })
    }
}

/// The standard deviation of each size as a share of it, which does not mind that all of them lose the same share, nor holes in the
/// rows that hide some turns.
pub(super) fn scatter(sizes: &[f64]) -> f64 {
    let mut steps: Vec<f64> =
        sizes.windows(2).map(|pair| (pair[1] / pair[0]).ln()).filter(|step| step.is_finite()).collect();
    if steps.is_empty() {
        return 0.0;
    }
    let loss = median(&mut steps);
    let mut off: Vec<f64> = steps.iter().map(|step| (step - loss).abs()).collect();
    // Where most of them are alike to the last digit, none is an outlier.
    let usual = median(&mut off);
    off.retain(|off| usual == 0.0 || *off < OUTLIER * usual);
    // Of a Gaussian the mean deviation is √(2/π) of the standard one, and a step has twice the variance of a size.
    off.iter().sum::<f64>() / off.len() as f64 * (PI / 2.0).sqrt() / SQRT_2
}
