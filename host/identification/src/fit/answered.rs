//! What pairs of Ms and DV cost once all smooth parameters have answered to them, to first order.

use super::arrow::ArrowFactor;
use super::fitted::Stiction;
use super::levels;
use super::linear::{Linear, SwingLinear, dot};
use super::problem::{PER_SWING, Point, Problem, Start, Unknown};
use super::solve::ANSWER_DAMPING;
use nalgebra::DVector;
use shared::effect::Effect;
use shared::parameters::{Parameters, base};

/// Rounds of search and descent.
pub(super) const MAX_ROUNDS: usize = 3;

/// Costs of pairs after the smooth parameters have answered to first order.
pub(super) fn answered_costs(problem: &Problem, linear: &Linear, point: &Point, tried: &[Stiction]) -> Vec<f64> {
    answers(problem, linear, point, tried).into_iter().map(|answer| answer.cost).collect()
}

/// How the smooth parameters answer to a pair, to first order.
pub(super) struct Answer {
    /// rad².
    pub(super) cost: f64,
    /// Their step, and that of the starts.
    pub(super) step: DVector<f64>,
}

/// What pairs leave of each swing while everything else stays as it is.
pub(super) struct Left<'a> {
    pair_problem: Problem<'a>,
    pairs: Vec<Vec<f64>>,
    starts: &'a [Start],
}

impl<'a> Left<'a> {
    pub(super) fn by(problem: &Problem<'a>, point: &'a Point, tried: &[Stiction]) -> Self {
        let levels = problem.unknowns.iter().zip(&point.values).filter(|(unknown, _)| unknown.name == levels::NAME);
        let (levels, at): (Vec<Unknown>, Vec<f64>) = levels.map(|(level, value)| (level.clone(), *value)).unzip();
        let pair_problem = Problem {
            unknowns: [stiction_unknowns(&problem.template), levels].concat(),
            template: problem.parameters(&point.values),
            ..problem.clone()
        };
        let pair = |pair: &Stiction| [&[pair.level_nm, pair.velocity_band], at.as_slice()].concat();
        let pairs: Vec<Vec<f64>> = tried.iter().map(pair).collect();
        Self { pair_problem, pairs, starts: &point.starts }
    }

    /// The residuals of one swing, a vector a pair.
    pub(super) fn of_swing(&self, swing_idx: usize) -> Vec<Vec<f64>> {
        let swing = &self.pair_problem.swings[swing_idx];
        let start = self.starts[swing_idx];
        let guesses: Vec<(&[f64], Start)> = self.pairs.iter().map(|pair| (pair.as_slice(), start)).collect();
        let mut predicted = self.pair_problem.predict(swing_idx, swing.len(), &guesses);
        let subtract = |column: &mut Vec<f64>| {
            column.iter_mut().zip(&swing.angles_rad).for_each(|(p, m)| *p = m - *p - start.offset_rad);
        };
        predicted.iter_mut().for_each(subtract);
        predicted
    }
}

pub(super) fn answers(problem: &Problem, linear: &Linear, point: &Point, tried: &[Stiction]) -> Vec<Answer> {
    let left = Left::by(problem, point, tried);
    let n_unknowns = problem.unknowns.len();
    let of_swing = |swing_idx: usize, known: &SwingLinear| -> Vec<(f64, Vec<f64>)> {
        let judge = |residuals: &Vec<f64>| {
            let slopes = known.columns.iter().map(|column| dot(column, residuals)).collect();
            (dot(residuals, residuals), slopes)
        };
        left.of_swing(swing_idx).iter().map(judge).collect()
    };
    let per_swing = linear.each(of_swing);
    let equations = &linear.equations;
    let factor = ArrowFactor::new(&equations.normal, ANSWER_DAMPING, |_| true);
    let answered = |pair_idx: usize| {
        let mut gradient = DVector::zeros(equations.gradient.len());
        let mut cost = 0.0;
        for (swing_idx, judged) in per_swing.iter().enumerate() {
            let (square, slopes) = &judged[pair_idx];
            cost += square;
            for (j, slope) in slopes.iter().enumerate() {
                gradient[if j < n_unknowns { j } else { j + PER_SWING * swing_idx }] += slope;
            }
        }
        let step = factor.solve(&gradient);
        Answer { cost: cost - gradient.dot(&step), step }
    };
    (0..tried.len()).map(answered).collect()
}

/// Rise of the error, in variances, at the 95 % bound of one number (chi-square with one degree of freedom, one-sided).
pub(super) const PROFILE_95: f64 = 2.71;

/// The error may rise by so much with a number that is moved, rad²: beyond that the number is unlikely.
pub(super) fn likely_rise(on: &Problem, linear: &Linear) -> f64 {
    let variance = linear.equations.cost / linear.equations.n_samples.max(1) as f64;
    PROFILE_95 * variance.max(on.noise_rad().powi(2))
}

/// Ms and DV as unknowns.
pub(super) fn stiction_unknowns(parameters: &Parameters<f64>) -> Vec<Unknown> {
    Effect::by_id(base::STICTION).map_or(Vec::new(), |effect| Unknown::all_of_effect(effect, parameters))
}
