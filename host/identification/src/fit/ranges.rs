//! Ranges for the first design, from the rig and the recording, where the user gives none.

use super::problem::{Problem, Quantity, Unknown};
use crate::swing::{Swing, Window};
use shared::parameters::base;
use std::f64::consts::PI;

/// m·l² + I is sought within this share of its first guess.
const INERTIA_SHARE: f64 = 0.2;

/// Friction is sought up to this many times what the decay would need if it were alone.
const FRICTION_FACTOR: f64 = 2.0;

/// Stiction is sought up to this share of m·g·l.
const STICTION_SHARE: f64 = 0.05;

/// The velocity band is sought up to this at the usual pace, rad/s.
pub(super) const WIDEST_BAND: f64 = 0.06;

/// And up to this share of what would hold a swing at its largest angle, or of its largest speed.
const HELD_SHARE: f64 = 0.5;

/// A range for each unknown.
#[derive(Clone, Debug, PartialEq)]
pub struct Ranges(pub Vec<(f64, f64)>);

/// How a swing decays over its lively part.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Decay {
    /// Largest angle at its start and end, rad.
    from_rad: f64,
    to_rad: f64,
    /// Half swings between.
    n_half_swings: f64,
    /// Seconds between.
    seconds: f64,
}

impl Decay {
    /// Coulomb friction that shrinks the swing so if it is alone, N·m: by 2·Mc/mgl a half swing.
    fn coulomb_nm(&self, gravity_nm: f64) -> f64 {
        0.5 * gravity_nm * (self.from_rad - self.to_rad) / self.n_half_swings
    }
}

/// The most Coulomb friction that the swings allow, N·m: more would end one of them sooner than it does.
pub fn largest_coulomb_nm(problem: &Problem) -> f64 {
    let pendulum = &problem.template.pendulum;
    let gravity_nm = pendulum.gravity_torque_nm();
    let half_swing_s = PI * (pendulum.pivot_inertia_kg_m2() / gravity_nm).sqrt();
    let lasting = |swing: &Swing| {
        let n_samples = swing.samples_within(Window::Lively);
        let seconds = n_samples.checked_sub(1).map_or(0.0, |last| swing.times_s[last]);
        let from_rad = swing.sizes_rad().take(n_samples).fold(0.0_f64, |largest, angle| largest.max(angle.abs()));
        Decay { from_rad, to_rad: 0.0, n_half_swings: (seconds / half_swing_s).max(1.0), seconds }
            .coulomb_nm(gravity_nm)
    };
    problem.swings.iter().map(lasting).fold(f64::INFINITY, f64::min)
}

/// Friction of one kind that makes the swings decay as they do.
#[derive(Clone, Copy, Debug)]
pub(super) struct Alone {
    /// N·m·s/rad.
    pub(super) viscous: f64,
    /// N·m.
    pub(super) coulomb_nm: f64,
}

/// The largest that one of the swings wants, of either kind; never nothing.
pub(super) fn friction_alone(problem: &Problem, inertia_kg_m2: f64) -> Alone {
    let decays: Vec<Decay> = problem.swings.iter().filter_map(decay).collect();
    alone(problem, &decays, inertia_kg_m2)
}

fn alone(problem: &Problem, decays: &[Decay], inertia_kg_m2: f64) -> Alone {
    let least = |id: u16| {
        let is_it = |unknown: &&Unknown| matches!(unknown.quantity, Quantity::Effect { id: its, .. } if its == id);
        problem.unknowns.iter().find(is_it).map_or(0.0, |unknown| 1e-3 * unknown.scale)
    };
    let largest = |value: &dyn Fn(&Decay) -> f64| decays.iter().map(value).fold(0.0, f64::max);
    let pivot = pivot_inertia(problem, inertia_kg_m2);
    // Alone, viscous friction shrinks the amplitude by exp(−Mw·t/2J).
    let viscous = largest(&|d| 2.0 * pivot * (d.from_rad / d.to_rad).ln() / d.seconds);
    let coulomb_nm = largest(&|d| d.coulomb_nm(problem.template.pendulum.gravity_torque_nm()));
    Alone { viscous: viscous.max(least(base::VISCOUS)), coulomb_nm: coulomb_nm.max(least(base::COULOMB)) }
}

fn pivot_inertia(problem: &Problem, inertia_kg_m2: f64) -> f64 {
    let pendulum = &problem.template.pendulum;
    pendulum.mass_kg * pendulum.length_m * pendulum.length_m + inertia_kg_m2
}

/// Ranges for all unknowns; `inertia_kg_m2` is the first guess at I.
pub fn from_recording(problem: &Problem, inertia_kg_m2: f64) -> Ranges {
    let decays: Vec<Decay> = problem.swings.iter().filter_map(decay).collect();
    let largest = |value: &dyn Fn(&Decay) -> f64| decays.iter().map(value).fold(0.0, f64::max);
    let gravity = problem.template.pendulum.gravity_torque_nm();
    let pivot = pivot_inertia(problem, inertia_kg_m2);
    let alone = alone(problem, &decays, inertia_kg_m2);
    // A level that holds the release, or a band that no swing leaves, is seen by nothing.
    let reached_rad = HELD_SHARE * if decays.is_empty() { f64::INFINITY } else { largest(&|d| d.from_rad) };
    let range = |unknown: &Unknown| match unknown.quantity {
        Quantity::Inertia => {
            let half = INERTIA_SHARE * pivot;
            ((inertia_kg_m2 - half).max(unknown.low), inertia_kg_m2 + half)
        }
        Quantity::Effect { id: base::VISCOUS, .. } => (0.0, FRICTION_FACTOR * alone.viscous),
        Quantity::Effect { id: base::COULOMB, .. } => (0.0, FRICTION_FACTOR * alone.coulomb_nm),
        Quantity::Effect { id: base::STICTION, index: 0 } => (0.0, gravity * reached_rad.min(STICTION_SHARE)),
        Quantity::Effect { id: base::STICTION, .. } => {
            (0.0, (reached_rad * (gravity / pivot).sqrt()).min(WIDEST_BAND / problem.pace()))
        }
        _ => (unknown.low, unknown.high),
    };
    Ranges(problem.unknowns.iter().map(range).collect())
}

fn decay(swing: &Swing) -> Option<Decay> {
    let n_samples = swing.samples_within(Window::Lively);
    let angles: Vec<f64> = swing.sizes_rad().take(n_samples).collect();
    let crossings: Vec<usize> = (1..n_samples).filter(|i| angles[i - 1] * angles[*i] < 0.0).collect();
    // Noise may cross zero more than once; those lobes stay below its peaks.
    let mut lobes: Vec<(usize, f64)> = Vec::new();
    let mut from = 0;
    for to in crossings.into_iter().chain([n_samples]) {
        let peak = angles[from..to].iter().fold(0.0_f64, |peak, a| peak.max(a.abs()));
        if peak > PEAK_NOISES * swing.noise_rad {
            lobes.push((from, peak));
        }
        from = to;
    }
    let (first, last) = (lobes.first()?, lobes.get(lobes.len().checked_sub(2)?)?);
    let n_half_swings = (lobes.len() - 2) as f64;
    let seconds = swing.times_s[last.0] - swing.times_s[first.0];
    let sensible = n_half_swings >= 1.0 && seconds > 0.0 && first.1 > last.1;
    sensible.then_some(Decay { from_rad: first.1, to_rad: last.1, n_half_swings, seconds })
}

/// A lobe's peak rises this far out of the noise.
const PEAK_NOISES: f64 = 6.0;
