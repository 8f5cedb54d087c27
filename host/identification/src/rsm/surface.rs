//! The response surface: a full quadratic in coded units, fitted to one response.
//!
//! y = b0 + Σ b_i x_i + Σ b_ii x_i² + Σ b_ij x_i x_j, by least squares; no term is ever dropped.

use super::coding::Factor;
use super::design::Design;
use super::error::FitError;
use super::regression::Regression;
use super::term::Term;
use nalgebra::{DMatrix, DVector};

/// Responses beyond this cannot be squared and summed safely.
const LARGEST_RESPONSE: f64 = 1e100;
/// Residuals below this fraction of the largest response are rounding of the fit itself.
const ROUNDING_OF_A_FIT: f64 = 1e-14;

/// A fitted quadratic with the runs it was learned from.
#[derive(Clone, Debug)]
pub struct Surface {
    regression: Regression,
    responses: DVector<f64>,
    coefficients: DVector<f64>,
    residuals: DVector<f64>,
}

impl Surface {
    /// Fits the full quadratic; `responses` are in the order of the design's runs.
    pub fn fit(design: &Design, responses: &[f64]) -> Result<Self, FitError> {
        check(design, responses)?;
        Self::over(&Regression::new(design)?, responses)
    }

    /// The same over a design that is ready.
    pub fn over(regression: &Regression, responses: &[f64]) -> Result<Self, FitError> {
        check(regression.design(), responses)?;
        let responses = DVector::from_column_slice(responses);
        let coefficients = regression.least_squares().solve(&responses);
        let residuals = without_rounding(&responses - regression.matrix() * &coefficients, &responses);
        Ok(Self { regression: regression.clone(), responses, coefficients, residuals })
    }

    /// The surface's height at a point in coded units.
    ///
    /// # Panics
    /// If the point has not one value a factor.
    pub fn predict(&self, coded: &[f64]) -> f64 {
        self.assert_length(coded);
        self.terms().iter().zip(&self.coefficients).map(|(term, coefficient)| coefficient * term.value(coded)).sum()
    }

    /// The surface's slopes at a point, response per coded unit, one a factor.
    ///
    /// # Panics
    /// If the point has not one value a factor.
    pub fn gradient(&self, coded: &[f64]) -> Vec<f64> {
        self.assert_length(coded);
        let along = |factor_idx| {
            let parts = self.terms().iter().zip(&self.coefficients);
            parts.map(|(term, coefficient)| coefficient * term.slope(coded, factor_idx)).sum()
        };
        (0..self.factors().len()).map(along).collect()
    }

    /// One-sigma uncertainty of `predict` from the scatter of the runs; none without residual degrees of freedom.
    ///
    /// # Panics
    /// If the point has not one value a factor.
    pub fn prediction_standard_error(&self, coded: &[f64]) -> Option<f64> {
        self.assert_length(coded);
        let values = DVector::from_iterator(self.terms().len(), self.terms().iter().map(|term| term.value(coded)));
        let weights = self.sensitivity().tr_mul(&values);
        Some(self.residual_standard_error()? * weights.norm())
    }

    /// The factors, in the order of a point's values.
    pub fn factors(&self) -> &[Factor] {
        self.design().factors()
    }

    /// The design that was fitted.
    pub fn design(&self) -> &Design {
        self.regression.design()
    }

    /// The terms, in the order of the coefficients.
    pub fn terms(&self) -> &[Term] {
        self.regression.terms()
    }

    /// The terms' names: `1`, `Mw`, `Mw^2`, `Mw*Mc` …
    pub fn term_names(&self) -> Vec<String> {
        self.terms().iter().map(|term| term.name(self.factors())).collect()
    }

    /// The coefficients in coded units, one a term, each in units of the response.
    pub fn coefficients(&self) -> &DVector<f64> {
        &self.coefficients
    }

    /// The responses that were fitted, one a run.
    pub fn responses(&self) -> &DVector<f64> {
        &self.responses
    }

    /// Response minus surface, one a run; zero where only rounding is left.
    pub fn residuals(&self) -> &DVector<f64> {
        &self.residuals
    }

    /// Leverage of each run, 0 to 1; the leverages add up to the number of terms.
    pub fn leverages(&self) -> Vec<f64> {
        self.regression.least_squares().leverages()
    }

    /// How each coefficient depends on each response, terms × runs.
    pub fn sensitivity(&self) -> DMatrix<f64> {
        self.regression.least_squares().sensitivity()
    }

    /// Condition number of the regression matrix in coded units.
    pub fn condition_number(&self) -> f64 {
        self.regression.least_squares().condition_number()
    }

    /// Runs beyond the number of terms; 0 for a saturated design, whose surface passes through every run.
    pub fn residual_dof(&self) -> usize {
        self.responses.len() - self.terms().len()
    }

    /// Sum of squared residuals.
    pub fn residual_sum_of_squares(&self) -> f64 {
        self.residuals.norm_squared()
    }

    /// Sum of squares about the mean; exactly 0 if all responses are equal.
    pub fn total_sum_of_squares(&self) -> f64 {
        without_rounding(self.responses.add_scalar(-self.responses.mean()), &self.responses).norm_squared()
    }

    /// Scatter of the runs about the surface, in units of the response; none for a saturated design.
    pub fn residual_standard_error(&self) -> Option<f64> {
        let dof = self.residual_dof();
        (dof > 0).then(|| (self.residual_sum_of_squares() / dof as f64).sqrt())
    }

    fn assert_length(&self, coded: &[f64]) {
        assert_eq!(coded.len(), self.factors().len(), "a point has one value a factor");
    }
}

fn check(design: &Design, responses: &[f64]) -> Result<(), FitError> {
    let n_runs = design.n_runs();
    if responses.len() != n_runs {
        return Err(FitError::ResponseCount { found: responses.len(), expected: n_runs });
    }
    if let Some(run_idx) = responses.iter().position(|value| value.is_nan() || value.abs() > LARGEST_RESPONSE) {
        return Err(FitError::Response { run: run_idx + 1, value: responses[run_idx] });
    }
    Ok(())
}

/// Sets deviations to zero when all of them are no more than rounding of the responses they come from.
fn without_rounding(deviations: DVector<f64>, responses: &DVector<f64>) -> DVector<f64> {
    let rounding = ROUNDING_OF_A_FIT * responses.len() as f64 * responses.amax();
    if deviations.amax() > rounding { deviations } else { DVector::zeros(deviations.len()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn design(n_factors: usize) -> Design {
        let factors = (0..n_factors).map(|idx| Factor::new(format!("x{idx}"), -2.0, 5.0).unwrap()).collect();
        Design::face_centred(factors, 1).unwrap()
    }

    fn two_factor_runs(runs: &[[f64; 2]]) -> Design {
        Design::from_coded(design(2).factors().to_vec(), runs.iter().map(|run| run.to_vec()).collect()).unwrap()
    }

    #[test]
    fn a_saturated_design_is_met_exactly_and_claims_no_uncertainty() {
        let runs = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0]];
        let responses = [3.0, -1.0, 4.0, 1.0, -5.0, 9.0];
        let surface = Surface::fit(&two_factor_runs(&runs), &responses).unwrap();
        assert_eq!(surface.residual_dof(), 0);
        assert_eq!(surface.residual_standard_error(), None);
        assert_eq!(surface.prediction_standard_error(&[0.0, 0.0]), None);
        for (run, response) in runs.iter().zip(responses) {
            assert!((surface.predict(run) - response).abs() < 1e-12);
        }
    }

    #[test]
    fn confounded_missing_and_broken_data_are_refused_with_their_reason() {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [-1.0, -1.0], [1.0, 1.0]];
        let refused = |design: &Design, responses: &[f64]| Surface::fit(design, responses).unwrap_err();
        assert_eq!(refused(&two_factor_runs(&corners), &[0.0; 6]), FitError::RankDeficient { rank: 4, n_terms: 6 });
        assert_eq!(refused(&two_factor_runs(&corners[..4]), &[0.0; 4]), FitError::TooFewRuns { n_runs: 4, n_terms: 6 });
        assert_eq!(refused(&design(2), &[0.0; 8]), FitError::ResponseCount { found: 8, expected: 9 });
        let mut responses = [0.0; 9];
        responses[6] = f64::INFINITY;
        assert_eq!(refused(&design(2), &responses), FitError::Response { run: 7, value: f64::INFINITY });
        responses[6] = f64::NAN;
        assert!(matches!(refused(&design(2), &responses), FitError::Response { run: 7, .. }));
    }

    #[test]
    fn the_leverages_add_up_to_the_number_of_terms() {
        for n_factors in 2..=6 {
            let design = design(n_factors);
            let surface = Surface::fit(&design, &vec![1.0; design.n_runs()]).unwrap();
            let sum: f64 = surface.leverages().iter().sum();
            assert!((sum - surface.terms().len() as f64).abs() < 1e-12);
        }
    }

    #[test]
    fn the_standard_error_at_a_run_is_the_scatter_times_the_root_of_its_leverage() {
        let design = design(3);
        let responses: Vec<f64> = (0..design.n_runs()).map(|run_idx| (run_idx as f64 * 1.7).sin()).collect();
        let surface = Surface::fit(&design, &responses).unwrap();
        let scatter = surface.residual_standard_error().unwrap();
        for (run, leverage) in design.coded_runs().iter().zip(surface.leverages()) {
            assert!((surface.prediction_standard_error(run).unwrap() - scatter * leverage.sqrt()).abs() < 1e-12);
        }
    }

    proptest! {
        #[test]
        fn a_known_quadratic_comes_back(n_factors in 2usize..=6, seed in proptest::collection::vec(-10.0..10.0, 28)) {
            let design = design(n_factors);
            let known = DVector::from_column_slice(&seed[..design.terms().len()]);
            let responses = design.model_matrix() * &known;
            let surface = Surface::fit(&design, responses.as_slice()).unwrap();
            // Rounding of the responses (below 300) times a condition number below 20.
            prop_assert!((surface.coefficients() - &known).amax() < 1e-11);
            prop_assert_eq!(surface.residual_sum_of_squares(), 0.0);
        }

        #[test]
        fn the_gradient_is_the_slope_of_the_prediction(
            seed in proptest::collection::vec(-10.0..10.0, 15), x in -1.0..1.0, y in -1.0..1.0,
        ) {
            let surface = Surface::fit(&design(3), &seed).unwrap();
            let step = 1e-4;
            let height = |x: f64| surface.predict(&[x, y, 0.2]);
            let difference = (height(x + step) - height(x - step)) / (2.0 * step);
            prop_assert!((surface.gradient(&[x, y, 0.2])[0] - difference).abs() < 1e-9);
        }
    }
}
