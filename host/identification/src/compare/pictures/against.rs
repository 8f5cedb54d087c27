//! Residuals against angle, velocity, phase and amplitude; autocorrelation and spectrum.

use super::time::residual_label;
use super::{milli, short_name};
use crate::compare::Comparison;
use crate::compare::recording::Judged;
use crate::plot::decimate::every;
use crate::plot::{Axis, Content, Curve, Picture, Style};
use crate::recording::Measured;

/// Dots of a cloud, all recordings together.
const N_DOTS: usize = 3000;

/// Bins of the mean over a cloud.
const N_BINS: usize = 24;

/// Where a residual is drawn.
struct Against {
    key: &'static str,
    title: &'static str,
    label: &'static str,
    explanation: &'static str,
    coordinate: fn(&Judged) -> Vec<f64>,
    /// Of rates there is no such coordinate.
    needs_angles: bool,
}

const ALL: [Against; 4] = [
    Against {
        key: "residual-angle",
        title: "Residual against angle",
        label: "angle in rad",
        explanation: "If the mean (large dots) bends away from zero at certain angles, suspect the sensor (gain, \
                      nonlinearity) or a torque that depends on the angle (spring, magnet, cable).",
        coordinate: |judged| judged.curves.modelled_rad.clone(),
        needs_angles: true,
    },
    Against {
        key: "residual-velocity",
        title: "Residual against velocity",
        label: "velocity in rad/s",
        explanation: "A mean that differs between both directions shows a delay of the sensor, play, or a friction \
                      that is not alike on both sides.",
        coordinate: |judged| judged.curves.velocities_rad_s.clone(),
        needs_angles: true,
    },
    Against {
        key: "residual-phase",
        title: "Residual against phase",
        label: "phase of the swing in rad (0: passing the middle forwards)",
        explanation: "The phase tells where in its swing the pendulum is: 0 passing the middle, π/2 at the turning \
                      point. A whole wave means a wrong period, two waves a wrong loss of energy.",
        coordinate: phases,
        needs_angles: true,
    },
    Against {
        key: "residual-amplitude",
        title: "Residual against amplitude",
        label: "amplitude of the swing in rad",
        explanation: "How far the cloud spreads at an amplitude says where the model fails: at large amplitude drag, \
                      springs or the sensor's gain are suspect, at small amplitude dry friction and stiction.",
        coordinate: amplitudes,
        needs_angles: false,
    },
];

pub(super) fn pictures(comparison: &Comparison) -> Vec<Picture> {
    let has_angles = comparison.measured == Measured::Angle;
    let shown = ALL.iter().filter(|against| has_angles || !against.needs_angles);
    let mut pictures: Vec<Picture> = shown.map(|against| picture(comparison, against)).collect();
    pictures.push(autocorrelation(comparison));
    pictures.push(spectrum(comparison));
    pictures
}

fn picture(comparison: &Comparison, against: &Against) -> Picture {
    let n_each = N_DOTS / comparison.recordings.len().max(1);
    let mut curves = Vec::new();
    let mut all: Vec<(f64, f64)> = Vec::new();
    for (k, judged) in comparison.recordings.iter().enumerate() {
        let x = (against.coordinate)(judged);
        let y: Vec<f64> = judged.curves.residuals_rad.iter().map(|r| milli(*r)).collect();
        curves.push(Curve::new(short_name(&judged.name), Style::Cloud, k, every(&x, &y, n_each)));
        all.extend(x.into_iter().zip(y));
    }
    curves.push(Curve::new("mean", Style::Dots, 6, means(&all)));
    Picture {
        key: against.key.to_owned(),
        title: against.title.to_owned(),
        explanation: against.explanation.to_owned(),
        x: Axis::linear(against.label),
        y: Axis::linear(residual_label(comparison.measured)),
        content: Content::Curves(curves),
    }
}

/// Means over equal bins of the coordinate.
fn means(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let (low, high) = points.iter().fold((f64::MAX, f64::MIN), |(low, high), (x, _)| (low.min(*x), high.max(*x)));
    let width = (high - low).max(1e-12) / N_BINS as f64;
    let mut sums = [(0.0, 0.0); N_BINS];
    for (x, y) in points {
        let bin = (((x - low) / width) as usize).min(N_BINS - 1);
        sums[bin].0 += y;
        sums[bin].1 += 1.0;
    }
    let filled = sums.iter().enumerate().filter(|(_, (_, n))| *n >= 10.0);
    filled.map(|(bin, (sum, n))| (low + (bin as f64 + 0.5) * width, sum / n)).collect()
}

/// atan2 of the angle over the local amplitude and the velocity over its largest value nearby.
fn phases(judged: &Judged) -> Vec<f64> {
    let pi = std::f64::consts::PI;
    let half_swing_s = judged.curves.half_swing_s.unwrap_or(1.0);
    let offset_rad = judged.start.offset_rad;
    let angles = judged.curves.modelled_rad.iter().zip(&judged.curves.velocities_rad_s);
    // For small swings the angle leads the velocity by a quarter; for larger ones nearly so.
    angles.map(|(angle, velocity)| (angle - offset_rad).atan2(velocity * half_swing_s / pi)).collect()
}

/// The amplitude of the swing that each sample belongs to.
fn amplitudes(judged: &Judged) -> Vec<f64> {
    let of_time = |time_s: &f64| {
        let row = judged.swings.partition_point(|row| row.to_s <= *time_s);
        judged.swings.get(row.min(judged.swings.len().saturating_sub(1))).map_or(f64::NAN, |row| row.amplitude_rad)
    };
    judged.curves.times_s.iter().map(of_time).collect()
}

fn autocorrelation(comparison: &Comparison) -> Picture {
    let mut curves = Vec::new();
    for (k, judged) in comparison.recordings.iter().enumerate() {
        let found = &judged.autocorrelation;
        let points = found.lags_s.iter().copied().zip(found.values.iter().copied());
        curves.push(Curve::new(short_name(&judged.name), Style::Line, k, points));
    }
    let longest = comparison.recordings.iter().max_by(|a, b| a.autocorrelation.band.total_cmp(&b.autocorrelation.band));
    if let Some(found) = longest.map(|judged| &judged.autocorrelation) {
        let ends = [found.lags_s.first().copied().unwrap_or(0.0), found.lags_s.last().copied().unwrap_or(1.0)];
        for (name, level) in [("95 % of white noise", found.band), ("", -found.band)] {
            curves.push(Curve::new(name, Style::Dashed, 6, ends.map(|lag| (lag, level))));
        }
    }
    Picture {
        key: "autocorrelation".to_owned(),
        title: "Does the residual remember itself?".to_owned(),
        explanation: "How alike the residual is to itself a moment later. Noise forgets at once and stays between the \
                      broken lines; waves show that the residual follows the swing, and that error bars must be wider \
                      than for plain noise (here they are)."
            .to_owned(),
        x: Axis::linear("lag in s"),
        y: Axis::linear("autocorrelation"),
        content: Content::Curves(curves),
    }
}

fn spectrum(comparison: &Comparison) -> Picture {
    let mut curves = Vec::new();
    for (k, judged) in comparison.recordings.iter().enumerate() {
        let found = &judged.spectrum;
        let points = found.frequencies_hz.iter().copied().zip(found.densities.iter().copied());
        curves.push(Curve::new(short_name(&judged.name), Style::Line, k, points));
        let ends = [found.frequencies_hz.first(), found.frequencies_hz.last()];
        let level = ends.into_iter().flatten().map(|f| (*f, found.white_density));
        curves.push(Curve::new(if k == 0 { "noise" } else { "" }, Style::Dashed, 6, level));
    }
    Picture {
        key: "spectrum".to_owned(),
        title: "At which frequencies is the residual?".to_owned(),
        explanation:
            "White noise is flat at the broken line. A hill at the frequency of the swing or its multiples is \
                      missing physics or wrong numbers; a rise towards high frequencies comes from the sensor."
                .to_owned(),
        x: Axis::logarithmic("frequency in Hz"),
        y: Axis::logarithmic("power density in rad²/Hz"),
        content: Content::Curves(curves),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::per_swing::Row;
    use crate::compare::tests::judged;

    #[test]
    fn means_of_a_line_lie_on_it() {
        let points: Vec<(f64, f64)> = (0..=2400).map(|i| 3.0 + f64::from(i) / 100.0).map(|x| (x, 2.0 * x)).collect();
        let found = means(&points);
        assert_eq!(found.len(), N_BINS);
        for (k, (x, y)) in found.iter().enumerate() {
            assert!((x - (3.5 + k as f64)).abs() < 1e-9, "{x}");
            // A bin holds its lower end, the last one both.
            assert!((y - 2.0 * x).abs() < 0.03, "{x} {y}");
        }
        assert!(means(&points[..9]).is_empty());
    }

    #[test]
    fn the_phase_of_a_sine_is_its_argument() {
        let mut judged = judged();
        let arguments: Vec<f64> = (0..60).map(|i| 0.1 * f64::from(i) - 3.0).collect();
        let (size, angular, zero_rad) = (0.2, 5.0, judged.start.offset_rad);
        judged.curves.half_swing_s = Some(std::f64::consts::PI / angular);
        judged.curves.modelled_rad = arguments.iter().map(|x| size * x.sin() + zero_rad).collect();
        judged.curves.velocities_rad_s = arguments.iter().map(|x| size * angular * x.cos()).collect();
        let found = phases(&judged);
        assert_eq!(found.len(), 60);
        assert!(found.iter().zip(&arguments).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?}");
    }

    #[test]
    fn a_sample_has_the_amplitude_of_its_swing() {
        let mut judged = judged();
        let row = |from_s: f64, to_s: f64, amplitude_rad: f64| Row {
            from_s,
            to_s,
            amplitude_rad,
            period_s: None,
            lost_j: None,
            residual_rad: 0.0,
        };
        judged.swings = vec![row(0.0, 1.0, 0.9), row(1.0, 2.0, 0.8)];
        judged.curves.times_s = vec![0.0, 0.5, 1.0, 1.9, 2.0, 2.5];
        assert_eq!(amplitudes(&judged), [0.9, 0.9, 0.8, 0.8, 0.8, 0.8]);
    }
}
