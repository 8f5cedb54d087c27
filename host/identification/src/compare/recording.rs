//! One recording judged: the model runs beside it, and everything that can be read off the difference.

use super::colour::{Autocorrelation, Spectrum, autocorrelation, spectrum};
use super::energy::Pair;
use super::follow::Followed;
use super::halves::{Halves, halves};
use super::measurement::Measurement;
use super::per_swing::{Row, rows};
use super::prediction::{Predictions, predictions};
use super::restart::{Restart, cuts, restarts, zero_of_swings};
use super::rms;
use super::slope::slopes;
use super::weak::half_width_s;
use crate::fit::problem::Start;
use crate::fit::quality::VELOCITY_CUTOFF_HZ;
use crate::recording::Measured;
use crate::recording::noise::{Noise, SlowExcess, slow_excess};
use crate::swing::wandering;
use crate::swing::zero::within_half_a_turn;
use crate::swing::{Swing, Window};
use crate::verdict::{ChiSquare, Left};
use crate::zero_phase;
use serde::Serialize;
use shared::parameters::Parameters;

/// A recording beside the model: what is told of it, how good the model is, and the curves.
#[derive(Clone, Debug, Serialize)]
pub struct Judged {
    /// The recording's name.
    pub name: String,
    /// What it holds; of rates, what is called `…_rad` is in rad/s.
    pub kind: Measured,
    /// Where the swing begins on the recording's clock, s.
    pub from_s: f64,
    /// Length, s.
    pub duration_s: f64,
    /// Start angle (rad), velocity (rad/s) and the sensor's zero (rad).
    #[serde(with = "StartRecord")]
    pub start: Start,
    /// Noise of the sensor.
    pub noise: Noise,
    /// Root mean square of the motion around its mean, rad.
    pub motion_rad: f64,
    /// How good the model is.
    #[serde(flatten)]
    pub verdict: Verdict,
    /// Free run, one swing, one step ahead.
    pub predictions: Predictions,
    /// A row a swing.
    pub swings: Vec<Row>,
    /// Angle at rest, measured and modelled, rad.
    pub stop_angles_rad: Option<(f64, f64)>,
    /// Of the residuals.
    pub autocorrelation: Autocorrelation,
    /// Of the residuals.
    pub spectrum: Spectrum,
    /// As measured.
    pub measured: Halves,
    /// As modelled.
    pub modelled: Halves,
    /// What was noticed, in words.
    pub notes: Vec<String>,
    /// Every sample.
    #[serde(skip)]
    pub curves: Curves,
}

/// How good the model is on one recording.
#[derive(Clone, Debug, Serialize)]
pub struct Verdict {
    /// Root mean square residual, rad.
    pub residual_rad: f64,
    /// Share of the motion that the model explains.
    pub explained: f64,
    /// Slow remainder beside white noise.
    pub slow_excess: SlowExcess,
    /// Is more than noise left?
    pub more_than_noise: bool,
}

/// What pictures and maps are made of; one value a sample unless it says otherwise.
#[derive(Clone, Debug)]
pub struct Curves {
    /// Seconds since the swing's first sample.
    pub times_s: Vec<f64>,
    /// Measured, rad.
    pub angles_rad: Vec<f64>,
    /// Modelled, offset included, rad.
    pub modelled_rad: Vec<f64>,
    /// Modelled velocity, rad/s.
    pub velocities_rad_s: Vec<f64>,
    /// Measured minus modelled, rad.
    pub residuals_rad: Vec<f64>,
    /// The same for the velocity, both filtered alike, rad/s.
    pub velocity_residuals_rad_s: Vec<f64>,
    /// The model started anew for each swing.
    pub restarts: Vec<Restart>,
    /// A typical half swing, s.
    pub half_swing_s: Option<f64>,
}

/// A start as a record.
#[derive(Serialize)]
#[serde(remote = "Start")]
struct StartRecord {
    angle_rad: f64,
    velocity_rad_s: f64,
    offset_rad: f64,
}

/// A block of the slow remainder's test, in half swings.
const SLOW_BLOCK: f64 = 0.1;

/// The autocorrelation is shown over so many half swings.
const SHOWN_HALF_SWINGS: f64 = 6.0;

/// Rest is averaged over this long at the end, s.
const REST_S: f64 = 0.3;

/// A sensor's zero farther off than this deserves a word, rad.
const ZERO_OFF_RAD: f64 = 0.05;

/// A slow remainder of less than this share of the noise variance does not matter.
const SLOW_SHARE: f64 = 0.02;

/// Reads everything off the model's run beside a measurement.
pub fn judge(measurement: &Measurement, parameters: &Parameters<f64>, followed: Followed) -> Judged {
    let swing = &measurement.swing;
    let cuts = cuts(swing, followed.start.offset_rad);
    let free_rad = followed.start.offset_rad;
    let offset_rad = cuts.as_ref().map_or(free_rad, |cuts| zero_of_swings(swing, parameters, free_rad, cuts));
    let step_s = swing.duration_s() / (swing.len() - 1) as f64;
    let restarts = cuts.as_ref().map_or(Vec::new(), |cuts| {
        restarts(swing, parameters, offset_rad, cuts, half_width_s(cuts.half_swing_s, step_s))
    });
    let gravity_nm = parameters.pendulum.gravity_torque_nm();
    let is_angle = swing.measured == Measured::Angle;
    let around_zero = |angles: &[f64], zero_rad: f64| -> Halves {
        if !is_angle {
            return Halves::default();
        }
        let angles: Vec<f64> = angles.iter().map(|angle| angle - zero_rad).collect();
        halves(&swing.times_s, &angles, swing.noise_rad, gravity_nm)
    };
    let (measured, modelled) =
        (around_zero(&swing.angles_rad, offset_rad), around_zero(&followed.angles_rad, free_rad));
    let half_swing_s = cuts.as_ref().map(|cuts| cuts.half_swing_s);
    let swings =
        cuts.as_ref().map_or(Vec::new(), |cuts| rows(swing, offset_rad, &followed.residuals_rad, cuts, &measured));
    let lively = &followed.residuals_rad[..swing.samples_within(Window::Lively)];
    let noise_rad = measurement.noise.level_rad();
    let block = (SLOW_BLOCK * half_swing_s.unwrap_or(1.0) / step_s) as usize;
    let predictions = predictions(swing, &followed, &restarts, parameters);
    Judged {
        name: swing.name.clone(),
        kind: swing.measured,
        from_s: measurement.from_s,
        duration_s: swing.duration_s(),
        start: followed.start,
        noise: measurement.noise.clone(),
        motion_rad: rms_around_mean(&swing.angles_rad),
        verdict: Verdict::of(swing, &followed, &measurement.noise, slow_excess(lively, noise_rad, block)),
        predictions,
        swings,
        stop_angles_rad: (is_angle && (measurement.has_rest || swing.comes_to_rest()))
            .then(|| stop_angles(swing, &followed)),
        autocorrelation: autocorrelation(lively, step_s, SHOWN_HALF_SWINGS * half_swing_s.unwrap_or(1.0)),
        spectrum: spectrum(lively, step_s, noise_rad),
        measured,
        modelled,
        notes: notes(measurement, offset_rad),
        curves: Curves::of(swing, followed, restarts, half_swing_s),
    }
}

impl Verdict {
    fn of(swing: &Swing, followed: &Followed, noise: &Noise, slow_excess: SlowExcess) -> Self {
        let residual_rad = rms(&followed.residuals_rad);
        let explained = explained(&swing.angles_rad, &followed.residuals_rad);
        let chi_square = ChiSquare::of_rms(residual_rad, noise.level_rad(), swing.len() as f64).beside(noise.colour);
        let is_slow = slow_excess.is_significant() && slow_excess.share > SLOW_SHARE;
        // Where the noise of the sensor is coloured, only its size can be judged.
        let more_than_noise = chi_square.left() == Left::Missing || is_slow && noise.colour.is_none();
        Self { residual_rad, explained, slow_excess, more_than_noise }
    }
}

impl Curves {
    fn of(swing: &Swing, followed: Followed, restarts: Vec<Restart>, half_swing_s: Option<f64>) -> Self {
        let rate_hz = (swing.len() - 1) as f64 / swing.duration_s();
        let smooth = zero_phase::filter(&followed.residuals_rad, VELOCITY_CUTOFF_HZ, rate_hz);
        Self {
            times_s: swing.times_s.to_vec(),
            angles_rad: swing.angles_rad.clone(),
            velocities_rad_s: slopes(&swing.times_s, &followed.angles_rad),
            velocity_residuals_rad_s: slopes(&swing.times_s, &smooth),
            modelled_rad: followed.angles_rad,
            residuals_rad: followed.residuals_rad,
            restarts,
            half_swing_s,
        }
    }
}

impl Judged {
    /// Measured and modelled motion for the energy picture.
    pub fn pair(&self) -> Pair {
        Pair { measured: self.measured.clone(), modelled: self.modelled.clone(), noise_rad: self.noise.level_rad() }
    }

    /// The free run again.
    pub fn followed(&self) -> Followed {
        let Curves { modelled_rad, residuals_rad, .. } = &self.curves;
        Followed { start: self.start, angles_rad: modelled_rad.clone(), residuals_rad: residuals_rad.clone() }
    }
}

fn rms_around_mean(angles_rad: &[f64]) -> f64 {
    let mean = angles_rad.iter().sum::<f64>() / angles_rad.len() as f64;
    rms(&angles_rad.iter().map(|angle| angle - mean).collect::<Vec<_>>())
}

fn stop_angles(swing: &Swing, followed: &Followed) -> (f64, f64) {
    let from = swing.times_s.partition_point(|t| *t < swing.duration_s() - REST_S).min(swing.len() - 1);
    let mean = |angles: &[f64]| angles.iter().sum::<f64>() / angles.len() as f64;
    (mean(&swing.angles_rad[from..]), mean(&followed.angles_rad[from..]))
}

fn notes(measurement: &Measurement, offset_rad: f64) -> Vec<String> {
    let mut notes = measurement.notes.clone();
    notes.extend(zero_words(&measurement.swing, offset_rad).filter(|_| measurement.swing.measured == Measured::Angle));
    notes
}

/// A word about a sensor's zero that is far off.
fn zero_words(swing: &Swing, offset_rad: f64) -> Option<String> {
    let offset_rad = within_half_a_turn(offset_rad);
    let degrees = offset_rad.to_degrees();
    let calibrate =
        || format!("the sensor's zero is off: the pendulum hangs at {offset_rad:.3} rad ({degrees:.1}°); calibrate it");
    let is_off = offset_rad.abs() > ZERO_OFF_RAD;
    is_off.then(|| wandering::words(swing, offset_rad).unwrap_or_else(calibrate))
}

/// Share of a motion's variance that residuals leave explained.
pub fn explained(angles_rad: &[f64], residuals_rad: &[f64]) -> f64 {
    let n = angles_rad.len().max(1) as f64;
    let mean = angles_rad.iter().sum::<f64>() / n;
    let motion: f64 = angles_rad.iter().map(|angle| (angle - mean).powi(2)).sum();
    1.0 - residuals_rad.iter().map(|r| r * r).sum::<f64>() / motion.max(1e-300)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn explained_is_the_share_of_the_motion_about_its_mean() {
        // Σ(θ − 2.5)² = 5, Σr² = 0.5.
        assert!((explained(&[1.0, 2.0, 3.0, 4.0], &[0.5, -0.5, 0.0, 0.0]) - 0.9).abs() < 1e-12);
    }

    #[test]
    fn a_zero_that_wanders_is_not_sent_to_be_calibrated() {
        let times_s: Vec<f64> = (0..2000).map(|i| f64::from(i) * 1e-2).collect();
        let said = |zero_rad: &dyn Fn(f64) -> f64| {
            let angle = |t: &f64| 0.6 * (6.0 * t).cos() * (-0.02 * t).exp() + zero_rad(*t);
            zero_words(&Swing::new("one", &times_s, &times_s.iter().map(angle).collect::<Vec<f64>>(), 1e-3), 0.15)
        };
        assert!(said(&|_| 0.15).unwrap().ends_with("(8.6°); calibrate it"));
        let wandering = said(&|t| 0.15 + 0.06 * (0.5 * t).sin()).unwrap();
        assert!(wandering.starts_with("no one zero is right for one") && wandering.contains("Fasten"), "{wandering}");
    }

    #[test]
    fn the_stop_angles_are_those_of_the_end() {
        let times_s: Vec<f64> = (0..600).map(|i| f64::from(i) * 5e-3).collect();
        let stopping = |rest_rad: f64| -> Vec<f64> {
            times_s.iter().map(|t| if *t < 2.5 { (6.0 * t).cos() } else { rest_rad }).collect()
        };
        let swing = Swing::new("stops", &times_s, &stopping(0.01), 1e-4);
        let start = Start { angle_rad: 1.0, velocity_rad_s: 0.0, offset_rad: 0.0 };
        let followed = Followed { start, angles_rad: stopping(-0.02), residuals_rad: vec![0.0; 600] };
        let (measured_rad, modelled_rad) = stop_angles(&swing, &followed);
        assert!((measured_rad - 0.01).abs() < 1e-12 && (modelled_rad + 0.02).abs() < 1e-12);
    }
}
