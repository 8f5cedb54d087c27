//! The runs of a design: swings simulated with given values, their starts solved for, and their five responses.
//!
//! Start angle, velocity and offset of each swing are solved for in every run, to first order.

use super::linear::dot;
use super::problem::{PER_SWING, Point, Problem, Start};
use super::quality::{Measured, Responses, Simulated};
use super::solve::solve_damped;
use crate::cores::on_all_cores;
use crate::swing::{Swing, Window};
use nalgebra::{DMatrix, DVector};
use simulation::LANES;

/// Derivative step for start angle (rad) and velocity (rad/s).
const START_STEP: f64 = 1e-5;

/// A simulated run, its starts solved for.
#[derive(Clone, Debug)]
pub struct Run {
    /// The values, and the starts that suit them best.
    pub point: Point,
    /// How far the simulated swings are from the measured ones.
    pub responses: Responses,
}

/// Derivatives of each swing with respect to its start angle, velocity and offset.
pub struct Nuisance(Vec<Vec<Vec<f64>>>);

impl Nuisance {
    /// At a guess, within a window.
    pub fn at(problem: &Problem, point: &Point, window: Window) -> Self {
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
        Self(on_all_cores(0..problem.swings.len(), of_swing))
    }
}

/// The readings of each swing, one column a run.
type Readings = Vec<Vec<Vec<f64>>>;

/// Simulates many sets of values from the starts of one guess, solving for their own starts.
pub fn runs(problem: &Problem, from: &Point, window: Window, nuisance: &Nuisance, values: &[Vec<f64>]) -> Vec<Run> {
    solved(problem, from, window, nuisance, values, simulated(problem, from, window, values))
}

/// The same, and the derivatives for further runs from this guess, simulated beside them.
pub fn first_runs(problem: &Problem, from: &Point, window: Window, values: &[Vec<f64>]) -> (Nuisance, Vec<Run>) {
    let (nuisance, simulated) =
        rayon::join(|| Nuisance::at(problem, from, window), || simulated(problem, from, window, values));
    let runs = solved(problem, from, window, &nuisance, values, simulated);
    (nuisance, runs)
}

fn simulated(problem: &Problem, from: &Point, window: Window, values: &[Vec<f64>]) -> Readings {
    let of_swing = |(swing_idx, swing): (usize, &Swing)| {
        let start = from.starts[swing_idx];
        let guesses: Vec<(&[f64], Start)> = values.iter().map(|values| (values.as_slice(), start)).collect();
        problem.predict(swing_idx, swing.samples_within(window), &guesses)
    };
    on_all_cores(problem.swings.iter().enumerate(), of_swing)
}

/// Solves for the starts of simulated runs and compares these with the measurement.
fn solved(
    problem: &Problem,
    from: &Point,
    window: Window,
    nuisance: &Nuisance,
    values: &[Vec<f64>],
    simulated: Readings,
) -> Vec<Run> {
    let of_swing = |(swing_idx, runs): (usize, Vec<Vec<f64>>)| -> Vec<(Start, Responses, usize)> {
        let swing = &problem.swings[swing_idx];
        let n_samples = swing.samples_within(window);
        let start = from.starts[swing_idx];
        let measured = Measured::new(swing, window, start.offset_rad);
        let columns = &nuisance.0[swing_idx];
        let normal = DMatrix::from_fn(PER_SWING, PER_SWING, |i, j| dot(&columns[i], &columns[j]));
        let solve_start = |simulated: Vec<f64>| {
            let mut simulated = beside(swing, simulated, start);
            let gradient = DVector::from_fn(PER_SWING, |i, _| dot(&columns[i], &simulated.residuals_rad));
            let step = start_step(&normal, &gradient, start.offset_rad, swing.zero_range());
            for i in 0..n_samples {
                let moved = step[0] * columns[0][i] + step[1] * columns[1][i];
                simulated.angles_rad[i] += moved;
                simulated.residuals_rad[i] -= moved + step[2];
            }
            let solved = Start {
                angle_rad: start.angle_rad + step[0],
                velocity_rad_s: start.velocity_rad_s + step[1],
                offset_rad: start.offset_rad + step[2],
            };
            (solved, simulated)
        };
        let compared = |runs: Vec<Vec<f64>>| {
            let (starts, simulated): (Vec<Start>, Vec<_>) = runs.into_iter().map(solve_start).unzip();
            let responses = measured.compare_each(&simulated);
            let of_run = |(start, responses)| (start, responses, n_samples);
            starts.into_iter().zip(responses).map(of_run).collect::<Vec<_>>()
        };
        let mut runs = runs.into_iter();
        let next = || Some(runs.by_ref().take(LANES).collect::<Vec<_>>()).filter(|batch| !batch.is_empty());
        on_all_cores(std::iter::from_fn(next), compared).concat()
    };
    let per_swing: Vec<Vec<(Start, Responses, usize)>> = on_all_cores(simulated.into_iter().enumerate(), of_swing);
    let run = |(run_idx, values): (usize, &Vec<f64>)| {
        let parts: Vec<&(Start, Responses, usize)> = per_swing.iter().map(|swing| &swing[run_idx]).collect();
        let starts = parts.iter().map(|part| part.0).collect();
        Run { point: Point { values: values.clone(), starts }, responses: pooled(&parts) }
    };
    values.iter().enumerate().map(run).collect()
}

fn beside(swing: &Swing, simulated: Vec<f64>, start: Start) -> Simulated {
    let left = |(measured, simulated): (&f64, &f64)| measured - simulated - start.offset_rad;
    let residuals_rad = swing.angles_rad.iter().zip(&simulated).map(left).collect();
    Simulated { angles_rad: simulated, residuals_rad }
}

/// The step to the best start whose zero stays within its range, or where it is if that lies beyond.
fn start_step(
    normal: &DMatrix<f64>,
    gradient: &DVector<f64>,
    offset_rad: f64,
    (low, high): (f64, f64),
) -> DVector<f64> {
    const OFFSET: usize = PER_SWING - 1;
    let step = solve_damped(normal, gradient, 0.0, &[true; PER_SWING]);
    let target = offset_rad + step[OFFSET];
    let bounded = target.clamp(low.min(offset_rad), high.max(offset_rad));
    if bounded == target {
        return step;
    }
    let left = gradient - normal.column(OFFSET) * (bounded - offset_rad);
    let mut step = solve_damped(normal, &left, 0.0, &[true, true, false]);
    step[OFFSET] = bounded - offset_rad;
    step
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
            let measured = Measured::new(swing, window, start.offset_rad);
            (start, measured.compare(&beside(swing, simulated, start)), n_samples)
        })
        .collect();
    pooled(&parts.iter().collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zero_beyond_its_range_is_put_on_its_end_and_the_start_is_solved_for_again() {
        let normal = DMatrix::from_row_slice(3, 3, &[4.0, 0.0, 1.0, 0.0, 2.0, 0.0, 1.0, 0.0, 3.0]);
        let gradient = DVector::from_vec(vec![4.0, 2.0, 20.0]);
        let free = start_step(&normal, &gradient, 0.5, (f64::NEG_INFINITY, f64::INFINITY));
        let bound = start_step(&normal, &gradient, 0.5, (-1.5, 1.5));
        assert!(free[2] > 5.0, "{free}");
        // 4·a + 1·1 = 4 with the zero moved by 1.
        assert!((bound[2] - 1.0).abs() < 1e-12 && (bound[0] - 0.75).abs() < 1e-12, "{bound}");
    }
}
