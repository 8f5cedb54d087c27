//! One recording judged: the model runs beside it, and everything that can be read off the difference.

use super::colour::{Autocorrelation, SlowExcess, Spectrum, autocorrelation, slow_excess, spectrum};
use super::energy::Pair;
use super::follow::{Followed, follow};
use super::halves::{Halves, halves};
use super::measurement::{Measurement, SensorNoise};
use super::mismatch::explained;
use super::per_swing::{Row, rows};
use super::prediction::{Predictions, predictions};
use super::restart::{Restart, cuts, restarts, zero_of_swings};
use super::slope::slopes;
use super::weak::half_width_s;
use super::{rms, verdict};
use crate::fit::problem::Start;
use crate::swing::{Swing, Window};
use crate::zero_phase;
use serde::Serialize;
use shared::parameters::Parameters;

/// A recording beside the model.
#[derive(Clone, Debug, Serialize)]
pub struct Judged {
    /// The recording's name.
    pub name: String,
    /// Where the swing begins on the recording's clock, s.
    pub from_s: f64,
    /// Length, s.
    pub duration_s: f64,
    /// Start angle (rad), velocity (rad/s) and the sensor's zero (rad).
    #[serde(with = "StartRecord")]
    pub start: Start,
    /// Noise of the sensor.
    pub noise: SensorNoise,
    /// Root mean square of the motion around its mean, rad.
    pub motion_rad: f64,
    /// Root mean square residual, rad.
    pub residual_rad: f64,
    /// Share of the motion that the model explains.
    pub explained: f64,
    /// Slow remainder beside white noise.
    pub slow_excess: SlowExcess,
    /// Is more than noise left?
    pub more_than_noise: bool,
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
    /// Seconds since the swing's first sample.
    #[serde(skip)]
    pub times_s: Vec<f64>,
    /// Measured, rad.
    #[serde(skip)]
    pub angles_rad: Vec<f64>,
    /// Modelled, offset included, rad.
    #[serde(skip)]
    pub modelled_rad: Vec<f64>,
    /// Modelled velocity, rad/s.
    #[serde(skip)]
    pub velocities_rad_s: Vec<f64>,
    /// Measured minus modelled, rad.
    #[serde(skip)]
    pub residuals_rad: Vec<f64>,
    /// The same for the velocity, both filtered alike, rad/s.
    #[serde(skip)]
    pub velocity_residuals_rad_s: Vec<f64>,
    /// The model started anew for each swing.
    #[serde(skip)]
    pub restarts: Vec<Restart>,
    /// A typical half swing, s.
    #[serde(skip)]
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

/// Velocities are compared below this frequency: far above the swing, far below the noise.
const VELOCITY_CUTOFF_HZ: f64 = 10.0;

/// A block of the slow remainder's test, in half swings.
const SLOW_BLOCK: f64 = 0.1;

/// The autocorrelation is shown over so many half swings.
const SHOWN_HALF_SWINGS: f64 = 6.0;

/// Rest is averaged over this long at the end, s.
const REST_S: f64 = 0.3;

/// Lets the model run beside a measurement and reads everything off.
pub fn judge(measurement: &Measurement, parameters: &Parameters<f64>) -> Judged {
    let swing = &measurement.swing;
    let followed = follow(swing, parameters);
    let cuts = cuts(swing, followed.start.offset_rad);
    let free_rad = followed.start.offset_rad;
    let offset_rad = cuts.as_ref().map_or(free_rad, |cuts| zero_of_swings(swing, parameters, free_rad, cuts));
    let step_s = swing.duration_s() / (swing.len() - 1) as f64;
    let restarts = cuts.as_ref().map_or(Vec::new(), |cuts| {
        restarts(swing, parameters, offset_rad, cuts, half_width_s(cuts.half_swing_s, step_s))
    });
    let gravity_nm = parameters.pendulum.gravity_torque_nm();
    let around_zero = |angles: &[f64], zero_rad: f64| -> Halves {
        let angles: Vec<f64> = angles.iter().map(|angle| angle - zero_rad).collect();
        halves(&swing.times_s, &angles, swing.noise_rad, gravity_nm)
    };
    let (measured, modelled) =
        (around_zero(&swing.angles_rad, offset_rad), around_zero(&followed.angles_rad, free_rad));
    let half_swing_s = cuts.as_ref().map(|cuts| cuts.half_swing_s);
    let swings =
        cuts.as_ref().map_or(Vec::new(), |cuts| rows(swing, offset_rad, &followed.residuals_rad, cuts, &measured));
    let lively = &followed.residuals_rad[..swing.samples_within(Window::Lively)];
    let block = (SLOW_BLOCK * half_swing_s.unwrap_or(1.0) / step_s) as usize;
    let smooth = zero_phase::filter(&followed.residuals_rad, VELOCITY_CUTOFF_HZ, step_s.recip());
    let mut judged = Judged {
        name: swing.name.clone(),
        from_s: measurement.from_s,
        duration_s: swing.duration_s(),
        start: followed.start,
        noise: measurement.noise.clone(),
        motion_rad: rms_around_mean(&swing.angles_rad),
        residual_rad: rms(&followed.residuals_rad),
        explained: explained(&swing.angles_rad, &followed.residuals_rad),
        slow_excess: slow_excess(lively, measurement.noise.level_rad(), block),
        more_than_noise: false,
        predictions: predictions(swing, &followed, &restarts, parameters),
        swings,
        stop_angles_rad: measurement.has_rest.then(|| stop_angles(swing, &followed)),
        autocorrelation: autocorrelation(lively, step_s, SHOWN_HALF_SWINGS * half_swing_s.unwrap_or(1.0)),
        spectrum: spectrum(lively, step_s, measurement.noise.level_rad()),
        measured,
        modelled,
        notes: notes(measurement, offset_rad),
        times_s: swing.times_s.clone(),
        angles_rad: swing.angles_rad.clone(),
        velocities_rad_s: slopes(&swing.times_s, &followed.angles_rad),
        velocity_residuals_rad_s: slopes(&swing.times_s, &smooth),
        modelled_rad: followed.angles_rad,
        residuals_rad: followed.residuals_rad,
        restarts,
        half_swing_s,
    };
    judged.more_than_noise = verdict::more_than_noise(&judged);
    judged
}

impl Judged {
    /// Measured and modelled motion for the energy picture.
    pub fn pair(&self) -> Pair {
        Pair { measured: self.measured.clone(), modelled: self.modelled.clone(), noise_rad: self.noise.level_rad() }
    }

    /// The free run again.
    pub fn followed(&self) -> Followed {
        Followed { start: self.start, angles_rad: self.modelled_rad.clone(), residuals_rad: self.residuals_rad.clone() }
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
    notes.extend(super::mismatch::zero_words(offset_rad));
    notes
}
