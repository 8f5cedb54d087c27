//! What is known about the parameters: every recording's own values, and correlations.

use crate::compare::Comparison;
use crate::compare::knowledge::Knowledge;
use crate::plot::{Axis, Content, Curve, Heat, Picture, Style};

pub(super) fn pictures(comparison: &Comparison) -> Vec<Picture> {
    let Some(knowledge) = &comparison.knowledge else { return Vec::new() };
    let mut pictures = Vec::new();
    if comparison.recordings.len() > 1 {
        pictures.push(by_recording(knowledge));
    }
    pictures.push(correlations(knowledge));
    pictures
}

fn by_recording(knowledge: &Knowledge) -> Picture {
    let known = knowledge.parameters.iter().filter(|known| known.chosen.value != 0.0 && !known.alone.is_empty());
    let curves = known.enumerate().map(|(k, known)| {
        let percent = |value: f64| 100.0 * value / known.chosen.value;
        // Side by side, so that bars do not hide each other.
        let place = |i: usize| (i + 1) as f64 + 0.08 * k as f64;
        let points = known.alone.iter().enumerate().map(|(i, estimate)| {
            (place(i), percent(estimate.value) - 100.0, percent(2.0 * estimate.std.unwrap_or(0.0)))
        });
        Curve::with_bars(known.symbol, k, points)
    });
    let mut curves: Vec<Curve> = curves.collect();
    let n = knowledge.parameters.iter().map(|known| known.alone.len()).max().unwrap_or(1) as f64;
    curves.push(Curve::new("all together", Style::Dashed, 6, [(0.5, 0.0), (n + 0.5, 0.0)]));
    Picture {
        key: "by-recording".to_owned(),
        title: "What every recording alone says".to_owned(),
        explanation: "Each recording's own value of each parameter, as its distance from the common one, with 95 % \
                      bars. Bars that miss zero contradict the others: the model is wrong in a way that depends on the \
                      swing, or, if the values climb from recording to recording, the bearing changes (warmth, wear)."
            .to_owned(),
        x: Axis::counted("recording, in the order given"),
        y: Axis::linear("difference from the common value in %"),
        content: Content::Curves(curves),
    }
}

fn correlations(knowledge: &Knowledge) -> Picture {
    let names: Vec<String> = knowledge.parameters.iter().map(|known| known.symbol.to_owned()).collect();
    let row = |row: &Vec<f64>| row.iter().map(|value| Some(*value)).collect();
    let note = |row: &Vec<f64>| row.iter().map(|value| format!("{value:+.2}")).collect();
    let places: Vec<f64> = (0..names.len()).map(|k| k as f64).collect();
    Picture {
        key: "correlations".to_owned(),
        title: "Which parameters can stand in for each other".to_owned(),
        explanation: "Correlation of the parameters' errors. Near +1 or −1 the recordings can hardly tell two of them \
                      apart: one can grow while the other makes up for it. Swings of other amplitudes help."
            .to_owned(),
        x: Axis::linear(""),
        y: Axis::linear(""),
        content: Content::Heat(Heat {
            x: places.clone(),
            y: places,
            names: Some(names),
            values: knowledge.correlations.iter().map(row).collect(),
            notes: knowledge.correlations.iter().map(note).collect(),
            label: "correlation".to_owned(),
            limit: 1.0,
        }),
    }
}
