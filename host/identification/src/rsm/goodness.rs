//! Goodness of fit: how much of the responses' variation the surface explains, and how much it would predict.
//!
//! Plain R² grows with every term and flatters small designs. Predicted R² leaves each run out in turn; negative means
//! that the mean of the other runs would have predicted better than the surface.
//! Source: D. M. Allen, Technometrics 16 (1974) 125 (PRESS).

use super::significance::ratio;
use super::surface::Surface;
use serde::Serialize;

/// A run with leverage this close to 1 cannot be predicted from the others.
const FULL_LEVERAGE: f64 = 1.0 - 1e-10;

/// The usual figures of one fit; absent where the design or the responses leave them undefined.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Goodness {
    /// Explained fraction of the variation, 0 to 1; absent if all responses are equal.
    pub r_squared: Option<f64>,
    /// The same per degree of freedom, at most 1; absent for a saturated design.
    pub r_squared_adjusted: Option<f64>,
    /// The same for runs left out, at most 1 and often negative; absent where `press` is.
    pub r_squared_predicted: Option<f64>,
    /// Sum of squared errors of predicting each run from the others; absent if some run has leverage 1.
    pub press: Option<f64>,
    /// Scatter about the surface, in units of the response; absent for a saturated design.
    pub residual_standard_error: Option<f64>,
    /// Runs beyond the number of terms.
    pub residual_dof: usize,
    /// Largest leverage of any run, 0 to 1.
    pub largest_leverage: f64,
    /// Condition number of the regression matrix in coded units.
    pub condition_number: f64,
}

/// Judges a fit by its own runs.
pub fn goodness(surface: &Surface) -> Goodness {
    let total = surface.total_sum_of_squares();
    let explained = |left_over: f64| ratio(left_over, total).map(|fraction| 1.0 - fraction);
    let press = press(surface);
    Goodness {
        r_squared: explained(surface.residual_sum_of_squares()),
        r_squared_adjusted: adjusted(surface, total),
        r_squared_predicted: press.and_then(explained),
        press,
        residual_standard_error: surface.residual_standard_error(),
        residual_dof: surface.residual_dof(),
        largest_leverage: surface.leverages().into_iter().fold(0.0, f64::max),
        condition_number: surface.condition_number(),
    }
}

fn adjusted(surface: &Surface, total: f64) -> Option<f64> {
    let total_variance = total / (surface.responses().len() - 1) as f64;
    let residual_variance = surface.residual_standard_error()?.powi(2);
    ratio(residual_variance, total_variance).map(|fraction| 1.0 - fraction)
}

/// A run's prediction from the others misses it by residual/(1 − leverage); no refit is needed.
fn press(surface: &Surface) -> Option<f64> {
    let leverages = surface.leverages();
    if leverages.iter().any(|&leverage| leverage > FULL_LEVERAGE) {
        return None;
    }
    let misses = surface.residuals().iter().zip(leverages).map(|(residual, leverage)| residual / (1.0 - leverage));
    Some(misses.map(|miss| miss * miss).sum())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rsm::coding::Factor;
    use crate::rsm::design::Design;

    fn design() -> Design {
        let factors = ["a", "b"].map(|name| Factor::new(name, 0.0, 1.0).unwrap());
        Design::face_centred(factors.to_vec(), 3).unwrap()
    }

    fn responses() -> Vec<f64> {
        (0..design().n_runs()).map(|run_idx| (run_idx as f64 * 2.3).sin()).collect()
    }

    #[test]
    fn press_equals_leaving_each_run_out_and_refitting() {
        let (design, responses) = (design(), responses());
        let mut sum = 0.0;
        for left_out in 0..design.n_runs() {
            let others = |idx: &usize| *idx != left_out;
            let runs = (0..design.n_runs()).filter(others).map(|idx| design.coded_runs()[idx].clone()).collect();
            let kept: Vec<f64> = (0..design.n_runs()).filter(others).map(|idx| responses[idx]).collect();
            let smaller = Design::from_coded(design.factors().to_vec(), runs).unwrap();
            let surface = Surface::fit(&smaller, &kept).unwrap();
            sum += (responses[left_out] - surface.predict(&design.coded_runs()[left_out])).powi(2);
        }
        let press = goodness(&Surface::fit(&design, &responses).unwrap()).press.unwrap();
        assert!((press - sum).abs() < 1e-12 * sum);
    }

    #[test]
    fn each_stricter_r_squared_is_smaller() {
        let figures = goodness(&Surface::fit(&design(), &responses()).unwrap());
        let (plain, adjusted) = (figures.r_squared.unwrap(), figures.r_squared_adjusted.unwrap());
        assert!(plain > adjusted && adjusted > figures.r_squared_predicted.unwrap());
    }

    #[test]
    fn equal_responses_have_nothing_to_explain() {
        let figures = goodness(&Surface::fit(&design(), &[0.1; 11]).unwrap());
        assert_eq!((figures.r_squared, figures.r_squared_adjusted, figures.r_squared_predicted), (None, None, None));
        assert_eq!(figures.press, Some(0.0));
    }

    #[test]
    fn a_saturated_design_cannot_be_judged_by_its_own_runs() {
        let runs = [-1.0, 0.0, 1.0].map(|x| vec![x]).to_vec();
        let design = Design::from_coded(vec![Factor::new("x", 0.0, 1.0).unwrap()], runs).unwrap();
        let figures = goodness(&Surface::fit(&design, &[1.0, 2.0, 5.0]).unwrap());
        assert_eq!(figures.r_squared, Some(1.0));
        assert_eq!((figures.r_squared_adjusted, figures.press, figures.residual_standard_error), (None, None, None));
    }

    #[test]
    fn the_figures_of_a_line_of_hills_are_those_worked_by_hand() {
        // A parabola through (−1, 0, 1, 2) misses 0, 0, 0, 6 by 6/20·(−1, 3, −3, 1): 1.8 of 27 are left.
        let runs = [-1.0, 0.0, 1.0, 2.0].map(|x| vec![x]).to_vec();
        let design = Design::from_coded(vec![Factor::new("x", 0.0, 1.0).unwrap()], runs).unwrap();
        let figures = goodness(&Surface::fit(&design, &[0.0, 0.0, 0.0, 6.0]).unwrap());
        assert!((figures.r_squared.unwrap() - (1.0 - 1.8 / 27.0)).abs() < 1e-12);
        assert!((figures.r_squared_adjusted.unwrap() - (1.0 - 1.8 / 9.0)).abs() < 1e-12);
        // What the parabola can't follow is the third polynomial, of length √20: the ends have 1/20 of it.
        assert!((figures.largest_leverage - 0.95).abs() < 1e-12, "{figures:?}");
    }
}
