//! The crude law of a free swing, fitted robustly, and where a recording breaks it.

use super::super::smooth::LocalFit;
use super::super::turning::WIDEST;
use super::super::{Measured, median, median_step_s};
use super::{Cut, MIN_TURNING_POINTS};
use nalgebra::{SMatrix, SVector};
use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::Range;

/// Local polynomials per half width.
const STATES_PER_WIDTH: f64 = 4.0;

/// An acceleration is disturbed when it is off the law by this many standard deviations of its own noise …
const DISTURBED_NOISE: f64 = 6.0;

/// … and this many of the typical misfit of the law (effects it does not know) …
const DISTURBED_MISFIT: f64 = 5.0;

/// … and this share of gravity at the amplitude of its swing, or at the typical one where that is larger: a spring of
/// the pivot that gives way leaves the large swings of a long recording 8 % of gravity off what its small ones say.
const DISTURBED_SHARE: f64 = 0.12;

/// A sensor that is off by e·sin 2θ, because its magnet or its track lies askew, shows accelerations that are off by up to
/// 4·e·ω²: of swings beyond a right angle as much as gravity. That of two strangers' recordings has 0.043 rad, and a
/// potentiometer's linearity of 2 % allows 0.12 rad. With half and with twice of it both are cut alike; with none their
/// largest swings, up to 5 s of them, are a hand's.
const SCALE_BEND_RAD: f64 = 0.17;

/// So many disturbed states in a row are a hand; fewer are the kink of dry friction at a turning point.
const N_DISTURBED: usize = 3;

/// Something may swing along where the law misses this share of gravity: 2 to 12 of five recordings in which it does, 0.04 of one
/// in which nothing does, so that half of it and twice of it tell the same …
const WOBBLE_SHARE: f64 = 0.1;

/// … and does where wide states leave less than this share of what it misses: 0.06 to 0.08 where the swings are seen, 0.6 and more
/// where they are not, so that half of it tells the same and twice of it would believe the latter.
const MOST_WOBBLE_LEFT: f64 = 0.5;

/// Rounds of the robust fit.
const N_ROUNDS: usize = 6;

/// Motion around one moment; where rates are measured, they and their slopes stand in place of the angle and its.
#[derive(Debug, Clone, Copy)]
pub(super) struct State {
    pub(super) time_s: f64,
    pub(super) angle_rad: f64,
    pub(super) velocity_rad_s: f64,
    pub(super) acceleration_rad_s2: f64,
    pub(super) spread_rad_s2: f64,
}

/// The crude law of a free swing: coefficients of [`law_terms`].
pub(super) type Law = SVector<f64, N_TERMS>;

const N_TERMS: usize = 5;

/// What the law needs beside the state: the speed below which friction turns (rad/s) and the one up to which friction is
/// known, beyond which that of the small swings of a long tail would be a hundred times too large; or where rates are measured, the
/// acceleration of the horizontal pendulum (rad/s²).
#[derive(Debug, Clone, Copy)]
enum Scale {
    Angle { slow_rad_s: f64, fastest_rad_s: f64 },
    Rate { gravity_rad_s2: f64 },
}

impl Scale {
    /// Gravity at an amplitude, as a share of what it is on the horizontal pendulum.
    fn gravity_at(self, amplitude_rad: f64) -> f64 {
        match self {
            Self::Angle { .. } => amplitude_rad.min(FRAC_PI_2).sin(),
            Self::Rate { .. } => amplitude_rad,
        }
    }

    /// What the known friction would add beyond the speed up to which it is known, if it went on as it begins (rad/s²).
    fn unknown_friction(self, state: &State, law: &Law) -> f64 {
        let Self::Angle { fastest_rad_s, .. } = self else { return 0.0 };
        let velocity = state.velocity_rad_s;
        -law[3].max(0.0) * (velocity - velocity.clamp(-fastest_rad_s, fastest_rad_s))
    }

    /// Of a state (rad²/s²); a rate is read without an angle.
    fn squared_speed(self, state: &State) -> f64 {
        match self {
            Self::Angle { .. } => state.velocity_rad_s.powi(2),
            Self::Rate { .. } => 0.0,
        }
    }
}

/// Angles obey the pendulum's law. Of a rate ω with its slope α, `ω̈ = −ω0² ω cos θ` and `sin θ = −α/ω0²` give terms
/// ω (1 − s²/2 − s⁴/8) with s = α/ω0², beside damping and a slope.
fn law_terms(state: &State, scale: Scale) -> Law {
    let velocity = state.velocity_rad_s;
    match scale {
        Scale::Angle { slow_rad_s, fastest_rad_s } => {
            let sign = (velocity / slow_rad_s).tanh();
            let velocity = velocity.clamp(-fastest_rad_s, fastest_rad_s);
            Law::from([-state.angle_rad.sin(), state.angle_rad.cos(), -sign, -velocity, -velocity * velocity.abs()])
        }
        Scale::Rate { gravity_rad_s2 } => {
            let (rate, sine) = (state.angle_rad, velocity / gravity_rad_s2);
            Law::from([-rate, rate * sine.powi(2), rate * sine.powi(4), -velocity, 1.0])
        }
    }
}

impl Cut<'_> {
    /// Fits the law and marks the states that break it.
    pub(super) fn find_disturbances(&mut self) -> Option<()> {
        if self.states.is_empty() {
            // Whether it was held is asked all the same: its period says how it would have fallen.
            self.law[0] = (PI / self.half_swing_s).powi(2);
            return Some(());
        }
        let typical_rad = self.typical_amplitude_rad();
        let frequency_rad_s = PI / self.half_swing_s;
        let scale = match self.recording.measured() {
            Measured::Angle => {
                Scale::Angle { slow_rad_s: 0.1 * typical_rad * frequency_rad_s, fastest_rad_s: f64::INFINITY }
            }
            Measured::Rate => Scale::Rate { gravity_rad_s2: frequency_rad_s.powi(2) },
        };
        let (law, misfit, fastest) = self.fit_law_blind_to_wobble(scale, typical_rad)?;
        let scale = match scale {
            Scale::Angle { slow_rad_s, .. } => Scale::Angle { slow_rad_s, fastest_rad_s: fastest },
            rate @ Scale::Rate { .. } => rate,
        };
        let dry_rad_s2 = if let Scale::Angle { .. } = scale { 2.0 * law[2].abs() } else { 0.0 };
        let common = DISTURBED_MISFIT * misfit + dry_rad_s2;
        let off = |state: &State| {
            let off = state.acceleration_rad_s2 - law.dot(&law_terms(state, scale));
            let more = scale.unknown_friction(state, &law);
            (off - off.clamp(more.min(0.0), more.max(0.0))).abs()
        };
        let limit = |state: &State| {
            let gravity = scale.gravity_at(self.amplitude_rad(state.time_s).max(typical_rad));
            let of_scale = SCALE_BEND_RAD * scale.squared_speed(state);
            common + DISTURBED_SHARE * law[0].abs() * gravity + of_scale + DISTURBED_NOISE * state.spread_rad_s2
        };
        let raw: Vec<bool> = self.states.iter().map(|state| off(state) > limit(state)).collect();
        self.law = law;
        self.disturbed = sustained(&raw);
        Some(())
    }

    /// Does something break the law there?
    pub(super) fn is_disturbed_within(&self, range: &Range<usize>) -> bool {
        let is_within = |state: &State| range.contains(&self.recording.index_at(state.time_s));
        self.states.iter().zip(&self.disturbed).any(|(state, disturbed)| *disturbed && is_within(state))
    }

    /// The law from states over as much of a half swing as a quartic can follow, where it hardly follows the usual ones of rates
    /// and follows those: something swings along faster, and the second derivative of a rate shows that by the square of how much.
    fn fit_law_blind_to_wobble(&mut self, scale: Scale, typical_rad: f64) -> Option<(Law, f64, f64)> {
        let found @ (law, misfit, _) = self.fit_law(scale)?;
        let is_angle = matches!(scale, Scale::Angle { .. });
        if is_angle || misfit < WOBBLE_SHARE * law[0].abs() * scale.gravity_at(typical_rad) {
            return Some(found);
        }
        let times_s = &self.times_s()[self.asked.start..];
        let angles_rad = &self.angles_rad()[self.asked.start..];
        let wide = states(times_s, angles_rad, self.whole_noise.total_rms, WIDEST * self.half_swing_s);
        let usual = std::mem::replace(&mut self.states, wide);
        match self.fit_law(scale) {
            Some(wide) if wide.1 < MOST_WOBBLE_LEFT * misfit => Some(wide),
            _ => {
                self.states = usual;
                Some(found)
            }
        }
    }

    /// The law from the middle half of the turning points on, the typical misfit (rad/s²), and the fastest speed that it
    /// follows. Bad states lose their vote from round to round.
    fn fit_law(&self, scale: Scale) -> Option<(Law, f64, f64)> {
        let n_turns = self.turns.len();
        let from_s = self.turns[(n_turns / 4).min(n_turns - MIN_TURNING_POINTS + 1)].time_s;
        let to_s = self.turns[n_turns - 1 - n_turns / 20].time_s;
        let trusted: Vec<&State> = self.states.iter().filter(|state| (from_s..=to_s).contains(&state.time_s)).collect();
        let mut limit = f64::INFINITY;
        let mut fitted = None;
        for _ in 0..N_ROUNDS {
            let law = least_squares(&trusted, scale, fitted.as_ref().map(|law| (law, limit)))?;
            let off = |state: &&State| (state.acceleration_rad_s2 - law.dot(&law_terms(state, scale))).abs();
            let misfit = 1.4826 * median(&mut trusted.iter().map(off).collect::<Vec<f64>>());
            limit = 4.0 * misfit;
            fitted = Some(law);
        }
        let law = fitted?;
        let follows = |state: &&&State| (state.acceleration_rad_s2 - law.dot(&law_terms(state, scale))).abs() <= limit;
        let fastest = trusted.iter().filter(follows).map(|state| state.velocity_rad_s.abs()).fold(0.0, f64::max);
        Some((law, limit / 4.0, fastest))
    }

    /// Half of the way from one turning point to the next around a moment, rad.
    pub(super) fn amplitude_rad(&self, time_s: f64) -> f64 {
        let behind = self.turns.partition_point(|turn| turn.time_s <= time_s).clamp(1, self.turns.len() - 1);
        (self.turns[behind].angle_rad - self.turns[behind - 1].angle_rad).abs() / 2.0
    }

    /// Median distance of turning points from their middle, rad.
    fn typical_amplitude_rad(&self) -> f64 {
        let mut amplitudes: Vec<f64> =
            self.turns.windows(2).map(|pair| (pair[1].angle_rad - pair[0].angle_rad).abs() / 2.0).collect();
        median(&mut amplitudes)
    }
}

pub(super) fn states(times_s: &[f64], angles_rad: &[f64], noise_rms_rad: f64, width_s: f64) -> Vec<State> {
    let step_s = median_step_s(times_s);
    let stride = ((width_s / (STATES_PER_WIDTH * step_s)) as usize).max(1);
    let moments = || times_s.iter().step_by(stride);
    let fits: Vec<LocalFit<5>> =
        moments().filter_map(|time_s| LocalFit::new(times_s, angles_rad, *time_s, width_s)).collect();
    let jitter_s = jitter_s(&fits, times_s, angles_rad, noise_rms_rad);
    let state = |fit: &LocalFit<5>| State {
        time_s: fit.centre_s(),
        angle_rad: fit.angle_rad(fit.centre_s()),
        velocity_rad_s: fit.velocity_rad_s(),
        acceleration_rad_s2: fit.acceleration_rad_s2(),
        spread_rad_s2: noise_rms_rad.hypot(jitter_s * fit.velocity_rad_s()) * fit.acceleration_spread(),
    };
    fits.iter().map(state).collect()
}

/// By how much the times of the readings are off (standard deviation, s): noise that grows with the speed, as that of a camera
/// whose frames are stamped late, which no rest shows. From the faster half of the states, so that a hand is none.
fn jitter_s(fits: &[LocalFit<5>], times_s: &[f64], angles_rad: &[f64], noise_rms_rad: f64) -> f64 {
    let mut speeds: Vec<f64> = fits.iter().map(|fit| fit.velocity_rad_s().abs()).collect();
    let typical_rad_s = median(&mut speeds);
    let fast = fits.iter().filter(|fit| fit.velocity_rad_s().abs() > typical_rad_s);
    let off_s = |fit: &LocalFit<5>| {
        let beyond_noise = fit.left_rms_rad(times_s, angles_rad).powi(2) - noise_rms_rad.powi(2);
        beyond_noise / fit.velocity_rad_s().powi(2)
    };
    let mut squares: Vec<f64> = fast.map(off_s).collect();
    if squares.is_empty() { 0.0 } else { median(&mut squares).max(0.0).sqrt() }
}

/// The law with the least squares; states further off an earlier law than its limit do not count.
fn least_squares(states: &[&State], scale: Scale, earlier: Option<(&Law, f64)>) -> Option<Law> {
    let mut normal = SMatrix::<f64, N_TERMS, N_TERMS>::identity() * 1e-9;
    let mut right = Law::zeros();
    for state in states {
        let terms = law_terms(state, scale);
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

#[cfg(test)]
mod tests {
    use crate::Recording;
    use crate::segment::{SegmentOptions, segment};

    /// Water or a magnet takes a fifth of a swing from turn to turn, and more; readings without noise show a tail of any length.
    #[test]
    fn large_swings_that_die_away_fast_are_no_hands_before_a_long_tail() {
        for damping in [0.6, 1.2, 2.0] {
            let (mut angle, mut velocity) = (0.5_f64, 0.0_f64);
            let mut readings = Vec::new();
            for step_idx in 0..100_000 {
                if step_idx % 50 == 0 {
                    readings.push(angle);
                }
                velocity -= 1e-4 * (39.5 * angle.sin() + damping * velocity);
                angle += 1e-4 * velocity;
            }
            let recording = Recording::uniform(200.0, readings).unwrap();
            let found = segment(&recording, &SegmentOptions::default()).unwrap();
            assert_eq!(found.free.start, 0, "{damping} {found:?}");
        }
    }

    /// The same, which a hand brought there: what drives it is no friction, however little is known of that.
    #[test]
    fn a_hand_before_a_long_tail_is_cut() {
        let (mut angle, mut velocity) = (0.0_f64, 0.0_f64);
        let mut readings = Vec::new();
        for step_idx in 0..120_000 {
            let time_s = f64::from(step_idx) * 1e-4;
            if step_idx % 50 == 0 {
                readings.push(angle);
            }
            let hand = if time_s < 2.0 { 30.0 * (5.0 * time_s).sin() } else { 0.0 };
            velocity -= 1e-4 * (39.5 * angle.sin() + 2.0 * velocity - hand);
            angle += 1e-4 * velocity;
        }
        let recording = Recording::uniform(200.0, readings).unwrap();
        let found = segment(&recording, &SegmentOptions::default()).unwrap();
        // It lets go at sample 400, and swings to one side in 100.
        assert!((400..=500).contains(&found.free.start), "{found:?}");
    }
}
