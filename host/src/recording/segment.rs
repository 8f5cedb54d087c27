//! Where the pendulum swings freely: after it was held or touched, until it hangs still.
//!
//! In: a recording, perhaps with the user's own limits. Out: index ranges and what was cut, in words.
//!
//! A free pendulum obeys `α = −ω0² sin θ + b cos θ − c sgn ω − d ω − e ω|ω|`. The five numbers are fitted to the middle
//! of the recording, robustly; where the acceleration (from local polynomials) is off by far more than noise, a hand
//! did it. The free swing is the undisturbed stretch with the most turning points. The friction law is crude on purpose:
//! it must recognise a hand, which does tens of rad/s², and be blind to every kind of missing physics.
//! If the pendulum was held still before, the release is placed to a few ms by fitting the start of the fall; the free
//! range begins shortly after it, never before.

use std::ops::Range;

use nalgebra::{SMatrix, SVector};
use thiserror::Error;

use super::smooth::LocalFit;
use super::turning::{self, TurningPoint};
use super::{Recording, median};
use crate::noise;

/// Two swings there and back.
const MIN_TURNING_POINTS: usize = 4;

/// Local polynomials per half width.
const STATES_PER_WIDTH: f64 = 4.0;

/// An acceleration is disturbed when it is off the law by this many standard deviations of its own noise …
const DISTURBED_NOISE: f64 = 6.0;

/// … and this many of the typical misfit of the law (effects it does not know) …
const DISTURBED_MISFIT: f64 = 5.0;

/// … and this share of gravity at the typical amplitude.
const DISTURBED_SHARE: f64 = 0.12;

/// So many disturbed states in a row are a hand; fewer are the kink of dry friction at a turning point.
const N_DISTURBED: usize = 3;

/// The free range begins this long after the fitted release, s: the release is known to a few ms.
const GUARD_S: f64 = 0.010;

/// Stillness is doubted when the mean over a short window leaves the start by this many of its standard deviations.
const STILL_SPREADS: f64 = 5.0;

/// Half swings at the end that may be too small to be seen.
const N_UNSEEN: f64 = 3.0;

/// A free pendulum is seen to fall after some noise rms; still for the time of a fall of this many, it is held.
const HELD_FALL_NOISE: f64 = 20.0;

/// Swings from turn to turn below this many noise rms are too uncertain to say that they grew.
const GROWTH_NOISE: f64 = 20.0;

/// The release is fitted to the first fall of this size, rad: enough to be seen, too little for anything but gravity …
const RELEASE_FALL_RAD: f64 = 0.15;

/// … and at least this many noise rms.
const RELEASE_FALL_NOISE: f64 = 30.0;

/// Moments tried for the release at most, whatever the steps of the recording.
const MAX_RELEASES_TRIED: usize = 4000;

/// Rounds of the robust fit.
const N_ROUNDS: usize = 6;

/// A free swing of ten hours; a simulation of more would want more memory than there is.
const LONGEST_S: f64 = 36_000.0;

/// The user's own limits, s; `None` = found.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct SegmentOptions {
    /// `--from`: the free swing begins here.
    pub from_s: Option<f64>,
    /// `--to`: the free swing ends here.
    pub to_s: Option<f64>,
}

/// The parts of a recording, as ranges of samples.
#[derive(Debug, Clone, PartialEq)]
pub struct Segments {
    /// Held still at the beginning, before the release or before a hand lifted it.
    pub lead_in: Option<Range<usize>>,
    /// Swinging freely, down to the final stop.
    pub free: Range<usize>,
    /// Hanging still at the end.
    pub rest: Option<Range<usize>>,
    /// The release, s: fitted when it was held still before, else the begin of the free range.
    pub release_s: f64,
    /// Turning points within the free range.
    pub n_turning_points: usize,
    /// What was cut and why, in words.
    pub notes: Vec<String>,
}

/// Why there is no free swing.
#[derive(Debug, Error, PartialEq)]
pub enum SegmentError {
    /// Too short.
    #[error(
        "only {n_turning_points} turning points of free swing in {duration_s:.2} s, expected at least \
         {MIN_TURNING_POINTS} (two swings); release from a larger angle, record longer, or choose the stretch with \
         --from and --to"
    )]
    TooFewSwings {
        /// Turning points found.
        n_turning_points: usize,
        /// Length of the stretch, s.
        duration_s: f64,
    },
    /// Longer than any pendulum swings.
    #[error(
        "{duration_s:e} s of free swing, expected at most {LONGEST_S} s; is the time in seconds? Otherwise choose the \
         stretch with --from and --to"
    )]
    TooLong {
        /// Length of the stretch, s.
        duration_s: f64,
    },
    /// Limits that leave nothing.
    #[error(
        "--from {from_s} s and --to {to_s} s leave {n_samples} samples; the recording goes from {first_s} s to {last_s} s"
    )]
    NothingBetween {
        /// Lower limit, s.
        from_s: f64,
        /// Upper limit, s.
        to_s: f64,
        /// Samples between them.
        n_samples: usize,
        /// First time of the recording, s.
        first_s: f64,
        /// Last time, s.
        last_s: f64,
    },
}

/// Finds the free swing.
///
/// # Errors
/// Fewer than two swings, or limits outside the recording.
pub fn segment(recording: &Recording, options: &SegmentOptions) -> Result<Segments, SegmentError> {
    let asked = asked_range(recording, options)?;
    let cut = Cut::new(recording, asked.clone())?;
    let stretch = cut.undisturbed()?;
    let rest = if options.to_s.is_some() { None } else { cut.rest(&stretch) };
    let start = if options.from_s.is_some() { Start::at(&cut, asked.start) } else { cut.start(&stretch) };
    let end = match &rest {
        Some(rest) => rest.start,
        None if options.to_s.is_some() => asked.end,
        None => stretch.end,
    };
    let free = start.free_idx..end.max(start.free_idx);
    let n_turning_points = cut.count_turns(&free);
    let duration_s = cut.duration_s(&free);
    if duration_s > LONGEST_S {
        return Err(SegmentError::TooLong { duration_s });
    }
    if n_turning_points < MIN_TURNING_POINTS {
        return Err(SegmentError::TooFewSwings { n_turning_points, duration_s });
    }
    let notes = notes(&cut, options, &start, &free, rest.as_ref());
    Ok(Segments { lead_in: start.lead_in, free, rest, release_s: start.release_s, n_turning_points, notes })
}

fn asked_range(recording: &Recording, options: &SegmentOptions) -> Result<Range<usize>, SegmentError> {
    let (first_s, last_s) = (recording.times_s()[0], recording.times_s()[recording.len() - 1]);
    let (from_s, to_s) = (options.from_s.unwrap_or(first_s), options.to_s.unwrap_or(last_s));
    let start = recording.index_at(from_s);
    let end = recording.times_s().partition_point(|time_s| *time_s <= to_s);
    let n_samples = end.saturating_sub(start);
    if n_samples < super::MIN_SAMPLES {
        return Err(SegmentError::NothingBetween { from_s, to_s, n_samples, first_s, last_s });
    }
    Ok(start..end)
}

/// Motion around one moment.
#[derive(Debug, Clone, Copy)]
struct State {
    time_s: f64,
    angle_rad: f64,
    velocity_rad_s: f64,
    acceleration_rad_s2: f64,
    spread_rad_s2: f64,
}

/// The crude law of a free swing: coefficients of [`law_terms`].
type Law = SVector<f64, N_TERMS>;

const N_TERMS: usize = 5;

fn law_terms(state: &State, slow_rad_s: f64) -> Law {
    let velocity = state.velocity_rad_s;
    let sign = (velocity / slow_rad_s).tanh();
    Law::from([-state.angle_rad.sin(), state.angle_rad.cos(), -sign, -velocity, -velocity * velocity.abs()])
}

/// Everything known about the asked part of a recording while it is cut.
struct Cut<'a> {
    recording: &'a Recording,
    asked: Range<usize>,
    noise_rms_rad: f64,
    width_s: f64,
    half_swing_s: f64,
    turns: Vec<TurningPoint>,
    states: Vec<State>,
    law: Law,
    disturbed: Vec<bool>,
}

/// How the free swing begins.
struct Start {
    lead_in: Option<Range<usize>>,
    free_idx: usize,
    release_s: f64,
    was_held: bool,
}

impl Start {
    fn at(cut: &Cut, free_idx: usize) -> Self {
        Self { lead_in: None, free_idx, release_s: cut.recording.times_s()[free_idx], was_held: false }
    }
}

impl<'a> Cut<'a> {
    fn new(recording: &'a Recording, asked: Range<usize>) -> Result<Self, SegmentError> {
        let (times_s, angles_rad) = (&recording.times_s()[asked.clone()], &recording.angles_rad()[asked.clone()]);
        let noise_rms_rad = noise::estimate(recording).total_rms;
        let turns = turning::turning_points(times_s, angles_rad, noise_rms_rad);
        let half_swing_s = turning::half_swing_s(times_s, angles_rad, noise_rms_rad);
        let duration_s = times_s[times_s.len() - 1] - times_s[0];
        let too_few = SegmentError::TooFewSwings { n_turning_points: turns.len(), duration_s };
        let (Some(half_swing_s), true) = (half_swing_s, turns.len() >= MIN_TURNING_POINTS) else { return Err(too_few) };
        let width_s = turning::quartic_width_s(half_swing_s, recording.step_s());
        let states = states(times_s, angles_rad, noise_rms_rad, width_s);
        let mut cut = Self {
            recording,
            asked,
            noise_rms_rad,
            width_s,
            half_swing_s,
            turns,
            states,
            law: Law::zeros(),
            disturbed: Vec::new(),
        };
        cut.find_disturbances().ok_or(too_few)?;
        Ok(cut)
    }

    fn times_s(&self) -> &'a [f64] {
        &self.recording.times_s()[..self.asked.end]
    }

    fn angles_rad(&self) -> &'a [f64] {
        &self.recording.angles_rad()[..self.asked.end]
    }

    fn duration_s(&self, range: &Range<usize>) -> f64 {
        match range.len() {
            0 => 0.0,
            _ => self.times_s()[range.end - 1] - self.times_s()[range.start],
        }
    }

    fn count_turns(&self, range: &Range<usize>) -> usize {
        let in_range = |time_s: f64| range.contains(&self.recording.index_at(time_s));
        self.turns.iter().filter(|turn| in_range(turn.time_s)).count()
    }

    /// Median distance of turning points from their middle, rad.
    fn typical_amplitude_rad(&self) -> f64 {
        let mut amplitudes: Vec<f64> =
            self.turns.windows(2).map(|pair| (pair[1].angle_rad - pair[0].angle_rad).abs() / 2.0).collect();
        median(&mut amplitudes)
    }

    /// Fits the law and marks the states that break it.
    fn find_disturbances(&mut self) -> Option<()> {
        let amplitude_rad = self.typical_amplitude_rad();
        let slow_rad_s = 0.1 * amplitude_rad * std::f64::consts::PI / self.half_swing_s;
        let (law, misfit) = self.fit_law(slow_rad_s)?;
        let dry_rad_s2 = 2.0 * law[2].abs();
        let common = DISTURBED_MISFIT * misfit + DISTURBED_SHARE * law[0].abs() * amplitude_rad.sin().abs();
        let off = |state: &State| (state.acceleration_rad_s2 - law.dot(&law_terms(state, slow_rad_s))).abs();
        let raw: Vec<bool> = self
            .states
            .iter()
            .map(|state| off(state) > common + dry_rad_s2 + DISTURBED_NOISE * state.spread_rad_s2)
            .collect();
        self.law = law;
        self.disturbed = sustained(&raw);
        Some(())
    }

    /// The law from the middle half of the turning points on, and the typical misfit (rad/s²). Bad states lose their
    /// vote from round to round.
    fn fit_law(&self, slow_rad_s: f64) -> Option<(Law, f64)> {
        let n_turns = self.turns.len();
        let from_s = self.turns[(n_turns / 4).min(n_turns - MIN_TURNING_POINTS + 1)].time_s;
        let to_s = self.turns[n_turns - 1 - n_turns / 20].time_s;
        let trusted: Vec<&State> = self.states.iter().filter(|state| (from_s..=to_s).contains(&state.time_s)).collect();
        let mut limit = f64::INFINITY;
        let mut fitted = None;
        for _ in 0..N_ROUNDS {
            let law = least_squares(&trusted, slow_rad_s, fitted.as_ref().map(|law| (law, limit)))?;
            let off = |state: &&State| (state.acceleration_rad_s2 - law.dot(&law_terms(state, slow_rad_s))).abs();
            let misfit = 1.4826 * median(&mut trusted.iter().map(off).collect::<Vec<f64>>());
            limit = 4.0 * misfit;
            fitted = Some(law);
        }
        fitted.map(|law| (law, limit / 4.0))
    }

    /// The stretch between disturbances with the most turning points, cut again where the swings grow.
    fn undisturbed(&self) -> Result<Range<usize>, SegmentError> {
        let stretches = self.stretches();
        let best = stretches.into_iter().max_by_key(|range| self.count_turns(range)).unwrap_or(0..0);
        let best = self.after_last_growth(best);
        match self.count_turns(&best) {
            n if n >= MIN_TURNING_POINTS => Ok(best),
            n_turning_points => {
                Err(SegmentError::TooFewSwings { n_turning_points, duration_s: self.duration_s(&best) })
            }
        }
    }

    /// Index ranges between the disturbances.
    fn stretches(&self) -> Vec<Range<usize>> {
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

    /// A free swing never grows: what comes before the last growth was pushed.
    fn after_last_growth(&self, range: Range<usize>) -> Range<usize> {
        let inside: Vec<&TurningPoint> =
            self.turns.iter().filter(|turn| range.contains(&self.recording.index_at(turn.time_s))).collect();
        let grows = |three: &[&TurningPoint]| {
            let spread_rad = three[0].spread_rad.hypot(three[2].spread_rad) + self.noise_rms_rad;
            let before = (three[0].angle_rad - three[1].angle_rad).abs();
            let after = (three[2].angle_rad - three[1].angle_rad).abs();
            let alternate = three[0].is_maximum != three[1].is_maximum && three[1].is_maximum != three[2].is_maximum;
            alternate && after > GROWTH_NOISE * self.noise_rms_rad && after > before * 1.02 + 6.0 * spread_rad
        };
        match inside.windows(3).rposition(grows) {
            Some(growth_idx) => self.recording.index_at(inside[growth_idx + 2].time_s)..range.end,
            None => range,
        }
    }

    /// Hanging still at the end: from some half swings after the last motion that can be seen, because the very last
    /// ones may be smaller than the noise, or hidden in the play of the sensor.
    fn rest(&self, stretch: &Range<usize>) -> Option<Range<usize>> {
        let last_turn_s = self
            .turns
            .iter()
            .rev()
            .map(|turn| turn.time_s)
            .find(|time_s| stretch.contains(&self.recording.index_at(*time_s)))?;
        let after = self.recording.index_at(last_turn_s)..stretch.end;
        let angles_rad = &self.angles_rad()[after.clone()];
        let n_window = self.n_in(self.half_swing_s / 4.0);
        let n_final = (4 * n_window).max(angles_rad.len() / 4).min(angles_rad.len());
        let final_rad = mean(&angles_rad[angles_rad.len() - n_final..]);
        let limit_rad = STILL_SPREADS * self.noise_rms_rad / (n_window as f64).sqrt();
        let moves = |window: &[f64]| (mean(window) - final_rad).abs() > limit_rad;
        let last_motion = angles_rad.windows(n_window).rposition(moves).map_or(0, |idx| idx + n_window);
        let start_s = self.times_s()[(after.start + last_motion).min(stretch.end - 1)] + N_UNSEEN * self.half_swing_s;
        let rest = self.recording.index_at(start_s)..stretch.end;
        (rest.start < rest.end && rest.len() >= n_window).then_some(rest)
    }

    fn n_in(&self, duration_s: f64) -> usize {
        ((duration_s / self.recording.step_s()).round() as usize).min(self.asked.len()).max(3)
    }

    /// How the undisturbed stretch begins: at once, with a release, or with a hand letting go.
    fn start(&self, stretch: &Range<usize>) -> Start {
        let lead_in = self.still_beginning();
        let rough_s = self.times_s()[stretch.start];
        let is_near = |held: &Range<usize>| rough_s - self.times_s()[held.end - 1] < 4.0 * self.width_s;
        let was_held = lead_in.as_ref().is_some_and(|held| is_near(held) && self.must_be_held(held));
        if stretch.start <= self.asked.start && !was_held {
            return Start::at(self, self.asked.start);
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

    /// The still part at the beginning, if there is one.
    fn still_beginning(&self) -> Option<Range<usize>> {
        let angles_rad = &self.angles_rad()[self.asked.start..];
        let n_window = self.n_in(self.width_s / 4.0).min(angles_rad.len());
        let limit = |n: usize| STILL_SPREADS * self.noise_rms_rad * (1.0 / n_window as f64 + 1.0 / n as f64).sqrt();
        let mut sum = angles_rad[..n_window].iter().sum::<f64>();
        let mut until = n_window;
        // The window runs ahead of the mean it is compared with, so a slow start cannot drag the mean along.
        while let Some(window) = angles_rad.get(until..until + n_window) {
            if (mean(window) - sum / until as f64).abs() > limit(until) {
                break;
            }
            sum += angles_rad[until];
            until += 1;
        }
        let is_still = until >= 3 * n_window;
        is_still.then(|| self.asked.start..self.asked.start + until)
    }

    /// Whether a free pendulum would have fallen visibly in that time. Tells a short hold from the first moments of a
    /// fall when the noise is too large for accelerations.
    fn must_be_held(&self, still: &Range<usize>) -> bool {
        let angle_rad = mean(&self.angles_rad()[still.clone()]);
        let gravity_rad_s2 = -self.law[0] * angle_rad.sin() + self.law[1] * angle_rad.cos();
        let fall_rad = gravity_rad_s2.abs() * self.duration_s(still).powi(2) / 2.0;
        fall_rad > HELD_FALL_NOISE * self.noise_rms_rad
    }

    /// Places the release: still until then, afterwards falling with constant torque and its first correction,
    /// `θ0 + α (τ²/2 − ω0² cos θ0 τ⁴/24)`; the time with the least squares wins.
    fn release(&self, held: &Range<usize>) -> Start {
        let still_s = self.times_s()[held.end - 1];
        let n_sure = (held.len() * 4 / 5).max(1);
        let held_rad = mean(&self.angles_rad()[held.start..held.start + n_sure]);
        let earliest = self.recording.index_at(still_s - 5.0 * self.width_s).max(held.start);
        let latest = self.recording.index_at(still_s + 1.5 * self.width_s).min(self.asked.end);
        let fall_rad = RELEASE_FALL_RAD.max(RELEASE_FALL_NOISE * self.noise_rms_rad);
        let has_fallen = |idx: &usize| (self.angles_rad()[*idx] - held_rad).abs() > fall_rad;
        let range = earliest..(held.end..latest).find(has_fallen).unwrap_or(latest);
        let grid_s = self.recording.step_s() / 4.0;
        let n_grid = ((3.0 * self.width_s / grid_s) as usize).min(MAX_RELEASES_TRIED);
        let candidates = (0..n_grid).map(|idx| still_s - 1.5 * self.width_s + idx as f64 * grid_s);
        let off = |release_s: f64| self.misfit_of_release(&range, held_rad, release_s);
        let release_s = candidates.min_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap_or(still_s);
        let free_s = release_s + GUARD_S.max(self.recording.step_s());
        let lead_in = held.start..self.recording.index_at(release_s - GUARD_S).clamp(held.start, held.end);
        let free_idx = self.recording.index_at(free_s);
        Start { lead_in: (!lead_in.is_empty()).then_some(lead_in), free_idx, release_s, was_held: true }
    }

    /// Sum of squares left by a release at `release_s` with the best acceleration.
    fn misfit_of_release(&self, range: &Range<usize>, held_rad: f64, release_s: f64) -> f64 {
        let stiffness = self.law[0] * held_rad.cos();
        let shape = |time_s: f64| {
            let after_s = (time_s - release_s).max(0.0);
            after_s.powi(2) / 2.0 - stiffness * after_s.powi(4) / 24.0
        };
        let samples = || range.clone().map(|idx| (shape(self.times_s()[idx]), self.angles_rad()[idx] - held_rad));
        let (across, along) =
            samples().fold((0.0, 0.0), |(a, b), (shape, angle)| (a + shape * angle, b + shape * shape));
        let acceleration = if along > 0.0 { across / along } else { 0.0 };
        samples().map(|(shape, angle)| (angle - acceleration * shape).powi(2)).sum()
    }
}

fn states(times_s: &[f64], angles_rad: &[f64], noise_rms_rad: f64, width_s: f64) -> Vec<State> {
    let step_s = super::median_step_s(times_s);
    let stride = ((width_s / (STATES_PER_WIDTH * step_s)) as usize).max(1);
    let state = |&time_s: &f64| {
        let fit = LocalFit::<5>::new(times_s, angles_rad, time_s, width_s)?;
        Some(State {
            time_s,
            angle_rad: fit.angle_rad(time_s),
            velocity_rad_s: fit.velocity_rad_s(),
            acceleration_rad_s2: fit.acceleration_rad_s2(),
            spread_rad_s2: noise_rms_rad * fit.acceleration_spread(),
        })
    };
    times_s.iter().step_by(stride).filter_map(state).collect()
}

/// The law with the least squares; states further off an earlier law than its limit do not count.
fn least_squares(states: &[&State], slow_rad_s: f64, earlier: Option<(&Law, f64)>) -> Option<Law> {
    let mut normal = SMatrix::<f64, N_TERMS, N_TERMS>::identity() * 1e-9;
    let mut right = Law::zeros();
    for state in states {
        let terms = law_terms(state, slow_rad_s);
        let is_off = |(law, limit): (&Law, f64)| (state.acceleration_rad_s2 - law.dot(&terms)).abs() > limit;
        if earlier.is_some_and(is_off) {
            continue;
        }
        normal += terms * terms.transpose();
        right += terms * state.acceleration_rad_s2;
    }
    normal.try_inverse().map(|inverse| inverse * right)
}

/// Keeps marks that stand in a row of at least [`N_DISTURBED`].
fn sustained(marks: &[bool]) -> Vec<bool> {
    marks.chunk_by(|a, b| a == b).flat_map(|run| vec![run[0] && run.len() >= N_DISTURBED; run.len()]).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn notes(
    cut: &Cut,
    options: &SegmentOptions,
    start: &Start,
    free: &Range<usize>,
    rest: Option<&Range<usize>>,
) -> Vec<String> {
    let first_s = cut.times_s()[cut.asked.start];
    let mut notes = Vec::new();
    let before_s = cut.times_s()[free.start] - first_s;
    match (&start.lead_in, options.from_s) {
        (_, Some(from_s)) => notes.push(format!("free swing taken from {from_s} s on, as told")),
        (_, None) if start.was_held => {
            notes.push(format!("cut {before_s:.2} s held still before the release at {:.3} s", start.release_s));
        }
        (Some(still), None) if free.start > cut.asked.start => {
            notes.push(format!("cut {before_s:.2} s: still for {:.2} s, then moved by hand", cut.duration_s(still)))
        }
        (None, None) if free.start > cut.asked.start => {
            notes.push(format!("cut the first {before_s:.2} s: a hand was still moving it"));
        }
        _ => {}
    }
    match (rest, options.to_s) {
        (_, Some(to_s)) => notes.push(format!("free swing taken up to {to_s} s, as told")),
        (Some(rest), _) => notes.push(format!("cut {:.2} s hanging still at the end", cut.duration_s(rest))),
        _ if free.end < cut.asked.end => notes.push(format!(
            "cut everything after {:.2} s: something other than gravity and friction moved it there",
            cut.times_s()[free.end]
        )),
        _ => {}
    }
    notes
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_S: f64 = 0.005;

    /// A pendulum with dry and viscous friction (ω0² = 70/s²), released from `angle_rad`, in steps of 0.1 ms.
    fn swing(angle_rad: f64, duration_s: f64) -> Vec<f64> {
        let (mut angle, mut velocity) = (angle_rad, 0.0_f64);
        let mut angles = Vec::new();
        for step_idx in 0..(duration_s / 1e-4) as usize {
            if step_idx % 50 == 0 {
                angles.push(angle);
            }
            let gravity = -70.0 * angle.sin();
            let is_stuck = velocity.abs() < 1e-4 && gravity.abs() < 0.3;
            let acceleration = gravity - 0.3 * velocity.signum() - 0.1 * velocity;
            velocity = if is_stuck { 0.0 } else { velocity + 1e-4 * acceleration };
            angle += 1e-4 * velocity;
        }
        angles
    }

    fn noisy(angles_rad: &[f64]) -> Recording {
        let mut state = 17_u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let noise_rad = 1e-3 * 12f64.sqrt();
        Recording::uniform(1.0 / STEP_S, angles_rad.iter().map(|angle| angle + noise_rad * uniform()).collect())
            .unwrap()
    }

    fn find(angles_rad: &[f64]) -> Segments {
        segment(&noisy(angles_rad), &SegmentOptions::default()).unwrap()
    }

    #[test]
    fn a_held_pendulum_is_free_just_after_its_release() {
        for angle_rad in [-2.5, -0.3, 0.15, 0.8, 1.57, 2.8] {
            let held = vec![angle_rad; 100];
            let segments = find(&[held, swing(angle_rad, 20.0)].concat());
            let late = segments.free.start as f64 * STEP_S - 0.5;
            assert!((0.0..0.06).contains(&late), "{angle_rad}: {late} {segments:?}");
            assert!(segments.notes[0].contains("held still before the release"), "{segments:?}");
        }
    }

    #[test]
    fn a_recording_that_begins_with_the_release_is_kept_whole() {
        let segments = find(&swing(1.0, 8.0));
        assert_eq!(segments.free, 0..1600);
        assert_eq!((segments.lead_in, segments.rest), (None, None));
        assert!(segments.notes.is_empty());
    }

    #[test]
    fn a_hand_that_ends_the_swing_is_cut() {
        let mut angles_rad = swing(1.2, 8.0);
        let caught_rad = angles_rad[1200];
        angles_rad.iter_mut().skip(1200).for_each(|angle| *angle = caught_rad);
        let segments = find(&angles_rad);
        assert!((1100..=1205).contains(&segments.free.end), "{segments:?}");
        assert!(segments.notes[0].contains("cut everything after"), "{segments:?}");
    }

    #[test]
    fn of_two_swings_in_one_recording_the_longer_one_is_taken() {
        let segments = find(&[swing(0.8, 4.0), vec![1.0; 100], swing(1.0, 12.0)].concat());
        let start_s = segments.free.start as f64 * STEP_S;
        assert!((4.5..4.7).contains(&start_s), "{segments:?}");
    }

    #[test]
    fn a_push_in_the_middle_divides_the_swing() {
        let first = swing(0.7, 3.0);
        let last_rad = *first.last().unwrap();
        let pushed: Vec<f64> = (0..80).map(|idx| last_rad + (1.4 - last_rad) * f64::from(idx) / 80.0).collect();
        let segments = find(&[first, pushed, swing(1.4, 10.0)].concat());
        let start_s = segments.free.start as f64 * STEP_S;
        assert!((3.39..3.6).contains(&start_s), "{segments:?}");
    }

    #[test]
    fn a_hanging_angle_that_is_not_zero_does_not_matter() {
        let angles_rad: Vec<f64> =
            [vec![0.9; 100], swing(0.9, 25.0)].concat().iter().map(|angle| angle + 0.2).collect();
        let segments = find(&angles_rad);
        assert!((100..112).contains(&segments.free.start), "{segments:?}");
        assert!(segments.rest.is_some(), "{segments:?}");
    }

    #[test]
    fn one_swing_is_too_few_and_the_message_says_so() {
        let error = segment(&noisy(&swing(1.0, 0.8)), &SegmentOptions::default()).unwrap_err();
        assert!(error.to_string().contains("two swings"), "{error}");
    }

    #[test]
    fn a_still_pendulum_has_too_few_swings() {
        let error = segment(&noisy(&vec![0.2; 1000]), &SegmentOptions::default()).unwrap_err();
        assert!(matches!(error, SegmentError::TooFewSwings { n_turning_points: 0, .. }), "{error}");
    }

    #[test]
    fn limits_of_the_user_are_taken_as_they_are() {
        let recording = noisy(&swing(1.0, 12.0));
        let options = SegmentOptions { from_s: Some(2.0), to_s: Some(8.0) };
        let segments = segment(&recording, &options).unwrap();
        assert_eq!(segments.free, 400..1601);
        assert_eq!(segments.notes.len(), 2);
    }

    #[test]
    fn limits_outside_the_recording_are_refused_with_its_times() {
        let recording = noisy(&swing(1.0, 12.0));
        let options = SegmentOptions { from_s: Some(20.0), to_s: None };
        let error = segment(&recording, &options).unwrap_err().to_string();
        assert!(error.contains("from 0 s to 11.995 s"), "{error}");
    }
}
