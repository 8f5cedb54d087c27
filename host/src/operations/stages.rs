//! How much each stage of a fit lowered the five responses.

use crate::fit::descent::{Tolerance, descend};
use crate::fit::identify::{Fit, Method, problem_of};
use crate::fit::linear::Steps;
use crate::fit::problem::{Point, Problem, Unknown};
use crate::fit::quality::Responses;
use crate::fit::runs::responses_at;
use crate::fit::sequential::Stage;
use crate::fit::tally::Tally;
use crate::swing::{Swing, Window};
use serde::Serialize;

/// The responses over the whole swings after a stage.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct After {
    /// What was just done.
    pub stage: &'static str,
    /// Where that led.
    pub responses: Responses,
}

/// First guess, response surfaces, least squares, as far as the method has them.
pub(super) fn stages(fit: &Fit, method: Method, swings: &[Swing]) -> Vec<After> {
    let after = |stage, responses| After { stage, responses };
    let mut stages = vec![after("first guess", fit.responses_before)];
    match (method, fit.stages.last()) {
        (Method::Rsm, _) => stages.push(after("response surfaces", fit.responses)),
        (Method::Both, Some(last)) => {
            stages.push(after("response surfaces", after_surfaces(fit, last, swings)));
            stages.push(after("least squares", fit.responses));
        }
        _ => stages.push(after("least squares", fit.responses)),
    }
    stages
}

/// The last design's optimum over the whole swings; how each swing began is fitted to it, as everywhere.
fn after_surfaces(fit: &Fit, last: &Stage, swings: &[Swing]) -> Responses {
    let count = Tally::default();
    let full = problem_of(swings, fit.rig(), &count);
    let fixed = Problem { template: full.parameters(&values_after(last, &full)), unknowns: Vec::new(), ..full };
    let from = Point { values: Vec::new(), starts: fit.starts.clone() };
    let end = descend(&fixed, &from, Window::Whole, Tolerance::ROUGH, Steps::new(&fixed));
    responses_at(&fixed, &end.point, Window::Whole)
}

/// Where a design ended. What it did not vary is as the whole fit has it.
fn values_after(design: &Stage, problem: &Problem) -> Vec<f64> {
    let mut varied = design.ranges.iter().zip(&design.values).peekable();
    let value = |(unknown, fitted): (&Unknown, f64)| {
        varied.next_if(|((symbol, _, _), _)| *symbol == unknown.symbol).map_or(fitted, |(_, value)| *value)
    };
    problem.unknowns.iter().zip(problem.template_values()).map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::examples::{self, swing};
    use crate::fit::identify::{self, Options};
    use shared::parameters::Parameters;

    #[test]
    fn the_first_guess_stands_before_what_the_fit_made_of_it() {
        let fit = examples::fit();
        let told = stages(&fit, Method::LeastSquares, &[swing()]);
        let [first, last] = [&told[0], &told[1]];
        assert_eq!((first.stage, first.responses), ("first guess", fit.responses_before));
        assert_eq!((last.stage, last.responses), ("least squares", fit.responses));
    }

    #[test]
    fn response_surfaces_end_where_their_last_design_does() {
        let options = Options { method: Method::Both, ranges: Vec::new() };
        let fit = identify::fit(&[swing()], &[], &Parameters::paper(), &options, &|_| {}).unwrap();
        let told = stages(&fit, Method::Both, &[swing()]);
        assert_eq!(
            told.iter().map(|after| after.stage).collect::<Vec<_>>(),
            ["first guess", "response surfaces", "least squares"]
        );
        // The surfaces end at numbers of their own.
        assert_ne!(told[1].responses, told[2].responses);
        let (swings, count) = ([swing()], Tally::default());
        let full = problem_of(&swings, fit.rig(), &count);
        let last = fit.stages.last().unwrap();
        let values = values_after(last, &full);
        let at = full.unknowns.iter().position(|unknown| unknown.symbol == "Mw").unwrap();
        let design = last.ranges.iter().position(|(symbol, _, _)| *symbol == "Mw").unwrap();
        assert_eq!(values[at], last.values[design]);
    }
}
