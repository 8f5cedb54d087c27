//! The error after each effect that was added or removed: a staircase down to the noise.

use super::{Axis, Content, Curve, Picture, Style};
use crate::recording::Measured;

/// The model after one change.
#[derive(Clone, Debug, PartialEq)]
pub struct Tread {
    /// What was done.
    pub words: String,
    /// Root mean square error on the fitted swings, rad.
    pub rmse_rad: f64,
    /// The same on held-out swings, rad.
    pub held_out_rad: Option<f64>,
}

/// Half the width of a tread: they touch.
const HALF: f64 = 0.5;

const EXPLANATION: &str = "Each step changes the model by one effect and fits everything again. Where the stairs reach \
    the noise, nothing is left to explain; dots far above them would show an effect that suits the fitted swings only.";

/// Draws the treads in their order, against the noise of the measurement in rad; of rates both are in rad/s.
pub fn staircase(treads: &[Tread], noise_rad: f64, measured: Measured) -> Picture {
    let place = |k: usize| k as f64;
    let stairs = |k: usize, rad: f64| [(place(k) - HALF, 1e3 * rad), (place(k) + HALF, 1e3 * rad)];
    let fitted = treads.iter().enumerate().flat_map(|(k, tread)| stairs(k, tread.rmse_rad));
    let held_out = treads.iter().enumerate().filter_map(|(k, tread)| Some((place(k), 1e3 * tread.held_out_rad?)));
    let noise = [-HALF, place(treads.len()) - HALF].map(|x| (x, 1e3 * noise_rad));
    let mut curves = vec![
        Curve::new("fitted swings", Style::Line, 0, fitted),
        Curve::new("held-out swings", Style::Dots, 1, held_out),
        Curve::new("noise of the measurement", Style::Dashed, 2, noise),
    ];
    curves.retain(|curve| !curve.x.is_empty());
    Picture {
        key: "staircase".to_owned(),
        title: "Error after each step".to_owned(),
        explanation: EXPLANATION.to_owned(),
        x: Axis::named("model", treads.iter().map(|tread| tread.words.clone()).collect()),
        y: Axis::logarithmic(&format!("error in {} rms", measured.milli_unit())),
        content: Content::Curves(curves),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::svg::svg;

    #[test]
    fn each_change_has_its_name_below_the_stairs() {
        let tread = |words: &str, rmse_rad: f64| Tread { words: words.to_owned(), rmse_rad, held_out_rad: None };
        let drawn =
            svg(&staircase(&[tread("base model", 5e-3), tread("+ quadratic-drag", 1e-3)], 9e-4, Measured::Angle));
        for expected in ["base model", "+ quadratic-drag", "noise of the measurement", "mrad"] {
            assert!(drawn.contains(expected), "{expected}: {drawn}");
        }
        assert!(!drawn.contains("held-out"), "{drawn}");
    }

    #[test]
    fn stairs_dots_and_noise_stand_at_their_errors_in_thousandths() {
        let tread = Tread { words: "base model".to_owned(), rmse_rad: 5e-3, held_out_rad: Some(6e-3) };
        let Content::Curves(curves) = staircase(&[tread], 9e-4, Measured::Angle).content else { panic!("no curves") };
        let of =
            |curve: &Curve| (curve.name.as_str().to_owned(), curve.y.iter().map(|y| y.round()).collect::<Vec<_>>());
        let told: Vec<_> = curves.iter().map(of).collect();
        let expected = [
            ("fitted swings", vec![5.0, 5.0]),
            ("held-out swings", vec![6.0]),
            ("noise of the measurement", vec![1.0, 1.0]),
        ];
        assert_eq!(told, expected.map(|(name, y)| (name.to_owned(), y)));
    }

    #[test]
    fn an_error_of_rates_is_drawn_in_their_unit() {
        let label = |measured: Measured| staircase(&[], 1e-3, measured).y.label;
        assert_eq!([label(Measured::Angle), label(Measured::Rate)], ["error in mrad rms", "error in mrad/s rms"]);
    }
}
