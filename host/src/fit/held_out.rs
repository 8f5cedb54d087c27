//! How well found values predict swings that took no part.

use super::descent::{Patience, descend};
use super::problem::{Point, Problem};
use super::{start, windows};
use crate::swing::{Swing, Window};
use shared::parameters::Parameters;
use std::sync::atomic::AtomicUsize;

/// Error on swings that took no part: only their starts are fitted.
pub fn held_out_rmse(held_out: &[Swing], parameters: &Parameters<f64>, count: &AtomicUsize) -> f64 {
    let problem = Problem {
        swings: held_out,
        template: parameters.clone(),
        unknowns: Vec::new(),
        offsets_are_free: true,
        n_simulations: count,
    };
    let point = Point { values: Vec::new(), starts: start::starts(held_out) };
    let first = windows::grow(&problem, &point);
    let last = descend(&problem, &first.point, Window::Whole, Patience::FINE, first.steps);
    (last.cost / problem.n_samples(Window::Whole).max(1) as f64).sqrt()
}
