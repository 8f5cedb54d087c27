//! From codes to angles: the zero of the hanging pendulum, the gain from known angles or from a swing, and whether the
//! track is even.
//!
//! angle = gain·(code − zero). The zero is where the pendulum hangs. The gain is the least-squares slope through it.
//! From a swing it comes by the period: gravity makes wide swings slower by a law of its own, which a wrong gain bends.

mod doubt;
mod hold;
mod line;

pub use doubt::{From, doubts};
pub use hold::{HoldError, Still, hold};
pub use line::{Known, Line, line};

use crate::fit::identify::{self, FitError, Method, Options};
use crate::number::significant;
use crate::swing::Swing;
use shared::effect::Effect;
use shared::parameters::{ParameterError, Parameters};
use shared::sensor::Sensor;

/// A swing must tell the gain better than the data sheet does (340° ± 4°).
const MOST_STD: f64 = 0.01;

/// Why a calibration can't be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CalibrationError {
    /// A slope that no potentiometer of this kind has.
    #[error("these angles give {mrad:.4} mrad a code, the data sheet says {nominal_mrad:.4}: more than twice off")]
    Absurd {
        /// As computed.
        mrad: f64,
        /// As expected.
        nominal_mrad: f64,
    },
    /// Readings that belong to other angles.
    #[error(
        "held at {odd_degrees:.2}° it reads {off_degrees:.1}° off a line through all angles; the potentiometer and \
             a hand allow {most_degrees:.1}°, so nothing was saved"
    )]
    NoLine {
        /// The angle of the reading that is off.
        odd_degrees: f64,
        /// By how much.
        off_degrees: f64,
        /// How much would be a line.
        most_degrees: f64,
        /// Angles that the same readings would be a line of, in the order in which they were held.
        suggested_degrees: Option<Vec<f64>>,
    },
    /// The swings don't tell.
    #[error("these swings tell the gain within ± {percent:.1} % only, no better than the data sheet")]
    NotTold {
        /// Standard deviation.
        percent: f64,
    },
    /// Nothing to measure.
    #[error("the gain of a sensor of kind {sensor} is known: {numbers}")]
    Known {
        /// The sensor.
        sensor: &'static str,
        /// What it is.
        numbers: String,
    },
    /// No fit.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// The model has no room for one more effect.
    #[error(transparent)]
    Model(#[from] ParameterError),
}

impl CalibrationError {
    /// What to do next.
    pub fn next_step(&self) -> String {
        match self {
            Self::NoLine { suggested_degrees: Some(angles), .. } => {
                let angles: Vec<String> = angles.iter().map(|angle| significant(*angle, 4)).collect();
                return format!("if that is how it was held, repeat with --angles={}", angles.join(","));
            }
            Self::NoLine { .. } => "hold it at each angle in the order given, measured from hanging, and repeat",
            Self::Absurd { .. } => "give the angles in degrees from hanging, in the order in which they are held",
            Self::Known { .. } => {
                "leave --angles and --recording out: only its zero is measured; --encoder changes its counts"
            }
            Self::NotTold { .. } => "release it from a larger angle, 60° or more, or use --angles",
            Self::Fit(_) => "see what `host fit` says of these recordings",
            Self::Model(_) => "take an effect out of the model first: host improve --remove",
        }
        .to_owned()
    }
}

/// By which factor the gain of these swings was too large, with its standard deviation: the fit with the sensor's
/// gain among the unknowns.
///
/// # Errors
/// No fit, or one that doesn't tell.
pub fn gain_of_swings(swings: &[Swing], model: &Parameters<f64>) -> Result<(f64, f64), CalibrationError> {
    let gain = Effect::<f64>::with(|rules| rules.is_calibrated).next().expect("the list has one, see its test");
    let mut model = model.clone();
    model.set(gain.id, &[gain.parameters[0].start])?;
    let options = Options { method: Method::LeastSquares, ranges: Vec::new() };
    let fit = identify::fit(swings, &[], &model, &options, &|_| {})?;
    let found = fit.identified.iter().find(|number| number.name == gain.name);
    let (error, std) = found.map_or((0.0, f64::INFINITY), |gain| (gain.value, gain.std.unwrap_or(f64::INFINITY)));
    if std > MOST_STD {
        return Err(CalibrationError::NotTold { percent: 100.0 * std });
    }
    Ok((1.0 + error, std))
}

/// Can known angles or swings tell anything of this sensor's gain?
///
/// # Errors
/// They can't.
pub fn check_gain(sensor: &Sensor) -> Result<(), CalibrationError> {
    match sensor.gain_is_known() {
        true => Err(CalibrationError::Known { sensor: sensor.name(), numbers: sensor.to_string() }),
        false => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::model::Model;

    #[test]
    fn a_wrong_gain_shows_in_the_swing() {
        let model = Model::new(&Parameters::paper());
        let mut state = model.release(1.6, 0.0);
        let mut noise = crate::random::Noise::new(5);
        let (mut times_s, mut angles_rad) = (Vec::new(), Vec::new());
        for idx in 0..12_000 {
            times_s.push(f64::from(idx) * 1e-3);
            angles_rad.push(1.03 * state.angle_rad + 1e-3 * noise.normal());
            model.step(&mut state, 1e-3);
        }
        let swing = Swing::new("swing", &times_s, &angles_rad, 1e-3);
        let (factor, std) = gain_of_swings(&[swing], &Parameters::paper()).unwrap();
        assert!((factor - 1.03).abs() < 4.0 * std && std < 2e-3, "{factor} ± {std}");
    }

    #[test]
    fn small_swings_tell_no_gain_and_it_is_said_in_percent_how_little() {
        let times_s: Vec<f64> = (0..600).map(|i| f64::from(i) / 100.0).collect();
        let mut noise = crate::random::Noise::new(5);
        let model = Model::new(&Parameters::paper());
        let mut state = model.release(0.2, 0.0);
        let mut angles_rad = Vec::new();
        for _ in &times_s {
            angles_rad.push(state.angle_rad + 1e-3 * noise.normal());
            (0..10).for_each(|_| model.step(&mut state, 1e-3));
        }
        let swings = [Swing::new("small", &times_s, &angles_rad, 1e-3)];
        let error = gain_of_swings(&swings, &Parameters::paper()).unwrap_err();
        // More than the 1 % of the data sheet.
        assert!(matches!(error, CalibrationError::NotTold { percent } if percent > 100.0 * MOST_STD), "{error:?}");
    }
}
