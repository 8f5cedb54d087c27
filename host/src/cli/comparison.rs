//! A comparison as text for the terminal: the verdict first, then recordings, parameters and limits.

use super::table::{table, wrapped};
use crate::compare::Comparison;
use crate::compare::knowledge::Known;
use crate::compare::pictures::short_name;
use crate::compare::recording::Judged;
use crate::compare::verdict::in_mrad;
use crate::geometry::{PER_GRAVITY, is_unknown};
use crate::number::with_spread;
use crate::shorten::shortened;

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
        parts.push(parameters(&knowledge.parameters));
    }
    if is_unknown(&comparison.parameters.pendulum) {
        parts.push(wrapped(PER_GRAVITY, 2));
    }
    let notes: Vec<String> = notes(comparison).iter().map(|note| format!("note: {note}")).collect();
    if !notes.is_empty() {
        parts.push(sentences(&notes));
    }
    parts.join("\n\n")
}

fn notes(comparison: &Comparison) -> Vec<String> {
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

fn parameters(parameters: &[Known]) -> String {
    let row = |known: &Known| {
        vec![
            known.symbol.to_owned(),
            with_spread(known.given, None),
            with_spread(known.chosen.value, known.chosen.std),
            known.unit.to_owned(),
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
