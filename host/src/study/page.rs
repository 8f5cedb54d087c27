//! The page of a study, to be pinned to the wall: one HTML file that needs nothing else.
//!
//! What was found stands first, then the rigs side by side, then each rig's friction over its swings.

mod drawing;
mod words;

use super::Study;
use super::between::Between;
use super::chart::FALSE_ALARMS;
use super::rig::{Finding, FindingKind, Friction, RigView};
use drawing::{control, side_by_side, sums};
use maud::{DOCTYPE, Markup, PreEscaped, html};
use words::{anchor, number};

/// The newest so many swings of a rig are drawn and listed; more could not be told apart, and no browser would show
/// them.
const MOST_SWINGS: usize = 300;

/// The whole page.
pub fn page(study: &Study) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { "How the bearings are" }
                style { (PreEscaped(include_str!("page/page.css"))) }
            }
            body {
                header {
                    h1 { "How the bearings are" }
                    p.quiet { (words::extent(study)) }
                }
                main {
                    (found(study))
                    @if study.rigs.len() > 1 { @for each in &study.between { (beside(each)) } }
                    @for rig in &study.rigs { (of_rig(study, rig)) }
                    (left_out(study))
                    (how_to_read())
                }
            }
        }
    };
    page.into_string()
}

/// What is found, as cards, wear first; or that there is nothing.
fn found(study: &Study) -> Markup {
    let findings = |wears: bool| {
        let of_rig = move |rig: &RigView| {
            let shown = rig.findings.iter().filter(|finding| is_shown(finding));
            let shown = shown.filter(|finding| (finding.kind == FindingKind::Wears) == wears);
            shown.map(|finding| of(rig, finding)).collect::<Vec<Markup>>()
        };
        study.rigs.iter().flat_map(of_rig)
    };
    let differs = study.standing_out();
    let differs = differs.iter().map(|(rig, words)| card("bad", rig, "differs", words));
    let models = study.diagnoses.iter().map(|(rig, diagnosis)| {
        let label = if diagnosis.missing.is_empty() { "what the model leaves" } else { "physics is missing" };
        card("unsure", rig, label, &words::begun(&diagnosis.words))
    });
    let cards: Vec<Markup> = findings(true).chain(differs).chain(findings(false)).chain(models).collect();
    html! {
        section.found {
            @if cards.is_empty() {
                div.card.good {
                    strong { "All is as it was." }
                    p { "No bearing wears, no rig stands out, no swing was disturbed." }
                }
            }
            @for card in &cards { (card) }
        }
    }
}

/// What is left out has a list of its own.
fn is_shown(finding: &Finding) -> bool {
    !matches!(finding.kind, FindingKind::OtherRig | FindingKind::Twice)
}

fn of(rig: &RigView, finding: &Finding) -> Markup {
    let (class, label) = match finding.kind {
        FindingKind::Wears => ("bad", "wears"),
        FindingKind::Eases => ("unsure", "has eased"),
        FindingKind::Pushed => ("unsure", "pushed by hand?"),
        FindingKind::Single => ("unsure", "one swing is off"),
        FindingKind::OtherRig | FindingKind::Twice => ("unsure", "left out"),
        FindingKind::Zero => ("unsure", "zero is off"),
    };
    card(class, &rig.name, label, &finding.words)
}

fn card(class: &str, rig: &str, label: &str, words: &str) -> Markup {
    html! {
        a.card.(class) href={ "#" (anchor(rig)) } {
            strong { (rig) } " " span.label { (label) }
            p { (words) }
        }
    }
}

fn beside(between: &Between) -> Markup {
    let Between { symbol, name, .. } = between;
    html! {
        section {
            h2 { "Side by side: " (name) " " (symbol) }
            (side_by_side(between))
            p.quiet {
                "Dot and bar: mean of a rig's swings ± its standard error. "
                @if between.is_judged { "A rig that stands out from how the others scatter is marked." }
                @else { "With fewer than seven rigs it can't be said what is usual; compare the bars." }
            }
        }
    }
}

fn of_rig(study: &Study, rig: &RigView) -> Markup {
    let is_imitating = study.diagnoses.get(&rig.name).is_some_and(|diagnosis| !diagnosis.missing.is_empty());
    html! {
        section id=(anchor(&rig.name)) {
            h2 { (rig.name) }
            p {
                (words::of_rig(rig))
                @if let Some(diagnosis) = study.diagnoses.get(&rig.name) { " " (words::begun(&diagnosis.words)) "." }
            }
            div.charts { @for friction in &rig.friction { (chart(rig, friction, is_imitating)) } }
            (swings(rig))
        }
    }
}

fn chart(rig: &RigView, friction: &Friction, is_imitating: bool) -> Markup {
    let (symbol, name, mean, unit) = (friction.symbol, friction.name, &friction.mean, friction.unit.clone());
    let value = if is_imitating {
        words::imitating(mean.value, &unit)
    } else {
        format!("{} {unit}", number(mean.value, mean.std_error))
    };
    html! {
        figure {
            h3 { (name) " " (symbol) ": " (value) }
            (control(rig, friction))
            (sums(friction))
        }
    }
}

fn swings(rig: &RigView) -> Markup {
    let row = |(idx, row): (usize, &super::row::Row)| {
        let value = |symbol: &str| {
            let known = row.found().and_then(|found| found.number(symbol));
            known.map_or("–".to_owned(), |known| number(known.value, known.std))
        };
        let of_noise =
            row.found().map_or("–".to_owned(), |found| format!("{:.2}", found.error_rad / found.noise_rad));
        html! {
            tr {
                td { (idx + 1) }
                td { (row.key.recording) }
                td { (row.recorded.as_deref().unwrap_or("–")) }
                td { (value("Mc")) }
                td { (value("Mw")) }
                td { (of_noise) }
            }
        }
    };
    let n_older = rig.rows.len().saturating_sub(MOST_SWINGS);
    html! {
        details {
            summary { "Every swing, " (rig.order) }
            @if n_older > 0 { p.quiet { (n_older) " older ones stand in the table (--csv)." } }
            div.wide { table {
                tr {
                    th { "no." } th { "recording" } th { "recorded" }
                    th { "Mc, N·m" } th { "Mw, N·m·s/rad" } th { "error / noise" }
                }
                @for each in rig.rows.iter().enumerate().skip(n_older) { (row(each)) }
            } }
        }
    }
}

fn left_out(study: &Study) -> Markup {
    let problems = study.problems();
    html! {
        @if !problems.is_empty() {
            section {
                h2 { "Left out" }
                ul { @for problem in &problems { li { strong { (problem.what) } ": " (problem.why) } } }
            }
        }
    }
}

fn how_to_read() -> Markup {
    let swings = FALSE_ALARMS.recip().round();
    html! {
        section {
            h2 { "How to read it, and how sure it is" }
            p {
                "Upper charts: each swing with the ± of its fit, and the band in which it should lie after those before. "
                "Lower charts: sums of what is too much (up) and too little (down), in standard deviations; beyond a broken line the level has changed, and the charts begin anew."
            }
            p {
                "While nothing changes, the charts of a rig raise at most one false alarm in " (swings) " swings: "
                "single swings, rising and falling sums, dry and viscous friction together. The limits follow from that rate "
                "(Shewhart's chart for individuals; cumulative sums with Siegmund's formula, on self-starting scores)."
            }
            p {
                "A change is dated by the most likely step; its size is what the last five swings have more than those "
                "before it, ± one standard error. ± of a swing is one standard deviation as its fit has it."
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::rig::tests::row;
    use super::*;

    #[test]
    fn friction_that_imitates_missing_physics_has_no_uncertainty() {
        let rows = [("1.csv", 0.9), ("2.csv", 1.0), ("3.csv", 1.1)].map(|(name, value)| row(name, value, 0.5));
        let rig = RigView::new("rig", rows.to_vec());
        let head = |is_imitating| {
            let drawn = chart(&rig, &rig.friction[0], is_imitating).into_string();
            drawn.split("</h3>").next().unwrap().to_owned()
        };
        assert!(head(false).contains('±') && !head(false).contains("imitating"), "{}", head(false));
        assert!(!head(true).contains('±') && head(true).contains("imitating what is missing"), "{}", head(true));
    }

    #[test]
    fn an_error_is_told_in_times_the_noise_and_what_failed_with_dashes() {
        let mut rows = vec![row("1.csv", 0.9, 0.5), row("2.csv", 1.0, 0.5)];
        let found = rows[0].outcome.as_mut().unwrap();
        (found.error_rad, found.noise_rad) = (3e-3, 2e-3);
        rows[1].outcome = Err("broken".to_owned());
        let shown = swings(&RigView::new("rig", rows)).into_string();
        let cells = |name: &str| shown.split_once(name).unwrap().1.split("</tr>").next().unwrap().to_owned();
        assert!(cells("1.csv").ends_with("<td>1.50</td>"), "{shown}");
        assert!(cells("2.csv").ends_with("<td>–</td><td>–</td><td>–</td>"), "{shown}");
    }
}
