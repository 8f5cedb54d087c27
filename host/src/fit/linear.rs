//! The model linearised at a guess: residuals, their derivatives, and the normal equations.

use super::problem::{PER_SWING, Point, Problem, Start};
use crate::swing::Window;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

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

/// All swings, linearised at a guess.
#[derive(Clone, Debug)]
pub struct Linear {
    /// One a swing.
    pub swings: Vec<SwingLinear>,
    /// JᵀJ; unknowns first, then angle, velocity and offset of each swing.
    pub normal: DMatrix<f64>,
    /// Jᵀr.
    pub gradient: DVector<f64>,
    /// rᵀr, rad².
    pub cost: f64,
    /// Number of residuals.
    pub n_samples: usize,
}

impl Linear {
    /// How much a step would lower the cost, rad², were the model linear.
    pub fn gain(&self, step: &DVector<f64>) -> f64 {
        2.0 * self.gradient.dot(step) - step.dot(&(&self.normal * step))
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
        linearise(&problem.on(&problem.decimated()), point, Window::Whole, &mut steps);
        steps
    }

    /// `moved` as it gave `linear`.
    fn adapt(&mut self, problem: &Problem, moved: &[(Vec<f64>, f64)], linear: &Linear) {
        let n_samples = linear.n_samples.max(1) as f64;
        let change = |j: usize, step: f64| step.abs() * (linear.normal[(j, j)] / n_samples).sqrt();
        let changes_rad = moved.iter().enumerate().map(|(j, (_, step))| change(j, *step));
        for ((step, unknown), change) in self.0.iter_mut().zip(&problem.unknowns).zip(changes_rad) {
            let factor = if change > NO_CHANGE_RAD { WANTED_CHANGE_RAD / change } else { 100.0 };
            *step = (*step * factor.clamp(1e-3, 1e2)).min(0.1 * unknown.scale);
        }
    }
}

/// Linearises at a guess within a window.
pub fn linearise(problem: &Problem, point: &Point, window: Window, steps: &mut Steps) -> Linear {
    let moved = moved_values(problem, point, steps);
    let swings: Vec<SwingLinear> = (0..problem.swings.len())
        .into_par_iter()
        .map(|swing_idx| linearise_swing(problem, point, window, &moved, swing_idx))
        .collect();
    let linear = assemble(problem.unknowns.len(), swings);
    steps.adapt(problem, &moved, &linear);
    linear
}

/// Linearises at a guess with more unknowns than `known`, whose columns are taken over: exact where the new unknowns
/// do nothing yet, good enough for a first step elsewhere. The new unknowns stand last in the problem.
pub fn linearise_added(problem: &Problem, point: &Point, window: Window, known: &Linear) -> Linear {
    let mut steps = Steps::new(problem);
    // The first linearisation finds the right steps, the second uses them.
    with_added(problem, point, window, known, &mut steps);
    with_added(problem, point, window, known, &mut steps)
}

fn with_added(problem: &Problem, point: &Point, window: Window, known: &Linear, steps: &mut Steps) -> Linear {
    let n_known = known.gradient.len() - PER_SWING * known.swings.len();
    let moved = moved_values(problem, point, steps);
    let added = &moved[n_known..];
    let of_swing = |swing_idx: usize| {
        let swing = &problem.swings[swing_idx];
        let start = point.starts[swing_idx];
        let mut guesses: Vec<(&[f64], Start)> = vec![(&point.values, start)];
        guesses.extend(added.iter().map(|(values, _)| (values.as_slice(), start)));
        let mut predicted = problem.predict(swing_idx, swing.samples_within(window), &guesses);
        let base = predicted.remove(0);
        for (column, (_, step)) in predicted.iter_mut().zip(added) {
            column.iter_mut().zip(&base).for_each(|(moved, base)| *moved = (*moved - base) / step);
        }
        let (unknowns, starts) = known.swings[swing_idx].columns.split_at(n_known);
        let residuals = swing.angles_rad.iter().zip(&base).map(|(m, p)| m - p - start.offset_rad).collect();
        SwingLinear { residuals, columns: [unknowns, &predicted, starts].concat() }
    };
    let swings = (0..problem.swings.len()).into_par_iter().map(of_swing).collect();
    let linear = assemble(problem.unknowns.len(), swings);
    steps.adapt(problem, &moved, &linear);
    linear
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

fn linearise_swing(
    problem: &Problem,
    point: &Point,
    window: Window,
    moved: &[(Vec<f64>, f64)],
    swing_idx: usize,
) -> SwingLinear {
    let swing = &problem.swings[swing_idx];
    let n_samples = swing.samples_within(window);
    let start = point.starts[swing_idx];
    let mut guesses: Vec<(&[f64], Start)> = vec![(&point.values, start)];
    guesses.extend(moved.iter().map(|(values, _)| (values.as_slice(), start)));
    guesses.push((&point.values, Start { angle_rad: start.angle_rad + START_STEP, ..start }));
    guesses.push((&point.values, Start { velocity_rad_s: start.velocity_rad_s + START_STEP, ..start }));
    let mut predicted = problem.predict(swing_idx, n_samples, &guesses);

    let base = predicted.remove(0);
    let steps = moved.iter().map(|(_, step)| *step).chain([START_STEP; 2]);
    for (column, step) in predicted.iter_mut().zip(steps) {
        column.iter_mut().zip(&base).for_each(|(moved, base)| *moved = (*moved - base) / step);
    }
    predicted.push(vec![1.0; n_samples]);
    let residuals = swing.angles_rad.iter().zip(&base).map(|(m, p)| m - p - start.offset_rad).collect();
    SwingLinear { residuals, columns: predicted }
}

/// Builds the normal equations of all swings.
fn assemble(n_unknowns: usize, swings: Vec<SwingLinear>) -> Linear {
    let size = n_unknowns + PER_SWING * swings.len();
    let mut normal = DMatrix::zeros(size, size);
    let mut gradient = DVector::zeros(size);
    let mut cost = 0.0;
    let blocks: Vec<(DMatrix<f64>, DVector<f64>)> = swings.par_iter().map(normal_of_swing).collect();
    for (swing_idx, (block, slope)) in blocks.iter().enumerate() {
        let place = |j: usize| if j < n_unknowns { j } else { j + PER_SWING * swing_idx };
        for i in 0..slope.len() {
            gradient[place(i)] += slope[i];
            for j in 0..slope.len() {
                normal[(place(i), place(j))] += block[(i, j)];
            }
        }
        cost += dot(&swings[swing_idx].residuals, &swings[swing_idx].residuals);
    }
    let n_samples = swings.iter().map(|swing| swing.residuals.len()).sum();
    Linear { swings, normal, gradient, cost, n_samples }
}

fn normal_of_swing(swing: &SwingLinear) -> (DMatrix<f64>, DVector<f64>) {
    let n_columns = swing.columns.len();
    let mut normal = DMatrix::zeros(n_columns, n_columns);
    for i in 0..n_columns {
        for j in 0..=i {
            let product = dot(&swing.columns[i], &swing.columns[j]);
            normal[(i, j)] = product;
            normal[(j, i)] = product;
        }
    }
    (normal, DVector::from_iterator(n_columns, swing.columns.iter().map(|column| dot(column, &swing.residuals))))
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
