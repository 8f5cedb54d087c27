//! Reports of a comparison and of a diagnosis: one HTML file each that needs nothing else, neither network nor other files.

pub mod diagnosis;
mod tables;

use crate::compare::Comparison;
use crate::compare::pictures::pictures;
use crate::compare::verdict::Answer;
use crate::geometry::{PER_GRAVITY, is_unknown};
use crate::plot::Picture;
use crate::web;
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// The whole page of a comparison.
pub fn report(comparison: &Comparison) -> String {
    let body = html! {
        (verdict(comparison))
        (tables::recordings(comparison))
        (tables::parameters(comparison))
        @for picture in &pictures_of(comparison) { (figure(picture)) }
        (tables::swings(comparison))
    };
    page("Where does the model fail?", &body)
}

/// The pictures of a comparison, in units that mean something where the geometry is unknown.
pub fn pictures_of(comparison: &Comparison) -> Vec<Picture> {
    let is_unknown = is_unknown(&comparison.parameters.pendulum);
    let drawn = |picture: Picture| if is_unknown { picture.per_gravity() } else { picture };
    pictures(comparison).into_iter().map(drawn).collect()
}

fn page(title: &str, body: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (title) }
                style { (PreEscaped(STYLE)) }
                (PreEscaped(web::script()))
            }
            body {
                h1 { (title) }
                (body)
            }
        }
    };
    page.into_string()
}

fn verdict(comparison: &Comparison) -> Markup {
    let class = match comparison.answer {
        Answer::NothingMissing => "good",
        Answer::NoPattern | Answer::NumbersDoNotFit => "unsure",
        Answer::PhysicsMissing | Answer::DoesNotFit => "bad",
    };
    let notes: Vec<&String> =
        comparison.recordings.iter().flat_map(|judged| &judged.notes).chain(&comparison.limits).collect();
    html! {
        section.verdict.(class) {
            @if comparison.fitted_first {
                p { "The model had no fitted values yet: it was fitted to these recordings first." }
            }
            @for sentence in &comparison.verdict { p { (sentence) } }
            @if is_unknown(&comparison.parameters.pendulum) { p { (PER_GRAVITY) } }
        }
        @if !notes.is_empty() {
            details open[notes.len() < 6] {
                summary { "What was noticed, and what can't be judged" }
                ul { @for note in notes { li { (note) } } }
            }
        }
    }
}

fn figure(picture: &Picture) -> Markup {
    html! {
        figure {
            h2 { (picture.title) }
            div.plot { (PreEscaped(web::html(picture))) }
            figcaption { (picture.explanation) }
        }
    }
}

const STYLE: &str = "
body { font: 16px/1.5 system-ui, sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; color: #222; }
h1 { font-size: 1.6rem; } h2 { font-size: 1.15rem; margin: 0 0 .3rem; }
.verdict { border-left: .4rem solid; padding: .2rem 1rem; background: #f6f6f6; font-size: 1.1rem; }
.verdict p { margin: .4rem 0; } code { font-size: 1.05rem; } section.effect { margin: 2rem 0; } .good { border-color: #009e73; } .unsure { border-color: #e69f00; } .bad { border-color: #d55e00; }
figure { margin: 2.5rem 0; } .plot { height: 440px; } figcaption { color: #444; max-width: 50rem; }
table { border-collapse: collapse; margin: 1rem 0; } th, td { padding: .2rem .7rem; text-align: right; border-bottom: 1px solid #ddd; }
th:first-child, td:first-child { text-align: left; } .wide { overflow-x: auto; } .wide td { white-space: nowrap; } details { margin: 1rem 0; }
p, li, summary { overflow-wrap: anywhere; }
@media print { .modebar-container { display: none !important; } figure, tr, .verdict { break-inside: avoid; } h1, h2 { break-after: avoid; } * { print-color-adjust: exact; } }
";
