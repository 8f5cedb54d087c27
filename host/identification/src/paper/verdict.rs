//! What of the paper comes out and what does not, in plain words with the numbers just calculated.

use super::designs::DesignComparison;
use super::equations::EquationComparison;
use super::optima::OptimumComparison;
use super::sequence::SequenceComparison;
use serde::Serialize;

/// Predicted R² below this, per cent, is worse than no surface.
const USELESS_PERCENT: f64 = 0.0;

/// A printed R² has two decimals.
const R_SQUARED_HALF_UNIT: f64 = 0.005;

/// Sentences for a person.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlainWords {
    /// What comes out.
    pub reproduced: Vec<String>,
    /// What does not, and why.
    pub not_reproduced: Vec<String>,
}

/// Sums everything up.
pub fn in_plain_words(
    designs: &[DesignComparison],
    equations: &[EquationComparison],
    optima: &[OptimumComparison],
    sequence: &SequenceComparison,
) -> PlainWords {
    PlainWords {
        reproduced: vec![
            counts(designs, optima),
            errors(designs),
            r_squared(&designs[2]),
            table_9(&optima[2]),
            equation_terms(equations),
        ],
        not_reproduced: optima
            .iter()
            .filter_map(|optimum| Some(format!("Table {}: {}.", optimum.table, optimum.why_not.as_ref()?)))
            .chain([predictions(designs), convergence(sequence)])
            .collect(),
    }
}

fn counts(designs: &[DesignComparison], optima: &[OptimumComparison]) -> String {
    let agreements = designs.iter().filter_map(|design| design.agreement);
    let (mut n_counts, mut n_wrong) =
        agreements.fold((0, 0), |(n, wrong), a| (n + a.n_counts, wrong + a.n_wrong_counts));
    for optimum in optima.iter().filter(|optimum| optimum.published_by == "simulation") {
        let pairs = optimum.published_responses.values().into_iter().zip(optimum.simulated.values()).skip(2);
        n_counts += 3;
        n_wrong += pairs.filter(|(printed, ours)| printed != ours).count();
    }
    format!("{} of {n_counts} printed counts of peaks and crossings come out exactly.", n_counts - n_wrong)
}

fn errors(designs: &[DesignComparison]) -> String {
    let percents: Vec<String> = designs
        .iter()
        .filter_map(|design| Some((design.runs_table?, design.agreement?)))
        .map(|(table, agreement)| format!("{:.1} % in Table {table}", 100.0 * agreement.rms_log_error))
        .collect();
    format!("The mean-square errors come out to {} (rms).", percents.join(" and "))
}

fn r_squared(design: &DesignComparison) -> String {
    let agrees = |row: &&super::designs::RSquared| {
        row.printed_percent.is_some_and(|printed| (printed - row.percent).abs() <= R_SQUARED_HALF_UNIT + 1e-9)
    };
    let n_equal = design.r_squared.iter().filter(agrees).count();
    format!("{n_equal} of {} printed R² come out to the last digit.", design.r_squared.len())
}

fn table_9(optimum: &OptimumComparison) -> String {
    format!(
        "The optimum of Table 9 comes out within {:.3} coded units, with bounds that the paper does not state.",
        optimum.coded_distance
    )
}

fn equation_terms(equations: &[EquationComparison]) -> String {
    let n_terms: usize = equations.iter().map(|equation| equation.terms.len()).sum();
    let n_misprints: usize = equations.iter().map(|equation| equation.misprints().count()).sum();
    format!(
        "{} of {n_terms} coefficients of Eqs 18–22 come out within rounding; {n_misprints} are misprints.",
        n_terms - n_misprints
    )
}

fn predictions(designs: &[DesignComparison]) -> String {
    let useless: Vec<String> = designs
        .iter()
        .filter(|design| design.runs_table.is_some())
        .flat_map(|design| design.r_squared.iter().map(move |row| (design.number, row)))
        .filter(|(_, row)| row.predicted_percent < USELESS_PERCENT)
        .map(|(number, row)| format!("{} of design {number} ({:.0} %)", row.response, row.predicted_percent))
        .collect();
    format!(
        "A high R² is not a good prediction: for runs left out it is negative, worse than the plain mean, for {}.",
        useless.join(", ")
    )
}

fn convergence(sequence: &SequenceComparison) -> String {
    let list = |values: Vec<f64>| values.iter().map(|value| format!("{value:.1e}")).collect::<Vec<_>>().join(", ");
    let simulated = |stages: &[super::sequence::Stage]| list(stages.iter().map(|stage| stage.simulated).collect());
    format!(
        "The sequence does not converge by itself. True mseA at the three printed optima: {} rad²; at the optima of the \
         surfaces in the same three boxes: {}; with each box centred on its own last optimum: {}.",
        list(sequence.printed_optima.to_vec()),
        simulated(&sequence.paper_boxes),
        simulated(&sequence.own_boxes)
    )
}
