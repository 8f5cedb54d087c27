//! The model put right before anything is judged: zero, friction, inertia and the strengths it has, by Gauss and
//! Newton's steps over the windows.
//!
//! A test around a stale model accuses the innocent, and a few per cent of inertia are stale enough. Short windows come
//! first, because over them even a period that is several per cent off is no more than a small angle off.

use super::column::{Columns, MAX_KNOWN, N_BASE, N_STARTS};
use super::follow::{Follower, Track};
use super::judge::Known;
use super::sums::{Block, Sums};
use super::window::{Readings, Window, Windows, noise_rad};
use crate::motion::Pendulum;
use crate::parameters::{Parameters, base};
use crate::real::Real;
use heapless::Vec;

/// The most releases that are looked at together.
pub const MAX_RELEASES: usize = 8;

/// Steps over windows of one period, at most so many …
const SHORT_STEPS: usize = 2;

/// … then as many over longer ones as it takes, at most so many.
const LONG_STEPS: usize = 6;

/// Steps over short windows are not needed where the inertia about the pivot moves by no more than this share: at the end
/// of long ones the phase is then off by a twentieth of a radian. With half or twice of it the tests of looks find the
/// same.
const NEAR_INERTIA: f64 = 6e-3;

/// Where an effect has been added, whose size may be far off yet; its sizes are measured by one more.
const STEPS_WITH_EFFECT: usize = 9;

/// After a step that promised to lower the squares by less than this many squares of the noise, what is left to do is
/// linear. With half, a tenth or twice of it nine rounds of blind rigs come out alike; a tenth takes a tenth more work.
pub const STILL: f64 = 500.0;

/// If the last step still moves the inertia about the pivot by more than this share, the model is none of this
/// pendulum.
const SETTLED: f64 = 6e-3;

/// Windows are so many periods long, the first of these of which there are enough: shorter ones see little of a slow
/// effect, longer ones are too few.
const PERIODS: [usize; 3] = [3, 2, 1];

/// So many are enough. Half and twice were not tried.
const ENOUGH_WINDOWS: usize = 10;

/// The model takes no more than about so many steps a period, or one a reading. By the paper's pendulum with a hidden
/// drag it leaves 0.5 % of the noise's squares more than steps from reading to reading do; half of it leaves 2 %,
/// twice 0.1 %. A look's work grows with it.
const STEPS_A_PERIOD: usize = 40;

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

/// Somebody who watches steps: what is kept of the last one's windows, and whether it was enough.
pub trait Watch<R: 'static> {
    /// A step begins, with these columns.
    fn begin(&mut self, columns: &Columns<R>);

    /// What one of its windows says.
    fn take(&mut self, window: &Sums<R>);

    /// Is a step enough that will leave these squares, so much less than before (in squares of the noise)?
    fn is_enough(&self, left: R, gain: R) -> bool;
}

/// Nobody does.
struct Unwatched;

impl<R: Real<Mask = bool>> Watch<R> for Unwatched {
    fn begin(&mut self, _: &Columns<R>) {}

    fn take(&mut self, _: &Sums<R>) {}

    fn is_enough(&self, _: R, gain: R) -> bool {
        gain.lt(R::of(STILL))
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

/// What a model is put right on: memory that is far too large for a stack.
pub struct Bench<R: 'static> {
    /// The columns of the model.
    pub columns: Columns<R>,
    track: Track<R>,
    block: Block<R>,
    window: Sums<R>,
    /// Sums over windows.
    pub all: Sums<R>,
    /// What the known columns make of them.
    pub known: Known<R>,
}

impl<R: Copy> Bench<R> {
    /// Empty, given zero.
    pub const fn empty(zero: R) -> Self {
        Self {
            columns: Columns::empty(),
            track: Track::empty(zero),
            block: Block::empty(zero),
            window: Sums::empty(zero),
            all: Sums::empty(zero),
            known: Known::empty(zero),
        }
    }
}

impl<R: Copy> Refitted<R> {
    /// None, given zero.
    pub const fn empty(zero: R) -> Self {
        let pendulum = Pendulum::all(zero);
        let parameters = Parameters { pendulum, effects: Vec::new(), formula: None, curve: None };
        Self { parameters, offset_rad: zero, has_band: false }
    }
}

impl<R: Real<Mask = bool>> Refitted<R> {
    /// The model as it was given.
    #[inline(never)]
    pub fn begin(&mut self, parameters: &Parameters<R>) {
        self.parameters = parameters.clone();
        (self.offset_rad, self.has_band) = (R::zero(), false);
    }

    /// As another one.
    #[inline(never)]
    pub fn copy(&mut self, other: &Self) {
        *self = other.clone();
    }

    /// Without stiction, which large swings do not show, and without a velocity band.
    pub fn take_band_out(&mut self) {
        self.set_stiction(R::zero());
    }

    /// Puts a velocity band right too. Between its edges acts the friction at the edge; a larger stop level looks like
    /// a wider band. False where the readings do not determine it.
    pub fn settle_band<D: Readings<R> + ?Sized>(&mut self, on: &Releases<R, D>, bench: &mut Bench<R>) -> bool {
        self.has_band = true;
        self.set_stiction(R::zero());
        self.steps(on, STEPS_WITH_EFFECT, bench, &mut Unwatched)
    }

    fn set_stiction(&mut self, velocity_band: R) {
        let _ = self.parameters.set(base::STICTION, &[R::zero(), velocity_band]);
    }

    /// Is put right by the readings. From near, it begins with the step that the bench knows, and goes on with long
    /// windows. False where the readings do not determine it.
    pub fn settle<D: Readings<R> + ?Sized>(
        &mut self,
        on: &Releases<R, D>,
        is_near: bool,
        bench: &mut Bench<R>,
    ) -> bool {
        if is_near {
            self.apply(&bench.columns, &bench.known.step);
        }
        (is_near || self.short_steps(on, bench)) && self.steps(on, LONG_STEPS, bench, &mut Unwatched)
    }

    fn short_steps<D: Readings<R> + ?Sized>(&mut self, on: &Releases<R, D>, bench: &mut Bench<R>) -> bool {
        for _ in 0..SHORT_STEPS {
            match self.step(on, 1, bench, &mut Unwatched) {
                None => return false,
                Some((moved, _)) if is_small(moved) => break,
                Some(_) => {}
            }
        }
        true
    }

    /// Is it so near that its inertia about the pivot would hardly move, by what all windows say?
    pub fn is_near(&self, bench: &mut Bench<R>) -> bool {
        let Bench { columns, all, known, .. } = bench;
        let inertia = N_STARTS + N_BASE - 1;
        known.solve(all, columns.known.len())
            && is_small(known.step[inertia] / self.parameters.pendulum.pivot_inertia_kg_m2())
    }

    /// Takes in an effect at these values, its known numbers moved by a step, and a velocity band; is put right again.
    pub fn settle_with<D: Readings<R> + ?Sized>(
        &mut self,
        on: &Releases<R, D>,
        (id, values): (u16, &[R]),
        known_step: &[R; MAX_KNOWN],
        bench: &mut Bench<R>,
        watched: &mut dyn Watch<R>,
    ) -> bool {
        bench.columns.fill(&self.parameters, self.has_band);
        self.apply(&bench.columns, known_step);
        self.has_band = true;
        self.parameters.set(id, values).is_ok() && self.steps(on, STEPS_WITH_EFFECT + 1, bench, watched)
    }

    /// Steps over windows of a look's length.
    fn steps<D: Readings<R> + ?Sized>(
        &mut self,
        on: &Releases<R, D>,
        n_most: usize,
        bench: &mut Bench<R>,
        watched: &mut dyn Watch<R>,
    ) -> bool {
        let (n_periods, unit) = (self.n_periods(on), on.noise_rad * on.noise_rad);
        let mut last = R::zero();
        for _ in 0..n_most {
            let Some((moved, gain)) = self.step(on, n_periods, bench, watched) else { return false };
            last = moved.abs();
            if watched.is_enough(bench.known.square / unit, gain / unit) {
                break;
            }
        }
        last.lt(R::of(SETTLED))
    }

    /// How long the windows of a look are, in periods.
    pub fn n_periods<D: Readings<R> + ?Sized>(&self, on: &Releases<R, D>) -> usize {
        PERIODS.into_iter().find(|n_periods| ENOUGH_WINDOWS <= self.n_windows(on, *n_periods)).unwrap_or(1)
    }

    /// How many windows of so many periods there are.
    #[inline(never)]
    pub fn n_windows<D: Readings<R> + ?Sized>(&self, on: &Releases<R, D>, n_periods: usize) -> usize {
        let zero = (self.offset_rad, on.noise_rad);
        let windows = |readings: &&D| Windows::new(*readings, on.interval_s, zero, n_periods).count();
        on.readings.iter().map(windows).sum()
    }

    /// Follows every window beside the bench's columns and gives its sums, its own start eliminated, with the bench's
    /// sums and what it knows.
    #[inline(never)]
    pub fn each_window<D: Readings<R> + ?Sized>(
        &self,
        on: &Releases<R, D>,
        has_candidates: bool,
        n_periods: usize,
        bench: &mut Bench<R>,
        take: &mut dyn FnMut(&Sums<R>, &mut Sums<R>, &Columns<R>, &Known<R>),
    ) {
        let Bench { columns, track, block, window: sums, all, known } = bench;
        let mut follower = Follower::new(track, &self.parameters, columns, has_candidates);
        for readings in &on.readings {
            for window in Windows::new(*readings, on.interval_s, (self.offset_rad, on.noise_rad), n_periods) {
                let most = (window.end - window.first) / (n_periods * STEPS_A_PERIOD);
                let angle = |index: usize| readings.at(index) - self.offset_rad;
                follow(&mut follower, &window, (most.max(1), on.interval_s), &angle, block, sums);
                sums.eliminate_starts();
                take(sums, all, columns, known);
            }
        }
    }

    /// One step to where the windows are explained best; by which share it moves the inertia about the pivot, and by how
    /// much it promises to lower the squares (rad²).
    #[inline(never)]
    fn step<D: Readings<R> + ?Sized>(
        &mut self,
        on: &Releases<R, D>,
        n_periods: usize,
        bench: &mut Bench<R>,
        watched: &mut dyn Watch<R>,
    ) -> Option<(R, R)> {
        bench.columns.fill(&self.parameters, self.has_band);
        bench.all.clear();
        watched.begin(&bench.columns);
        self.each_window(on, false, n_periods, bench, &mut |window, all, _, _| {
            all.add(window);
            watched.take(window);
        });
        let Bench { columns, all, known, .. } = bench;
        if !known.solve(all, columns.known.len()) {
            return None;
        }
        Some((self.apply(columns, &known.step), known.gain(all)))
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

/// Is a share by which the inertia moves small enough for long windows?
fn is_small<R: Real<Mask = bool>>(moved: R) -> bool {
    moved.abs().lt(R::of(NEAR_INERTIA))
}

/// Follows a window from step to step, at most so many intervals in s each, and sums up what each of its angles (rad)
/// says.
#[inline(never)]
fn follow<R: Real<Mask = bool>>(
    follower: &mut Follower<R>,
    window: &Window<R>,
    (most, interval_s): (usize, R),
    angle: &dyn Fn(usize) -> R,
    block: &mut Block<R>,
    sums: &mut Sums<R>,
) {
    let (n_known, n_added) = follower.n_columns();
    let last = window.end - 1;
    let mut index = window.first;
    sums.clear();
    follower.start(window.angle_rad, window.velocity_rad_s, R::of(window.first as f64) * interval_s);
    let reading_rad = follower.read(block);
    block.add(angle(index) - reading_rad);
    while index < last {
        let n = follower.stride(most, interval_s).min(last - index);
        follower.advance_over(n, interval_s, &mut |share, reading_rad| {
            index += 1;
            block.add_between(angle(index) - reading_rad, share);
        });
        index += 1;
        if block.is_full() {
            sums.add_block(block, n_known, n_added);
        }
        let reading_rad = follower.read(block);
        block.add(angle(index) - reading_rad);
    }
    sums.add_block(block, n_known, n_added);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_its_band_a_model_has_no_stiction_and_keeps_its_friction() {
        let paper = Parameters::<f64>::paper();
        assert!(paper.values(base::STICTION).unwrap().iter().any(|value| *value > 0.0));
        let mut refitted = Refitted::empty(0.0);
        refitted.begin(&paper);
        refitted.take_band_out();
        assert_eq!(refitted.parameters.values(base::STICTION).unwrap()[..], [0.0, 0.0]);
        assert_eq!(refitted.parameters.values(base::COULOMB), paper.values(base::COULOMB));
    }
}
