//! One recording, from its file to its row: read, cut to the free swing, fitted alone from the rig's model.
//!
//! Each is fitted alone, by least squares (where that leaves more than noise, also from response surfaces), so that a
//! row depends on nothing but its file, the model and the options. All of it runs on one thread: sums then have one
//! order, and the numbers are the same to the bit on every machine with the same arithmetic, whatever runs beside.
//!
//! The rig's geometry is as sure as its model file says, so that the ± of a row hold its tolerances, as those of any fit do.

use super::folder::{Rig, path_of};
use super::row::{Key, Number, Origin, Outcome, Row, word};
use crate::compare::rms;
use crate::diagnose::zero_of_rig::off_beyond_friction;
use crate::fit::identify::{self, Fit, Method};
use crate::fit::uncertainty::Status;
use crate::geometry;
use crate::now;
use crate::operations::fit::modelled;
use crate::recording::plausible::Swings;
use crate::recording::segment::SegmentOptions;
use crate::recording::{self, Measured, ReadOptions, Recording};
use crate::swing::Swing;
use crate::verdict::Left;
use shared::effect::Effect;
use std::path::Path;

/// The program's version, as rows name it.
pub const PROGRAM: &str = env!("CARGO_PKG_VERSION");

/// How all recordings of a study are read.
#[derive(Clone, Debug, Default)]
pub struct Reading {
    /// Columns and units.
    pub read: ReadOptions,
    /// Where the free swing lies, if the user knows it better.
    pub segment: SegmentOptions,
}

impl Reading {
    /// As rows name it; empty for the usual way.
    pub fn in_words(&self) -> String {
        let usual = Self::default();
        let (mine, others) = (format!("{self:?}"), format!("{usual:?}"));
        if mine == others { String::new() } else { mine }
    }

    fn of(&self, rig: &Rig) -> ReadOptions {
        ReadOptions { measured: rig.model.measured(), ..self.read.clone() }
    }

    /// The free swing of a recording, and the recording.
    ///
    /// # Errors
    /// What is wrong with it, in words.
    pub fn swing(&self, folder: &Path, rig: &Rig, key: &Key) -> Result<(Recording, Swing, Vec<String>), String> {
        let path = path_of(folder, key);
        let recording = recording::read(&path, &self.of(rig)).map_err(|error| error.fault.to_string())?;
        let name = key.to_string();
        let (swing, segments) =
            Swing::from_recording(&name, &recording, &self.segment).map_err(|error| error.to_string())?;
        let notes = recording.notes().iter().chain(&segments.notes).cloned().collect();
        Ok((recording, swing, notes))
    }
}

/// Reads and fits one recording.
pub fn measure(folder: &Path, rig: &Rig, key: &Key, origin: Origin, reading: &Reading) -> Row {
    let mut recorded = None;
    let outcome = reading.swing(folder, rig, key).and_then(|(recording, swing, notes)| {
        recorded.clone_from(&recording.header().started);
        fitted(rig, swing, notes)
    });
    Row { key: key.clone(), origin, program: PROGRAM.to_owned(), studied: now::iso(), recorded, outcome }
}

fn fitted(rig: &Rig, swing: Swing, mut notes: Vec<String>) -> Result<Outcome, String> {
    let swings = [swing];
    let model = rig.model.known();
    notes.extend(geometry::check(model.parameters, &swings).map_err(|error| error.to_string())?);
    let by = |method| {
        let options = identify::Options { method, ranges: Vec::new() };
        identify::fit(&swings, &[], model, &options, &|_| ())
    };
    let quick = by(Method::LeastSquares).map_err(|error| error.to_string())?;
    // Of 700 simulated swings five ended in a side valley, where one would be taken for a swing that was pushed.
    let is_doubtful = quick.left != Left::Noise;
    let careful = is_doubtful.then(|| by(Method::Both).ok()).flatten();
    let fit = careful.filter(|careful| careful.rmse_rad < quick.rmse_rad).unwrap_or(quick);
    let zero = zero_number(&swings, &fit);
    let mut outcome = outcome(&swings[0], &fit, notes);
    outcome.numbers.extend(zero);
    Ok(outcome)
}

/// How far the sensor's zero is off, behind the fitted numbers, where it is.
fn zero_number(swings: &[Swing], fit: &Fit) -> Option<Number> {
    let (value, std) = off_beyond_friction(swings, fit)?;
    let effect = Effect::<f64>::with(|rules| rules.is_free_offset).next()?;
    let parameter = effect.parameters.first()?;
    Some(Number {
        symbol: parameter.symbol.to_owned(),
        effect: effect.name.to_owned(),
        unit: parameter.unit.to_owned(),
        value,
        std: Some(std),
        upper: None,
        status: word(&Status::Identified),
    })
}

/// The error of a fit and what it leaves. Of a swing that was touched a fit takes the parts; here it counts as a whole, and as
/// pushed: friction of one swing is compared with that of others, which nobody touched.
fn error_of(swing: &Swing, fit: &Fit) -> (f64, Left) {
    if fit.touches.is_empty() {
        return (fit.rmse_rad, fit.left);
    }
    let modelled = modelled(swing, &fit.starts[0], &fit.parameters);
    let residuals: Vec<f64> = swing.angles_rad.iter().zip(modelled).map(|(a, b)| a - b).collect();
    (rms(&residuals), Left::Missing)
}

fn outcome(swing: &Swing, fit: &Fit, notes: Vec<String>) -> Outcome {
    let (error_rad, left) = error_of(swing, fit);
    let seen = Swings::of(&swing.times_s, &swing.angles_rad);
    let seen = seen.map(|seen| if swing.measured == Measured::Rate { seen.in_angles() } else { seen });
    Outcome {
        n_samples: swing.len(),
        duration_s: swing.duration_s(),
        amplitude_rad: swing.angles_rad.iter().fold(0.0, |largest, angle| f64::max(largest, angle.abs())),
        period_s: seen.map(|seen| seen.small_period_s()),
        noise_rad: fit.noise_rad,
        error_rad,
        left: word(&left),
        notes: notes.into_iter().chain(fit.warnings.iter().cloned()).collect(),
        numbers: fit.identified.iter().map(Number::from).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::examples::{fit, swing};
    use crate::rigfile::RigFile;
    use shared::parameters::Parameters;

    #[test]
    fn a_zero_that_is_off_is_kept_as_a_number_of_the_recording() {
        let off = |zero_rad: f64| {
            let mut swing = swing();
            swing.angles_rad.iter_mut().for_each(|angle| *angle += zero_rad);
            let model = RigFile::new(Parameters::paper().pendulum).unwrap();
            let rig = Rig { name: String::new(), model, model_hash: String::new(), recordings: Vec::new() };
            fitted(&rig, swing, Vec::new()).unwrap().number("off").map(|number| number.value)
        };
        assert!(off(0.05).is_some_and(|off_rad| (off_rad - 0.05).abs() < 2e-3), "{:?}", off(0.05));
        assert_eq!(off(0.0), None);
    }

    #[test]
    fn an_outcome_holds_the_error_and_the_noise_of_its_fit() {
        let (noise_rad, rmse_rad, left) = (1e-3, 3e-3, Left::Missing);
        let found = outcome(&swing(), &Fit { noise_rad, rmse_rad, left, ..fit() }, vec!["cut".to_owned()]);
        assert_eq!((found.noise_rad, found.error_rad, found.left.as_str()), (1e-3, 3e-3, "missing"));
        assert_eq!((found.n_samples, found.duration_s, found.notes[0].as_str()), (800, 7.99, "cut"));
        // The paper's pendulum takes 0.9 s for a small swing.
        let p = Parameters::<f64>::paper().pendulum;
        let small_s = std::f64::consts::TAU * (p.pivot_inertia_kg_m2() / p.gravity_torque_nm()).sqrt();
        assert!((found.period_s.unwrap() / small_s - 1.0).abs() < 0.01, "{found:?}");
    }
}
