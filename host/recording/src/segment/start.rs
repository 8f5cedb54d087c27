//! How the free swing begins: at once, with a release, or with a hand that lets go.

use super::super::carrier::Carrier;
use super::super::noise::{rms_about_line, robust_spread};
use super::super::{Measured, median};
use super::{Cut, STILL_SPREADS, mean};
use nalgebra::{Matrix2, Vector2};
use std::f64::consts::PI;
use std::ops::Range;

/// The free range begins this long after the fitted release, s: the release is known to a few ms.
const GUARD_S: f64 = 0.010;

/// A hand that trembles by so many noises may open slowly: then it begins where the accelerations are free of it. Of 416 simulated
/// swings six began 0.02 to 0.08 s before such a hand was off without this, one 0.05 s with it. Half and twice were not tried.
const TREMBLES: f64 = 2.0;

/// A free pendulum is seen to fall after some noise rms; still for the time of a fall of this many, it is held.
const HELD_FALL_NOISE: f64 = 20.0;

/// A swing that turns is seen to stand still for the time of a fall of 17 noises, where a window has three samples; a hand
/// that holds it does so for longer. Half of it leaves no room for chance; with twice of it a hold of 0.3 s in a noise of a
/// twentieth of the swing is none.
const STOPS_FALL_NOISE: f64 = 40.0;

/// What falls is further off so many windows later, in three twentieths of a half swing; with one, a knock of a window and
/// a half still passed for a release. With twice as many it falls still.
const FALLS_ON_FOR: usize = 3;

/// … and by this share of what gravity alone would make of it: without it three of 416 simulated holds ended at a tremble, 0.8 s
/// early. Half and twice were not tried; with all of it a pendulum in thick grease would be held for good.
const FALLS_LEAST: f64 = 0.25;

/// The release is fitted to the first fall of this size, rad (a rate that makes it so within a swing): enough to be seen, too little for anything but gravity …
const RELEASE_FALL_RAD: f64 = 0.15;

/// … and at least this many noise rms.
const RELEASE_FALL_NOISE: f64 = 30.0;

/// Moments tried for the release at most, however short the steps of the recording: they then lie further apart, which
/// over three widths is less than 0.2 ms.
const MAX_RELEASES_TRIED: usize = 4000;

/// A hand pushed if a release with a velocity leaves less than this share of what one from rest does. Of eleven simulated pushes it
/// was 0.01 to 0.70, of 27 recordings without a push 0.97 and more, and once, where next to nothing is left, 0.75; with half of it
/// two pushes towards the lowest point and the strongest one were taken for falls that began 16 to 25 ms before they did.
const PUSHED: f64 = 0.8;

/// … and by so many noise variances less. Those pushes gained 68 and more, the 27 recordings 4.5 at most: half of it and twice of it
/// tell the same ones.
const SURE_OF_PUSH: f64 = 25.0;

/// So near to upright a pendulum balances rather than swings, rad: there what it lacks to upright grows e-fold in 1/ω0,
/// and with it whatever is not known of its first angle, so that growing windows of least squares do not find the way (a
/// release 0.013 rad from upright was left at 0.9 rad, with response surfaces before them at 0.025). With half of it the
/// unknown is twice as large as here, with twice of it half as large, and 0.7/ω0 more of the swing is lost.
const BALANCED_RAD: f64 = 0.2;

/// Half swings in which a cart may roll on. Half and twice were not tried.
const ROLLS_HALF_SWINGS: f64 = 2.0;

/// What is called still ends up to so many half swings after a hand began to lift it: 0.04 to 0.11 s of 1.2 s made 1.3 to 1.9 noises
/// in nine of 416 simulated swings. Half and twice were not tried.
pub(super) const BEGINS_TO_MOVE: f64 = 0.25;

/// How the free swing begins.
pub(super) struct Start {
    pub(super) lead_in: Option<Range<usize>>,
    pub(super) free_idx: usize,
    pub(super) release_s: f64,
    pub(super) was_held: bool,
}

impl Start {
    pub(super) fn at(cut: &Cut, free_idx: usize) -> Self {
        Self { lead_in: None, free_idx, release_s: cut.recording.times_s()[free_idx], was_held: false }
    }

    /// A hand was on it until later than it seemed.
    pub(super) fn moved_to(&mut self, free_idx: usize, time_s: f64) {
        (self.free_idx, self.release_s) = (free_idx, time_s);
    }
}

impl Cut<'_> {
    /// How the free swing begins. In much noise no acceleration shows a hand that lifts, but that it holds shows; and one that
    /// was seen may have let go later than it seems.
    pub(super) fn start(&self, stretch: &Range<usize>) -> Start {
        let start = self.start_of(stretch);
        let is_of_hand = !start.was_held && start.free_idx > self.asked.start;
        if self.recording.measured() == Measured::Rate || self.states.is_empty() {
            return start;
        }
        match self.held_within(start.free_idx, stretch) {
            Some(held) => self.let_go(start.lead_in, &held, stretch.end),
            None if is_of_hand => {
                let from = self.swung_from(&start, stretch.end);
                let free_idx = self.follows_from(&(from..stretch.end));
                Start { free_idx, release_s: start.release_s.max(self.times_s()[free_idx]), ..start }
            }
            None => start,
        }
    }

    /// The release behind a hold that something else came before.
    fn let_go(&self, lead_in: Option<Range<usize>>, held: &Range<usize>, end: usize) -> Start {
        let Start { free_idx, release_s, .. } = self.release(held);
        let lead_in = lead_in.or_else(|| self.still_beginning());
        Start { lead_in, free_idx: free_idx.min(end), release_s, was_held: false }
    }

    /// How the undisturbed stretch begins: at once, with a release, or with a hand letting go.
    fn start_of(&self, stretch: &Range<usize>) -> Start {
        let lead_in = self.still_beginning();
        let rough_s = self.times_s()[stretch.start];
        let is_near = |held: &Range<usize>| rough_s - self.times_s()[held.end - 1] < 4.0 * self.width_s;
        let was_held = lead_in.as_ref().is_some_and(|held| is_near(held) && self.must_be_held(held));
        if stretch.start <= self.asked.start && !was_held {
            // Nothing that swings is still for so long.
            let hung = lead_in.filter(|still| self.duration_s(still) > self.half_swing_s);
            let free_idx = hung.as_ref().map_or(self.asked.start, |hung| hung.end);
            return Start { lead_in: hung, ..Start::at(self, free_idx) };
        }
        match lead_in {
            Some(held) if was_held => self.release(&held),
            lead_in => {
                let free_s = rough_s + self.width_s / 2.0;
                let free_idx = self.recording.index_at(free_s).min(stretch.end);
                Start { lead_in, free_idx, release_s: free_s, was_held: false }
            }
        }
    }

    /// What hung still until it moved was swung by somebody, however gently: it is free from its largest swing on.
    fn swung_from(&self, start: &Start, end: usize) -> usize {
        let hung = start.lead_in.as_ref().is_some_and(|hung| hung.end == start.free_idx);
        let largest = hung.then(|| self.largest_swing(&(start.free_idx..end))).flatten();
        largest.map_or(start.free_idx, |swing| swing.start)
    }

    /// The first sample from this one on at which it has left upright; this one where it never does.
    pub(super) fn fallen(&self, from: usize, end: usize) -> usize {
        if self.recording.measured() == Measured::Rate {
            return from;
        }
        let is_balanced = |idx: &usize| self.angles_rad()[*idx].cos() < -BALANCED_RAD.cos();
        (from..end).find(|idx| !is_balanced(idx)).unwrap_or(from)
    }

    /// The first sample from this one on at which what carries it stands too, and its column, where the file has one: a cart that is
    /// pushed to start the swing rolls on for less than a swing.
    pub(super) fn carried_until(&self, from: usize, end: usize) -> Option<(usize, &str)> {
        let n_first = self.n_in(ROLLS_HALF_SWINGS * self.half_swing_s);
        let stands = |carrier: &'_ Carrier| carrier.stands_from(&(from..end), n_first, self.angles_rad());
        let carriers = self.recording.carriers.iter();
        carriers.filter_map(|carrier| Some((stands(carrier)?, carrier.column.as_str()))).max_by_key(|(idx, _)| *idx)
    }

    /// The still part at the beginning, if there is one. What falls goes on: if it is no further off some windows later, or hardly
    /// where gravity would have it, it was chance, or a hand that trembles; with few samples a swing it is back again some windows
    /// later.
    fn still_beginning(&self) -> Option<Range<usize>> {
        let n_later = FALLS_ON_FOR * self.n_still_window();
        let first = self.asked.start..(self.asked.start + n_later).min(self.asked.end);
        let least_rad = match self.recording.measured() {
            Measured::Angle => FALLS_LEAST * self.fall_rad(&first),
            Measured::Rate => 0.0,
        };
        let goes_on = |left_rad: f64, later_rad: Option<f64>| {
            let is_further = |later_rad: f64| later_rad / left_rad > 1.0 && later_rad.abs() > least_rad;
            self.has_few_samples() || later_rad.is_none_or(is_further)
        };
        let still = self.still_from(self.asked.clone(), goes_on);
        (self.is_long(&still) && self.is_at_one_place(&still)).then_some(still)
    }

    /// Are most of its samples there but for the noise? Between few samples a swing what turns may be back at its mean whenever
    /// it is looked at.
    fn is_at_one_place(&self, still: &Range<usize>) -> bool {
        let angles_rad = &self.angles_rad()[still.clone()];
        let middle_rad = median(&mut angles_rad.to_vec());
        let off_rad: Vec<f64> = angles_rad.iter().map(|angle_rad| angle_rad - middle_rad).collect();
        robust_spread(&off_rad) < STILL_SPREADS * self.noise_rms_rad
    }

    /// The last still part, from this sample on and before the largest swing, that a free pendulum would have left. A free
    /// swing is largest where it begins.
    pub(super) fn held_within(&self, from: usize, stretch: &Range<usize>) -> Option<Range<usize>> {
        let end = self.largest_swing(&(from..stretch.end))?.end;
        let (mut start, mut found) = (from, None);
        while start < end {
            // Where it turns it is off and back again, as behind a knock.
            let still = self.still_from(start..end, |_, _| true);
            start = still.end;
            if self.is_long(&still) && self.fall_rad(&still) > STOPS_FALL_NOISE * self.noise_rms_rad {
                found = Some(still);
            }
        }
        found
    }

    /// At least three windows; of few samples a swing as many as what turns would not be still for.
    fn is_long(&self, still: &Range<usize>) -> bool {
        let would_fall = || self.fall_rad(still) > STOPS_FALL_NOISE * self.noise_rms_rad;
        still.len() >= 3 * self.n_in(self.width_s / 4.0) || (self.has_few_samples() && would_fall())
    }

    /// A window of three samples is then most of a half swing.
    pub(super) fn n_still_window(&self) -> usize {
        if self.has_few_samples() { 1 } else { self.n_in(self.width_s / 4.0) }
    }

    /// So few a swing that no acceleration is seen.
    pub(super) fn has_few_samples(&self) -> bool {
        self.states.is_empty() && self.recording.measured() == Measured::Angle
    }

    /// How long it is still from the first sample of a range on, at least a window. It ends where a window is off, if how far
    /// this is and how far some windows later says so.
    pub(super) fn still_from(&self, range: Range<usize>, ends: impl Fn(f64, Option<f64>) -> bool) -> Range<usize> {
        let angles_rad = &self.angles_rad()[range.clone()];
        let n_window = self.n_still_window().min(angles_rad.len());
        let limit = |n: usize| STILL_SPREADS * self.noise_rms_rad * (1.0 / n_window as f64 + 1.0 / n as f64).sqrt();
        let mut sum = angles_rad[..n_window].iter().sum::<f64>();
        let mut until = n_window;
        let off = |from: usize, mean_rad: f64| Some(mean(angles_rad.get(from..from + n_window)?) - mean_rad);
        // The window runs ahead of the mean it is compared with, so a slow start cannot drag the mean along.
        while let Some(left_rad) = off(until, sum / until as f64) {
            let later = || off(until + FALLS_ON_FOR * n_window, sum / until as f64);
            if left_rad.abs() > limit(until) && ends(left_rad, later()) {
                break;
            }
            sum += angles_rad[until];
            until += 1;
        }
        range.start..range.start + until
    }

    /// Whether a free pendulum would have fallen visibly in that time. Tells a short hold from the first moments of a
    /// fall when the noise is too large for accelerations.
    fn must_be_held(&self, still: &Range<usize>) -> bool {
        if self.recording.measured() == Measured::Rate {
            let gained_rad_s = self.frequency_rad_s() * self.largest_reading() * self.duration_s(still);
            return gained_rad_s > HELD_FALL_NOISE * self.noise_rms_rad;
        }
        self.fall_rad(still) > HELD_FALL_NOISE * self.noise_rms_rad
    }

    /// What was still at the beginning, where a hand held it, and where it hung; without the last moments, in which it may have
    /// begun to move.
    pub(super) fn held_or_hanging(&self, start: &Start) -> (Option<Range<usize>>, Option<Range<usize>>) {
        let Some(still) = start.lead_in.clone() else { return (None, None) };
        let is_held = start.was_held || self.must_be_held(&still);
        let begins_to_move = self.n_in(BEGINS_TO_MOVE * self.half_swing_s);
        let sure = Some(still.start..still.end.saturating_sub(begins_to_move).max(still.start));
        if is_held { (sure, None) } else { (None, sure) }
    }

    /// How far a free pendulum would have fallen in that time, rad: not at all within half a line of a coarse sensor about where
    /// it hangs.
    fn fall_rad(&self, still: &Range<usize>) -> f64 {
        let angle_rad = mean(&self.angles_rad()[still.clone()]);
        let gravity_rad_s2 = -self.law[0] * angle_rad.sin() + self.law[1] * angle_rad.cos();
        let rounded_rad_s2 = self.law[0].abs() * self.whole_noise.lsb.unwrap_or(0.0) / 2.0;
        (gravity_rad_s2.abs() - rounded_rad_s2).max(0.0) * self.duration_s(still).powi(2) / 2.0
    }

    /// Places the release: still until then, afterwards falling with constant torque and its first correction,
    /// `θ0 + α (τ²/2 − ω0² cos θ0 τ⁴/24)`, or where that does not follow, with a push as well; the time with the least squares
    /// wins.
    fn release(&self, held: &Range<usize>) -> Start {
        if self.states.is_empty() {
            return self.first_fallen(held);
        }
        let still_s = self.times_s()[held.end - 1];
        let n_sure = (held.len() * 4 / 5).max(1);
        let held_rad = mean(&self.angles_rad()[held.start..held.start + n_sure]);
        let earliest = self.recording.index_at(still_s - 5.0 * self.width_s).max(held.start);
        let latest = self.recording.index_at(still_s + 1.5 * self.width_s).min(self.asked.end);
        let is_rate = self.recording.measured() == Measured::Rate;
        let large = RELEASE_FALL_RAD * if is_rate { self.frequency_rad_s() } else { 1.0 };
        let fall_rad = large.max(RELEASE_FALL_NOISE * self.noise_rms_rad);
        let has_fallen = |idx: &usize| (self.angles_rad()[*idx] - held_rad).abs() > fall_rad;
        let range = earliest..(held.end..latest).find(has_fallen).unwrap_or(latest);
        let searched_s = 3.0 * self.width_s;
        let grid_s = (self.recording.step_s() / 4.0).max(searched_s / MAX_RELEASES_TRIED as f64);
        let n_grid = (searched_s / grid_s) as usize;
        let candidates = || (0..n_grid).map(|idx| still_s - 1.5 * self.width_s + idx as f64 * grid_s);
        let best = |kind: Release| {
            let off = |release_s: f64| (release_s, self.misfit_of_release(&range, held_rad, release_s, kind));
            candidates().map(off).min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((still_s, f64::INFINITY))
        };
        let (fallen, pushed) = (best(Release::Fall), best(Release::Push));
        let gain = (fallen.1 - pushed.1) / self.noise_rms_rad.powi(2);
        let was_pushed = pushed.1 < PUSHED * fallen.1 && gain > SURE_OF_PUSH;
        let (release_s, _) = if was_pushed { pushed } else { fallen };
        let held_rms_rad = rms_about_line(&self.angles_rad()[held.start..held.start + n_sure]);
        let trembles = held_rms_rad > TREMBLES * self.whole_noise.total_rms;
        let guard_s = if trembles { self.width_s / 2.0 } else { GUARD_S.max(self.recording.step_s()) };
        let free_s = release_s + guard_s;
        let lead_in = held.start..self.recording.index_at(release_s - GUARD_S).clamp(held.start, held.end);
        let free_idx = self.recording.index_at(free_s);
        Start { lead_in: (!lead_in.is_empty()).then_some(lead_in), free_idx, release_s, was_held: true }
    }

    /// Between too few samples to see an acceleration the first one that has fallen is free.
    fn first_fallen(&self, held: &Range<usize>) -> Start {
        let held_rad = mean(&self.angles_rad()[held.clone()]);
        let has_fallen =
            |idx: &usize| (self.angles_rad()[*idx] - held_rad).abs() > HELD_FALL_NOISE * self.noise_rms_rad;
        let free_idx = (held.end..self.asked.end).find(has_fallen).unwrap_or(held.end);
        Start { lead_in: Some(held.clone()), free_idx, release_s: self.times_s()[free_idx], was_held: true }
    }

    fn frequency_rad_s(&self) -> f64 {
        PI / self.half_swing_s
    }

    /// The largest reading of the asked part.
    fn largest_reading(&self) -> f64 {
        self.angles_rad()[self.asked.start..].iter().fold(0.0, |largest, reading| largest.max(reading.abs()))
    }

    /// Sum of squares left by a release at `release_s` with the best acceleration, and the best velocity if it is a push:
    /// `ω (τ − ω0² cos θ0 τ³/6)` more. Of rates it is the slope of both.
    fn misfit_of_release(&self, range: &Range<usize>, held_rad: f64, release_s: f64, kind: Release) -> f64 {
        let is_rate = self.recording.measured() == Measured::Rate;
        let stiffness = self.law[0] * if is_rate { 1.0 } else { held_rad.cos() };
        let shape = |time_s: f64| {
            let after_s = time_s - release_s;
            let (push, fall) = match is_rate {
                _ if after_s <= 0.0 => (0.0, 0.0),
                false => (
                    after_s - stiffness * after_s.powi(3) / 6.0,
                    after_s.powi(2) / 2.0 - stiffness * after_s.powi(4) / 24.0,
                ),
                true => (1.0 - stiffness * after_s.powi(2) / 2.0, after_s - stiffness * after_s.powi(3) / 6.0),
            };
            Vector2::new(fall, if kind == Release::Push { push } else { 0.0 })
        };
        let samples = || range.clone().map(|idx| (shape(self.times_s()[idx]), self.angles_rad()[idx] - held_rad));
        let (normal, right) = samples()
            .fold((Matrix2::zeros(), Vector2::zeros()), |(normal, right), (shape, angle)| {
                (normal + shape * shape.transpose(), right + shape * angle)
            });
        let best =
            normal.pseudo_inverse(f64::EPSILON * normal.norm()).map_or(Vector2::zeros(), |inverse| inverse * right);
        samples().map(|(shape, angle)| (angle - best.dot(&shape)).powi(2)).sum()
    }
}

/// How a hand lets go.
#[derive(Clone, Copy, PartialEq)]
enum Release {
    /// It opens.
    Fall,
    /// It pushes.
    Push,
}
