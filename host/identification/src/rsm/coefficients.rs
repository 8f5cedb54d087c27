//! The coefficient table: each term's estimate with standard error, t and p.

use super::significance::{ratio, two_sided_t};
use super::surface::Surface;
use serde::Serialize;

/// One row of the table, in coded units. What the data cannot tell is absent: everything but the estimate for a
/// saturated design, t and p for a surface that passes through every run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Coefficient {
    /// `1`, `Mw`, `Mw^2` or `Mw*Mc`.
    pub name: String,
    /// Change of the response per coded unit of the term.
    pub estimate: f64,
    /// One-sigma uncertainty of the estimate.
    pub standard_error: Option<f64>,
    /// Estimate over standard error.
    pub t: Option<f64>,
    /// Two-sided probability of such a t by chance, 0 to 1.
    pub p: Option<f64>,
}

/// One row a term, in the order of `Surface::terms`.
pub fn coefficient_table(surface: &Surface) -> Vec<Coefficient> {
    let sensitivity = surface.sensitivity();
    let rows = surface.term_names().into_iter().zip(surface.coefficients()).zip(sensitivity.row_iter());
    rows.map(|((name, &estimate), weights)| {
        let standard_error = surface.residual_standard_error().map(|scatter| scatter * weights.norm());
        let t = standard_error.and_then(|error| ratio(estimate, error));
        let p = t.and_then(|t| two_sided_t(t, surface.residual_dof()));
        Coefficient { name, estimate, standard_error, t, p }
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rsm::coding::Factor;
    use crate::rsm::design::Design;

    fn one_factor(runs: &[f64], responses: &[f64]) -> Vec<Coefficient> {
        let factor = Factor::new("x", 0.0, 1.0).unwrap();
        let runs = runs.iter().map(|&x| vec![x]).collect();
        coefficient_table(&Surface::fit(&Design::from_coded(vec![factor], runs).unwrap(), responses).unwrap())
    }

    #[test]
    fn a_parabola_over_six_runs_has_the_errors_worked_by_hand() {
        // Two runs a level with means 1, 2, 5: b0 = 2, b1 = (5 − 1)/2 = 2, b11 = (1 + 5)/2 − 2 = 1.
        // Residuals are ±0.5, so s² = 1.5/3; variances are s²/2 for b0, s²/4 for b1, s²·(1/8 + 1/8 + 1/2) for b11.
        let table = one_factor(&[-1.0, -1.0, 0.0, 0.0, 1.0, 1.0], &[0.5, 1.5, 1.5, 2.5, 4.5, 5.5]);
        let expected = [("1", 2.0, 0.25), ("x", 2.0, 0.125), ("x^2", 1.0, 0.375)];
        for (row, (name, estimate, variance)) in table.iter().zip(expected) {
            assert_eq!(row.name, name);
            assert!((row.estimate - estimate).abs() < 1e-14);
            assert!((row.standard_error.unwrap() - f64::sqrt(variance)).abs() < 1e-14);
            assert!((row.t.unwrap() - estimate / f64::sqrt(variance)).abs() < 1e-12);
            assert!((0.0..0.3).contains(&row.p.unwrap()));
        }
    }

    #[test]
    fn a_saturated_parabola_has_estimates_only() {
        for row in one_factor(&[-1.0, 0.0, 1.0], &[1.0, 2.0, 5.0]) {
            assert!(row.estimate.is_finite());
            assert_eq!((row.standard_error, row.t, row.p), (None, None, None));
        }
    }

    #[test]
    fn a_perfect_fit_has_zero_error_and_no_t() {
        for row in one_factor(&[-1.0, -1.0, 0.0, 1.0], &[1.0, 1.0, 2.0, 5.0]) {
            assert_eq!((row.standard_error, row.t, row.p), (Some(0.0), None, None));
        }
    }
}
