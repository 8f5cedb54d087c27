//! From codes to angles: the zero of the hanging pendulum, the gain from known angles or from a swing, and whether the
//! track is even.
//!
//! angle = gain·(code − zero). The zero is where the pendulum hangs. The gain is the least-squares slope through it.
//! From a swing it comes by the period: gravity makes wide swings slower by a law of its own, which a wrong gain bends.

mod hold;

pub use hold::{HoldError, Still, hold};

use crate::fit::identify::{self, FitError, Method, Options};
use crate::swing::Swing;
use shared::effect::Effect;
use shared::parameters::{ParameterError, Parameters};
use shared::sensor::Sensor;

/// A gain further than this factor from the data sheet's is a mistake.
const GAIN_FACTOR: f64 = 2.0;

/// A swing must tell the gain better than the data sheet does (340° ± 4°).
const MOST_STD: f64 = 0.01;

/// A code at a known angle.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Known {
    /// The angle in rad, as somebody set it.
    pub angle_rad: f64,
    /// The mean code there.
    pub code: f64,
}

/// What known angles tell.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Line {
    /// Angle of a code in rad.
    pub radian_per_code: f64,
    /// Its standard deviation, from two angles on.
    pub std: Option<f64>,
    /// By how much each angle is off the line, rad.
    pub off_rad: Vec<f64>,
}

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
    pub fn next_step(&self) -> &'static str {
        match self {
            Self::Absurd { .. } => "give the angles in degrees from hanging, in the order in which they are held",
            Self::Known { .. } => {
                "leave --angles and --recording out: only its zero is measured; --encoder changes its counts"
            }
            Self::NotTold { .. } => "release it from a larger angle, 60° or more, or use --angles",
            Self::Fit(_) => "see what `host fit` says of these recordings",
            Self::Model(_) => "take an effect out of the model first: host improve --remove",
        }
    }
}

/// The gain from at least one known angle that is not zero; `nominal` is the data sheet's, rad a code.
///
/// # Errors
/// A gain that can't be.
pub fn line(zero_code: f64, known: &[Known], nominal: f64) -> Result<Line, CalibrationError> {
    let codes = |point: &Known| point.code - zero_code;
    let square: f64 = known.iter().map(|point| point.angle_rad.powi(2)).sum();
    let codes_per_rad = known.iter().map(|point| codes(point) * point.angle_rad).sum::<f64>() / square;
    let radian_per_code = 1.0 / codes_per_rad;
    if !(1.0 / GAIN_FACTOR..GAIN_FACTOR).contains(&(radian_per_code.abs() / nominal)) {
        return Err(CalibrationError::Absurd { mrad: 1e3 * radian_per_code, nominal_mrad: 1e3 * nominal });
    }
    let off_rad: Vec<f64> = known.iter().map(|point| radian_per_code * codes(point) - point.angle_rad).collect();
    let n_spare = known.len().saturating_sub(1);
    let variance = off_rad.iter().map(|off| off * off).sum::<f64>() / n_spare.max(1) as f64;
    let std = (n_spare > 0).then(|| radian_per_code.abs() * (variance / square).sqrt());
    Ok(Line { radian_per_code, std, off_rad })
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
    use shared::potentiometer::{FULL_SCALE_12_BIT, Potentiometer};

    const NOMINAL: f64 = Potentiometer::nominal(FULL_SCALE_12_BIT).radian_per_code as f64;

    fn known(angle_rad: f64, code: f64) -> Known {
        Known { angle_rad, code }
    }

    #[test]
    fn the_gain_comes_back_from_known_angles_also_a_negative_one() {
        for gain in [1.5e-3, -1.4e-3] {
            let points: Vec<Known> = [0.5, -0.7, 1.2].map(|angle| known(angle, 2000.0 + angle / gain)).to_vec();
            let line = line(2000.0, &points, NOMINAL).unwrap();
            assert!((line.radian_per_code / gain - 1.0).abs() < 1e-12);
            assert!(line.off_rad.iter().all(|off| off.abs() < 1e-12));
        }
    }

    #[test]
    fn a_bent_track_is_off_the_line() {
        let bent = |angle: f64| known(angle, 2048.0 + (angle + 0.02 * angle * angle) / 1.45e-3);
        let line = line(2048.0, &[0.5, 1.0, 1.5].map(bent), NOMINAL).unwrap();
        assert!(line.off_rad.iter().any(|off| off.abs() > 4e-3), "{line:?}");
        assert!(line.std.is_some_and(|std| std > 1e-6));
    }

    #[test]
    fn degrees_taken_for_radians_are_refused() {
        let error = line(2048.0, &[known(45.0, 2590.0)], NOMINAL).unwrap_err();
        assert!(matches!(error, CalibrationError::Absurd { .. }));
    }

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
    fn the_gain_of_two_angles_is_as_sure_as_they_are_near_its_line() {
        // Off by 10 mrad to either side: one is spare, so that a known angle is good for 14 mrad, and two of them for 10.
        let found = line(0.0, &[known(1.0, 1010.0), known(1.0, 990.0)], 1e-3).unwrap();
        assert!((found.radian_per_code - 1e-3).abs() < 1e-12);
        assert!((found.std.unwrap() - 1e-5).abs() < 1e-9, "{found:?}");
        assert_eq!(line(0.0, &[known(1.0, 1010.0)], 1e-3).unwrap().std, None);
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
