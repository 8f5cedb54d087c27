//! From where a method ended to numbers with uncertainties and warnings.

use super::covariance::{Covariance, covariance};
use super::found::{Fit, Identified, Verdict};
use super::held_out::held_out_rmse;
use super::identify::FitError;
use super::linear::{Steps, linearise};
use super::outcome::{Outcome, full_values};
use super::problem::{Point, Problem, Unknown};
use super::quality::Responses;
use super::runs::responses_at;
use super::sequential::Stage;
use super::stiction::with_stiction;
use crate::swing::{Swing, Window};
use crate::verdict::Left;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

/// Errors beyond this share of the motion mean that the model does not follow it.
const HOPELESS_SHARE: f64 = 0.6;

/// Puts the result together.
pub(super) struct Report<'a, 'b> {
    pub(super) problem: &'b Problem<'a>,
    pub(super) outcome: Outcome,
    pub(super) given: &'b [(String, f64, f64)],
}

impl Report<'_, '_> {
    pub(super) fn build(
        &self,
        held_out: &[Swing],
        responses_before: Responses,
        stages: Vec<Stage>,
        count: &AtomicUsize,
        began: Instant,
    ) -> Result<Fit, FitError> {
        let problem = self.problem;
        let rmse_rad = self.outcome.rmse_rad(problem);
        let motion = rms(problem.swings.iter().flat_map(|swing| swing.angles_rad.iter().copied()));
        if !rmse_rad.is_finite() || rmse_rad > HOPELESS_SHARE * motion {
            return Err(FitError::Hopeless { error_rad: rmse_rad });
        }
        let full = self.full_problem();
        let values = full_values(&full, &self.outcome.point, self.outcome.stiction);
        let point = Point { values, starts: self.outcome.point.starts.clone() };
        let (known, covariance) = self.uncertainty(&full, &point);
        let parameters = full.parameters(&point.values);
        let identified = self.identified(&full, &point, &known, covariance.as_ref());
        let correlations = correlations(identified.len(), &known, covariance.as_ref());
        let left = full.chi_square(self.outcome.cost).left();
        let warnings = self.warnings(&identified, covariance.as_ref(), &stages, rmse_rad, left);
        let held_out_rmse_rad = (!held_out.is_empty()).then(|| held_out_rmse(held_out, &parameters, count));
        Ok(Fit {
            responses: responses_at(&full, &point, Window::Whole),
            parameters,
            identified,
            correlations,
            starts: point.starts,
            rmse_rad,
            left,
            noise_rad: problem.noise_rad(),
            held_out_rmse_rad,
            responses_before,
            stages,
            warnings,
            n_simulations: count.load(Ordering::Relaxed),
            seconds: began.elapsed().as_secs_f64(),
        })
    }

    fn full_problem(&self) -> Problem<'_> {
        with_stiction(self.problem, self.outcome.stiction)
    }

    /// The indices of the numbers that the data tell smoothly, and their covariance. Numbers on a bound are known to be
    /// there and take no part; neither does stiction without a band.
    fn uncertainty(&self, full: &Problem, point: &Point) -> (Vec<usize>, Option<Covariance>) {
        let has_band = self.outcome.stiction.velocity_band > 0.0;
        let takes_part = |j: &usize| {
            let (unknown, value) = (&full.unknowns[*j], point.values[*j]);
            let inside = value > unknown.low && value < unknown.high;
            inside && (has_band || !unknown.is_stiction())
        };
        let known: Vec<usize> = (0..full.unknowns.len()).filter(takes_part).collect();
        let covariance = covariance_of(full, point, &known);
        if covariance.is_some() || !has_band {
            return (known, covariance);
        }
        // Ms or DV without a smooth trace: the others still have their uncertainties.
        let known: Vec<usize> = known.into_iter().filter(|j| !full.unknowns[*j].is_stiction()).collect();
        let covariance = covariance_of(full, point, &known);
        (known, covariance)
    }

    fn identified(
        &self,
        full: &Problem,
        point: &Point,
        known: &[usize],
        covariance: Option<&Covariance>,
    ) -> Vec<Identified> {
        let (low, high) = self.outcome.level_range_nm;
        let identified = |(j, unknown): (usize, &Unknown)| {
            let smooth = known.iter().position(|k| *k == j).and_then(|column| covariance?.std(column));
            let is_level = unknown.is_stiction() && unknown.symbol == "Ms";
            // All levels within the range stop the pendulum alike: a uniform distribution.
            let uniform = (is_level && high > low).then(|| (high - low) / 12.0_f64.sqrt());
            let std = smooth.or(uniform);
            let value = point.values[j];
            let size = if unknown.name == "inertia" { full.template.pendulum.pivot_inertia_kg_m2() } else { value };
            let verdict = verdict(size, std);
            Identified { symbol: unknown.symbol, name: unknown.name, value, std, unit: unknown.unit, verdict }
        };
        full.unknowns.iter().enumerate().map(identified).collect()
    }

    fn warnings(
        &self,
        identified: &[Identified],
        covariance: Option<&Covariance>,
        stages: &[Stage],
        rmse_rad: f64,
        left: Left,
    ) -> Vec<String> {
        let mut warnings = Vec::new();
        let noise = self.problem.noise_rad();
        if left == Left::Missing {
            warnings.push(format!(
                "the error is {:.1} times the noise: physics is missing from the model (host diagnose names it)",
                rmse_rad / noise
            ));
        }
        if covariance.is_some_and(|covariance| covariance.coloured) {
            warnings.push("the residuals are correlated in time; the uncertainties allow for it".to_owned());
        }
        if !self.outcome.converged {
            warnings.push("least squares ran out of patience; more or longer swings would help".to_owned());
        }
        for number in identified {
            warnings.extend(self.warning_of(number));
        }
        let last = stages.last().and_then(|stage| stage.r_squared_predicted);
        if let Some(r_squared) = last.filter(|r_squared| *r_squared < 0.5) {
            let percent = 100.0 * r_squared;
            warnings.push(format!(
                "the last surface of mseA predicts only {percent:.0} % of new runs: don't trust its optimum"
            ));
        }
        warnings
    }

    fn warning_of(&self, number: &Identified) -> Option<String> {
        let Identified { symbol, value, .. } = number;
        let given = self.given.iter().find(|(name, ..)| name == symbol);
        if let Some((_, low, high)) = given.filter(|(_, low, high)| value < low || value > high) {
            return Some(format!("{symbol} lies outside the range {low} … {high} that was given"));
        }
        match (number.verdict, number.name) {
            (Verdict::Not, "stiction") if *value == 0.0 => {
                Some(format!("{symbol} has no visible effect: zero explains the swings as well as any small value"))
            }
            (Verdict::Not, "stiction") => {
                Some(format!("{symbol} is hardly identifiable here; record several swings down to rest"))
            }
            (Verdict::Not, "viscous" | "coulomb") if *value == 0.0 => {
                Some(format!("{symbol} is zero within its uncertainty"))
            }
            (Verdict::Not, _) => {
                Some(format!("{symbol} is not identifiable from these swings; add a release at 1.4 rad or more"))
            }
            _ => None,
        }
    }
}

fn covariance_of(full: &Problem, point: &Point, known: &[usize]) -> Option<Covariance> {
    let part = Problem {
        unknowns: known.iter().map(|j| full.unknowns[*j].clone()).collect(),
        template: full.parameters(&point.values),
        ..full.clone()
    };
    let point = Point { values: known.iter().map(|j| point.values[*j]).collect(), starts: point.starts.clone() };
    covariance(&linearise(&part, &point, Window::Whole, &mut Steps::found(&part, &point)))
}

fn correlations(n_identified: usize, known: &[usize], covariance: Option<&Covariance>) -> Vec<Vec<Option<f64>>> {
    let column = |j: usize| known.iter().position(|known| *known == j);
    let correlation = |i: usize, j: usize| covariance?.correlation(column(i)?, column(j)?);
    let row = |i: usize| (0..n_identified).map(|j| correlation(i, j)).collect();
    (0..n_identified).map(row).collect()
}

fn verdict(size: f64, std: Option<f64>) -> Verdict {
    match std.map(|std| std / size.abs()) {
        Some(relative) if relative < 0.1 => Verdict::Identified,
        Some(relative) if relative < 0.5 => Verdict::Weak,
        _ => Verdict::Not,
    }
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0.0), |(sum, n), value| (sum + value * value, n + 1.0));
    if n > 0.0 { (sum / n).sqrt() } else { 0.0 }
}
