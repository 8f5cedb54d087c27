//! A damped step of least squares within the bounds of its unknowns, and the guess that it leads to.
//!
//! A number that is a share of another one is carried along by its product with that: the torque is linear in the product, so
//! that a valley that is curved in the share is straight there, and a step may go all the way.

use super::arrow::ArrowFactor;
use super::linear::Equations;
use super::problem::{PER_SWING, Point, Problem, Quantity};
use nalgebra::DVector;
use shared::effect::Effect;

/// A damped step within the bounds.
pub(super) struct Step {
    /// What it adds to the unknowns, then to angle, velocity and offset of each swing.
    pub(super) change: DVector<f64>,
    damping: f64,
    /// Numbers that are not on their bounds.
    free: Vec<bool>,
}

impl Step {
    /// A number that would leave its bounds is put on its bound, and the others are solved for again.
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
            let bounded = |j: usize| {
                let (here, low, high) = match j < n_unknowns {
                    true => (point.values[j], problem.unknowns[j].low, problem.unknowns[j].high),
                    false => bounded_zero(problem, point, (j - n_unknowns) / PER_SWING),
                };
                let kept = kept_share(problem, point, &step, j);
                let target = here + kept * step[j];
                let bounded = target.clamp(low, high);
                (bounded != target).then_some((j, (bounded - here) / kept))
            };
            let is_bounded = |j: &usize| *j < n_unknowns || is_offset(*j);
            let leaving = (0..free.len()).filter(|j| free[*j] && is_bounded(j)).find_map(bounded);
            match leaving {
                None => return Self { change: step, damping, free },
                Some((j, to_bound)) => {
                    free[j] = false;
                    fixed_step[j] = to_bound;
                    gradient -= linear.normal.column(j) * to_bound;
                }
            }
        }
    }

    /// What the free numbers answer to another right-hand side, damped as the step is.
    pub(super) fn answer(&self, linear: &Equations, gradient: &DVector<f64>) -> DVector<f64> {
        ArrowFactor::new(&linear.normal, self.damping, |j| self.free[j]).solve(gradient)
    }
}

/// The sensor's zero of a swing, and between what it may be; one that begins beyond that may stay there.
pub(super) fn bounded_zero(problem: &Problem, point: &Point, swing_idx: usize) -> (f64, f64, f64) {
    let here = point.starts[swing_idx].offset_rad;
    let (low, high) = problem.swings[swing_idx].zero_range();
    (here, low.min(here), high.max(here))
}

/// The same as a change alone.
pub fn bounded_step(problem: &Problem, point: &Point, linear: &Equations, damping: f64) -> DVector<f64> {
    Step::bounded(problem, point, linear, damping).change
}

/// The guess after a step.
pub fn stepped(problem: &Problem, point: &Point, step: &DVector<f64>) -> Point {
    let n_unknowns = problem.unknowns.len();
    let mut next = point.clone();
    for (j, value) in next.values.iter_mut().enumerate() {
        let Some(of) = whole_of(problem, j) else {
            *value += step[j];
            continue;
        };
        let unknown = &problem.unknowns[j];
        *value = (*value + share_kept(point.values[of], step[of]) * step[j]).clamp(unknown.low, unknown.high);
    }
    for (swing_idx, start) in next.starts.iter_mut().enumerate() {
        let first = n_unknowns + PER_SWING * swing_idx;
        start.angle_rad += step[first];
        start.velocity_rad_s += step[first + 1];
        start.offset_rad += step[first + 2];
    }
    next
}

/// The unknown that another one is a share of.
fn whole_of(problem: &Problem, share: usize) -> Option<usize> {
    let Quantity::Effect { id, index } = problem.unknowns.get(share)?.quantity else { return None };
    let (_, of) = Effect::<f64>::by_id(id)?.rules.share_of.filter(|(share, _)| usize::from(*share) == index)?;
    let whole = Quantity::Effect { id, index: usize::from(of) };
    problem.unknowns.iter().position(|unknown| unknown.quantity == whole)
}

/// How much of its change in a step a number keeps: all, but for a share of another one.
fn kept_share(problem: &Problem, point: &Point, step: &DVector<f64>, j: usize) -> f64 {
    whole_of(problem, j).map_or(1.0, |of| share_kept(point.values[of], step[of]))
}

/// With whole w and share s, Δ(w·s) = s·Δw + w·Δs leads to (w·s + Δ(w·s)) / (w + Δw) = s + Δs·w / (w + Δw). Of nothing there
/// is no share, and it changes as any number does.
fn share_kept(whole: f64, change: f64) -> f64 {
    let kept = whole / (whole + change);
    if kept.is_finite() && kept != 0.0 { kept } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{rig, simulated};
    use crate::fit::identify::problem_of;
    use crate::fit::linear::{Steps, equations};
    use crate::fit::problem::Start;
    use crate::fit::tally::Tally;
    use crate::swing::Window;

    /// Begun where it hangs, a turn and more from where the readings are, so that only a far zero helps.
    #[test]
    fn no_step_leaves_the_turn_in_which_the_recording_swings() {
        let (rig, count) = (rig(), Tally::default());
        let swings = [simulated("one", &rig, 10.0, 1)];
        let problem = problem_of(&swings, &rig, &count);
        let (low, high) = swings[0].zero_range();
        assert!(low < -1.4 && low > -1.8 && high > 1.4 && high < 1.8, "{low} {high}");
        let swung = |offset_rad| Start { angle_rad: -7.0, velocity_rad_s: 0.0, offset_rad };
        let after = |offset_rad| {
            let point = Point { values: problem.template_values(), starts: vec![swung(offset_rad)] };
            let linear = equations(&problem, &point, Window::Whole, &mut Steps::new(&problem));
            offset_rad + bounded_step(&problem, &point, &linear, 0.0)[problem.unknowns.len() + PER_SWING - 1]
        };
        assert!((after(0.0) - high).abs() < 1e-9, "{}", after(0.0));
        // One that is beyond it does not go on.
        assert!(after(low - 1.0) >= low - 1.0 - 1e-9);
    }

    #[test]
    fn a_share_follows_from_the_product_and_the_whole() {
        let (whole, share) = (0.003, 2.8);
        let (more, less) = (0.017, -16.7);
        let product: f64 = whole * share + share * more + whole * less;
        assert!((share + share_kept(whole, more) * less - product / (whole + more)).abs() < 1e-12);
        // Of nothing, and where nothing is left.
        assert_eq!([share_kept(0.0, 0.1), share_kept(0.1, -0.1)], [1.0, 1.0]);
    }
}
