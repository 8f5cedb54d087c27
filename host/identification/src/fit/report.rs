//! From where a method ended to numbers with uncertainties and warnings.

use super::apart::apart_rmse;
use super::error::FitError;
use super::fitted::Fitted;
use super::found::{Fit, Identified, Verdict};
use super::held_out::held_out_rmse;
use super::problem::{Point, Problem, Quantity};
use super::quality::{Responses, predicted};
use super::runs::responses_at;
use super::sequential::Stage;
use super::uncertainty::{Number, Status, UNKNOWN_SHARE, Uncertainty, uncertainty};
use crate::fit::tally::Tally;
use crate::geometry::{slower_than_seen, unit_of};
use crate::number::{angle, noises};
use crate::swing::{Swing, Window, kind};
use crate::verdict::{CHANCE_STDS, LOOK_FIRST, Left, followed_one_by_one, hardly_follows};
use shared::parameters::base;
use std::time::Instant;

/// A geometry this many standard deviations from the measured one is told; of honest tolerances 1 in 80 is.
const DOUBTFUL_STDS: f64 = 2.5;

/// Puts the result together.
pub(super) struct Report<'a, 'b> {
    pub(super) problem: &'b Problem<'a>,
    pub(super) model: Fitted,
    pub(super) given: &'b [(String, f64, f64)],
}

impl Report<'_, '_> {
    pub(super) fn build(
        self,
        held_out: &[Swing],
        responses_before: Responses,
        stages: Vec<Stage>,
        count: &Tally,
        began: Instant,
    ) -> Result<Fit, FitError> {
        let (problem, model) = (self.problem, &self.model);
        let rmse_rad = problem.rmse_rad(model.cost);
        if !problem.is_followed(model.cost) {
            return Err(FitError::Hopeless { error: rmse_rad, measured: kind(problem.swings), follows_from_s: None });
        }
        let uncertainty = uncertainty(problem, model);
        let quantities = problem.unknowns.iter().map(|unknown| unknown.quantity);
        let quantities = quantities.chain([Quantity::Mass, Quantity::Length]);
        let order: Vec<usize> = quantities.filter_map(|quantity| uncertainty.index_of(quantity)).collect();
        let identified: Vec<Identified> = order.iter().map(|j| identified(&uncertainty.numbers[*j], model)).collect();
        let row = |i: &usize| order.iter().map(|j| uncertainty.correlations[*i][*j]).collect();
        let left = problem.chi_square(model.cost).left();
        let values = problem.unknowns.iter().map(|unknown| unknown.get(&model.parameters)).collect();
        let point = Point { values, starts: model.starts.clone() };
        let held_out_rmse_rad = held_out_rmse(held_out, &model.parameters, count);
        Ok(Fit {
            responses: responses_at(problem, &point, Window::Whole),
            correlations: order.iter().map(row).collect(),
            warnings: self.warnings(&identified, &uncertainty, &stages, left),
            identified,
            rmse_rad,
            left,
            hardly_follows: left == Left::Missing && hardly_follows(problem.left_of_motion(model.cost)),
            noise_rad: problem.noise_rad(),
            held_out_rmse_rad,
            responses_before,
            stages,
            n_simulations: count.simulations(),
            seconds: began.elapsed().as_secs_f64(),
            parameters: problem.tolerances.settled(&self.model.parameters),
            tolerances: problem.tolerances,
            starts: self.model.starts,
            touches: Vec::new(),
        })
    }

    fn warnings(
        &self,
        identified: &[Identified],
        uncertainty: &Uncertainty,
        stages: &[Stage],
        left: Left,
    ) -> Vec<String> {
        let mut warnings = Vec::new();
        let ratio = self.problem.rmse_rad(self.model.cost) / self.problem.noise_rad();
        let driven = Swing::driven(self.problem.swings);
        if !driven.is_empty() {
            warnings.push(format!(
                "the swings of {} don't become smaller, so that a motor or a hand drives them: neither friction nor what is \
                 missing can be found from them; record the pendulum swinging freely, or choose such a stretch with --from \
                 and --to",
                driven.join(", ")
            ));
        } else if left == Left::Missing {
            warnings.push(what_is_wrong(ratio, self.problem.left_of_motion(self.model.cost)));
            let unit = kind(self.problem.swings).milli_unit();
            warnings.extend(apart_rmse(self.problem, &self.model).map(|rmse| followed_one_by_one(rmse, unit)));
        } else if left == Left::Nearly {
            warnings.push(NEARLY.to_owned());
        }
        if uncertainty.coloured {
            warnings.push("the residuals are correlated in time; the uncertainties allow for it".to_owned());
        }
        if self.model.termination.is_some_and(|reason| !reason.is_converged()) {
            warnings.push("least squares ran out of patience; more or longer swings would help".to_owned());
        }
        warnings.extend(uncertainty.alike.iter().map(|symbols| {
            format!("{} can't be told apart here: only what they do together is known", symbols.join(" and "))
        }));
        let of_numbers = identified.iter().filter_map(|number| Some((number.symbol, self.warning_of(number, left)?)));
        warnings.extend(said_once(of_numbers.collect()));
        warnings.extend(self.far_from_measured());
        let last = stages.last().and_then(|stage| stage.r_squared_predicted);
        if let Some(r_squared) = last.filter(|r_squared| *r_squared < 0.5) {
            let predicts = predicted(r_squared, 0);
            warnings.push(format!("the last surface of mseA predicts {predicts}: don't trust its optimum"));
        }
        warnings
    }

    /// A period that asks for another geometry than the measured one.
    fn far_from_measured(&self) -> Option<String> {
        let inertia = self.problem.unknowns.iter().find(|unknown| unknown.quantity == Quantity::Inertia)?;
        let off = inertia.prior?.off(inertia.get(&self.model.parameters)).abs();
        (off > DOUBTFUL_STDS).then(|| {
            format!(
                "the period asks for a geometry {off:.1} standard deviations from the measured mass, length and \
                 inertia; measure them again, or give their std in rig.toml larger"
            )
        })
    }

    fn warning_of(&self, number: &Identified, left: Left) -> Option<String> {
        let Identified { symbol, value, .. } = number;
        let unit = unit_of(number.unit, &self.model.parameters.pendulum);
        let given = self.given.iter().find(|(name, ..)| name == symbol);
        if let Some((_, low, high)) = given.filter(|(_, low, high)| value < low || value > high) {
            return Some(format!("{symbol} lies outside the range {low} … {high} that was given"));
        }
        let bound = number.upper.map_or(String::new(), |upper| format!("; it is below {} {unit}", two_digits(upper)));
        if number.status == Status::UpperBound && *value > 0.0 {
            let known = number
                .upper
                .map_or("unknown".to_owned(), |upper| format!("only known to be below {} {unit}", two_digits(upper)));
            return Some(format!("{symbol} is {known}, because no swing comes to rest"));
        }
        let unknown =
            self.problem.unknowns.iter().find(|unknown| unknown.symbol == *symbol && unknown.name == number.name);
        let id = unknown.and_then(|unknown| match unknown.quantity {
            Quantity::Effect { id, .. } => Some(id),
            _ => None,
        });
        // Of driven swings nothing that is missing can be told.
        let is_imitating = left == Left::Missing && Swing::driven(self.problem.swings).is_empty();
        match (number.verdict, id) {
            (Verdict::Not, Some(base::VISCOUS | base::COULOMB)) if is_imitating => {
                Some(unknown_beside_missing_physics(number))
            }
            (Verdict::Not, Some(base::STICTION)) if *value == 0.0 => Some(format!(
                "{symbol} has no visible effect: zero explains the swings as well as any small value{bound}"
            )),
            (Verdict::Not, Some(base::STICTION)) => {
                Some(format!("{symbol} is hardly identifiable here; record several swings down to rest"))
            }
            (Verdict::Not, Some(base::VISCOUS | base::COULOMB)) if *value == 0.0 => {
                Some(format!("{symbol} is zero within its uncertainty"))
            }
            (Verdict::Not, _) if is_imitating => {
                let is_inertia = unknown.is_some_and(|unknown| unknown.quantity == Quantity::Inertia);
                let told = (is_inertia && *value == 0.0)
                    .then(|| slower_than_seen(&self.model.parameters, self.problem.swings))
                    .flatten();
                Some(told.unwrap_or_else(|| unknown_beside_missing_physics(number)))
            }
            (Verdict::Not, _) => {
                let more = what_tells_more(self.problem.largest_rad());
                Some(format!("{symbol} is not identifiable from these swings; {more}"))
            }
            _ => None,
        }
    }
}

/// Mw and Mc imitate a weak law so well that little more than the noise is left, and are then off by many of their ±: friction
/// of other exponents, or that depends on the angle, takes them 20 to 190 off in swings that leave 1.04 to 1.09 noises.
const NEARLY: &str = "a little more than the noise is left: should an effect be missing, friction imitates it and is off by more than \
                      its ± (host diagnose says whether one is)";

/// Where so many noises are left, and this share of the motion: what hardly follows the swings lacks more than a drag.
fn what_is_wrong(ratio: f64, share: f64) -> String {
    let noises = noises(ratio);
    if !hardly_follows(share) {
        return format!(
            "the error is {noises} times the noise: physics is missing from the model (host diagnose names it)"
        );
    }
    format!(
        "the error is {noises} times the noise and beyond it {:.0} % of the motion: the model hardly follows these \
         swings; before you ask what physics is missing, {LOOK_FIRST}",
        100.0 * share
    )
}

/// What is said of several numbers alike is said once, of all of them.
fn said_once(of_numbers: Vec<(&str, String)>) -> Vec<String> {
    let mut said: Vec<(Vec<&str>, String)> = Vec::new();
    for (symbol, words) in of_numbers {
        let Some(rest) = words.strip_prefix(&format!("{symbol} is ")) else {
            said.push((Vec::new(), words));
            continue;
        };
        let rest = rest.replace(&format!("draw {symbol} "), "draw it ");
        match said.iter_mut().find(|(_, other)| *other == rest) {
            Some((symbols, _)) => symbols.push(symbol),
            None => said.push((vec![symbol], rest)),
        }
    }
    let sentence = |(symbols, rest): (Vec<&str>, String)| match symbols.as_slice() {
        [] => rest,
        [symbol] => format!("{symbol} is {}", rest.replace("draw it ", &format!("draw {symbol} "))),
        _ => format!("{} are {}", symbols.join(" and "), rest.replace("draw it ", "draw them ")),
    };
    said.into_iter().map(sentence).collect()
}

/// The cause is not a lack of swings: what is missing asks the other numbers to imitate it.
fn unknown_beside_missing_physics(number: &Identified) -> String {
    let symbol = number.symbol;
    let is_near_zero = number.value.abs() <= CHANCE_STDS * number.std.unwrap_or(0.0);
    let wanted = if is_near_zero { format!(", and draw {symbol} towards zero") } else { String::new() };
    format!("{symbol} is not identifiable while physics is missing: the other numbers imitate what is missing{wanted}")
}

/// What to record for a number that swings of up to this angle do not tell. Not every pendulum can be released from as far
/// as one likes.
fn what_tells_more(largest_rad: f64) -> String {
    if largest_rad >= LARGE_RELEASE_RAD {
        return "more releases, down to rest, would tell more".to_owned();
    }
    let farther_rad = (FARTHER * largest_rad).min(LARGE_RELEASE_RAD);
    format!("a release from {} rad or more, if it can go so far, and more of them would tell more", angle(farther_rad))
}

/// Releases from here on show what depends on the amplitude: gain, spring, drag and Stribeck friction. A larger one is no
/// help, rad.
pub(crate) const LARGE_RELEASE_RAD: f64 = 1.2;

/// A larger release is one from so many times as far.
const FARTHER: f64 = 1.5;

fn identified(number: &Number, model: &Fitted) -> Identified {
    let Number { unknown, value, std, status, upper } = number;
    let size = match unknown.quantity {
        Quantity::Inertia => model.parameters.pendulum.pivot_inertia_kg_m2(),
        _ => *value,
    };
    let verdict = match status {
        Status::Identified => verdict(size, *std),
        _ => Verdict::Not,
    };
    let (symbol, name, unit) = (unknown.symbol, unknown.name, unknown.unit);
    Identified { symbol, name, value: *value, std: *std, unit, verdict, status: *status, upper: *upper }
}

fn verdict(size: f64, std: Option<f64>) -> Verdict {
    match std.map(|std| std / size.abs()) {
        Some(relative) if relative < 0.1 => Verdict::Identified,
        Some(relative) if relative < UNKNOWN_SHARE => Verdict::Weak,
        _ => Verdict::Not,
    }
}

fn two_digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.1e}").parse().unwrap_or(value);
    if value > 1e-3 { format!("{rounded}") } else { format!("{value:.1e}") }
}

#[cfg(test)]
mod tests {
    use super::super::descent::Termination;
    use super::super::ranges::Ranges;
    use super::super::region::Region;
    use super::super::tests::{RELEASE_RAD, at_rest, viscous_problem, viscous_swing};
    use super::super::tolerance::Prior;
    use super::*;

    #[test]
    fn what_hardly_follows_the_motion_is_not_sent_to_look_for_physics_first() {
        let little = what_is_wrong(451.0, 0.24);
        assert!(little.contains("451 times the noise: physics is missing") && !little.contains('%'), "{little}");
        let hardly = what_is_wrong(4.49, 0.26);
        assert!(
            hardly.contains("4.49 times the noise and beyond it 26 % of the motion: the model hardly follows"),
            "{hardly}"
        );
    }

    #[test]
    fn a_number_is_identified_to_a_tenth_and_weak_to_a_half() {
        let of = |std: f64| verdict(-2.0, Some(std));
        assert_eq!([0.19, 0.21, 0.99, 1.01].map(of), {
            use Verdict::{Identified, Not, Weak};
            [Identified, Weak, Weak, Not]
        });
        assert_eq!(verdict(2.0, None), Verdict::Not);
    }

    #[test]
    fn what_is_odd_about_a_number_or_its_search_is_said() {
        let (swings, count) = (viscous_swing(4e-4), Tally::default());
        let problem = viscous_problem(&swings, 4e-4, &count);
        let point = Point { values: problem.template_values(), starts: at_rest(RELEASE_RAD) };
        let mut model = Fitted::at(&problem, &point);
        model.termination = Some(Termination::LostPatience);
        let given = [("Mw".to_owned(), 1e-3, 2e-3)];
        let report = Report { problem: &problem, model, given: &given };
        let unknown = problem.unknowns[0].clone();
        let number = Number { unknown, value: 4e-4, std: Some(1e-6), status: Status::Identified, upper: None };
        let said = report.warning_of(&identified(&number, &report.model), Left::Noise).unwrap();
        assert_eq!(said, "Mw lies outside the range 0.001 … 0.002 that was given");
        let nothing = Uncertainty { numbers: Vec::new(), correlations: Vec::new(), alike: Vec::new(), coloured: false };
        let told = report.warnings(&[], &nothing, &[], Left::Noise);
        assert_eq!(told, ["least squares ran out of patience; more or longer swings would help"]);
        assert_eq!(report.warnings(&[], &nothing, &[], Left::Nearly)[0], NEARLY);
    }

    #[test]
    fn a_number_that_is_not_told_has_its_cause_and_what_would_help() {
        let (swings, count) = (viscous_swing(4e-4), Tally::default());
        let problem = viscous_problem(&swings, 4e-4, &count);
        let point = Point { values: problem.template_values(), starts: at_rest(RELEASE_RAD) };
        let report = Report { problem: &problem, model: Fitted::at(&problem, &point), given: &[] };
        let said = |value: f64, left: Left| {
            let unknown = problem.unknowns[0].clone();
            let number = Number { unknown, value, std: Some(3e-4), status: Status::NotIdentified, upper: None };
            report.warning_of(&identified(&number, &report.model), left).unwrap()
        };
        let missing = said(3.3e-4, Left::Missing);
        assert!(missing.starts_with("Mw is not identifiable while physics is missing"), "{missing}");
        assert!(
            missing.ends_with("imitate what is missing, and draw Mw towards zero") && !missing.contains("release"),
            "{missing}"
        );
        assert!(!said(8e-4, Left::Missing).contains("zero"));
        assert!(said(3.3e-4, Left::Noise).starts_with("Mw is not identifiable from these swings; "));
        assert_eq!(what_tells_more(1.5), "more releases, down to rest, would tell more");
        assert!(what_tells_more(0.2).starts_with("a release from 0.30 rad or more"), "{}", what_tells_more(0.2));
        assert!(what_tells_more(1.1).starts_with("a release from 1.20 rad"), "{}", what_tells_more(1.1));
    }

    #[test]
    fn what_is_true_of_several_numbers_is_said_once() {
        let missing = |symbol: &str| {
            format!("{symbol} is not identifiable while physics is missing, and draw {symbol} towards zero")
        };
        let all = vec![("Mw", missing("Mw")), ("I", "it ends at zero".to_owned()), ("Mc", missing("Mc"))];
        let told = said_once(all);
        assert_eq!(
            told,
            ["Mw and Mc are not identifiable while physics is missing, and draw them towards zero", "it ends at zero"]
        );
        assert_eq!(said_once(vec![("Mw", missing("Mw"))]), [missing("Mw")]);
    }

    #[test]
    fn a_geometry_that_is_too_large_or_too_small_by_three_standard_deviations_is_doubted() {
        let (swings, count) = (viscous_swing(4e-4), Tally::default());
        let doubts = |stds: f64| {
            let mut problem = viscous_problem(&swings, 4e-4, &count);
            let place = problem.unknowns.iter().position(|unknown| unknown.quantity == Quantity::Inertia).unwrap();
            let point = Point { values: problem.template_values(), starts: at_rest(RELEASE_RAD) };
            let value = point.values[place] - stds * 1e-5;
            problem.unknowns[place].prior = Some(Prior { value, std: 1e-5, only_below: false });
            let model = Fitted::at(&problem, &point);
            Report { problem: &problem, model, given: &[] }.far_from_measured()
        };
        for stds in [3.0, -3.0] {
            assert!(doubts(stds).unwrap().contains("a geometry 3.0 standard deviations from the measured"));
        }
        assert_eq!([doubts(2.0), doubts(-2.0)], [None, None]);
    }

    #[test]
    fn a_surface_that_predicts_less_than_half_of_new_runs_is_not_to_be_trusted() {
        let (swings, count) = (viscous_swing(4e-4), Tally::default());
        let problem = viscous_problem(&swings, 4e-4, &count);
        let point = Point { values: problem.template_values(), starts: at_rest(RELEASE_RAD) };
        let report = Report { problem: &problem, model: Fitted::at(&problem, &point), given: &[] };
        let nothing = Uncertainty { numbers: Vec::new(), correlations: Vec::new(), alike: Vec::new(), coloured: false };
        let stage = |share: f64| Stage {
            window_s: None,
            ranges: Vec::new(),
            values: Vec::new(),
            before: Responses::default(),
            after: Responses::default(),
            goodness: Vec::new(),
            surfaces: Vec::new(),
            region: Region::of_ranges(&Ranges(Vec::new())),
            r_squared_predicted: Some(share),
        };
        let said = |share: f64| report.warnings(&[], &nothing, &[stage(share)], Left::Noise).join(" ");
        assert!(said(0.31).contains("the last surface of mseA predicts only 31 % of new runs"), "{}", said(0.31));
        assert!(said(-3.54).contains("the last surface of mseA predicts none of the new runs: "), "{}", said(-3.54));
        assert_eq!(said(0.9), "");
    }
}
