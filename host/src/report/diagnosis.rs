//! The report of a diagnosis: what is missing, on which parts of the swings each claim holds, and what was tried.

use super::tables::LONGEST_NAME;
use super::{figure, page};
use crate::compare::pictures::short_name;
use crate::diagnose::holds::Part;
use crate::diagnose::levels::Levels;
use crate::diagnose::{Candidate, Diagnosis, Holding, Suggestion, Value};
use crate::formula::effect_of;
use crate::geometry::unit_of;
use crate::number::{noises, with_spread};
use crate::plot::friction::friction;
use crate::plot::staircase::{Tread, staircase};
use crate::shorten::shortened;
use crate::verdict::Left;
use maud::{Markup, html};
use shared::effect::Effect;
use shared::motion::Pendulum;

/// The whole page; the sentences say what the tables and pictures show.
pub fn report(diagnosis: &Diagnosis, sentences: &[String], treads: &[Tread]) -> String {
    let class = match diagnosis.left {
        Left::Noise => "good",
        Left::Nearly => "unsure",
        Left::Missing => "bad",
    };
    let body = html! {
        section.verdict.(class) { @for sentence in sentences { p { (sentence) } } }
        (figure(&staircase(treads, diagnosis.noise, diagnosis.measured)))
        @for name in &diagnosis.verdict { (claimed(diagnosis, name)) }
        @if let Some(levels) = &diagnosis.levels { (levels_of_releases(levels)) }
        (curve(diagnosis))
        (formulas(diagnosis))
        (tried(diagnosis))
    };
    page("Which physical effect is missing?", &body)
}

/// One claimed effect: what it is, its numbers, what it does, and where it is seen.
fn claimed(diagnosis: &Diagnosis, name: &str) -> Markup {
    let in_model = diagnosis.parameters.effects.iter();
    let in_model = in_model.filter_map(|present| effect_of(&diagnosis.parameters, present.id));
    let effect = in_model.chain(Effect::by_name(name)).find(|effect| effect.name == name);
    let evidence = diagnosis.evidence.iter().find(|evidence| evidence.effect == name);
    let holding = diagnosis.holds_on.iter().find(|claim| claim.effect == name);
    let values: Vec<&Value> = diagnosis.values.iter().filter(|value| value.effect == name).collect();
    html! {
        section.effect {
            h2 { (name) }
            @if let Some(effect) = effect {
                p { (effect.summary) }
                p { code { (effect.formula) } }
            }
            @if !values.is_empty() { table { @for value in values { (number(value, &diagnosis.parameters.pendulum)) } } }
            @if let Some(evidence) = evidence { p { (evidence.words) } }
            @if let Some(holding) = holding { (holds_on(holding)) }
            @if let Some(effect) = effect { p { "Shows best: " (effect.experiment) " Source: " (effect.source) "." } }
        }
    }
}

fn number(value: &Value, pendulum: &Pendulum<f64>) -> Markup {
    let unit = unit_of(value.unit, pendulum);
    let end = if value.is_on_an_end() { "the end of its range" } else { "" };
    html! { tr { td { (value.symbol) } td { (with_spread(value.value, value.std)) } td { (unit) } td { (end) } } }
}

fn holds_on(claim: &Holding) -> Markup {
    let seen = |part: &Part| match (part.seen, part.std) {
        (Some(true), _) => "seen",
        (Some(false), _) => "not seen",
        (None, Some(_)) => "can't be told",
        (None, None) => "too few windows alone",
    };
    let p = claim.p.map(|p| format!("; chance alone looks like this in {p:.0e} of the cases"));
    html! {
        p { "Tested on " (claim.windows) " windows of the swings" (p.unwrap_or_default()) "." }
        table {
            tr { th { "part of the swings" } th { "strength there" } th { } }
            @for part in &claim.parts {
                tr { td { (shortened(short_name(&part.name), LONGEST_NAME)) } td { (with_spread(part.value, part.std)) } td { (seen(part)) } }
            }
        }
    }
}

fn levels_of_releases(levels: &Levels) -> Markup {
    html! {
        section.effect {
            h2 { "Friction levels of the releases" }
            p { (levels.words) "." }
            table {
                tr { th { "recording" } th { "part of the friction" } th { "share of the mean" } }
                @for part in &levels.parts {
                    @for release in &part.releases {
                        tr { td { (shortened(short_name(&release.recording), LONGEST_NAME)) } td { (part.part.words()) } td { (with_spread(release.value, release.std)) } }
                    }
                }
            }
        }
    }
}

/// Friction as a free curve, where no law explains the swings.
fn curve(diagnosis: &Diagnosis) -> Markup {
    let Some(curve) = &diagnosis.curve else { return html! {} };
    html! {
        section.effect { h2 { "Friction as a free curve" } p { (curve.in_words(diagnosis)) } }
        @if let Some(picture) = friction(&curve.parameters, &curve.stds) { (figure(&picture)) }
    }
}

fn formulas(diagnosis: &Diagnosis) -> Markup {
    let row = |found: &Suggestion| {
        let left = noises(found.rmse / diagnosis.noise);
        html! { tr { td { code { "torque = " (found.words) } } td { (milli(found.rmse)) } td { (left) } } }
    };
    html! {
        @if !diagnosis.formulas.is_empty() {
            h2 { "Formulas for what remains" }
            table { (head("formula", diagnosis)) @for found in &diagnosis.formulas { (row(found)) } }
        }
    }
}

fn tried(diagnosis: &Diagnosis) -> Markup {
    let row = |candidate: &Candidate| {
        let left = noises(candidate.rmse / diagnosis.noise);
        html! { tr { td { (candidate.title()) } td { (milli(candidate.rmse)) } td { (left) } } }
    };
    html! {
        h2 { "What was tried" }
        table { (head("model", diagnosis)) @for candidate in diagnosis.tried() { (row(candidate)) } }
    }
}

fn head(what: &str, diagnosis: &Diagnosis) -> Markup {
    html! { tr { th { (what) } th { (diagnosis.measured.milli_unit()) } th { "noises" } } }
}

fn milli(value: f64) -> String {
    format!("{:.2}", 1e3 * value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::Standing;
    use crate::examples::{claim, diagnosis};

    #[test]
    fn the_colour_is_that_of_what_is_left() {
        for (left, class) in [(Left::Noise, "good"), (Left::Nearly, "unsure"), (Left::Missing, "bad")] {
            let page = report(&Diagnosis { left, ..diagnosis() }, &[], &[]);
            assert!(page.contains(&format!("<section class=\"verdict {class}\">")), "{class}");
        }
    }

    #[test]
    fn each_part_says_whether_the_claim_is_seen_there() {
        let part = |name: &str, seen| Part { name: name.to_owned(), value: 2.0, std: Some(0.5), seen };
        let parts = vec![part("early", Some(true)), part("late", Some(false)), part("left", None)];
        let table = holds_on(&Holding { parts, ..claim(Standing::Holds, None) }).into_string();
        for (name, seen) in [("early", "seen"), ("late", "not seen"), ("left", "can't be told")] {
            assert!(table.contains(&format!("<td>{name}</td><td>2.00 ± 0.50</td><td>{seen}</td>")), "{table}");
        }
        let parts = vec![Part { std: None, ..part("late", None) }];
        let table = holds_on(&Holding { parts, ..claim(Standing::Holds, None) }).into_string();
        assert!(table.contains("<td>too few windows alone</td>"), "{table}");
    }
}
