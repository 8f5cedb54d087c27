//! The model linearised at a guess: residuals, their derivatives, and the normal equations.

use super::arrow::Arrow;
use super::problem::{PER_SWING, Point, Problem, Start};
use crate::cores::on_all_cores;
use crate::swing::Window;
use nalgebra::{DMatrix, DVector};

/// Finite-difference steps are chosen so that the readings change by about this much (rms, rad): far above rounding,
/// far below where the curvature shows.
const WANTED_CHANGE_RAD: f64 = 1e-5;

/// A step that changes the readings by less, even when enlarged, has no effect.
const NO_CHANGE_RAD: f64 = 1e-12;

/// Derivative step for the start angle (rad) and velocity (rad/s).
const START_STEP: f64 = 1e-6;

/// One swing, linearised.
#[derive(Clone, Debug)]
pub struct SwingLinear {
    /// Measured minus predicted, rad.
    pub residuals: Vec<f64>,
    /// Derivatives of the prediction, a column an unknown, then start angle, velocity and offset.
    pub columns: Vec<Vec<f64>>,
}

/// The normal equations of all swings at a guess.
#[derive(Clone, Debug)]
pub struct Equations {
    /// JᵀJ; unknowns first, then angle, velocity and offset of each swing.
    pub normal: Arrow,
    /// Jᵀr.
    pub gradient: DVector<f64>,
    /// rᵀr, rad².
    pub cost: f64,
    /// Number of residuals.
    pub n_samples: usize,
}

impl Equations {
    /// How much a step would lower the cost, rad², were the model linear.
    pub fn gain(&self, step: &DVector<f64>) -> f64 {
        2.0 * self.gradient.dot(step) - self.normal.quadratic(step)
    }
}

/// All swings, linearised at a guess.
#[derive(Clone, Debug)]
pub struct Linear<'a> {
    columns: Columns<'a>,
    n_unknowns: usize,
    /// The normal equations.
    pub equations: Equations,
}

/// Residuals and columns of each swing. Those of many swings would fill the memory, and are cheap to make anew.
#[derive(Clone, Debug)]
enum Columns<'a> {
    Kept(Vec<SwingLinear>),
    Anew(Box<Place<'a>>),
}

/// The columns of up to so many swings are kept.
const MOST_KEPT: usize = 16;

impl<'a> Linear<'a> {
    /// Of linearised swings that have so many unknowns in common.
    pub fn of(n_unknowns: usize, swings: Vec<SwingLinear>) -> Self {
        let equations = assemble(n_unknowns, on_all_cores(&swings, Block::of));
        Self { columns: Columns::Kept(swings), n_unknowns, equations }
    }

    fn at(place: Place<'a>) -> Self {
        let n_unknowns = place.problem.unknowns.len();
        if place.problem.swings.len() <= MOST_KEPT {
            return Self::of(n_unknowns, place.each(|_, swing| swing));
        }
        let equations = place.equations();
        Self { columns: Columns::Anew(Box::new(place)), n_unknowns, equations }
    }

    /// What something is of each swing.
    pub fn each<T: Send>(&self, of: impl Fn(usize, &SwingLinear) -> T + Sync) -> Vec<T> {
        match &self.columns {
            Columns::Kept(swings) => on_all_cores(swings.iter().enumerate(), |(idx, swing)| of(idx, swing)),
            Columns::Anew(place) => place.each(|idx, swing| of(idx, &swing)),
        }
    }

    /// One vector of what the swings share and of what is each one's own.
    pub(super) fn together<'b>(&self, swings: impl Iterator<Item = Option<&'b Vec<f64>>>) -> DVector<f64> {
        let mut sum = DVector::zeros(self.equations.gradient.len());
        for (swing_idx, values) in swings.enumerate() {
            let place = |j: usize| if j < self.n_unknowns { j } else { j + PER_SWING * swing_idx };
            values.into_iter().flatten().enumerate().for_each(|(j, value)| sum[place(j)] += value);
        }
        sum
    }

    /// How many numbers the swings share.
    pub fn n_unknowns(&self) -> usize {
        self.n_unknowns
    }

    /// Number of swings.
    pub fn n_swings(&self) -> usize {
        (self.equations.gradient.len() - self.n_unknowns) / PER_SWING
    }
}

/// Where a problem is linearised, and the unknowns moved for it.
#[derive(Clone, Debug)]
struct Place<'a> {
    problem: Problem<'a>,
    point: Point,
    window: Window,
    /// The values with one unknown moved, and by how much.
    moved: Vec<(Vec<f64>, f64)>,
}

impl<'a> Place<'a> {
    fn new(problem: &Problem<'a>, point: &Point, window: Window, steps: &Steps) -> Self {
        let moved = moved_values(problem, point, steps);
        Self { problem: problem.clone(), point: point.clone(), window, moved }
    }

    fn each<T: Send>(&self, of: impl Fn(usize, SwingLinear) -> T + Sync) -> Vec<T> {
        let of_swing = |swing_idx: usize| of(swing_idx, self.of_swing(swing_idx));
        on_all_cores(0..self.problem.swings.len(), of_swing)
    }

    fn equations(&self) -> Equations {
        assemble(self.problem.unknowns.len(), self.each(|_, swing| Block::of(&swing)))
    }

    fn of_swing(&self, swing_idx: usize) -> SwingLinear {
        let swing = &self.problem.swings[swing_idx];
        let n_samples = swing.samples_within(self.window);
        let (values, start) = (self.point.values.as_slice(), self.point.starts[swing_idx]);
        let mut guesses: Vec<(&[f64], Start)> = vec![(values, start)];
        guesses.extend(self.moved.iter().map(|(values, _)| (values.as_slice(), start)));
        guesses.push((values, Start { angle_rad: start.angle_rad + START_STEP, ..start }));
        guesses.push((values, Start { velocity_rad_s: start.velocity_rad_s + START_STEP, ..start }));
        let mut predicted = self.problem.predict(swing_idx, n_samples, &guesses);

        let base = predicted.remove(0);
        let steps = self.moved.iter().map(|(_, step)| *step).chain([START_STEP; 2]);
        for (column, step) in predicted.iter_mut().zip(steps) {
            column.iter_mut().zip(&base).for_each(|(moved, base)| *moved = (*moved - base) / step);
        }
        predicted.push(vec![1.0; n_samples]);
        let residuals = swing.angles_rad.iter().zip(&base).map(|(m, p)| m - p - start.offset_rad).collect();
        SwingLinear { residuals, columns: predicted }
    }
}

/// The finite-difference step of each unknown; it adapts from one linearisation to the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Steps(pub Vec<f64>);

impl Steps {
    /// First steps, from the unknowns' scales.
    pub fn new(problem: &Problem) -> Self {
        Self(problem.unknowns.iter().map(|unknown| 1e-4 * unknown.scale).collect())
    }

    /// The right steps at a guess, found on decimated swings.
    pub fn found(problem: &Problem, point: &Point) -> Self {
        let mut steps = Self::new(problem);
        equations(&problem.on(&problem.decimated()), point, Window::Whole, &mut steps);
        steps
    }

    /// `moved` as it gave the equations.
    fn adapt(&mut self, problem: &Problem, moved: &[(Vec<f64>, f64)], equations: &Equations) {
        let n_samples = equations.n_samples.max(1) as f64;
        let change = |j: usize, step: f64| step.abs() * (equations.normal.square(j) / n_samples).sqrt();
        let changes_rad = moved.iter().enumerate().map(|(j, (_, step))| change(j, *step));
        for ((step, unknown), change) in self.0.iter_mut().zip(&problem.unknowns).zip(changes_rad) {
            let factor = if change > NO_CHANGE_RAD { WANTED_CHANGE_RAD / change } else { 100.0 };
            *step = (*step * factor.clamp(1e-3, 1e2)).min(0.1 * unknown.scale);
        }
    }
}

/// Linearises at a guess within a window.
pub fn linearise<'a>(problem: &Problem<'a>, point: &Point, window: Window, steps: &mut Steps) -> Linear<'a> {
    let place = Place::new(problem, point, window, steps);
    let moved = place.moved.clone();
    let mut linear = Linear::at(place);
    steps.adapt(problem, &moved, &linear.equations);
    add_penalties(problem, point, window, &mut linear.equations);
    linear
}

/// The normal equations alone.
pub fn equations(problem: &Problem, point: &Point, window: Window, steps: &mut Steps) -> Equations {
    let place = Place::new(problem, point, window, steps);
    let mut equations = place.equations();
    steps.adapt(problem, &place.moved, &equations);
    add_penalties(problem, point, window, &mut equations);
    equations
}

/// What keeps numbers near what is known of them, and a friction curve straight, at a guess.
fn add_penalties(problem: &Problem, point: &Point, window: Window, equations: &mut Equations) {
    add_priors(problem, point, equations);
    add_ridge(problem, point, window, equations);
}

/// A prior is one more reading, of the unknown itself.
fn add_priors(problem: &Problem, point: &Point, equations: &mut Equations) {
    let mut shared = DMatrix::zeros(problem.unknowns.len(), problem.unknowns.len());
    let known = problem.unknowns.iter().zip(&point.values).enumerate();
    for (j, (prior, value)) in known.filter_map(|(j, (unknown, value))| Some((j, (unknown.prior?, *value)))) {
        let (off, weight) = (prior.off(value), problem.least_variance());
        equations.cost += weight * off.powi(2);
        equations.gradient[j] -= weight * off / prior.std;
        if off != 0.0 || !prior.only_below {
            shared[(j, j)] = weight / prior.std.powi(2);
        }
    }
    equations.normal.add_shared(&shared);
}

/// What keeps a friction curve straight, at a guess.
fn add_ridge(problem: &Problem, point: &Point, window: Window, equations: &mut Equations) {
    let Some((ridge, knots)) = problem.ridge.as_ref().zip(problem.knots()) else { return };
    let weighted = ridge.weighted(problem.n_samples(window));
    let torques = DVector::from_column_slice(&point.values[knots.clone()]);
    let pull = &weighted * &torques;
    equations.cost += torques.dot(&pull);
    let mut gradient = equations.gradient.rows_mut(knots.start, knots.len());
    gradient -= pull;
    let mut shared = DMatrix::zeros(problem.unknowns.len(), problem.unknowns.len());
    shared.view_mut((knots.start, knots.start), (knots.len(), knots.len())).copy_from(&weighted);
    equations.normal.add_shared(&shared);
}

/// The normal equations at a guess with more unknowns than `known`, whose columns are taken over: exact where the new
/// unknowns do nothing yet, good enough for a first step elsewhere. The new unknowns stand last in the problem.
pub fn equations_with_added(problem: &Problem, point: &Point, window: Window, known: &Linear) -> Equations {
    let mut steps = Steps::new(problem);
    // The first time finds the right steps, the second uses them.
    with_added(problem, point, window, known, &mut steps);
    with_added(problem, point, window, known, &mut steps)
}

fn with_added(problem: &Problem, point: &Point, window: Window, known: &Linear, steps: &mut Steps) -> Equations {
    let moved = moved_values(problem, point, steps);
    let added = &moved[known.n_unknowns..];
    let of_swing = |swing_idx: usize, known_swing: &SwingLinear| {
        let swing = &problem.swings[swing_idx];
        let start = point.starts[swing_idx];
        let mut guesses: Vec<(&[f64], Start)> = vec![(&point.values, start)];
        guesses.extend(added.iter().map(|(values, _)| (values.as_slice(), start)));
        let mut predicted = problem.predict(swing_idx, swing.samples_within(window), &guesses);
        let base = predicted.remove(0);
        for (column, (_, step)) in predicted.iter_mut().zip(added) {
            column.iter_mut().zip(&base).for_each(|(moved, base)| *moved = (*moved - base) / step);
        }
        let (unknowns, starts) = known_swing.columns.split_at(known.n_unknowns);
        let columns: Vec<&[f64]> = unknowns.iter().chain(&predicted).chain(starts).map(Vec::as_slice).collect();
        let residuals: Vec<f64> = swing.angles_rad.iter().zip(&base).map(|(m, p)| m - p - start.offset_rad).collect();
        Block::new(&residuals, &columns)
    };
    let mut equations = assemble(problem.unknowns.len(), known.each(of_swing));
    steps.adapt(problem, &moved, &equations);
    add_penalties(problem, point, window, &mut equations);
    equations
}

/// The guess with one unknown moved, for each unknown, and by how much: inwards where a bound is near.
fn moved_values(problem: &Problem, point: &Point, steps: &Steps) -> Vec<(Vec<f64>, f64)> {
    let moved = |j: usize| {
        let mut values = point.values.clone();
        let step = if values[j] + steps.0[j] > problem.unknowns[j].high { -steps.0[j] } else { steps.0[j] };
        values[j] += step;
        (values, step)
    };
    (0..problem.unknowns.len()).map(moved).collect()
}

/// What one swing adds to the normal equations.
struct Block {
    normal: DMatrix<f64>,
    gradient: DVector<f64>,
    cost: f64,
    n_samples: usize,
}

impl Block {
    fn of(swing: &SwingLinear) -> Self {
        let columns: Vec<&[f64]> = swing.columns.iter().map(Vec::as_slice).collect();
        Self::new(&swing.residuals, &columns)
    }

    fn new(residuals: &[f64], columns: &[&[f64]]) -> Self {
        let n_columns = columns.len();
        let mut normal = DMatrix::zeros(n_columns, n_columns);
        for i in 0..n_columns {
            for j in 0..=i {
                let product = dot(columns[i], columns[j]);
                normal[(i, j)] = product;
                normal[(j, i)] = product;
            }
        }
        let gradient = DVector::from_iterator(n_columns, columns.iter().map(|column| dot(column, residuals)));
        Self { normal, gradient, cost: dot(residuals, residuals), n_samples: residuals.len() }
    }
}

/// The normal equations of all swings.
fn assemble(n_unknowns: usize, blocks: Vec<Block>) -> Equations {
    let mut gradient = DVector::zeros(n_unknowns + PER_SWING * blocks.len());
    for (swing_idx, block) in blocks.iter().enumerate() {
        let place = |j: usize| if j < n_unknowns { j } else { j + PER_SWING * swing_idx };
        (0..block.gradient.len()).for_each(|i| gradient[place(i)] += block.gradient[i]);
    }
    let cost = blocks.iter().map(|block| block.cost).sum();
    let n_samples = blocks.iter().map(|block| block.n_samples).sum();
    let blocks: Vec<DMatrix<f64>> = blocks.into_iter().map(|block| block.normal).collect();
    Equations { normal: Arrow::new(n_unknowns, PER_SWING, &blocks), gradient, cost, n_samples }
}

/// Sum of products, in four parts that the processor works on together.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 4];
    let (chunks_a, chunks_b) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = chunks_a.remainder().iter().zip(chunks_b.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in chunks_a.zip(chunks_b) {
        (0..4).for_each(|k| sums[k] += x[k] * y[k]);
    }
    sums.iter().sum::<f64>() + rest
}
