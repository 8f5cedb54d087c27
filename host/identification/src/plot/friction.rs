//! A friction curve over the speed with its band, and the named laws that resemble it.

use super::{Axis, Content, Curve, Picture, Style};
use crate::diagnose::resemblance::{Resemblance, of_model};
use crate::fit::curve::built_up_nm;
use crate::geometry::is_unknown;
use shared::curve::Spline;
use shared::parameters::Parameters;

/// Points along a curve.
const POINTS: usize = 200;

/// A band is so many standard deviations wide to either side: 95 %.
const BAND_STDS: f64 = 1.96;

const EXPLANATION: &str = "Friction against the motion at each speed, left free, with its knots; bars hold 95 % and come \
    from how it scatters from window to window. Broken lines are laws of the list laid through it: where they leave the \
    bars, the friction is not of that kind. A knot without a bar is told by one stretch of a swing alone, or its ± is not \
    known here.";

/// Draws the curve of a model, if it has one, with the standard deviations of its torques as far as they are known,
/// N·m.
pub fn friction(parameters: &Parameters<f64>, stds: &[Option<f64>]) -> Option<Picture> {
    let curve = parameters.curve.as_ref()?;
    let (built_up, spline) = (built_up_nm(parameters), Spline::new(curve));
    let milli = |(speed, torque): (f64, f64)| (speed, 1e3 * (built_up + torque));
    let speeds: Vec<f64> = curve.speeds_rad_s().iter().map(|speed| f64::from(*speed)).collect();
    let largest = speeds.last().copied().unwrap_or(0.0);
    let along = (0..=POINTS).map(|k| largest * k as f64 / POINTS as f64);
    let std_of = |knot: usize| stds.get(knot).copied().flatten();
    let knots = || speeds.iter().copied().zip(curve.torques_nm().iter().copied()).enumerate();
    let known = knots().filter_map(|(k, knot)| {
        let (speed, torque) = milli(knot);
        Some((speed, torque, 1e3 * BAND_STDS * std_of(k)?))
    });
    let others = knots().filter(|(k, _)| std_of(*k).is_none()).map(|(_, knot)| milli(knot));
    let mut curves = vec![
        Curve::new("friction curve", Style::Line, 0, along.map(|speed| milli((speed, spline.torque_nm(speed))))),
        Curve::with_bars("knots with 95 %", 0, known),
        Curve::new("other knots", Style::Dots, 6, others),
    ];
    curves.retain(|curve| !curve.x.is_empty());
    curves.extend(of_model(parameters).iter().enumerate().map(|(k, law)| beside(law, k + 1, &speeds)));
    Some(Picture {
        key: "friction".to_owned(),
        title: "Friction over speed".to_owned(),
        explanation: EXPLANATION.to_owned(),
        x: Axis::linear("speed in rad/s"),
        y: Axis::linear(if is_unknown(&parameters.pendulum) {
            "friction per m·g·l, 10⁻³"
        } else {
            "friction in mN·m"
        }),
        content: Content::Curves(curves),
    })
}

fn beside(law: &Resemblance, colour: usize, speeds: &[f64]) -> Curve {
    let name = if law.effect == "none" { "viscous and coulomb".to_owned() } else { format!("with {}", law.effect) };
    let torques = law.torques.iter().map(|torque| 1e3 * torque);
    Curve::new(&name, Style::Dashed, colour, speeds.iter().copied().zip(torques))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::svg::svg;
    use shared::effect::Effect;

    #[test]
    fn the_curve_stands_beside_the_laws_it_resembles_with_what_builds_up() {
        let mut parameters = Parameters::frictionless(Parameters::paper().pendulum);
        assert!(friction(&parameters, &[]).is_none());
        let knots = [0.0, 1.0, 2.0, 4.0_f32].map(|speed| (speed, 1e-3 + 2e-4 * f64::from(speed).powi(2)));
        let curve = shared::curve::Curve::new(&knots.map(|knot| knot.0), &knots.map(|knot| knot.1)).unwrap();
        parameters.set_curve(&curve).unwrap();
        parameters.set(Effect::<f64>::by_name("presliding").unwrap().id, &[5e-4, 0.02]).unwrap();
        let picture = friction(&parameters, &[Some(1e-5), None, Some(1e-5), Some(1e-5)]).unwrap();
        let Content::Curves(curves) = &picture.content else { panic!("{picture:?}") };
        let bars = curves.iter().find(|curve| curve.bars.is_some()).unwrap();
        assert!((bars.y[0] - 1.5).abs() < 1e-9 && bars.x.len() == 3, "{bars:?}");
        // 1.96 standard deviations of 0.01 mN·m hold 95 %.
        assert!((bars.bars.as_ref().unwrap()[0] - 0.0196).abs() < 1e-9, "{bars:?}");
        let drawn = svg(&picture);
        assert_eq!(picture.y.label, "friction in mN·m");
        parameters.pendulum.length_m = 1e-3;
        assert_eq!(friction(&parameters, &[]).unwrap().y.label, "friction per m·g·l, 10⁻³");
        assert!(drawn.contains("with quadratic-drag") && drawn.contains("other knots"), "{drawn}");
    }
}
