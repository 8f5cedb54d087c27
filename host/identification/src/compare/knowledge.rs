//! What the recordings say about each parameter: the value they would choose, its interval, correlations, a verdict,
//! and whether every recording alone says the same.
//!
//! All parameters move together from the given ones to where the squared error is least; Ms and DV stay, because the
//! error is not smooth in them. A recording alone is answered to first order at the common values.
//!
//! A geometry that is known to tolerances is what a fit makes of it: the likeliest one, whose tolerances every ± holds. What
//! one recording alone would choose has the ± of its swings only: all have the same mass and length, so that no
//! tolerance excuses recordings that contradict each other.

use super::follow::Followed;
use crate::diagnose::zero;
use crate::fit::clusters::NORMAL_95;
use crate::fit::covariance::{Covariance, with_model_error};
use crate::fit::descent::{Tolerance, descend};
use crate::fit::fitted::Fitted;
use crate::fit::identify::problem_of;
use crate::fit::linear::{Linear, Steps, SwingLinear, dot, linearise};
use crate::fit::problem::{PER_SWING, Point, Problem, Quantity, Unknown};
use crate::fit::solve::solve_damped;
use crate::fit::tally::Tally;
use crate::fit::tolerance::KnownRig;
use crate::fit::tolerated::tolerated;
use crate::fit::uncertainty::{Number, Status, Uncertainty};
use crate::formula::{FRICTION_CURVE, effect_of};
use crate::swing::{Swing, Window};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Recordings disagree when chance alone would do it more rarely than this.
const DISAGREEMENT: f64 = 1e-3;

/// How well the recordings tell a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Identifiability {
    /// Known within 10 %.
    Identified,
    /// Known within a factor of about two.
    Weak,
    /// Next to nothing is known about it.
    Not,
    /// Zero, below which it can't be.
    Zero,
    /// At another end of its range: it would go on, so that nobody knows how far.
    AtEnd,
}

impl Identifiability {
    /// For a person.
    pub fn words(self) -> &'static str {
        match self {
            Self::Identified => "identified",
            Self::Weak => "weak",
            Self::Not => "not identifiable",
            Self::Zero => "zero",
            Self::AtEnd => "at the end of its range",
        }
    }
}

/// A value with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Standard deviation, coloured residuals allowed for; absent if the data give none.
    pub std: Option<f64>,
}

impl Estimate {
    /// The 95 % interval.
    pub fn interval(&self) -> Option<(f64, f64)> {
        self.std.map(|std| (self.value - NORMAL_95 * std, self.value + NORMAL_95 * std))
    }
}

/// One parameter as the recordings see it.
#[derive(Clone, Debug, Serialize)]
pub struct Known {
    /// The literature's symbol.
    pub symbol: &'static str,
    /// The effect, or `inertia`.
    pub name: &'static str,
    /// SI unit.
    pub unit: &'static str,
    /// As the rig file has it.
    pub given: f64,
    /// What all recordings together would choose.
    pub chosen: Estimate,
    /// How well they tell it.
    pub verdict: Identifiability,
    /// What every recording alone would choose.
    pub alone: Vec<Estimate>,
    /// Probability that recordings of one pendulum differ this much; absent with one recording.
    pub agreement: Option<f64>,
    /// Which recording would help, if one is needed.
    pub advice: Option<String>,
}

impl Known {
    /// Is it zero, below which it can't be? One that is smaller than its error may be anything.
    pub fn is_zero(&self) -> bool {
        self.verdict == Identifiability::Zero
    }

    /// Do the recordings contradict each other?
    pub fn disagrees(&self) -> bool {
        self.agreement.is_some_and(|probability| probability < DISAGREEMENT)
    }

    /// Does the value rise or fall from recording to recording?
    pub fn drifts(&self) -> bool {
        let values: Vec<f64> = self.alone.iter().map(|estimate| estimate.value).collect();
        let rises = values.windows(2).all(|pair| pair[0] < pair[1]);
        let falls = values.windows(2).all(|pair| pair[0] > pair[1]);
        self.disagrees() && values.len() >= 3 && (rises || falls)
    }
}

/// What is known about all parameters.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Knowledge {
    /// One a parameter, stiction left out; then mass and length, where they have a tolerance.
    pub parameters: Vec<Known>,
    /// Correlations, in the same order.
    pub correlations: Vec<Vec<f64>>,
    /// Are the residuals coloured? The intervals allow for it.
    pub coloured: bool,
    /// How far the sensor's zero is off, rad, if it is.
    pub zero: Option<Estimate>,
}

/// Asks the recordings for the parameters; `followed` tells how each began.
pub fn knowledge(swings: &[Swing], rig: KnownRig, followed: &[Followed]) -> Knowledge {
    let count = Tally::default();
    let problem = problem_of(swings, rig, &count).without_stiction();
    let starts = followed.iter().map(|followed| followed.start).collect();
    let first = Point { values: problem.template_values(), starts };
    let descended = descend(&problem, &first, Window::Whole, Tolerance::FINE, Steps::new(&problem));
    let (end, cost) = (descended.point, descended.cost);
    // A value at its bound is known to be there and takes no part.
    let inside = |j: &usize| end.values[*j] > problem.unknowns[*j].low && end.values[*j] < problem.unknowns[*j].high;
    let free: Vec<usize> = (0..end.values.len()).filter(inside).collect();
    let (part, point) = restricted(&problem, &end, &free);
    let mut steps = Steps::new(&part);
    linearise(&part, &point, Window::Whole, &mut steps);
    let linear = linearise(&part, &point, Window::Whole, &mut steps);
    let together = with_model_error(&part, &linear, &point.starts);
    let alone = linear.each(|swing_idx, swing| alone(&part, swing_idx, swing, &point));

    let found = found(&problem, &end, &free, together.as_ref());
    let model = Fitted { cost, ..Fitted::at(&problem, &end) };
    let zero = zero::off_rad(&problem, &model).map(|(value, std)| Estimate { value, std: Some(std) });
    let found = tolerated(&problem, &model, found);
    let given = problem.tolerances.settled(&problem.parameters(&first.values));
    let known = |(j, number): (usize, &Number)| {
        let column = free.iter().position(|k| *k == j);
        let alone =
            alone.iter().filter_map(|alone| Some(settled(number, *end.values.get(j)?, alone.estimates.get(column?)?)));
        let alone: Vec<Estimate> = alone.collect();
        let verdict = verdict(number, &problem);
        Known {
            symbol: number.unknown.symbol,
            name: number.unknown.name,
            unit: number.unknown.unit,
            given: number.unknown.get(&given),
            agreement: agreement(&alone),
            advice: advice(&number.unknown, &problem, verdict),
            chosen: Estimate { value: number.value, std: number.std },
            verdict,
            alone,
        }
    };
    let row = |row: &Vec<Option<f64>>| row.iter().map(|correlation| correlation.unwrap_or(0.0)).collect();
    Knowledge {
        parameters: found.numbers.iter().enumerate().map(known).collect(),
        correlations: found.correlations.iter().map(row).collect(),
        coloured: found.coloured,
        zero,
    }
}

/// What all recordings say together, at the mass and length that were measured.
fn found(problem: &Problem, point: &Point, free: &[usize], together: Option<&Covariance>) -> Uncertainty {
    let column = |j: usize| free.iter().position(|k| *k == j);
    let number = |(j, unknown): (usize, &Unknown)| {
        let std = column(j).and_then(|column| together?.std(column));
        let status = if column(j).is_some() { Status::Identified } else { Status::AtBound };
        Number { unknown: unknown.clone(), value: point.values[j], std, status, upper: None }
    };
    let correlation = |i: usize, j: usize| together?.correlation(column(i)?, column(j)?);
    let row = |i: usize| (0..point.values.len()).map(|j| correlation(i, j)).collect();
    Uncertainty {
        numbers: problem.unknowns.iter().enumerate().map(number).collect(),
        correlations: (0..point.values.len()).map(row).collect(),
        alike: Vec::new(),
        coloured: together.is_some_and(|covariance| covariance.coloured),
    }
}

/// What one recording alone would choose, in the geometry of a number that was found at another mass and length.
fn settled(number: &Number, found: f64, alone: &Estimate) -> Estimate {
    let is_scaled = found != 0.0 && number.unknown.quantity != Quantity::Inertia;
    let scale = if is_scaled { number.value / found } else { 1.0 };
    Estimate { value: number.value + scale * (alone.value - found), std: alone.std.map(|std| scale * std) }
}

/// The problem with some unknowns only; the others keep their values.
fn restricted<'a>(problem: &Problem<'a>, point: &Point, free: &[usize]) -> (Problem<'a>, Point) {
    let part = Problem {
        unknowns: free.iter().map(|j| problem.unknowns[*j].clone()).collect(),
        template: problem.parameters(&point.values),
        ..problem.clone()
    };
    let values = free.iter().map(|j| point.values[*j]).collect();
    (part, Point { values, starts: point.starts.clone() })
}

/// What one recording alone says.
struct Alone {
    estimates: Vec<Estimate>,
}

fn alone(together: &Problem, swing_idx: usize, swing: &SwingLinear, point: &Point) -> Alone {
    let n_columns = swing.columns.len();
    let normal = DMatrix::from_fn(n_columns, n_columns, |i, j| dot(&swing.columns[i], &swing.columns[j]));
    let gradient = DVector::from_fn(n_columns, |i, _| dot(&swing.columns[i], &swing.residuals));
    let step = solve_damped(&normal, &gradient, 0.0, &vec![true; n_columns]);
    let residuals: Vec<f64> = (0..swing.residuals.len())
        .map(|row| swing.residuals[row] - (0..n_columns).map(|j| swing.columns[j][row] * step[j]).sum::<f64>())
        .collect();
    let left = SwingLinear { residuals, columns: swing.columns.clone() };
    let linear = Linear::of(n_columns - PER_SWING, vec![left]);
    let place = swing_idx..swing_idx + 1;
    let covariance = with_model_error(&together.on(&together.swings[place.clone()]), &linear, &point.starts[place]);
    let estimate = |j: usize| Estimate {
        value: point.values[j] + step[j],
        std: covariance.as_ref().and_then(|covariance| covariance.std(j)),
    };
    Alone { estimates: (0..n_columns - PER_SWING).map(estimate).collect() }
}

/// Probability that the scatter of the recordings' values is chance.
fn agreement(alone: &[Estimate]) -> Option<f64> {
    let known: Vec<(f64, f64)> = alone.iter().filter_map(|e| Some((e.value, e.std?.powi(-2)))).collect();
    if known.len() < 2 {
        return None;
    }
    let total: f64 = known.iter().map(|(_, weight)| weight).sum();
    let mean = known.iter().map(|(value, weight)| weight * value).sum::<f64>() / total;
    let square = known.iter().map(|(value, weight)| weight * (value - mean).powi(2)).sum();
    let distribution = ChiSquared::new((known.len() - 1) as f64).ok()?;
    Some(distribution.sf(square))
}

fn verdict(number: &Number, problem: &Problem) -> Identifiability {
    if number.status == Status::AtBound {
        return if number.value == 0.0 { Identifiability::Zero } else { Identifiability::AtEnd };
    }
    // The inertia about the centre is a small part of the one about the pivot, which the period tells.
    let size = match number.unknown.quantity {
        Quantity::Inertia => problem.template.pendulum.pivot_inertia_kg_m2(),
        _ => number.value,
    };
    match number.std.map(|std| std / size.abs()) {
        Some(relative) if relative < 0.1 => Identifiability::Identified,
        Some(relative) if relative < 0.5 => Identifiability::Weak,
        _ => Identifiability::Not,
    }
}

/// The experiment that shows the effect best.
fn advice(unknown: &Unknown, problem: &Problem, verdict: Identifiability) -> Option<String> {
    let needed = matches!(verdict, Identifiability::Weak | Identifiability::Not);
    let experiment = match unknown.quantity {
        Quantity::Mass | Quantity::Length => "No swing tells it: weigh and balance the pendulum.",
        Quantity::Inertia => "A release from a small angle: the period tells the inertia.",
        Quantity::Effect { id, .. } => effect_of(&problem.template, id)?.experiment,
        Quantity::Knot(_) => FRICTION_CURVE.experiment,
        Quantity::Level { .. } => return None,
    };
    needed.then(|| experiment.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::tests::{NOISE_RAD, VISCOUS, rig, swing};
    use crate::fit::problem::Start;

    fn known(values: [f64; 3], agreement: f64) -> Known {
        Known {
            symbol: "Mc",
            name: "coulomb",
            unit: "N·m",
            given: 1.0,
            chosen: Estimate { value: 1.0, std: Some(0.01) },
            verdict: Identifiability::Identified,
            alone: values.map(|value| Estimate { value, std: Some(0.01) }).to_vec(),
            agreement: Some(agreement),
            advice: None,
        }
    }

    #[test]
    fn a_number_drifts_if_every_recording_goes_on_from_the_one_before() {
        let drifts = |values| known(values, 1e-9).drifts();
        assert!(drifts([1.0, 2.0, 3.0]) && drifts([3.0, 2.0, 1.0]));
        assert!(![[1.0, 2.0, 2.0], [2.0, 1.0, 1.0], [1.0, 3.0, 2.0]].into_iter().any(drifts));
        assert!(!known([1.0, 2.0, 3.0], 0.5).drifts());
    }

    #[test]
    fn recordings_agree_with_the_probability_of_their_chi_square() {
        // Two values with ±3 and ±4 differ by ±5: at 1.96 of these the probability is 5 %.
        let estimate = |value: f64, std: f64| Estimate { value, std: Some(std) };
        let found = agreement(&[estimate(10.0, 3.0), estimate(10.0 + 5.0 * 1.959_964, 4.0)]).unwrap();
        assert!((found - 0.05).abs() < 1e-6, "{found}");
        assert_eq!(agreement(&[estimate(10.0, 3.0)]), None);
    }

    #[test]
    fn what_is_not_free_stays_where_it_was_found() {
        let (count, swings) = (Tally::default(), [swing("one", NOISE_RAD, 1)]);
        let mut problem = problem_of(&swings, KnownRig::from(&rig(VISCOUS)), &count);
        problem.unknowns.retain(|unknown| ["Mw", "I"].contains(&unknown.symbol));
        let start = Start { angle_rad: 0.02, velocity_rad_s: 0.0, offset_rad: 0.0 };
        let point = Point { values: vec![3e-4, 2e-3], starts: vec![start] };
        let (part, left) = restricted(&problem, &point, &[1]);
        assert_eq!(part.unknowns, problem.unknowns[1..]);
        assert_eq!((left.values, left.starts), (vec![2e-3], vec![start]));
        assert_eq!(problem.unknowns[0].get(&part.template), 3e-4);
    }

    #[test]
    fn what_lies_at_an_end_that_is_not_zero_is_not_called_zero() {
        let (count, swings) = (Tally::default(), [swing("one", NOISE_RAD, 1)]);
        let problem = problem_of(&swings, KnownRig::from(&rig(VISCOUS)), &count);
        let at = |name: &str, index: usize, value: f64| {
            let effect = shared::effect::Effect::by_name(name).unwrap();
            let unknown = Unknown::of_effect(effect, index, &problem.template);
            verdict(&Number { unknown, value, std: None, status: Status::AtBound, upper: None }, &problem).words()
        };
        assert_eq!(at("coulomb", 0, 0.0), "zero");
        assert_eq!([at("power-law-drag", 1, 0.25), at("detent", 2, 60.0)], ["at the end of its range"; 2]);
        let negative = Known { chosen: Estimate { value: -1.0, std: Some(0.01) }, ..known([-1.0; 3], 0.5) };
        assert!(!negative.is_zero());
    }

    #[test]
    fn an_interval_reaches_as_far_as_95_percent_of_a_normal_distribution() {
        assert_eq!(Estimate { value: 10.0, std: Some(2.0) }.interval(), Some((6.08, 13.92)));
        assert_eq!(Estimate { value: 10.0, std: None }.interval(), None);
    }

    #[test]
    fn two_recordings_that_differ_are_no_drift_yet() {
        let mut two = known([1.0, 2.0, 3.0], 1e-9);
        two.alone.truncate(2);
        assert!(two.disagrees() && !two.drifts());
    }
}
