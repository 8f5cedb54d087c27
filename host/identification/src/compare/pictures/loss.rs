//! Pictures that need no model: energy lost, period, both sides.

use super::{milli, short_name};
use crate::compare::Comparison;
use crate::compare::halves::Halves;
use crate::compare::recording::Judged;
use crate::plot::{Axis, Content, Curve, Picture, Style};

pub(super) fn pictures(comparison: &Comparison) -> Vec<Picture> {
    vec![loss(comparison), loss_means(comparison), period(comparison), sides(comparison)]
}

/// Measured dots and a modelled line for every recording.
fn both(
    comparison: &Comparison,
    measured: impl Fn(&Judged) -> Vec<(f64, f64, f64)>,
    modelled: impl Fn(&Judged) -> Vec<(f64, f64)>,
) -> Vec<Curve> {
    let mut curves = Vec::new();
    for (k, judged) in comparison.recordings.iter().enumerate() {
        curves.push(Curve::with_bars(short_name(&judged.name), k, measured(judged)));
    }
    let mut line: Vec<(f64, f64)> = comparison.recordings.iter().flat_map(modelled).collect();
    line.sort_by(|a, b| a.0.total_cmp(&b.0));
    // A line of one point would not be seen.
    let style = if line.len() > 1 { Style::Line } else { Style::Dots };
    curves.push(Curve::new("modelled", style, 6, line));
    curves
}

fn loss(comparison: &Comparison) -> Picture {
    let points = |halves: &Halves| -> Vec<(f64, f64, f64)> {
        halves.losses().iter().map(|loss| (loss.amplitude_rad, milli(loss.loss_nm), milli(loss.spread_nm))).collect()
    };
    Picture {
        key: "loss".to_owned(),
        title: "Energy lost per path against amplitude".to_owned(),
        explanation: "No model is needed for the dots: the height of two turning points on one side tells how much \
                      energy was lost between them; divided by the path this is the mean friction torque. Dry \
                      (Coulomb) friction is flat, viscous friction a straight line, air drag bends upwards. The line is \
                      what the model loses: where the dots leave it, friction has another law there."
            .to_owned(),
        x: Axis::linear("amplitude in rad"),
        y: Axis::linear("energy lost per path in mJ/rad = mN·m"),
        content: Content::Curves(both(
            comparison,
            |judged| points(&judged.measured),
            |judged| points(&judged.modelled).into_iter().map(|(x, y, _)| (x, y)).collect(),
        )),
    }
}

fn loss_means(comparison: &Comparison) -> Picture {
    let means = comparison.energy.loss_missing.iter().map(|mean| (mean.x, milli(mean.value), milli(2.0 * mean.spread)));
    let points: Vec<(f64, f64, f64)> = means.collect();
    let ends = [points.first().map_or(0.0, |p| p.0), points.last().map_or(1.0, |p| p.0)];
    Picture {
        key: "loss-missing".to_owned(),
        title: "Energy lost per path: measured minus modelled".to_owned(),
        explanation:
            "The difference between dots and line of the picture above, averaged over similar amplitudes, with \
                      95 % bars. Bars that do not reach zero show friction that the model lacks (above) or has too \
                      much of (below)."
                .to_owned(),
        x: Axis::linear("amplitude in rad"),
        y: Axis::linear("missing loss in mN·m"),
        content: Content::Curves(vec![
            Curve::with_bars("missing", 0, points),
            Curve::new("model is right", Style::Dashed, 6, ends.map(|x| (x, 0.0))),
        ]),
    }
}

fn period(comparison: &Comparison) -> Picture {
    let points = |halves: &Halves| -> Vec<(f64, f64)> {
        halves.periods.iter().map(|period| (period.amplitude_rad, period.period_s)).collect()
    };
    let with_bar = |judged: &Judged| -> Vec<(f64, f64, f64)> {
        points(&judged.measured).into_iter().map(|(x, y)| (x, y, 0.0)).collect()
    };
    Picture {
        key: "period".to_owned(),
        title: "Period against amplitude".to_owned(),
        explanation: "Large swings take longer, by a law that is known exactly. Dots that leave the line at small \
                      amplitude point to stiction or a wrong inertia, at large amplitude to a spring, a wrong sensor \
                      gain or a wrong zero."
            .to_owned(),
        x: Axis::linear("amplitude in rad"),
        y: Axis::linear("period in s"),
        content: Content::Curves(both(comparison, with_bar, |judged| points(&judged.modelled))),
    }
}

fn sides(comparison: &Comparison) -> Picture {
    let of_side = |rising: bool| {
        let halves = comparison.recordings.iter().flat_map(|judged| &judged.measured.halves);
        let halves = halves.filter(move |half| half.is_rising == rising);
        halves.map(|half| (half.amplitude_rad, milli(half.loss_nm), milli(half.loss_spread_nm)))
    };
    Picture {
        key: "sides".to_owned(),
        title: "Half swings to either side".to_owned(),
        explanation:
            "Energy lost per path, counter-clockwise and clockwise half swings apart. Both should lie on each \
                      other. A constant distance is friction that differs between the directions, or a zero that is \
                      off by as much; a distance that changes with amplitude is something else."
                .to_owned(),
        x: Axis::linear("amplitude in rad"),
        y: Axis::linear("energy lost per path in mN·m"),
        content: Content::Curves(vec![
            Curve::with_bars("counter-clockwise", 0, of_side(true)),
            Curve::with_bars("clockwise", 1, of_side(false)),
        ]),
    }
}
