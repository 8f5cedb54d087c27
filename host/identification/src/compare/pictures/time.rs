//! Against time: the motion, the residuals of angle and velocity, the last swings, and how far ahead the model sees.

use super::{milli, short_name};
use crate::compare::Comparison;
use crate::compare::recording::Judged;
use crate::plot::decimate::decimated;
use crate::plot::{Axis, Content, Curve, Picture, Style};
use crate::recording::Measured;

/// Points of a line; zooming still shows every swing.
const N_POINTS: usize = 6000;

/// Points of as many lines as there are recordings: a report of fifty then has 8 MB, of which the script that draws takes
/// more than half; with 50,000 and at least 1,000 each it had 9.4.
const N_POINTS_TOGETHER: usize = 36_000;

/// A line keeps its shape with so many: nearly one for each pixel of a report.
const LEAST_POINTS: usize = 700;

/// The last swings are shown over so many half swings.
const LAST_HALF_SWINGS: f64 = 10.0;

pub(super) fn pictures(comparison: &Comparison) -> Vec<Picture> {
    let all: Vec<(&Judged, String)> = comparison
        .recordings
        .iter()
        .map(|judged| (judged, String::new()))
        .chain(comparison.held_out.iter().map(|judged| (judged, ", held out".to_owned())))
        .collect();
    let lines = Lines::of(all.len());
    let mut pictures = Vec::new();
    for (k, (judged, suffix)) in all.iter().enumerate() {
        pictures.push(motion(lines, judged, suffix, k + 1));
        pictures.push(residual(lines, judged, suffix, k + 1));
        pictures.extend(last_swings(lines, judged, suffix, k + 1));
    }
    pictures.push(velocity(lines, &all));
    pictures.push(ahead(comparison));
    pictures
}

/// Lines of so many points each.
#[derive(Clone, Copy)]
struct Lines(usize);

impl Lines {
    fn of(n_recordings: usize) -> Self {
        Self((N_POINTS_TOGETHER / n_recordings.max(1)).clamp(LEAST_POINTS, N_POINTS))
    }

    /// Of a few swings.
    fn halved(self) -> Self {
        Self(self.0 / 2)
    }

    fn line(self, name: &str, colour: usize, x: &[f64], y: &[f64]) -> Curve {
        let (x, y) = decimated(x, y, self.0);
        Curve::new(name, Style::Line, colour, x.into_iter().zip(y))
    }
}

fn reading_label(kind: Measured) -> &'static str {
    match kind {
        Measured::Angle => "angle in rad",
        Measured::Rate => "rate in rad/s",
    }
}

/// Of an axis of residuals.
pub(super) fn residual_label(kind: Measured) -> &'static str {
    match kind {
        Measured::Angle => "residual in mrad",
        Measured::Rate => "residual in mrad/s",
    }
}

fn motion(lines: Lines, judged: &Judged, suffix: &str, number: usize) -> Picture {
    Picture {
        key: format!("motion-{number}"),
        title: format!("Measured and modelled: {}{suffix}", short_name(&judged.name)),
        explanation: "What was measured and the model, which was only told how this swing began. Where both lines lie \
                      on each other the model is right; zoom in to see where they part."
            .to_owned(),
        x: Axis::linear("time since the start of the free swing in s"),
        y: Axis::linear(reading_label(judged.kind)),
        content: Content::Curves(vec![
            lines.line("measured", 0, &judged.curves.times_s, &judged.curves.angles_rad),
            lines.line("modelled", 1, &judged.curves.times_s, &judged.curves.modelled_rad),
        ]),
    }
}

fn residual(lines: Lines, judged: &Judged, suffix: &str, number: usize) -> Picture {
    let residuals: Vec<f64> = judged.curves.residuals_rad.iter().map(|r| milli(*r)).collect();
    let ends = [0.0, judged.duration_s];
    let noise = milli(2.0 * judged.noise.level_rad());
    let limit = |name: &str, value: f64| Curve::new(name, Style::Dashed, 6, ends.map(|t| (t, value)));
    Picture {
        key: format!("residual-{number}"),
        title: format!("Measured minus modelled: {}{suffix}", short_name(&judged.name)),
        explanation: "What the model leaves. A perfect model leaves only noise: a band without any shape, 95 % of it \
                      between the broken lines. Waves in the rhythm of the swing mean that something is missing or \
                      that a number is wrong."
            .to_owned(),
        x: Axis::linear("time since the start of the free swing in s"),
        y: Axis::linear(residual_label(judged.kind)),
        content: Content::Curves(vec![
            lines.line("residual", 0, &judged.curves.times_s, &residuals),
            limit("± 2 × noise", noise),
            limit("", -noise),
        ]),
    }
}

fn last_swings(lines: Lines, judged: &Judged, suffix: &str, number: usize) -> Option<Picture> {
    let (measured_rad, modelled_rad) = judged.stop_angles_rad?;
    let from_s = judged.duration_s - LAST_HALF_SWINGS * judged.curves.half_swing_s?;
    let from = judged.curves.times_s.partition_point(|t| *t < from_s);
    let part = |values: &[f64]| -> Vec<f64> { values[from..].iter().map(|angle| milli(*angle)).collect() };
    let times_s = &judged.curves.times_s[from..];
    Some(Picture {
        key: format!("last-swings-{number}"),
        title: format!("The last swings: {}{suffix}", short_name(&judged.name)),
        explanation: format!(
            "Here friction decides: where and when the pendulum stops tells about stiction. It stopped at {:.2} mrad, \
             the model at {:.2} mrad. A stop elsewhere, or a slow creep after it, shows stiction or bristles that the \
             model does not have.",
            milli(measured_rad),
            milli(modelled_rad)
        ),
        x: Axis::linear("time since the start of the free swing in s"),
        y: Axis::linear("angle in mrad"),
        content: Content::Curves(vec![
            lines.halved().line("measured", 0, times_s, &part(&judged.curves.angles_rad)),
            lines.halved().line("modelled", 1, times_s, &part(&judged.curves.modelled_rad)),
        ]),
    })
}

fn velocity(lines: Lines, all: &[(&Judged, String)]) -> Picture {
    let curve = |(k, (judged, suffix)): (usize, &(&Judged, String))| {
        let name = format!("{}{suffix}", short_name(&judged.name));
        lines.line(&name, k, &judged.curves.times_s, &judged.curves.velocity_residuals_rad_s)
    };
    Picture {
        key: "residual-velocity-time".to_owned(),
        title: "Velocity: measured minus modelled".to_owned(),
        explanation:
            "The same for the velocity, both smoothed alike below 10 Hz. Friction acts on the velocity first, \
                      so a wrong torque shows here sooner than in the angle."
                .to_owned(),
        x: Axis::linear("time since the start of the free swing in s"),
        y: Axis::linear("velocity residual in rad/s"),
        content: Content::Curves(all.iter().enumerate().map(curve).collect()),
    }
}

fn ahead(comparison: &Comparison) -> Picture {
    let kinds = ["free run", "one swing ahead", "one step ahead"];
    let judged: Vec<&Judged> = comparison.recordings.iter().chain(&comparison.held_out).collect();
    let of_kind = |(k, name): (usize, &&str)| {
        let value = |judged: &&Judged| {
            let predictions = &judged.predictions;
            let error = [Some(predictions.free_run_rad), predictions.swing_ahead_rad, predictions.step_ahead_rad][k];
            error.unwrap_or(f64::NAN) / judged.noise.level_rad()
        };
        Curve::new(name, Style::Dots, k, judged.iter().enumerate().map(|(i, judged)| ((i + 1) as f64, value(judged))))
    };
    let mut curves: Vec<Curve> = kinds.iter().enumerate().map(of_kind).collect();
    let ends = [0.5, judged.len() as f64 + 0.5];
    curves.push(Curve::new("noise", Style::Dashed, 6, ends.map(|x| (x, 1.0))));
    Picture {
        key: "ahead".to_owned(),
        title: "How far ahead the model sees".to_owned(),
        explanation: "Error in units of the noise. Free run: from the start to the end. One swing ahead: started anew \
                      at every swing, judged on the next. One step ahead: corrected at every sample. If only the free \
                      run is bad, small errors added up; if one swing ahead is bad too, the physics is wrong; one \
                      step ahead is nearly always good and proves nothing."
            .to_owned(),
        x: Axis::counted("recording, in the order given"),
        y: Axis::logarithmic("error / noise"),
        content: Content::Curves(curves),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::tests::judged;

    #[test]
    fn many_recordings_share_the_points_of_their_lines_down_to_one_a_pixel() {
        assert_eq!([1, 8, 20, 50, 500].map(|n_recordings| Lines::of(n_recordings).0), [6000, 4500, 1800, 720, 700]);
        let times_s: Vec<f64> = (0..20_000).map(f64::from).collect();
        assert!((300..=724).contains(&Lines::of(50).line("", 0, &times_s, &times_s).x.len()));
    }

    #[test]
    fn the_last_swings_are_ten_half_swings_to_the_end() {
        let mut judged = judged();
        judged.stop_angles_rad = Some((1e-3, 2e-3));
        judged.curves.half_swing_s = Some(0.5);
        judged.duration_s = 8.0;
        judged.curves.times_s = (0..=128).map(|i| f64::from(i) / 16.0).collect();
        judged.curves.angles_rad = judged.curves.times_s.clone();
        judged.curves.modelled_rad = vec![0.0; 129];
        let picture = last_swings(Lines::of(1), &judged, "", 1).unwrap();
        let Content::Curves(curves) = picture.content else { panic!("no curves") };
        assert_eq!((curves[0].x.first(), curves[0].x.last(), curves[0].x.len()), (Some(&3.0), Some(&8.0), 81));
        assert_eq!(curves[0].y.first(), Some(&3000.0));
        judged.stop_angles_rad = None;
        assert!(last_swings(Lines::of(1), &judged, "", 1).is_none());
    }
}
