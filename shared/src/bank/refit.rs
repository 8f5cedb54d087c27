//! The model put right before anything is judged: zero, friction, inertia and the strengths it has, by Gauss and
//! Newton's steps over the windows.
//!
//! A test around a stale model accuses the innocent, and a few per cent of inertia are stale enough. Short windows come
//! first, because over them even a period that is several per cent off is no more than a small angle off.

use super::column::{Columns, MAX_KNOWN, N_BASE, N_STARTS};
use super::follow::Follower;
use super::sums::Sums;
use super::window::{Readings, Windows, noise_rad};
use crate::parameters::{Parameters, base};
use crate::real::Real;
use crate::score::inverted;
use heapless::Vec;

/// The most releases that are looked at together.
pub const MAX_RELEASES: usize = 8;

/// Steps over windows of one period …
const SHORT_STEPS: usize = 2;

/// … then as many over longer ones as it takes, at most so many.
const LONG_STEPS: usize = 6;

/// Where an effect has been added, whose size may be far off yet.
const STEPS_WITH_EFFECT: usize = 9;

/// A step that promises to lower the squares by less than this many squares of the noise changes nothing that could be
/// seen.
const STILL: f64 = 0.01;

/// If the last step still moves the inertia about the pivot by more than this share, the model is none of this
/// pendulum.
const SETTLED: f64 = 6e-3;

/// Windows are so many periods long, the first of these of which there are enough: shorter ones see little of a slow
/// effect, longer ones are too few.
const PERIODS: [usize; 3] = [3, 2, 1];
const ENOUGH_WINDOWS: usize = 10;

/// A step changes the inertia about the pivot by no more than this share: what is further off comes by several.
const LARGEST_STEP: f64 = 0.1;

/// The readings of several releases, evenly sampled.
pub struct Releases<'a, R, D: ?Sized> {
    /// Of each release, from about its first instant on.
    pub readings: Vec<&'a D, MAX_RELEASES>,
    /// Between two readings, s.
    pub interval_s: R,
    /// Their noise, rad.
    pub noise_rad: R,
}

impl<'a, R: Real<Mask = bool>, D: Readings<R> + ?Sized> Releases<'a, R, D> {
    /// The last ones of those given, evenly sampled with this interval in s.
    pub fn new(readings: &[&'a D], interval_s: R) -> Self {
        let last = &readings[readings.len().max(MAX_RELEASES) - MAX_RELEASES..];
        let mut squares = R::zero();
        let mut n = R::zero();
        for readings in last {
            let (noise, own) = (noise_rad(*readings), R::of(readings.len() as f64));
            (squares, n) = (squares + own * noise * noise, n + own);
        }
        let noise_rad = (squares / n.max(R::one())).sqrt();
        Self { readings: last.iter().copied().collect(), interval_s, noise_rad }
    }
}

/// A model with the zero of its sensor.
#[derive(Clone, Debug)]
pub struct Refitted<R> {
    /// The model.
    pub parameters: Parameters<R>,
    /// What is added to its readings, rad.
    pub offset_rad: R,
    /// Is the width of its velocity band put right too? It is zero otherwise.
    pub has_band: bool,
}

impl<R: Real<Mask = bool>> Refitted<R> {
    /// The model as it was given.
    pub fn new(parameters: &Parameters<R>) -> Self {
        Self { parameters: parameters.clone(), offset_rad: R::zero(), has_band: false }
    }

    /// Without stiction, which large swings do not show, and without a velocity band.
    pub fn without_band(mut self) -> Self {
        self.set_stiction(R::zero());
        self
    }

    /// With a velocity band, put right. Between its edges acts the friction at the edge; a larger stop level looks like
    /// a wider band.
    pub fn with_band<D: Readings<R> + ?Sized>(&self, on: &Releases<R, D>) -> Option<Self> {
        let mut larger = Self { has_band: true, ..self.clone() };
        larger.set_stiction(R::zero());
        larger.stepped(on, STEPS_WITH_EFFECT)
    }

    fn set_stiction(&mut self, velocity_band: R) {
        let _ = self.parameters.set(base::STICTION, &[R::zero(), velocity_band]);
    }

    /// The columns of this model.
    pub fn columns(&self) -> Columns<R> {
        Columns::new(&self.parameters, self.has_band)
    }

    /// Put right by the readings. `None` where they do not determine it.
    pub fn settled<D: Readings<R> + ?Sized>(mut self, on: &Releases<R, D>) -> Option<Self> {
        for _ in 0..SHORT_STEPS {
            self.step(on, 1)?;
        }
        self.stepped(on, LONG_STEPS)
    }

    /// With an effect at these values, its known numbers moved by a step, and with a velocity band; put right again.
    pub fn with<D: Readings<R> + ?Sized>(
        &self,
        on: &Releases<R, D>,
        (id, values): (u16, &[R]),
        known_step: &[R; MAX_KNOWN],
    ) -> Option<Self> {
        let mut larger = Self { has_band: true, ..self.clone() };
        larger.apply(&self.columns(), known_step);
        larger.parameters.set(id, values).ok()?;
        larger.stepped(on, STEPS_WITH_EFFECT)
    }

    /// Steps over windows of a look's length.
    fn stepped<D: Readings<R> + ?Sized>(mut self, on: &Releases<R, D>, n_most: usize) -> Option<Self> {
        let (n_periods, still) = (self.n_periods(on), R::of(STILL) * on.noise_rad * on.noise_rad);
        let mut last = R::zero();
        for _ in 0..n_most {
            let (moved, gain) = self.step(on, n_periods)?;
            last = moved.abs();
            if gain.lt(still) {
                break;
            }
        }
        last.lt(R::of(SETTLED)).then_some(self)
    }

    /// How long the windows of a look are, in periods.
    pub fn n_periods<D: Readings<R> + ?Sized>(&self, on: &Releases<R, D>) -> usize {
        PERIODS.into_iter().find(|n_periods| ENOUGH_WINDOWS <= self.n_windows(on, *n_periods)).unwrap_or(1)
    }

    /// How many windows of so many periods there are.
    pub fn n_windows<D: Readings<R> + ?Sized>(&self, on: &Releases<R, D>, n_periods: usize) -> usize {
        let zero = (self.offset_rad, on.noise_rad);
        let windows = |readings: &&D| Windows::new(*readings, on.interval_s, zero, n_periods).count();
        on.readings.iter().map(windows).sum()
    }

    /// Follows every window and gives its sums, its own start eliminated.
    #[inline(never)]
    pub fn each_window<D: Readings<R> + ?Sized>(
        &self,
        on: &Releases<R, D>,
        n_periods: usize,
        columns: &Columns<R>,
        has_candidates: bool,
        take: &mut dyn FnMut(&Sums<R>),
    ) {
        let mut follower = Follower::new(&self.parameters, columns, has_candidates);
        let mut sums = Sums::default();
        for readings in &on.readings {
            for window in Windows::new(*readings, on.interval_s, (self.offset_rad, on.noise_rad), n_periods) {
                sums.clear();
                follower.start(window.angle_rad, window.velocity_rad_s, R::of(window.first as f64) * on.interval_s);
                for index in window.first..window.end {
                    if index > window.first {
                        follower.advance(on.interval_s);
                    }
                    let prediction = follower.read();
                    let residual = readings.at(index) - self.offset_rad - prediction.reading_rad;
                    sums.add_reading(residual, prediction.known, prediction.added);
                }
                sums.eliminate_starts();
                take(&sums);
            }
        }
    }

    /// One step to where the windows are explained best; by which share it moves the inertia about the pivot, and by how
    /// much it promises to lower the squares (rad²).
    #[inline(never)]
    fn step<D: Readings<R> + ?Sized>(&mut self, on: &Releases<R, D>, n_periods: usize) -> Option<(R, R)> {
        let columns = self.columns();
        let mut sums = Sums::default();
        self.each_window(on, n_periods, &columns, false, &mut |window| sums.add(window));
        let inverse = inverted(&sums.known, N_STARTS, columns.known.len())?;
        let step: [R; MAX_KNOWN] = core::array::from_fn(|i| {
            (0..MAX_KNOWN).fold(R::zero(), |sum, j| sum + inverse[i][j] * sums.known_score[j])
        });
        let gain = step.iter().zip(&sums.known_score).fold(R::zero(), |sum, (step, score)| sum + *step * *score);
        Some((self.apply(&columns, &step), gain))
    }

    /// Moves the known numbers, but the inertia not too far; by which share that was to be moved.
    fn apply(&mut self, columns: &Columns<R>, step: &[R; MAX_KNOWN]) -> R {
        let pendulum = &mut self.parameters.pendulum;
        let whole = pendulum.pivot_inertia_kg_m2();
        let largest = R::of(LARGEST_STEP) * whole;
        let [_, _, offset, viscous, coulomb, inertia, ..] = *step;
        let share = (largest / inertia.abs().max(largest)).min(R::one());
        pendulum.inertia_kg_m2 = (pendulum.inertia_kg_m2 + share * inertia).max(R::zero());
        self.offset_rad = self.offset_rad + share * offset;
        let dry = [(base::VISCOUS, viscous), (base::COULOMB, coulomb)];
        dry.iter().for_each(|(id, change)| self.change(*id, 0, share * *change, R::zero()));
        let strengths = step.iter().skip(N_STARTS + N_BASE);
        for ((id, index), change) in columns.present.iter().zip(strengths) {
            let least = if base::has(*id) { R::zero() } else { -R::of(f64::from(f32::MAX)) };
            self.change(*id, usize::from(*index), share * *change, least);
        }
        inertia / whole
    }

    fn change(&mut self, id: u16, index: usize, by: R, least: R) {
        let effect = self.parameters.effects.iter_mut().find(|effect| effect.id == id);
        if let Some(value) = effect.and_then(|effect| effect.values.get_mut(index)) {
            *value = (*value + by).max(least);
        }
    }
}
