//! Sequential response surface methodology: the paper's method, made to converge.
//!
//! Each stage runs a face-centred central composite design, fits the five response surfaces, and moves to their
//! optimum. The paper's own sequence does not converge from its own wide ranges: far from the truth the error surface
//! is no parabola and the next box shuts the truth out. Three things cure that: the time window grows, so that early
//! stages see a smooth error; a move is accepted only if the simulated error falls; a box is re-centred before its
//! width changes, and shrinks only when its optimum lies inside or its surface cannot be believed (it predicts runs
//! that were left out badly, or the simulation does not keep what it promised): a trust region of surfaces.
//!
//! Start angle, velocity and offset of each swing are solved for in every run, to first order.

use super::linear::{dot, solve_damped};
use super::problem::{PER_SWING, Point, Problem, Start};
use super::quality::{Measured, Responses};
use super::windows::WINDOWS_S;
use crate::rsm::{Composite, Design, Desirability, Factor, Goodness, Search, Surface, goodness, optimum};
use crate::swing::Window;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use serde::Serialize;

/// Rounds of design and move within one window.
const MAX_ROUNDS: usize = 8;

/// A box shrinks to this share of its width where its surface can't be believed.
const SHRINK: f64 = 0.5;

/// Below this predicted R² (PRESS) of mseA a surface is not believed.
const CREDIBLE_R_SQUARED: f64 = 0.9;

/// A surface is not believed either when the error falls by less than this share of what it promised.
const KEPT_PROMISE: f64 = 0.25;

/// A believed box whose optimum lies on a face grows by this factor.
const GROW: f64 = 2.0;

/// A window is finished when a move lowers the sum of squares by less than so many noise variances.
const LITTLE_GAIN: f64 = 5.0;

/// A box reaches this many standard deviations around its optimum: the truth is inside, whatever the next window says.
const BOX_STDS: f64 = 5.0;

/// The search for the optimum of one stage; coarse, because the simulation decides.
const SEARCH: Search = Search { n_samples: 400, n_starts: 6, smallest_edge: 1e-4, seed: 1 };

/// Derivative step for start angle (rad) and velocity (rad/s).
const START_STEP: f64 = 1e-5;

/// One design and the move it led to.
#[derive(Clone, Debug, Serialize)]
pub struct Stage {
    /// Seconds of the swings it looked at; absent for all of them.
    pub window_s: Option<f64>,
    /// Symbols, low and high ends.
    pub ranges: Vec<(&'static str, f64, f64)>,
    /// Values after the move, in the order of the ranges.
    pub values: Vec<f64>,
    /// Responses at the box's centre.
    pub before: Responses,
    /// Responses after the move.
    pub after: Responses,
    /// How far each surface can be believed, in the order of [`Responses::NAMES`].
    #[serde(skip)]
    pub goodness: Vec<Goodness>,
    /// The surfaces themselves, in the same order.
    #[serde(skip)]
    pub surfaces: Vec<Surface>,
    /// R² of the mseA surface, predicted by leaving runs out.
    pub r_squared_predicted: Option<f64>,
}

/// A range for each unknown.
#[derive(Clone, Debug, PartialEq)]
pub struct Ranges(pub Vec<(f64, f64)>);

/// Where the sequence ended.
#[derive(Clone, Debug)]
pub struct Sequence {
    /// The best guess.
    pub point: Point,
    /// Each stage in turn.
    pub stages: Vec<Stage>,
    /// The last box.
    pub ranges: Ranges,
}

/// A simulated run, its starts solved for.
#[derive(Clone, Debug)]
struct Run {
    point: Point,
    responses: Responses,
}

/// Goes through all windows from wide ranges, up to the last swings before rest; `begins` is told each window.
pub fn sequence(problem: &Problem, ranges: &Ranges, starts: &[Start], begins: &dyn Fn(Window)) -> Sequence {
    let longest_s = problem.longest_s();
    let firsts = WINDOWS_S.into_iter().filter(|seconds| *seconds < 0.8 * longest_s).map(Window::First);
    let centre = ranges.0.iter().map(|(low, high)| 0.5 * (low + high)).collect();
    let point = Point { values: centre, starts: starts.to_vec() };
    let mut sequence = Sequence { point, stages: Vec::new(), ranges: ranges.clone() };
    for window in firsts.chain([Window::Lively]) {
        begins(window);
        sequence = in_window(problem, sequence, window);
    }
    sequence
}

/// Designs and moves within one window until the noise or the gains are small.
pub fn in_window(problem: &Problem, from: Sequence, window: Window) -> Sequence {
    let mut now = from;
    for _ in 0..MAX_ROUNDS {
        let Some((next, is_finished)) = one_stage(problem, &now, window) else { break };
        now = next;
        if is_finished {
            break;
        }
    }
    now
}

/// One design around the present guess and the move it leads to; true if nothing is left to gain in this window.
fn one_stage(problem: &Problem, now: &Sequence, window: Window) -> Option<(Sequence, bool)> {
    let factors = box_around(problem, &now.ranges, &now.point)?;
    let design = Design::face_centred(factors.clone(), 1).ok()?;
    let nuisance = Nuisance::at(problem, &now.point, window);
    let simulate = |values: &[Vec<f64>]| runs(problem, &now.point, window, &nuisance, values);

    let mut tried = simulate(&[vec![now.point.values.clone()], design.natural_runs()].concat());
    let here = tried.remove(0);
    let surfaces: Vec<Surface> = (0..Responses::NAMES.len())
        .map(|k| Surface::fit(&design, &tried.iter().map(|run| run.responses.values()[k]).collect::<Vec<_>>()))
        .collect::<Result<_, _>>()
        .ok()?;
    let fits: Vec<Goodness> = surfaces.iter().map(goodness).collect();

    let proposals = proposals(&surfaces, &tried, &factors);
    tried.extend(simulate(&proposals));
    let best = tried.iter().min_by(|a, b| a.responses.mse_angle.total_cmp(&b.responses.mse_angle))?;
    let moves = best.responses.mse_angle < here.responses.mse_angle;
    let chosen = if moves { best } else { &here };
    let n_samples = problem.n_samples(window) as f64;
    let gain = (here.responses.mse_angle - chosen.responses.mse_angle) * n_samples / problem.noise_rad().powi(2);

    let promised = promised_gain(&surfaces[0]) * n_samples / problem.noise_rad().powi(2);
    let r_squared_predicted = fits[0].r_squared_predicted;
    let kept_promise = gain > KEPT_PROMISE * promised || promised < LITTLE_GAIN;
    let credible = kept_promise && r_squared_predicted.is_some_and(|r| r > CREDIBLE_R_SQUARED);
    let next_box = NextBox {
        problem,
        factors: &factors,
        error: &surfaces[0],
        mse: chosen.responses.mse_angle,
        n_samples,
        credible,
    };
    let ranges = next_box.ranges(&chosen.point.values);
    let stage = Stage {
        window_s: match window {
            Window::First(seconds) => Some(seconds),
            _ => None,
        },
        ranges: problem.unknowns.iter().zip(&factors).map(|(u, f)| (u.symbol, f.low(), f.high())).collect(),
        values: chosen.point.values.clone(),
        before: here.responses,
        after: chosen.responses,
        goodness: fits,
        surfaces: surfaces.clone(),
        r_squared_predicted,
    };
    let mut stages = now.stages.clone();
    stages.push(stage);
    Some((Sequence { point: chosen.point.clone(), stages, ranges }, credible && gain < LITTLE_GAIN))
}

/// The present box, its centre moved to the present guess, within the hard limits.
fn box_around(problem: &Problem, ranges: &Ranges, point: &Point) -> Option<Vec<Factor>> {
    let factor = |j: usize| {
        let (low, high) = ranges.0[j];
        let unknown = &problem.unknowns[j];
        let (low, high) = shifted(0.5 * (high - low), point.values[j], unknown.low, unknown.high);
        Factor::new(unknown.symbol, low, high).ok()
    };
    (0..problem.unknowns.len()).map(factor).collect()
}

/// A range of the given half width around a value, moved (not cut) to stay within the limits where it fits.
fn shifted(half: f64, centre: f64, low: f64, high: f64) -> (f64, f64) {
    let half = half.min(0.5 * (high - low));
    let centre = centre.clamp(low + half, high - half);
    (centre - half, centre + half)
}

/// Points worth a simulation: the most desirable one, and the least predicted error in angle.
fn proposals(surfaces: &[Surface], runs: &[Run], factors: &[Factor]) -> Vec<Vec<f64>> {
    let goals: Result<Vec<Desirability>, _> = (0..surfaces.len())
        .map(|k| {
            let worst = runs.iter().map(|run| run.responses.values()[k].abs()).fold(1e-12, f64::max);
            if k < 2 { Desirability::minimise(0.0, worst) } else { Desirability::target(-worst, 0.0, worst) }
        })
        .collect();
    let all = goals.and_then(Composite::new).ok().and_then(|goal| optimum(surfaces, &goal, &SEARCH).ok());
    let least = least_error(&surfaces[0]);
    let natural = |coded: &[f64]| factors.iter().zip(coded).map(|(factor, c)| factor.natural(*c)).collect();
    all.map(|optimum| optimum.natural).into_iter().chain(least.map(|coded| natural(&coded))).collect()
}

/// By how much the surface of mseA says that the error falls from the box's centre to its best point.
fn promised_gain(error: &Surface) -> f64 {
    let centre = vec![0.0; error.factors().len()];
    least_error(error).map_or(0.0, |best| error.predict(&centre) - error.predict(&best))
}

/// The point of the box with the least predicted error: damped Newton steps on the quadratic, held in the box.
fn least_error(surface: &Surface) -> Option<Vec<f64>> {
    let n_factors = surface.factors().len();
    let curvature = curvature(surface);
    let mut coded = vec![0.0; n_factors];
    let mut free = vec![true; n_factors];
    for _ in 0..=n_factors {
        let gradient = -DVector::from_vec(surface.gradient(&coded));
        let step = solve_damped(&positive(&curvature), &gradient, 1e-9, &free);
        let reach = |j: usize| if step[j] == 0.0 { f64::INFINITY } else { (step[j].signum() - coded[j]) / step[j] };
        let (blocking, share) =
            (0..n_factors).map(|j| (j, reach(j))).min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 1.0));
        let share = share.clamp(0.0, 1.0);
        (0..n_factors).for_each(|j| coded[j] = (coded[j] + share * step[j]).clamp(-1.0, 1.0));
        if share >= 1.0 {
            break;
        }
        free[blocking] = false;
    }
    coded.iter().all(|c| c.is_finite()).then_some(coded)
}

/// Second derivatives in coded units, from differences of the gradient (which is linear).
fn curvature(surface: &Surface) -> DMatrix<f64> {
    let n_factors = surface.factors().len();
    let base = surface.gradient(&vec![0.0; n_factors]);
    DMatrix::from_fn(n_factors, n_factors, |i, j| {
        let mut coded = vec![0.0; n_factors];
        coded[j] = 1.0;
        surface.gradient(&coded)[i] - base[i]
    })
}

/// The nearest matrix that curves upwards everywhere: eigenvalues below a small share of the largest are raised.
fn positive(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let mut eigen = matrix.clone().symmetric_eigen();
    let floor = 1e-6 * eigen.eigenvalues.amax().max(1e-300);
    eigen.eigenvalues.iter_mut().for_each(|value| *value = value.max(floor));
    eigen.recompose()
}

/// What decides the next box.
struct NextBox<'a, 'b> {
    problem: &'b Problem<'a>,
    factors: &'b [Factor],
    error: &'b Surface,
    mse: f64,
    n_samples: f64,
    credible: bool,
}

impl NextBox<'_, '_> {
    /// A surface that can't be believed halves its box. A believed one gives the standard deviations of its optimum; the
    /// box then reaches a few of them; a side with the optimum on its face grows.
    fn ranges(&self, values: &[f64]) -> Ranges {
        let stds = self.coded_stds();
        let next = |j: usize| {
            let factor = &self.factors[j];
            let present = factor.half_range();
            let inside = factor.coded(values[j]).abs() < 0.9;
            let half = match (self.credible, inside) {
                (false, _) => SHRINK * present,
                (true, true) => (BOX_STDS * stds[j]).clamp(STRONGEST_SHRINK, 1.0) * present,
                (true, false) => GROW * present,
            };
            let unknown = &self.problem.unknowns[j];
            let narrowest = if unknown.is_stiction() { NARROWEST_STICTION } else { NARROWEST };
            let half = half.max(narrowest * values[j].abs().max(unknown.scale));
            shifted(half, values[j], unknown.low, unknown.high)
        };
        Ranges((0..self.factors.len()).map(next).collect())
    }

    /// Standard deviations of the optimum from the noise (n·mse is the sum of squares, so its curvature is twice JᵀJ)
    /// and from the surface's own error, which tilts it.
    fn coded_stds(&self) -> Vec<f64> {
        let curvature = positive(&curvature(self.error));
        let size = curvature.nrows();
        let inverse = curvature.cholesky().map(|factor| factor.inverse());
        let spread = |j: usize| inverse.as_ref().map_or(f64::INFINITY, |inverse| inverse[(j, j)]);
        let noise = 2.0 * self.mse / self.n_samples;
        let tilt = self.error.residual_standard_error().unwrap_or(0.0);
        (0..size).map(|j| (noise * spread(j) + (tilt * spread(j)).powi(2)).sqrt()).collect()
    }
}

/// The narrowest half width of a box, relative to the value or the unknown's scale: narrower could not be coded.
const NARROWEST: f64 = 1e-6;

/// The same for Ms and DV, which short windows hardly tell.
const NARROWEST_STICTION: f64 = 0.1;

/// A box shrinks to no less than this share at once.
const STRONGEST_SHRINK: f64 = 0.15;

/// Derivatives of each swing with respect to its start angle, velocity and offset.
struct Nuisance(Vec<Vec<Vec<f64>>>);

impl Nuisance {
    fn at(problem: &Problem, point: &Point, window: Window) -> Self {
        let of_swing = |swing_idx: usize| {
            let n_samples = problem.swings[swing_idx].samples_within(window);
            let start = point.starts[swing_idx];
            let values = point.values.as_slice();
            let moved_angle = Start { angle_rad: start.angle_rad + START_STEP, ..start };
            let moved_velocity = Start { velocity_rad_s: start.velocity_rad_s + START_STEP, ..start };
            let guesses = [(values, start), (values, moved_angle), (values, moved_velocity)];
            let predicted = problem.predict(swing_idx, n_samples, &guesses);
            let slope = |k: usize| predicted[k].iter().zip(&predicted[0]).map(|(a, b)| (a - b) / START_STEP).collect();
            vec![slope(1), slope(2), vec![1.0; n_samples]]
        };
        Self((0..problem.swings.len()).into_par_iter().map(of_swing).collect())
    }
}

/// Simulates many sets of values from the starts of one guess, solving for their own starts.
fn runs(problem: &Problem, from: &Point, window: Window, nuisance: &Nuisance, values: &[Vec<f64>]) -> Vec<Run> {
    let of_swing = |swing_idx: usize| -> Vec<(Start, Responses, usize)> {
        let swing = &problem.swings[swing_idx];
        let n_samples = swing.samples_within(window);
        let start = from.starts[swing_idx];
        let guesses: Vec<(&[f64], Start)> = values.iter().map(|values| (values.as_slice(), start)).collect();
        let measured = Measured::new(swing, window, start.offset_rad);
        let columns = &nuisance.0[swing_idx];
        let normal = DMatrix::from_fn(PER_SWING, PER_SWING, |i, j| dot(&columns[i], &columns[j]));
        let solve_start = |mut simulated: Vec<f64>| {
            let mut residuals: Vec<f64> =
                swing.angles_rad.iter().zip(&simulated).map(|(m, s)| m - s - start.offset_rad).collect();
            let gradient = DVector::from_fn(PER_SWING, |i, _| dot(&columns[i], &residuals));
            let step = solve_damped(&normal, &gradient, 0.0, &[true; PER_SWING]);
            for i in 0..n_samples {
                let moved = step[0] * columns[0][i] + step[1] * columns[1][i];
                simulated[i] += moved;
                residuals[i] -= moved + step[2];
            }
            let solved = Start {
                angle_rad: start.angle_rad + step[0],
                velocity_rad_s: start.velocity_rad_s + step[1],
                offset_rad: start.offset_rad + step[2],
            };
            (solved, measured.compare(&simulated, &residuals), n_samples)
        };
        problem.predict(swing_idx, n_samples, &guesses).into_par_iter().map(solve_start).collect()
    };
    let per_swing: Vec<Vec<(Start, Responses, usize)>> = (0..problem.swings.len()).map(of_swing).collect();
    let run = |(run_idx, values): (usize, &Vec<f64>)| {
        let parts: Vec<&(Start, Responses, usize)> = per_swing.iter().map(|swing| &swing[run_idx]).collect();
        let starts = parts.iter().map(|part| part.0).collect();
        Run { point: Point { values: values.clone(), starts }, responses: pooled(&parts) }
    };
    values.iter().enumerate().map(run).collect()
}

/// Mean squares over all samples, counts summed.
fn pooled(parts: &[&(Start, Responses, usize)]) -> Responses {
    let n_samples: usize = parts.iter().map(|part| part.2).sum();
    let mean = |value: fn(&Responses) -> f64| {
        parts.iter().map(|part| value(&part.1) * part.2 as f64).sum::<f64>() / n_samples.max(1) as f64
    };
    let sum = |value: fn(&Responses) -> f64| parts.iter().map(|part| value(&part.1)).sum();
    Responses {
        mse_angle: mean(|r| r.mse_angle),
        mse_velocity: mean(|r| r.mse_velocity),
        positive_peaks: sum(|r| r.positive_peaks),
        negative_peaks: sum(|r| r.negative_peaks),
        zero_crossings: sum(|r| r.zero_crossings),
    }
}

/// Responses of one guess over a window.
pub fn responses_at(problem: &Problem, point: &Point, window: Window) -> Responses {
    let parts: Vec<(Start, Responses, usize)> = (0..problem.swings.len())
        .map(|swing_idx| {
            let (swing, start) = (&problem.swings[swing_idx], point.starts[swing_idx]);
            let n_samples = swing.samples_within(window);
            let simulated = problem.predict(swing_idx, n_samples, &[(&point.values, start)]).remove(0);
            let residuals: Vec<f64> =
                swing.angles_rad.iter().zip(&simulated).map(|(m, s)| m - s - start.offset_rad).collect();
            (start, Measured::new(swing, window, start.offset_rad).compare(&simulated, &residuals), n_samples)
        })
        .collect();
    pooled(&parts.iter().collect::<Vec<_>>())
}
