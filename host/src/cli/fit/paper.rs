//! `host fit --paper`: the paper's tables beside ours.

use super::drawing;
use crate::cli::output;
use crate::cli::table::{table, wrapped};
use crate::error::Failure;
use crate::fit::quality::Responses;
use crate::number::{count, significant};
use crate::paper::data::SYMBOLS;
use crate::paper::designs::{DesignComparison, RSquared, RunComparison};
use crate::paper::equations::{EquationComparison, TermComparison};
use crate::paper::optima::OptimumComparison;
use crate::paper::sequence::{SequenceComparison, Stage};
use crate::paper::verdict::PlainWords;
use crate::paper::{Comparison, compare};
use std::path::Path;

/// Stands behind what the table contradicts.
const FLAG: &str = " ◄";

pub(super) fn run(json: bool, plot: Option<&Path>, force: bool) -> Result<(), Failure> {
    output::check(&plot.into_iter().collect::<Vec<_>>(), &[], force)?;
    let comparison = compare(&output::say);
    if let Some(path) = plot {
        drawing::of_paper(path, force)?;
        output::say(&format!("wrote {}", path.display()));
    }
    if json {
        output::json("fit", &comparison);
    } else {
        output::result(&in_words(&comparison));
    }
    Ok(())
}

fn in_words(comparison: &Comparison) -> String {
    let mut parts = vec![opening(comparison)];
    parts.extend(comparison.designs.iter().filter_map(runs));
    parts.push(goodness(&comparison.designs));
    parts.push(equations(&comparison.equations));
    parts.extend(comparison.optima.iter().map(optimum));
    parts.push(sequence(&comparison.sequence));
    parts.push(closing(&comparison.verdict));
    parts.join("\n\n")
}

fn opening(comparison: &Comparison) -> String {
    let simulation = &comparison.simulation;
    let text = format!(
        "Printed numbers stand left, “ours” are calculated here. Runs start at {} rad at rest and last \
         {:.1} s, in steps of {} ms, with the paper's sign of stiction, against a rebuilt recording: the authors' own was \
         never published, so its noise is added to the mean squares (mseA {:.2e}, mseV {:.2e}). {} simulated swings in {:.1} s.",
        simulation.start_rad,
        simulation.duration_s,
        1e3 * simulation.step_s,
        simulation.floor_angle,
        simulation.floor_velocity,
        comparison.simulations,
        comparison.seconds
    );
    format!("{}\n{}", output::heading("The paper beside this program"), wrapped(&text, 0))
}

/// Table 3 or 8; design 2 has none.
fn runs(design: &DesignComparison) -> Option<String> {
    let (number, agreement) = (design.runs_table?, design.agreement?);
    let header = ["run", "coded", "mseA", "ours", "mseV", "ours", "ePM eNM eZC", "ours"];
    let shown = table(header, design.runs.iter().map(run_row).collect(), 2);
    let summary = format!(
        "mean squares agree to {:.1} % (rms of the logarithms); {} of {} counts differ",
        100.0 * agreement.rms_log_error,
        agreement.n_wrong_counts,
        agreement.n_counts
    );
    let ranges = format!("ranges of Table {}: {}", design.levels_table, ranges(design));
    let title = output::heading(&format!("Table {number}: the 27 runs of design {}", design.number));
    Some(format!("{title}\n{}\n{shown}\n{summary}", wrapped(&ranges, 2)))
}

fn ranges(design: &DesignComparison) -> String {
    let range = |range: &crate::paper::designs::Range| format!("{} {:e} … {:e}", range.symbol, range.low, range.high);
    design.ranges.iter().map(range).collect::<Vec<_>>().join(", ")
}

fn run_row(run: &RunComparison) -> Vec<String> {
    let square = |value: f64| format!("{value:.6}").chars().take(8).collect::<String>();
    let counts = |r: &Responses| {
        let [positive, negative, crossings] = [r.positive_peaks, r.negative_peaks, r.zero_crossings].map(count);
        format!("{positive:>3} {negative:>3} {crossings:>3}")
    };
    let printed = run.published.unwrap_or(run.ours);
    let flag = if run.n_wrong_counts() > 0 { FLAG } else { "" };
    vec![
        run.run.to_string(),
        run.signs.clone(),
        square(printed.mse_angle),
        square(run.ours.mse_angle),
        square(printed.mse_velocity),
        square(run.ours.mse_velocity),
        counts(&printed),
        counts(&run.ours) + flag,
    ]
}

fn goodness(designs: &[DesignComparison]) -> String {
    let percent = |value: f64| format!("{value:.2}");
    let row = |(number, row): (usize, &RSquared)| {
        let printed = row.printed_percent.map_or("—".to_owned(), percent);
        let shown = [row.percent, row.adjusted_percent, row.predicted_percent].map(percent);
        [vec![number.to_string(), row.response.to_owned(), printed], shown.to_vec()].concat()
    };
    let published = designs.iter().filter(|design| design.runs_table.is_some());
    let rows = published.flat_map(|design| design.r_squared.iter().map(|row| (design.number, row))).map(row).collect();
    let header = ["design", "response", "paper R²", "R²", "adjusted", "predicted"];
    let title = output::heading("R² of the printed responses, %");
    format!(
        "{title}\n{}\nA predicted R² below zero is worse than taking the mean of the other runs.",
        table(header, rows, 2)
    )
}

/// Two equations beside each other as long as there are two.
fn equations(equations: &[EquationComparison]) -> String {
    let title = output::heading("Eqs 18–22, natural units");
    let tables: Vec<String> = equations.chunks(2).map(equation_table).collect();
    let found: Vec<String> =
        equations.iter().flat_map(|equation| equation.misprints().map(move |term| misprint(equation, term))).collect();
    format!("{title}\n{}\n{} misprints ({}):\n{}", tables.join("\n\n"), found.len(), FLAG.trim(), found.join("\n"))
}

fn equation_table(equations: &[EquationComparison]) -> String {
    let header = std::iter::once("term".to_owned())
        .chain(equations.iter().flat_map(|e| [format!("Eq {} {}", e.number, e.response), "ours".to_owned()]));
    let row = |term_idx: usize| {
        let pair = |e: &EquationComparison| [e.terms[term_idx].printed.clone(), as_printed(&e.terms[term_idx])];
        let term = equations[0].terms[term_idx].term.clone();
        std::iter::once(term).chain(equations.iter().flat_map(pair)).collect()
    };
    table(header, (0..equations[0].terms.len()).map(row).collect(), 1)
}

/// Our coefficient with the decimals of the printed one.
fn as_printed(term: &TermComparison) -> String {
    let decimals = term.printed.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let flag = if term.is_misprint { FLAG } else { "  " };
    format!("{:.decimals$}{flag}", term.ours)
}

fn misprint(equation: &EquationComparison, term: &TermComparison) -> String {
    format!("  Eq {}, {}: printed {}, the table gives{}", equation.number, term.term, term.printed, {
        let shown = as_printed(term);
        format!(" {}", shown.trim_end_matches(FLAG))
    })
}

fn optimum(optimum: &OptimumComparison) -> String {
    let title = output::heading(&format!("Table {}: the optimum of design {}", optimum.table, optimum.design));
    let header = ["", "paper", "replayed", "our surface", "our optimum", "replayed"];
    let values = (0..SYMBOLS.len()).map(|j| {
        let [paper, ours] = [optimum.published[j], optimum.ours.values[j]].map(|value| significant(value, 6));
        vec![SYMBOLS[j].to_owned(), paper, String::new(), String::new(), ours, String::new()]
    });
    let columns = [
        &optimum.published_responses,
        &optimum.simulated,
        &optimum.predicted,
        &optimum.ours.predicted,
        &optimum.ours.simulated,
    ];
    let responses = Responses::NAMES.iter().enumerate().map(|(k, name)| {
        let shown = columns.map(|r| if k < 2 { significant(r.values()[k], 4) } else { count(r.values()[k]) });
        std::iter::once((*name).to_owned()).chain(shown).collect()
    });
    let shown = table(header, values.chain(responses).collect(), 1);
    format!("{title}\n{shown}\n{}", wrapped(&optimum_in_words(optimum), 0))
}

fn optimum_in_words(optimum: &OptimumComparison) -> String {
    let [angle, velocity, peaks, ..] = optimum.ours.bounds;
    let basis = if optimum.design == 2 { "the replayed responses" } else { "the printed responses" };
    let mut text = format!(
        "The paper's responses are by {}; our optimum is that of {basis}, with the bounds mseA {angle:.4}, mseV \
         {velocity:.3}, counts from {peaks:.0}: desirability {:.4}, at the paper's point {:.4}, and {:.3} coded units apart.",
        optimum.published_by, optimum.ours.desirability, optimum.desirability_at_published, optimum.coded_distance
    );
    if let Some(why) = &optimum.why_not {
        text.push_str(&format!(" Not reproduced: {why}."));
    }
    text
}

fn sequence(sequence: &SequenceComparison) -> String {
    let title = output::heading("Does the sequence find its way by itself? True mseA (rad²) after each design");
    let text = |value: f64| significant(value, 3);
    let stages = |name: &str, stages: &[Stage]| {
        std::iter::once(name.to_owned()).chain(stages.iter().map(|stage| text(stage.simulated))).collect()
    };
    let printed = std::iter::once("at the optima as printed".to_owned())
        .chain(sequence.printed_optima.iter().map(|value| text(*value)))
        .collect();
    let rows = vec![
        printed,
        stages("at our optima in the paper's boxes", &sequence.paper_boxes),
        stages("at our optima, boxes around our last", &sequence.own_boxes),
    ];
    format!("{title}\n{}", table(["", "design 1", "design 2", "design 3"], rows, 1))
}

fn closing(verdict: &PlainWords) -> String {
    let list = |title: &str, sentences: &[String]| {
        let lines: Vec<String> = sentences.iter().map(|sentence| wrapped(&format!("- {sentence}"), 2)).collect();
        format!("{}\n{}", output::heading(title), lines.join("\n"))
    };
    format!("{}\n\n{}", list("Reproduced", &verdict.reproduced), list("Not reproduced", &verdict.not_reproduced))
}
