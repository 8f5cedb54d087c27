//! Where a hand has let go for sure: the first half swings must follow, backwards in time, from those behind them.
//!
//! In: a free swing by its accelerations, whose beginning was somebody's. Out: from which sample on it follows. What moves it
//! by some percent of gravity is lost in accelerations, but adds up to a tenth of the amplitude within half a swing. So
//! `θ̈ = −a sin θ + b cos θ − c sgn ω − d ω` is fitted to the angles of two swings and followed backwards through the half
//! swing before them. How far it is off there, it should also be off before later ones: what the law does not know of
//! the pendulum is much the same in all of them, and so is the noise.

use super::super::median;
use super::Cut;
use nalgebra::{SMatrix, SVector};
use std::f64::consts::PI;
use std::ops::Range;

/// Half swings to which the law is fitted: fewer do not tell damping from dry friction.
pub(super) const FITTED: usize = 4;

/// Half swings that are doubted, behind a hand that was seen.
const DOUBTED: usize = 2;

/// So many later ones, at least, say how far off is usual …
pub(super) const FEWEST_USUAL: usize = 4;

/// … and so many at most.
pub(super) const MOST_USUAL: usize = 6;

/// A half swing that is off so many times as far as usual does not follow. Of 108 recordings of strangers the first or the
/// second one does not in ten: in six, of which the three that were looked at jump or are moved there, and in four that have too few
/// samples or too large swings, or are off by less than [`OFF_SHARE`]. With half of it it does not in nine more, with
/// twice of it two of the six are missed.
const OFF_TIMES: f64 = 7.0;

/// … and by this share of the amplitude (rms). With half of it swings of 2.5 rad, whose largest one is 1.2 % off, would be cut,
/// with twice of it the second half swing of an uneven clock stays.
const OFF_SHARE: f64 = 0.02;

/// Beyond this angle a pendulum slows down towards upright, and what is not known of it grows there, rad.
const STEEP_RAD: f64 = 2.0;

/// Samples of a half swing that are looked at, at most, …
const MOST_SAMPLES: usize = 40;

/// … or where each sample counts, …
const MOST_LOOKED: usize = 200;

/// … and at least: fewer leave too few for the numbers of the law.
const FEWEST_SAMPLES: usize = 8;

/// Steps through a hole in the rows, at most: ten half swings. Half of it and twice of it were not tried.
const MOST_STEPS: f64 = 80.0;

/// Rounds of the fit: enough for the same recordings.
const N_ROUNDS: usize = 6;

/// Speed below which dry friction turns, as a share of the largest.
const SLOW_SHARE: f64 = 0.05;

/// A sample, and how far it is off (rad).
pub(super) type Off = (usize, f64);

/// Angle, speed, and the four numbers of the law.
type Start = SVector<f64, 6>;

impl Cut<'_> {
    /// From which sample of a range on it follows from what is behind.
    pub(super) fn follows_from(&self, range: &Range<usize>) -> usize {
        let n_ends = DOUBTED + MOST_USUAL + FITTED;
        let turned = self.turns_in(range).into_iter().map(|turn| self.recording.index_at(turn.time_s));
        let ends: Vec<usize> = std::iter::once(range.start).chain(turned).take(n_ends + 1).collect();
        let n_looks = ends.len().saturating_sub(FITTED + 1);
        let off: Vec<f64> = (0..n_looks).map(|look| self.off_before(&ends[look..=look + 1 + FITTED])).collect();
        if n_looks < DOUBTED + FEWEST_USUAL || off.iter().any(|off| off.is_nan()) {
            return range.start;
        }
        let usual = median(&mut off[DOUBTED..].to_vec());
        let amplitude_rad = self.amplitude_rad(self.times_s()[ends[DOUBTED]]);
        let is_off = |look: &usize| off[*look] > (OFF_TIMES * usual).max(OFF_SHARE * amplitude_rad);
        (0..DOUBTED).rev().find(is_off).map_or(range.start, |look| ends[look + 1])
    }

    /// How far the angles between the first two of these ends are off what those between the others say (rms, rad); NaN where it
    /// can't be told.
    fn off_before(&self, ends: &[usize]) -> f64 {
        self.off_beside(ends[0]..ends[1], ends[1]..ends[ends.len() - 1])
    }

    /// How far the angles of one range, before or behind another, are off what those of the other one say, which is
    /// [`FITTED`] half swings long (rms, rad); NaN where it can't be told. What lies between them is not asked.
    pub(super) fn off_beside(&self, looked: Range<usize>, fitted: Range<usize>) -> f64 {
        if self.is_steep(&looked) || self.is_steep(&fitted) {
            return f64::NAN;
        }
        let (near, far, to) = match looked.start <= fitted.start {
            true => (fitted.start, fitted.end, looked.start),
            false => (fitted.end, fitted.start, looked.end),
        };
        let Some(off) = self.off_along(near, far, to, MOST_SAMPLES) else { return f64::NAN };
        let asked = off.iter().filter(|(idx, _)| looked.start <= *idx && *idx <= looked.end);
        let squares: Vec<f64> = asked.map(|(_, off)| off * off).collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    }

    /// Samples from one on, away from another one up to which the law is fitted, and how far each is off that (rad); `None` where
    /// it can't be told.
    pub(super) fn off_from(&self, from: usize, inward: usize, to: usize) -> Option<Vec<Off>> {
        let is_steep = |end: usize| self.is_steep(&(from.min(end)..from.max(end) + 1));
        if is_steep(inward) || is_steep(to) { None } else { self.off_along(from, inward, to, MOST_LOOKED) }
    }

    /// The same, however steep, with so many samples of a half swing at most.
    fn off_along(&self, from: usize, inward: usize, to: usize, most_samples: usize) -> Option<Vec<Off>> {
        let n_half_swing = from.abs_diff(inward) / FITTED;
        if n_half_swing < FEWEST_SAMPLES {
            return None;
        }
        let start = self.fitted(&outward(from, inward, n_half_swing.div_ceil(MOST_SAMPLES)))?;
        let away = outward(from, to, n_half_swing.div_ceil(most_samples));
        Some(away.iter().copied().zip(self.off(&start, &away)).collect())
    }

    fn is_steep(&self, range: &Range<usize>) -> bool {
        self.angles_rad()[range.clone()].iter().any(|angle| angle.abs() > STEEP_RAD)
    }

    /// The start and the law that leave the least squares at these samples.
    fn fitted(&self, samples: &[usize]) -> Option<Start> {
        let frequency_rad_s = PI / self.half_swing_s;
        let gravity_rad_s2 = frequency_rad_s.powi(2);
        // Of large swings the period alone is too far off.
        let is_near = (gravity_rad_s2..2.0 * gravity_rad_s2).contains(&self.law[0]);
        let [known_rad_s2, tilt_rad_s2] = if is_near { [self.law[0], self.law[1]] } else { [gravity_rad_s2, 0.0] };
        let mut start = Start::from([self.angles_rad()[samples[0]], 0.0, known_rad_s2, tilt_rad_s2, 0.0, 0.0]);
        // So far each number is moved for a derivative: a change of the angles far above rounding, and nearly linear.
        let steps =
            Start::from([1.0, frequency_rad_s, gravity_rad_s2, gravity_rad_s2, gravity_rad_s2, frequency_rad_s]);
        let steps = 1e-4 * steps;
        for _ in 0..N_ROUNDS {
            let off = self.off(&start, samples);
            let moved = |idx: usize| {
                let mut moved = start;
                moved[idx] += steps[idx];
                self.off(&moved, samples)
            };
            let columns: [Vec<f64>; 6] = std::array::from_fn(moved);
            let mut normal = SMatrix::<f64, 6, 6>::zeros();
            let mut right = Start::zeros();
            for (row, off) in off.iter().enumerate() {
                let slopes = Start::from_fn(|idx, _| off - columns[idx][row]);
                normal += slopes * slopes.transpose();
                right += slopes * *off;
            }
            start += steps.component_mul(&(normal.try_inverse()? * right));
        }
        start.iter().all(|number| number.is_finite()).then_some(start)
    }

    /// Measured less simulated angles at these samples, in their order, from the first of them on.
    fn off(&self, start: &Start, samples: &[usize]) -> Vec<f64> {
        let slow_rad_s = SLOW_SHARE * start[0].abs() * PI / self.half_swing_s;
        let (mut state, mut time_s) = ([start[0], start[1]], self.times_s()[samples[0]]);
        let mut off = Vec::with_capacity(samples.len());
        for idx in samples {
            let until_s = self.times_s()[*idx] - time_s;
            // Rows may be missing, for however long: through more than some swings nothing is told anyway.
            let n_steps = (until_s.abs() * FEWEST_SAMPLES as f64 / self.half_swing_s).ceil().clamp(1.0, MOST_STEPS);
            for _ in 0..n_steps as usize {
                state = stepped(state, until_s / n_steps, start, slow_rad_s);
            }
            time_s = self.times_s()[*idx];
            off.push(self.angles_rad()[*idx] - state[0]);
        }
        off
    }
}

/// One sample in so many, from one on to another one, on either side of it.
fn outward(from: usize, to: usize, every: usize) -> Vec<usize> {
    if to < from { (to..=from).rev().step_by(every).collect() } else { (from..=to).step_by(every).collect() }
}

/// The hyperbolic tangent, by one exponential: that of the library took half of a look through a hole in the rows.
fn soft_sign(of: f64) -> f64 {
    // Beyond, it is one to the last bit.
    let grown = (2.0 * of.clamp(-20.0, 20.0)).exp();
    (grown - 1.0) / (grown + 1.0)
}

/// A step of Runge and Kutta, of either sign.
fn stepped(state: [f64; 2], step_s: f64, law: &Start, slow_rad_s: f64) -> [f64; 2] {
    let slope = |[angle, velocity]: [f64; 2]| {
        let friction = law[4] * soft_sign(velocity / slow_rad_s) + law[5] * velocity;
        [velocity, -law[2] * angle.sin() + law[3] * angle.cos() - friction]
    };
    let add = |to: [f64; 2], slope: [f64; 2], step_s: f64| [to[0] + step_s * slope[0], to[1] + step_s * slope[1]];
    let first = slope(state);
    let second = slope(add(state, first, step_s / 2.0));
    let third = slope(add(state, second, step_s / 2.0));
    let fourth = slope(add(state, third, step_s));
    let sum = [0, 1].map(|idx| first[idx] + 2.0 * second[idx] + 2.0 * third[idx] + fourth[idx]);
    add(state, sum, step_s / 6.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_soft_sign_is_the_hyperbolic_tangent() {
        for of in [-400.0, -20.0, -3.0, -0.7, -1e-9, 0.0, 0.01, 1.0, 8.0, 25.0] {
            let (found, library) = (soft_sign(of), f64::tanh(of));
            assert!((found - library).abs() < 1e-15, "{of}: {found} in place of {library}");
        }
    }
}
