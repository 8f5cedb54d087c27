//! A diagnosis in words and tables: what is missing, how sure that is, and what it gains.

use crate::diagnose::{Candidate, Diagnosis};
use shared::effect::Effect;

/// The whole diagnosis for a person.
pub(super) fn in_words(diagnosis: &Diagnosis) -> String {
    let mut parts = vec![verdict(diagnosis)];
    parts.extend(diagnosis.verdict.iter().filter_map(|name| claimed(diagnosis, name)));
    if !diagnosis.undecided.is_empty() {
        parts.push(format!(
            "These data can't tell {} from {}; a release from a larger angle may.",
            diagnosis.undecided.join(" or "),
            diagnosis.verdict.join(" + ")
        ));
    }
    if diagnosis.verdict.is_empty() && !diagnosis.unexplained {
        return parts.join("\n\n");
    }
    parts.push(staircase(diagnosis));
    parts.push(ranking(diagnosis));
    parts.join("\n\n")
}

fn verdict(diagnosis: &Diagnosis) -> String {
    let noises = |rmse: f64| format!("{:.2} mrad, {:.2} times the noise", 1e3 * rmse, rmse / diagnosis.noise);
    let (before, after) = (noises(diagnosis.rmse_before), noises(diagnosis.rmse_after));
    match (diagnosis.verdict.as_slice(), diagnosis.unexplained) {
        ([], false) => format!("Nothing is missing at this noise level: the base model leaves {after}."),
        ([], true) => format!(
            "The base model leaves {before}, but no effect of the list explains it.\n\
             Not explained by any candidate: look where it fails with `host compare`."
        ),
        (names, false) => {
            format!("Missing: {}. With it the error falls from {before},\nto {after}.", names.join(" and "))
        }
        (names, true) => format!(
            "Missing: {}. With it the error falls from {before},\nto {after}. What remains is not explained by any \
             candidate.",
            names.join(" and ")
        ),
    }
}

/// One claimed effect: what it is and its numbers.
fn claimed(diagnosis: &Diagnosis, name: &str) -> Option<String> {
    let effect = Effect::<f64>::by_name(name)?;
    let candidate = diagnosis.candidates.iter().find(|candidate| candidate.name == diagnosis_name(diagnosis));
    let belongs = |symbol: &str| effect.parameters.iter().any(|parameter| parameter.symbol == symbol);
    let values =
        candidate.map_or(&[][..], |candidate| &candidate.parameters).iter().filter(|value| belongs(value.symbol));
    let mut lines = vec![format!("{name}: {}", effect.summary), format!("  {}", effect.formula)];
    lines.extend(values.map(|value| {
        let std = value.std.map_or(String::new(), |std| format!(" ± {std:.1e}"));
        let unit = if value.unit == "1" { "" } else { value.unit };
        format!("  {:<4} = {:.4e}{std} {unit}", value.symbol, value.value)
    }));
    lines.push(format!("  shows best: {}", effect.experiment));
    Some(lines.join("\n"))
}

/// The claimed model as candidates are named; the offset is no candidate of its own.
fn diagnosis_name(diagnosis: &Diagnosis) -> String {
    let named: Vec<&str> = diagnosis.staircase.iter().skip(1).map(|step| step.added).collect();
    if named.is_empty() { "none".to_owned() } else { named.join("+") }
}

fn staircase(diagnosis: &Diagnosis) -> String {
    let highest = diagnosis.rmse_before.max(diagnosis.noise);
    let bar = |rmse: f64| "█".repeat((BAR_WIDTH * rmse / highest).round().max(1.0) as usize);
    let held_out = |rmse: Option<f64>| rmse.map_or(String::new(), |rmse| format!("  held out {:.2}", 1e3 * rmse));
    let mut lines = vec!["Error, mrad rms".to_owned()];
    lines.extend(diagnosis.staircase.iter().map(|step| {
        let name = if step.added == "base" { "base model".to_owned() } else { format!("+ {}", step.added) };
        format!("  {name:<28}{:>8.2}  {}{}", 1e3 * step.rmse, bar(step.rmse), held_out(step.held_out))
    }));
    lines.push(format!("  {:<28}{:>8.2}  {}", "noise", 1e3 * diagnosis.noise, bar(diagnosis.noise)));
    lines.join("\n")
}

/// Widest bar of the staircase, characters.
const BAR_WIDTH: f64 = 30.0;

fn ranking(diagnosis: &Diagnosis) -> String {
    let line = |candidate: &Candidate| {
        format!("  {:<44}{:>8.2}  {:>7.2}", candidate.name, 1e3 * candidate.rmse, candidate.rmse / diagnosis.noise)
    };
    let head = format!("{:<46}{:>8}  {:>7}", "Tried", "mrad", "noises");
    let lines = diagnosis.candidates.iter().take(SHOWN).map(line);
    std::iter::once(head).chain(lines).collect::<Vec<_>>().join("\n")
}

/// So many candidates are shown; `--json` has all.
const SHOWN: usize = 8;
