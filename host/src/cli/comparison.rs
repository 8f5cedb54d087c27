//! A comparison as text for the terminal: the verdict first, then recordings, parameters and limits.

use super::table::{table, wrapped};
use crate::compare::Comparison;
use crate::compare::knowledge::Known;
use crate::compare::pictures::short_name;
use crate::compare::recording::Judged;
use crate::compare::verdict::in_mrad;
use crate::geometry::{PER_GRAVITY, is_unknown, unit_of};
use crate::number::with_spread;
use crate::shorten::shortened;
use shared::motion::Pendulum;

/// The numbers beside a longer name would leave the screen.
const LONGEST_NAME: usize = 32;

pub(super) fn text(comparison: &Comparison) -> String {
    let mut parts = Vec::new();
    if comparison.fitted_first {
        parts.push("The model had no fitted values yet: it was fitted to these recordings first.".to_owned());
    }
    parts.push(sentences(&comparison.verdict));
    parts.push(recordings(comparison));
    if let Some(knowledge) = &comparison.knowledge {
        parts.push(parameters(&knowledge.parameters, &comparison.parameters.pendulum));
    }
    if is_unknown(&comparison.parameters.pendulum) {
        parts.push(wrapped(PER_GRAVITY, 2));
    }
    parts.join("\n\n")
}

/// What a person should know beside the result.
pub(super) fn notes(comparison: &Comparison) -> Vec<String> {
    let all: Vec<&Judged> = comparison.recordings.iter().chain(&comparison.held_out).collect();
    let of_one = |judged: &&Judged| {
        let whose = if all.len() > 1 { format!("{}: ", short_name(&judged.name)) } else { String::new() };
        judged.notes.iter().map(|note| format!("{whose}{note}")).collect::<Vec<_>>()
    };
    all.iter().flat_map(of_one).chain(comparison.limits.iter().cloned()).collect()
}

fn sentences(sentences: &[String]) -> String {
    sentences.iter().map(|sentence| wrapped(sentence, 2)).collect::<Vec<_>>().join("\n")
}

fn recordings(comparison: &Comparison) -> String {
    let or_dash = |error: Option<f64>| error.map_or("–".to_owned(), in_mrad);
    let row = |judged: &Judged, suffix: &str| {
        vec![
            format!("{}{suffix}", shortened(short_name(&judged.name), LONGEST_NAME)),
            in_mrad(judged.noise.level_rad()),
            in_mrad(judged.predictions.free_run_rad),
            or_dash(judged.predictions.swing_ahead_rad),
            or_dash(judged.predictions.step_ahead_rad),
        ]
    };
    let head = format!("error in {} rms", comparison.measured.milli_unit());
    let fitted = comparison.recordings.iter().map(|judged| row(judged, ""));
    let held_out = comparison.held_out.iter().map(|judged| row(judged, " (held out)"));
    table([head.as_str(), "noise", "free run", "a swing ahead", "a step ahead"], fitted.chain(held_out).collect(), 1)
}

fn parameters(parameters: &[Known], pendulum: &Pendulum<f64>) -> String {
    let row = |known: &Known| {
        vec![
            known.symbol.to_owned(),
            with_spread(known.given, None),
            with_spread(known.chosen.value, known.chosen.std),
            unit_of(known.unit, pendulum).into_owned(),
            format!("{}{}", known.verdict.words(), if known.disagrees() { ", recordings disagree" } else { "" }),
        ]
    };
    let table = table(["", "in the model", "wanted", "unit", "verdict"], parameters.iter().map(row).collect(), 5);
    let advice = parameters
        .iter()
        .filter_map(|known| known.advice.as_ref().map(|advice| format!("{}: {advice}", known.symbol)))
        .collect::<Vec<_>>();
    if advice.is_empty() { table } else { format!("{table}\n{}", sentences(&advice)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::knowledge::Estimate;
    use crate::compare::prediction::Predictions;
    use crate::examples::comparison;

    fn cells(table: &str, row: &str) -> Vec<String> {
        let line = table.lines().find(|line| line.trim_start().starts_with(row)).unwrap();
        line.split_whitespace().map(str::to_owned).collect()
    }

    #[test]
    fn errors_stand_under_the_distance_that_they_are_ahead() {
        let mut comparison = comparison();
        comparison.recordings[0].predictions =
            Predictions { free_run_rad: 4e-3, swing_ahead_rad: Some(3e-3), step_ahead_rad: Some(2e-3) };
        let table = recordings(&comparison);
        assert!(
            table.contains("noise") && cells(&table, "swing.csv") == ["swing.csv", "1.00", "4.00", "3.00", "2.00"],
            "{table}"
        );
        comparison.recordings[0].predictions.step_ahead_rad = None;
        let table = recordings(&comparison);
        assert_eq!(cells(&table, "swing.csv"), ["swing.csv", "1.00", "4.00", "3.00", "–"], "{table}");
    }

    #[test]
    fn a_note_says_whose_it_is_where_there_are_several_recordings() {
        let mut comparison = comparison();
        comparison.limits.clear();
        comparison.recordings[0].notes = vec!["it was touched".to_owned()];
        assert_eq!(notes(&comparison), ["it was touched"]);
        let other = comparison.recordings[0].clone();
        comparison.held_out.push(other);
        assert_eq!(notes(&comparison), ["swing.csv: it was touched"; 2]);
    }

    #[test]
    fn a_number_of_the_model_stands_beside_the_one_that_is_wanted() {
        let mut known = comparison().knowledge.unwrap().parameters;
        known.truncate(1);
        (known[0].given, known[0].chosen) = (3e-4, Estimate { value: 2e-4, std: Some(1e-6) });
        let table = parameters(&known, &Pendulum::paper());
        assert_eq!(cells(&table, known[0].symbol)[1..5], ["3.000e-4", "(2.000", "±", "0.010)e-4"], "{table}");
    }
}
