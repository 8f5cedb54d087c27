//! Cutting a release into windows: so many periods each, from one upward zero crossing to another.
//!
//! A window begins where a cubic through the readings around its first instant says; what that is off by, the window's
//! own start columns take up.

use crate::real::Real;

/// A crossing counts after the pendulum was on the other side by this many noises.
const BACK_NOISES: f64 = 4.0;

/// Windows of smaller swings are left out: below so many noises nothing is to be seen. Half and twice were not tried.
const LEAST_NOISES: f64 = 8.0;

/// Below so many rad stiction decides. Half and twice were not tried.
pub(super) const LEAST_RAD: f64 = 0.05;

/// The cubic at the start lies through this part of a period on either side, as short as the pendulum's sine is one.
const CUBICS_A_PERIOD: usize = 14;

/// What the rest of the bank knows of the readings of one release, in rad, evenly sampled from about its release on.
pub trait Readings<R> {
    /// How many.
    fn len(&self) -> usize;
    /// One of them.
    fn at(&self, index: usize) -> R;
    /// None?
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl<R: Copy> Readings<R> for [R] {
    fn len(&self) -> usize {
        self.len()
    }
    fn at(&self, index: usize) -> R {
        self[index]
    }
}

/// A part of a release.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window<R> {
    /// Its first reading …
    pub first: usize,
    /// … and the first one behind it.
    pub end: usize,
    /// Angle at the first reading, rad.
    pub angle_rad: R,
    /// Velocity there, rad/s.
    pub velocity_rad_s: R,
}

/// Finds the windows of a release, one after the other.
pub struct Windows<'a, R, D: ?Sized> {
    readings: &'a D,
    offset_rad: R,
    noise_rad: R,
    interval_s: R,
    n_periods: usize,
    next: Option<usize>,
}

impl<'a, R: Real<Mask = bool>, D: Readings<R> + ?Sized> Windows<'a, R, D> {
    /// Of so many periods, on readings with this zero and this noise.
    pub fn new(readings: &'a D, interval_s: R, (offset_rad, noise_rad): (R, R), n_periods: usize) -> Self {
        let mut windows = Self { readings, offset_rad, noise_rad, interval_s, n_periods, next: None };
        windows.next = windows.crossing_after(0);
        windows
    }

    fn angle(&self, index: usize) -> R {
        self.readings.at(index) - self.offset_rad
    }

    /// The next upward zero crossing: the first reading that is not below zero after one that was clearly below.
    fn crossing_after(&self, from: usize) -> Option<usize> {
        let clearly = R::of(BACK_NOISES) * self.noise_rad;
        let below = (from..self.readings.len()).find(|i| self.angle(*i).lt(-clearly))?;
        (below..self.readings.len()).find(|i| R::zero().le(self.angle(*i)))
    }

    fn amplitude_rad(&self, from: usize, to: usize) -> R {
        (from..to).fold(R::zero(), |largest, index| largest.max(self.angle(index).abs()))
    }

    /// Angle and velocity by a cubic through the readings up to so many before and behind.
    fn start_at(&self, index: usize, n_around: usize) -> Option<(R, R)> {
        let last = index + n_around;
        if index < n_around || self.readings.len() <= last {
            return None;
        }
        let [mut s0, mut s2, mut s4, mut s6] = [R::zero(); 4];
        let [mut y0, mut y1, mut y2, mut y3] = [R::zero(); 4];
        for i in index - n_around..=last {
            let t = (R::of(i as f64) - R::of(index as f64)) / R::of(n_around as f64);
            let (square, y) = (t * t, self.angle(i));
            (s0, s2, s4, s6) = (s0 + R::one(), s2 + square, s4 + square * square, s6 + square * square * square);
            (y0, y1, y2, y3) = (y0 + y, y1 + t * y, y2 + square * y, y3 + t * square * y);
        }
        let angle = (y0 * s4 - y2 * s2) / (s0 * s4 - s2 * s2);
        let slope = (y1 * s6 - y3 * s4) / (s2 * s6 - s4 * s4);
        Some((angle, slope / (R::of(n_around as f64) * self.interval_s)))
    }
}

impl<R: Real<Mask = bool>, D: Readings<R> + ?Sized> Iterator for Windows<'_, R, D> {
    type Item = Window<R>;

    fn next(&mut self) -> Option<Window<R>> {
        let least = R::of(LEAST_RAD).max(R::of(LEAST_NOISES) * self.noise_rad);
        loop {
            let first = self.next?;
            let (mut last_period, mut end) = (first, first);
            for _ in 0..self.n_periods {
                last_period = end;
                end = self.crossing_after(end)?;
            }
            self.next = Some(end);
            if self.amplitude_rad(last_period, end).lt(least) {
                return None;
            }
            let n_around = ((end - first) / (self.n_periods * CUBICS_A_PERIOD)).max(MIN_AROUND);
            if let Some((angle_rad, velocity_rad_s)) = self.start_at(first, n_around) {
                return Some(Window { first, end, angle_rad, velocity_rad_s });
            }
        }
    }
}

/// A cubic needs this many readings on either side.
const MIN_AROUND: usize = 3;

/// The noise of readings, rad: from differences of sixth order, in which a swing of 20 samples a period
/// leaves nothing.
pub fn noise_rad<R: Real<Mask = bool>, D: Readings<R> + ?Sized>(readings: &D) -> R {
    let weights = WEIGHTS.map(R::of);
    let difference = |i: usize| {
        let terms = weights.iter().enumerate();
        terms.fold(R::zero(), |sum, (k, weight)| sum + *weight * readings.at(i + k))
    };
    let n = readings.len().max(WEIGHTS.len()) - WEIGHTS.len();
    let sum = (0..n).fold(R::zero(), |sum, i| sum + difference(i) * difference(i));
    (sum / (R::of(SQUARE_OF_WEIGHTS) * R::of(n.max(1) as f64))).sqrt()
}

const WEIGHTS: [f64; 7] = [1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0];
const SQUARE_OF_WEIGHTS: f64 = 924.0;
