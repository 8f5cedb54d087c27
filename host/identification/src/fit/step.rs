//! A damped step of least squares within the bounds of its unknowns, and the guess that it leads to.

use super::arrow::ArrowFactor;
use super::linear::Equations;
use super::problem::{PER_SWING, Point, Problem};
use nalgebra::DVector;

/// A damped step within the bounds.
pub(super) struct Step {
    /// What it adds to the unknowns, then to angle, velocity and offset of each swing.
    pub(super) change: DVector<f64>,
    damping: f64,
    /// Numbers that are not on their bounds.
    free: Vec<bool>,
}

impl Step {
    /// An unknown that would leave its bounds is put on its bound, and the others are solved for again.
    pub(super) fn bounded(problem: &Problem, point: &Point, linear: &Equations, damping: f64) -> Self {
        let n_unknowns = problem.unknowns.len();
        let is_offset = |j: usize| j >= n_unknowns && (j - n_unknowns) % PER_SWING == PER_SWING - 1;
        let mut free: Vec<bool> =
            (0..linear.gradient.len()).map(|j| problem.offsets_are_free || !is_offset(j)).collect();
        let mut gradient = linear.gradient.clone();
        let mut fixed_step = DVector::zeros(gradient.len());
        loop {
            let factor = ArrowFactor::new(&linear.normal, damping, |j| free[j]);
            let step = factor.solve(&gradient) + &fixed_step;
            let leaving = (0..n_unknowns).filter(|j| free[*j]).find_map(|j| {
                let target = point.values[j] + step[j];
                let bounded = target.clamp(problem.unknowns[j].low, problem.unknowns[j].high);
                (bounded != target).then_some((j, bounded - point.values[j]))
            });
            match leaving {
                None => return Self { change: step, damping, free },
                Some((j, to_bound)) => {
                    free[j] = false;
                    fixed_step[j] = to_bound;
                    gradient -= linear.normal.shared_column(j) * to_bound;
                }
            }
        }
    }

    /// What the free numbers answer to another right-hand side, damped as the step is.
    pub(super) fn answer(&self, linear: &Equations, gradient: &DVector<f64>) -> DVector<f64> {
        ArrowFactor::new(&linear.normal, self.damping, |j| self.free[j]).solve(gradient)
    }
}

/// The same as a change alone.
pub fn bounded_step(problem: &Problem, point: &Point, linear: &Equations, damping: f64) -> DVector<f64> {
    Step::bounded(problem, point, linear, damping).change
}

/// The guess after a step.
pub fn stepped(point: &Point, step: &DVector<f64>, n_unknowns: usize) -> Point {
    let mut next = point.clone();
    next.values.iter_mut().zip(step.iter()).for_each(|(value, change)| *value += change);
    for (swing_idx, start) in next.starts.iter_mut().enumerate() {
        let first = n_unknowns + PER_SWING * swing_idx;
        start.angle_rad += step[first];
        start.velocity_rad_s += step[first + 1];
        start.offset_rad += step[first + 2];
    }
    next
}
