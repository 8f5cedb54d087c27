//! A comparison as text for the terminal.

use super::Comparison;
use super::knowledge::{Identifiability, Known};
use super::recording::Judged;
use super::verdict::in_mrad;

/// The verdict first, then recordings, parameters and limits.
pub fn text(comparison: &Comparison) -> String {
    let mut lines: Vec<String> = Vec::new();
    if comparison.fitted_first {
        lines.push("The model had no fitted values yet: it was fitted to these recordings first.".to_owned());
    }
    lines.extend(comparison.verdict.iter().cloned());
    lines.push(String::new());
    lines.push("recording                        noise  free run  a swing ahead  a step ahead   (mrad rms)".to_owned());
    lines.extend(comparison.recordings.iter().map(|judged| recording(judged, "")));
    lines.extend(comparison.held_out.iter().map(|judged| recording(judged, " (held out)")));
    if let Some(knowledge) = &comparison.knowledge {
        lines.push(String::new());
        lines.push("parameter          as given    these recordings want (95 %)                  verdict".to_owned());
        lines.extend(knowledge.parameters.iter().map(parameter));
    }
    let notes = comparison.recordings.iter().flat_map(|judged| &judged.notes);
    let notes: Vec<String> = notes.chain(&comparison.limits).map(|note| format!("note: {note}")).collect();
    if !notes.is_empty() {
        lines.push(String::new());
    }
    lines.extend(notes);
    lines.join("\n")
}

fn recording(judged: &Judged, suffix: &str) -> String {
    let or_dash = |error: Option<f64>| error.map_or("–".to_owned(), in_mrad);
    let predictions = &judged.predictions;
    format!(
        "{:<32} {:>5} {:>9} {:>14} {:>13}",
        format!("{}{suffix}", judged.name),
        in_mrad(judged.noise.level_rad()),
        in_mrad(predictions.free_run_rad),
        or_dash(predictions.swing_ahead_rad),
        or_dash(predictions.step_ahead_rad)
    )
}

fn parameter(known: &Known) -> String {
    let range =
        known.chosen.interval().map_or("no uncertainty".to_owned(), |(low, high)| format!("{low:.4e} … {high:.4e}"));
    let advice = known.advice.as_ref().map_or(String::new(), |advice| format!(": {advice}"));
    format!(
        "{:<4} {:>20.5e}    {:>11.5e}  {range:<26} {:<15} {}{advice}",
        known.symbol,
        known.given,
        known.chosen.value,
        known.unit,
        words(known.verdict)
    )
}

/// A verdict in words.
pub fn words(verdict: Identifiability) -> &'static str {
    match verdict {
        Identifiability::Identified => "identified",
        Identifiability::Weak => "weak",
        Identifiability::Not => "not identifiable",
        Identifiability::Zero => "zero",
    }
}
