//! The tables of a report: recordings, parameters, swings.

use crate::compare::Comparison;
use crate::compare::knowledge::Known;
use crate::compare::per_swing::Row;
use crate::compare::pictures::short_name;
use crate::compare::recording::Judged;
use crate::compare::verdict::in_mrad;
use crate::geometry::unit_of;
use crate::number::with_spread;
use crate::shorten::shortened;
use maud::{Markup, html};

/// A table with a longer name would be wider than the page.
pub(super) const LONGEST_NAME: usize = 40;

pub(super) fn recordings(comparison: &Comparison) -> Markup {
    let or_dash = |error: Option<f64>| error.map_or("–".to_owned(), in_mrad);
    let row = |judged: &Judged, held_out: bool| {
        html! {
            tr {
                td title=(judged.name) { (shortened(short_name(&judged.name), LONGEST_NAME)) @if held_out { " (held out)" } }
                td { (format!("{:.1}", judged.duration_s)) }
                td { (in_mrad(judged.noise.level_rad())) }
                td { (in_mrad(judged.predictions.free_run_rad)) }
                td { (or_dash(judged.predictions.swing_ahead_rad)) }
                td { (or_dash(judged.predictions.step_ahead_rad)) }
                td { (in_mrad(judged.start.offset_rad)) }
            }
        }
    };
    let unit = comparison.measured.milli_unit();
    html! {
        h2 { "Recordings" }
        div.wide tabindex="0" role="region" aria-label="Recordings" { table {
            tr { th { "recording" } th { "length, s" } th { "noise, " (unit) } th { "free run, " (unit) }
                 th { "a swing ahead, " (unit) } th { "a step ahead, " (unit) } th { "sensor's zero, " (unit) } }
            @for judged in &comparison.recordings { (row(judged, false)) }
            @for judged in &comparison.held_out { (row(judged, true)) }
        } }
    }
}

pub(super) fn parameters(comparison: &Comparison) -> Markup {
    let Some(knowledge) = &comparison.knowledge else { return html! {} };
    let row = |known: &Known| {
        let interval = known.chosen.interval();
        html! {
            tr {
                td { (known.symbol) " (" (known.name) ")" }
                td { (format!("{:.4e}", known.given)) }
                td { (with_spread(known.chosen.value, known.chosen.std)) }
                td { @if let Some((low, high)) = interval { (format!("{low:.2e} … {high:.2e}")) } @else { "–" } }
                td { (unit_of(known.unit, &comparison.parameters.pendulum)) }
                td { (known.verdict.words()) @if known.disagrees() { ", recordings disagree" } }
            }
        }
    };
    html! {
        h2 { "Parameters" }
        div.wide tabindex="0" role="region" aria-label="Parameters" { table {
            tr { th { "parameter" } th { "in the model" } th { "these recordings want" } th { "95 % interval" }
                 th { "unit" } th { "verdict" } }
            @for known in &knowledge.parameters { (row(known)) }
        } }
        @if knowledge.coloured {
            p { "The residuals are coloured; the intervals allow for it." }
        }
        @for known in &knowledge.parameters {
            @if let Some(advice) = &known.advice { p { (known.symbol) ": " (advice) } }
        }
    }
}

pub(super) fn swings(comparison: &Comparison) -> Markup {
    let optional = |value: Option<f64>, factor: f64, digits: usize| {
        value.map_or("–".to_owned(), |value| format!("{:.digits$}", factor * value))
    };
    let row = |row: &Row| {
        html! {
            tr {
                td { (format!("{:.2}", row.from_s)) }
                td { (format!("{:.4}", row.amplitude_rad)) }
                td { (optional(row.period_s, 1.0, 4)) }
                td { (optional(row.lost_j, 1e3, 4)) }
                td { (in_mrad(row.residual_rad)) }
            }
        }
    };
    let unit = comparison.measured.milli_unit();
    html! {
        @for judged in &comparison.recordings {
            details {
                summary { "Every swing of " (judged.name) }
                div.wide tabindex="0" role="region" aria-label="Every swing" { table {
                    tr { th { "from, s" } th { "amplitude, rad" } th { "period, s" } th { "energy lost, mJ" }
                         th { "residual, " (unit) " rms" } }
                    @for each in &judged.swings { (row(each)) }
                } }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::examples::comparison;
    use crate::recording::Measured;

    #[test]
    fn every_swing_has_its_loss_in_millijoules_and_its_residual_in_thousandths() {
        let mut comparison = comparison();
        let row = Row {
            from_s: 1.5,
            to_s: 2.5,
            amplitude_rad: 0.75,
            period_s: None,
            lost_j: Some(1.25e-3),
            residual_rad: 2e-3,
        };
        comparison.recordings[0].swings = vec![row];
        let table = swings(&comparison).into_string();
        let cells = "<td>1.50</td><td>0.7500</td><td>–</td><td>1.2500</td><td>2.00</td>";
        assert!(table.contains(cells) && table.contains("<th>residual, mrad rms</th>"), "{table}");
        comparison.measured = Measured::Rate;
        assert!(swings(&comparison).into_string().contains("<th>residual, mrad/s rms</th>"));
    }

    #[test]
    fn a_table_that_is_wider_than_a_phone_scrolls_by_itself() {
        let mut comparison = comparison();
        comparison.recordings[0].swings.truncate(1);
        let tables = [recordings(&comparison), parameters(&comparison), swings(&comparison)];
        for table in tables.map(Markup::into_string) {
            let boxed = table.split("<table>").next().unwrap_or_default();
            assert!(boxed.contains("<div class=\"wide\" tabindex=\"0\" role=\"region\""), "{table}");
        }
        assert!(crate::report::report(&comparison).contains(".wide { overflow-x: auto; }"));
    }

    #[test]
    fn a_step_ahead_that_can_not_be_told_is_a_dash_in_its_column() {
        let mut comparison = comparison();
        let predictions = &mut comparison.recordings[0].predictions;
        (predictions.free_run_rad, predictions.swing_ahead_rad, predictions.step_ahead_rad) = (4e-3, Some(3e-3), None);
        let table = recordings(&comparison).into_string();
        assert!(table.contains("<td>4.00</td><td>3.00</td><td>–</td>"), "{table}");
        comparison.recordings[0].predictions.step_ahead_rad = Some(2e-3);
        let table = recordings(&comparison).into_string();
        assert!(table.contains("<td>4.00</td><td>3.00</td><td>2.00</td>"), "{table}");
    }
}
