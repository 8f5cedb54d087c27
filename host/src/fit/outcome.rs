//! Values, starts and stiction that a method ended with, and how they fit the swings.

use super::descent::Descent;
use super::problem::{Point, Problem, Unknown};
use super::stiction::{Settled, Stiction, smooth_unknowns, with_stiction};
use crate::swing::Window;

/// Values and stiction that an identification ended with.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The smooth unknowns and the starts.
    pub point: Point,
    /// Ms and DV.
    pub stiction: Stiction,
    /// Levels that give the same swings, N·m.
    pub level_range_nm: (f64, f64),
    /// Sum of squared errors, rad².
    pub cost: f64,
    /// False if the descent ran out of patience.
    pub converged: bool,
}

impl Outcome {
    pub(super) fn better(self, other: Self) -> Self {
        if other.cost < self.cost { other } else { self }
    }

    /// The same values judged on all samples of a problem.
    pub(super) fn on(self, problem: &Problem) -> Self {
        let fixed = with_stiction(&smooth(problem), self.stiction);
        let cost = fixed.costs(Window::Whole, std::slice::from_ref(&self.point))[0];
        Self { cost, ..self }
    }

    pub(super) fn rmse_rad(&self, problem: &Problem) -> f64 {
        (self.cost / problem.n_samples(Window::Whole) as f64).sqrt()
    }

    pub(super) fn settled(settled: Settled) -> Self {
        let Descent { point, cost, converged, .. } = settled.descent;
        Self { point, stiction: settled.stiction, level_range_nm: settled.level_range_nm, cost, converged }
    }
}

/// The same problem without Ms and DV among its unknowns.
pub fn smooth<'a>(problem: &Problem<'a>) -> Problem<'a> {
    Problem { unknowns: smooth_unknowns(&problem.unknowns), ..problem.clone() }
}

pub(super) fn smooth_point(problem: &Problem, point: &Point) -> Point {
    let keep = |(unknown, value): (&Unknown, &f64)| (!unknown.is_stiction()).then_some(*value);
    let values = problem.unknowns.iter().zip(&point.values).filter_map(keep).collect();
    Point { values, starts: point.starts.clone() }
}

/// All unknowns' values in the problem's order, from the smooth ones and Ms and DV.
pub(super) fn full_values(problem: &Problem, smooth: &Point, stiction: Stiction) -> Vec<f64> {
    let mut smooth = smooth.values.iter();
    let mut pair = [stiction.level_nm, stiction.velocity_band].into_iter();
    let next = |unknown: &Unknown| {
        let value = if unknown.is_stiction() { pair.next() } else { smooth.next().copied() };
        value.unwrap_or(0.0)
    };
    problem.unknowns.iter().map(next).collect()
}

pub(super) fn pair_of(problem: &Problem, values: &[f64]) -> Stiction {
    let value = |index: usize| {
        let of_stiction = problem.unknowns.iter().zip(values).filter(|(unknown, _)| unknown.is_stiction());
        of_stiction.map(|(_, value)| *value).nth(index).unwrap_or(0.0)
    };
    Stiction { level_nm: value(0), velocity_band: value(1) }
}
