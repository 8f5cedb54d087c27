//! The torques at the knots of a friction curve as unknowns, and a ridge that keeps the curve straight where the swings say
//! nothing.
//!
//! Penalised is how far each inner knot lies off the straight line through its neighbours, so that Coulomb and viscous
//! friction cost nothing. The strength is counted per sample: decimated swings give the same curve.
//! Source: P. H. C. Eilers, B. D. Marx, Statist. Sci. 11 (1996) 89, on unequal distances.

use super::clusters::Sums;
use super::linear::Equations;
use super::problem::{Problem, Quantity, Unknown};
use crate::swing::Window;
use nalgebra::{DMatrix, DVector};
use shared::effect::CURVE_NAME;
use shared::parameters::Parameters;

/// Symbols of the torques at the knots.
const SYMBOLS: [&str; shared::curve::MAX_KNOTS] = [
    "F1", "F2", "F3", "F4", "F5", "F6", "F7", "F8", "F9", "F10", "F11", "F12", "F13", "F14", "F15", "F16", "F17",
    "F18", "F19", "F20", "F21", "F22", "F23", "F24", "F25", "F26", "F27", "F28", "F29", "F30", "F31", "F32",
];

/// A knot may reach this share of m·g·l, and a change of so much of it matters.
const HIGHEST_SHARE: f64 = 2.0;
const SCALE_SHARE: f64 = 2e-3;

impl Unknown {
    /// The torques at the knots of the friction curve.
    pub fn knots(parameters: &Parameters<f64>) -> Vec<Self> {
        let n_knots = parameters.curve.as_ref().map_or(0, |curve| curve.torques_nm().len());
        let gravity_nm = parameters.pendulum.gravity_torque_nm();
        let knot = |(index, symbol): (usize, &&'static str)| Self {
            quantity: Quantity::Knot(index),
            symbol,
            name: CURVE_NAME,
            unit: "N·m",
            low: 0.0,
            high: HIGHEST_SHARE * gravity_nm,
            scale: SCALE_SHARE * gravity_nm,
        };
        SYMBOLS.iter().take(n_knots).enumerate().map(knot).collect()
    }
}

/// What a crooked curve costs.
#[derive(Clone, Debug, PartialEq)]
pub struct Ridge {
    /// rad² a sample for a (N·m)² off the straight line.
    strength: f64,
    /// DᵀD: the squares of all distances off the line, as a quadratic form of the torques.
    matrix: DMatrix<f64>,
}

impl Ridge {
    /// For knots at these speeds.
    pub fn new(speeds_rad_s: &[f32], strength: f64) -> Self {
        Self { strength, matrix: roughness(speeds_rad_s) }
    }

    /// What it adds to the sum of squares, rad².
    pub fn penalty(&self, problem: &Problem, window: Window, values: &[f64]) -> f64 {
        let Some(knots) = knots_of(problem, values) else { return 0.0 };
        self.weight(problem, window) * knots.dot(&(&self.matrix * &knots))
    }

    /// Adds it to the normal equations at a guess.
    pub fn add_to(&self, equations: &mut Equations, problem: &Problem, window: Window, values: &[f64]) {
        let Some((first, knots)) = first_knot(problem).zip(knots_of(problem, values)) else { return };
        let weighted = self.weight(problem, window) * &self.matrix;
        let pull = &weighted * &knots;
        equations.cost += knots.dot(&pull);
        (0..knots.len()).for_each(|i| equations.gradient[first + i] -= pull[i]);
        let (n_unknowns, n_knots) = (problem.unknowns.len(), knots.len());
        let mut all = DMatrix::zeros(n_unknowns, n_unknowns);
        all.view_mut((first, first), (n_knots, n_knots)).copy_from(&weighted);
        equations.normal.add_shared(&all);
    }

    /// It as normal equations of so many numbers, the knots from `first` on, at some torques.
    pub fn sums(&self, problem: &Problem, first: usize, torques_nm: &[f64], size: usize) -> Sums {
        let weighted = self.weight(problem, Window::Whole) * &self.matrix;
        let mut sums = Sums { matrix: DMatrix::zeros(size, size), gradient: DVector::zeros(size) };
        let n_knots = torques_nm.len();
        sums.matrix.view_mut((first, first), (n_knots, n_knots)).copy_from(&weighted);
        sums.gradient.rows_mut(first, n_knots).copy_from(&-(weighted * DVector::from_column_slice(torques_nm)));
        sums
    }

    fn weight(&self, problem: &Problem, window: Window) -> f64 {
        self.strength * problem.n_samples(window) as f64
    }
}

/// Where the knots begin among the unknowns.
pub fn first_knot(problem: &Problem) -> Option<usize> {
    problem.unknowns.iter().position(|unknown| unknown.quantity == Quantity::Knot(0))
}

fn knots_of(problem: &Problem, values: &[f64]) -> Option<DVector<f64>> {
    let first = first_knot(problem)?;
    let n_knots = problem.unknowns.iter().filter(|unknown| matches!(unknown.quantity, Quantity::Knot(_))).count();
    Some(DVector::from_column_slice(&values[first..first + n_knots]))
}

/// The squares of the distances of inner knots off the line through their neighbours, as a matrix.
pub fn roughness(speeds_rad_s: &[f32]) -> DMatrix<f64> {
    let n_knots = speeds_rad_s.len();
    let mut distances = DMatrix::zeros(n_knots.saturating_sub(2), n_knots);
    for (row, around) in speeds_rad_s.windows(3).enumerate() {
        let [before, here, after] = [0, 1, 2].map(|i| f64::from(around[i]));
        let share = (here - before) / (after - before);
        (distances[(row, row)], distances[(row, row + 1)], distances[(row, row + 2)]) = (share - 1.0, 1.0, -share);
    }
    distances.tr_mul(&distances)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_curve_costs_nothing_and_a_knot_off_the_line_its_square() {
        let speeds = [0.0, 0.5, 2.0, 3.0_f32];
        let matrix = roughness(&speeds);
        let cost = |torques: [f64; 4]| {
            let torques = DVector::from_column_slice(&torques);
            torques.dot(&(&matrix * &torques))
        };
        let line = speeds.map(|speed| 1e-3 + 2e-3 * f64::from(speed));
        assert!(cost(line) < 1e-18);
        // The last inner knot lifted by 3e-3: it lies 3e-3 off, and the one before by a quarter of that.
        let bent = [line[0], line[1], line[2] + 3e-3, line[3]];
        assert!((cost(bent) / (9e-6 * (1.0 + 0.0625)) - 1.0).abs() < 1e-9, "{}", cost(bent));
    }
}
