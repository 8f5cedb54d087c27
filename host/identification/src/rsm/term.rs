//! The terms of a full quadratic: intercept, linear, square, interaction, in this order.

use super::coding::Factor;
use nalgebra::DMatrix;

/// One term of a quadratic; the numbers are factor indices.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Term {
    /// The constant.
    Intercept,
    /// x_i
    Linear(usize),
    /// x_i²
    Square(usize),
    /// x_i·x_j, with i below j.
    Interaction(usize, usize),
}

impl Term {
    /// All (k+1)(k+2)/2 terms of the full quadratic in `n_factors` = k factors.
    pub fn full_quadratic(n_factors: usize) -> Vec<Self> {
        let linear = (0..n_factors).map(Self::Linear);
        let squares = (0..n_factors).map(Self::Square);
        let interactions = (0..n_factors).flat_map(|i| (i + 1..n_factors).map(move |j| Self::Interaction(i, j)));
        std::iter::once(Self::Intercept).chain(linear).chain(squares).chain(interactions).collect()
    }

    /// The term's value at a point.
    pub fn value(self, point: &[f64]) -> f64 {
        match self {
            Self::Intercept => 1.0,
            Self::Linear(i) => point[i],
            Self::Square(i) => point[i] * point[i],
            Self::Interaction(i, j) => point[i] * point[j],
        }
    }

    /// The term's slope along one factor at a point.
    pub fn slope(self, point: &[f64], factor_idx: usize) -> f64 {
        match self {
            Self::Linear(i) if i == factor_idx => 1.0,
            Self::Square(i) if i == factor_idx => 2.0 * point[i],
            Self::Interaction(i, j) if i == factor_idx => point[j],
            Self::Interaction(i, j) if j == factor_idx => point[i],
            _ => 0.0,
        }
    }

    /// Whether the factor stands in the term.
    pub fn involves(self, factor_idx: usize) -> bool {
        match self {
            Self::Intercept => false,
            Self::Linear(i) | Self::Square(i) => i == factor_idx,
            Self::Interaction(i, j) => i == factor_idx || j == factor_idx,
        }
    }

    /// `1`, `Mw`, `Mw^2` or `Mw*Mc`.
    pub fn name(self, factors: &[Factor]) -> String {
        match self {
            Self::Intercept => "1".to_string(),
            Self::Linear(i) => factors[i].name().to_string(),
            Self::Square(i) => format!("{}^2", factors[i].name()),
            Self::Interaction(i, j) => format!("{}*{}", factors[i].name(), factors[j].name()),
        }
    }
}

/// The regression matrix: one row a run, one column a term.
pub fn model_matrix(terms: &[Term], coded_runs: &[Vec<f64>]) -> DMatrix<f64> {
    DMatrix::from_fn(coded_runs.len(), terms.len(), |run_idx, term_idx| terms[term_idx].value(&coded_runs[run_idx]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_factors_have_twenty_one_terms_each_once() {
        let terms = Term::full_quadratic(5);
        assert_eq!(terms.len(), 21);
        assert!(terms.iter().enumerate().all(|(idx, term)| !terms[..idx].contains(term)));
    }

    #[test]
    fn slopes_agree_with_central_differences() {
        let (point, step) = ([0.3, -0.7, 0.9], 1e-5);
        for term in Term::full_quadratic(3) {
            for factor_idx in 0..3 {
                let (mut above, mut below) = (point, point);
                above[factor_idx] += step;
                below[factor_idx] -= step;
                let difference = (term.value(&above) - term.value(&below)) / (2.0 * step);
                // Central differences are exact for quadratics up to rounding, eps/step.
                assert!((term.slope(&point, factor_idx) - difference).abs() < 1e-9, "{term:?} along {factor_idx}");
                assert!(term.involves(factor_idx) || difference == 0.0);
            }
        }
    }

    #[test]
    fn terms_are_named_by_their_factors_in_their_order() {
        let factors = ["Mw", "Mc"].map(|name| Factor::new(name, 0.0, 1.0).unwrap());
        let names: Vec<String> = Term::full_quadratic(2).into_iter().map(|term| term.name(&factors)).collect();
        assert_eq!(names, ["1", "Mw", "Mc", "Mw^2", "Mc^2", "Mw*Mc"]);
    }
}
