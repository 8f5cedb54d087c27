//! Which jump of the rate, if any, would explain the motion about each place of a swing?
//!
//! In: a swing, and a model that follows it. Out: a place every half swing, with the jump within that half swing which
//! takes most of what is left in a window about it. The window begins anew, and its friction and its period may differ from
//! the model's, so that what a model gathers, and what it lacks in losses or in stiffness, is no jump: to first order these
//! are the answers of the readings to another angle, rate and zero, to a dry, a viscous and a restoring torque
//! ([`super::super::response`]), which are taken out of residuals and jumps alike. It is the score test of an impulse, window
//! by window.

use crate::cores::on_all_cores;
use crate::fit::clusters::{beyond, orthonormal};
use crate::fit::linear::dot;
use crate::fit::problem::Start;
use crate::fit::response::{Path, moved};
use crate::recording::turning::half_swing_s;
use crate::swing::{Swing, Window};
use shared::parameters::Parameters;
use simulation::{Transition, inverse, readings};
use std::ops::Range;

/// Half swings of a window on either side of its middle. With two, jumps and what a window may do by itself are hardly told
/// apart: of 51 bumps of simulated swings 17 are placed right in place of 46. With three 45 are, but about the first swings
/// of real recordings smooth errors look like jumps. Twice was not tried.
pub(super) const BESIDE: usize = 4;

/// Readings of a half swing that are looked at, as means of their neighbours: they show a jump as well as all do.
const READINGS: usize = 32;

/// A jump of which less is left, as a square, is what the window may do by itself.
const OWN: f64 = 1e-6;

/// The jump that explains most within one half swing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    /// When, s since the swing's first sample.
    pub(super) time_s: f64,
    /// How large, rad/s.
    pub(super) jump_rad_s: f64,
    /// Its standard deviation, rad/s.
    pub(super) std_rad_s: f64,
    /// What it takes of the squared residuals, rad².
    pub(super) gain: f64,
    /// The same over the variance of what stays, or that of the noise.
    pub(super) chi_square: f64,
    /// The same as a share of all that is beyond the noise.
    pub(super) share: f64,
    /// A half swing, s.
    pub(super) half_swing_s: f64,
}

/// The places of a swing, a half swing apart, from the first to the last that has a whole window.
pub(super) fn places(swing: &Swing, parameters: &Parameters<f64>, start: Start) -> Vec<Place> {
    let Some(seen) = Seen::of(swing, parameters, start) else { return Vec::new() };
    let last_s = seen.times_s.last().copied().unwrap_or(0.0);
    let n_half_swings = (last_s / seen.half_swing_s) as usize;
    let middles = BESIDE..(n_half_swings + 1).saturating_sub(BESIDE);
    on_all_cores(middles, |k| seen.place(k as f64 * seen.half_swing_s)).into_iter().flatten().collect()
}

/// A swing beside its model, thinned.
struct Seen {
    half_swing_s: f64,
    times_s: Vec<f64>,
    residuals: Vec<f64>,
    /// Variance of one of them that noise makes.
    noise: f64,
    path: Path,
    /// From the first reading to each.
    transitions: Vec<Transition>,
    /// What a window may do by itself.
    own: Vec<Vec<f64>>,
}

impl Seen {
    /// Until the pendulum hardly swings; `None` where it never does.
    fn of(swing: &Swing, parameters: &Parameters<f64>, start: Start) -> Option<Self> {
        let n_samples = swing.samples_within(Window::Lively);
        let times_s = &swing.times_s[..n_samples];
        let sizes_rad: Vec<f64> = swing.sizes_rad().take(n_samples).collect();
        let half_swing_s = half_swing_s(times_s, &sizes_rad, swing.size_rad(swing.noise_rad))?;
        let every = ((n_samples as f64 * half_swing_s / times_s.last()?) as usize / READINGS).max(1);
        let residuals = means(&residuals(swing, parameters, start, n_samples), every);
        let times_s: Vec<f64> = times_s.iter().copied().step_by(every).collect();
        let path = Path::of(parameters, start, &swing.like(&times_s, &residuals));
        let transitions = path.from_the_first();
        // Friction that does not depend on the speed, friction that does, and what restores.
        let torques = |[angle, rate]: [f64; 2]| vec![(0, -rate.signum()), (1, -rate), (2, -angle.sin())];
        let mut own = path.answers(3, torques);
        own.extend([0, 1].map(|j| transitions.iter().map(|by| path.read([by[0][j], by[1][j]])).collect()));
        own.push(vec![1.0; times_s.len()]);
        let noise = swing.noise_rad.powi(2) / every as f64;
        Some(Self { half_swing_s, times_s, residuals, noise, path, transitions, own })
    }

    /// The readings from one time to another, each in half swings from a middle (s).
    fn within(&self, middle_s: f64, from: f64, to: f64) -> Range<usize> {
        let index =
            |half_swings: f64| self.times_s.partition_point(|t| *t < middle_s + half_swings * self.half_swing_s);
        index(from)..index(to)
    }

    fn place(&self, middle_s: f64) -> Option<Place> {
        let window = self.within(middle_s, -(BESIDE as f64), BESIDE as f64);
        let basis = orthonormal(self.own.iter().map(|column| &column[window.clone()]));
        let residuals = beyond(&self.residuals[window.clone()], &basis);
        let jump = |at: usize| self.jump(at, &window, &basis, &residuals);
        self.within(middle_s, -0.5, 0.5).filter_map(jump).max_by(|a, b| a.gain.total_cmp(&b.gain))
    }

    /// A jump at one reading, in a window of which its own columns and what these leave are given.
    fn jump(&self, at: usize, window: &Range<usize>, basis: &[Vec<f64>], residuals: &[f64]) -> Option<Place> {
        let first = moved(&inverse(&self.transitions[at])?, [0.0, 1.0]);
        let answer = |i: usize| if i <= at { 0.0 } else { self.path.read(moved(&self.transitions[i], first)) };
        let answers: Vec<f64> = window.clone().map(answer).collect();
        let column = beyond(&answers, basis);
        let (square, product) = (dot(&column, &column), dot(&column, residuals));
        // A window has these numbers, the jump and its time.
        let n_numbers = self.own.len() + 2;
        if window.len() <= n_numbers || square <= OWN * dot(&answers, &answers) {
            return None;
        }
        let gain = product.powi(2) / square;
        let freedom = (window.len() - n_numbers) as f64;
        let left = (dot(residuals, residuals) - gain).max(0.0);
        let variance = (left / freedom).max(self.noise);
        Some(Place {
            time_s: self.times_s[at],
            jump_rad_s: product / square,
            std_rad_s: (variance / square).sqrt(),
            gain,
            chi_square: gain / variance,
            share: gain / (gain + (left - freedom * self.noise).max(0.0)),
            half_swing_s: self.half_swing_s,
        })
    }
}

/// Measured minus modelled at the first samples.
fn residuals(swing: &Swing, parameters: &Parameters<f64>, start: Start, n_samples: usize) -> Vec<f64> {
    let modelled = readings(parameters, start.release(swing), swing.schedule(parameters), n_samples);
    let left = |(measured, modelled): (&f64, &f64)| measured - modelled - start.offset_rad;
    swing.angles_rad.iter().zip(&modelled).map(left).collect()
}

/// Means of so many values about every so many-th.
fn means(values: &[f64], every: usize) -> Vec<f64> {
    let about = |at: usize| {
        let near = &values[at.saturating_sub(every / 2)..(at + every.div_ceil(2)).min(values.len())];
        near.iter().sum::<f64>() / near.len() as f64
    };
    (0..values.len()).step_by(every).map(about).collect()
}
