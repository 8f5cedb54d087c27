//! Comparison: how good is a fitted model, where does it fail, and is that noise or physics?
//!
//! [`measurement`] takes a recording with what is known around its free swing; [`recording`] lets the model run beside
//! it; [`energy`] and [`torque`] look for patterns that can be named; [`knowledge`] asks what the recordings say about
//! the parameters; [`verdict`] puts it into words. The parameters stay as given; only the starts of the swings are
//! fitted, unless the rig is fresh and [`Options::fit_first`] is set.

pub mod binned;
pub mod colour;
pub mod energy;
pub mod follow;
pub mod halves;
pub mod knowledge;
pub mod limits;
pub mod measurement;
pub mod mismatch;
pub mod per_swing;
pub mod pictures;
pub mod prediction;
pub mod recording;
pub mod restart;
mod slope;
pub mod torque;
pub mod verdict;
pub mod weak;

use crate::fit::identify::{self, FitError, Method};
use crate::swing::Swing;
use energy::Energy;
use knowledge::Knowledge;
use measurement::Measurement;
use mismatch::Mismatch;
use per_swing::Place;
use rayon::prelude::*;
use recording::Judged;
use serde::Serialize;
use shared::parameters::{Parameters, base};
use torque::{Grid, TorqueMap};
use verdict::{Answer, Totals};

/// Version of the record that `--json` shows.
pub const VERSION: u32 = 1;

/// What the user may choose.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options {
    /// Fit the parameters first: the rig file has none of its own yet.
    pub fit_first: bool,
}

/// Why nothing could be compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CompareError {
    /// No recording at all.
    #[error("there is no recording to compare with; give at least one")]
    NoRecording,
    /// The first fit failed.
    #[error(transparent)]
    Fit(#[from] FitError),
}

/// A model beside its recordings.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// Version of this record.
    pub version: u32,
    /// What it comes to.
    pub answer: Answer,
    /// The verdict, a sentence an entry.
    pub verdict: Vec<String>,
    /// Were the parameters fitted to these recordings first?
    pub fitted_first: bool,
    /// The model that was compared.
    pub parameters: Parameters<f64>,
    /// Over all recordings that are not held out.
    pub totals: Totals,
    /// Over the held-out ones.
    pub held_out_totals: Option<Totals>,
    /// Where the residual is larger than elsewhere.
    pub places: Vec<Place>,
    /// Each recording.
    pub recordings: Vec<Judged>,
    /// Each held-out recording.
    pub held_out: Vec<Judged>,
    /// Energy and period against amplitude.
    pub energy: Energy,
    /// Missing torque over angle and velocity.
    pub torque: Option<TorqueMap>,
    /// What the recordings say about the parameters; absent when they do not follow the model.
    pub knowledge: Option<Knowledge>,
    /// Recordings that do not fit at all.
    pub mismatches: Vec<Mismatch>,
    /// What can't be judged, in words.
    pub limits: Vec<String>,
}

/// Compares a model with recordings.
///
/// # Errors
/// No recording, or a first fit that failed.
pub fn compare(
    rig: &Parameters<f64>,
    measurements: &[Measurement],
    held_out: &[Measurement],
    options: &Options,
) -> Result<Comparison, CompareError> {
    if measurements.is_empty() {
        return Err(CompareError::NoRecording);
    }
    let swings: Vec<Swing> = measurements.iter().map(|measurement| measurement.swing.clone()).collect();
    let parameters = if options.fit_first { fitted(&swings, rig)? } else { rig.clone() };
    let judge_all = |all: &[Measurement]| -> Vec<Judged> {
        all.par_iter().map(|measurement| recording::judge(measurement, &parameters)).collect()
    };
    let recordings = judge_all(measurements);
    let held_out = judge_all(held_out);
    let mismatches = mismatches(&swings, &recordings, &parameters);
    let knowledge = mismatches.is_empty().then(|| {
        let followed: Vec<_> = recordings.iter().map(Judged::followed).collect();
        knowledge::knowledge(&swings, &parameters, &followed)
    });
    let tables: Vec<_> = recordings.iter().map(|r| (r.swings.as_slice(), r.stop_angles_rad.is_some())).collect();
    let mut comparison = Comparison {
        version: VERSION,
        answer: Answer::NothingMissing,
        verdict: Vec::new(),
        fitted_first: options.fit_first,
        totals: Totals::of(&recordings),
        held_out_totals: (!held_out.is_empty()).then(|| Totals::of(&held_out)),
        places: per_swing::places(&tables),
        energy: energy::energy(&recordings.iter().map(Judged::pair).collect::<Vec<_>>()),
        torque: mismatches.is_empty().then(|| torque_of(&recordings, &parameters)).flatten(),
        knowledge,
        mismatches,
        limits: limits::limits(measurements, &recordings),
        recordings,
        held_out,
        parameters,
    };
    comparison.answer = verdict::answer(&comparison);
    comparison.verdict = verdict::sentences(&comparison);
    Ok(comparison)
}

fn fitted(swings: &[Swing], rig: &Parameters<f64>) -> Result<Parameters<f64>, FitError> {
    let options = identify::Options { method: Method::LeastSquares, ranges: Vec::new() };
    identify::fit(swings, &[], rig, &options, &|_| ()).map(|fit| fit.parameters)
}

fn mismatches(swings: &[Swing], recordings: &[Judged], parameters: &Parameters<f64>) -> Vec<Mismatch> {
    let of = |(swing, judged): (&Swing, &Judged)| {
        let fits = judged.explained > mismatch::HOPELESS && !mismatch::is_upside_down(judged.start.offset_rad);
        (!fits).then(|| Mismatch {
            recording: judged.name.clone(),
            explained: judged.explained,
            reason: mismatch::reason(swing, parameters, judged),
        })
    };
    swings.iter().zip(recordings).filter_map(of).collect()
}

/// The torque map of all recordings together.
fn torque_of(recordings: &[Judged], parameters: &Parameters<f64>) -> Option<TorqueMap> {
    let restarts = || recordings.iter().flat_map(|recording| &recording.restarts);
    let largest = |of: &dyn Fn(&restart::Restart) -> &[f64]| {
        restarts().flat_map(|restart| of(restart).iter()).fold(0.0_f64, |largest, x| largest.max(x.abs()))
    };
    let grid = Grid {
        angle_rad: largest(&|restart| &restart.angles_rad),
        velocity_rad_s: largest(&|restart| &restart.velocities_rad_s),
    };
    let coefficient = |id| parameters.values(id).and_then(|values| values.first().copied()).unwrap_or(0.0);
    let (viscous, coulomb_nm) = (coefficient(base::VISCOUS), coefficient(base::COULOMB));
    let base = weak::Base { pendulum: parameters.pendulum, viscous, coulomb_nm };
    let windows_of = |recording: &Judged| -> Vec<weak::Windows> {
        let Some(half_swing_s) = recording.half_swing_s else { return Vec::new() };
        let step_s = recording.duration_s / (recording.times_s.len() - 1) as f64;
        let width_s = weak::half_width_s(half_swing_s, step_s);
        let noise_rad = recording.noise.level_rad();
        let of =
            |restart: &restart::Restart| weak::windows(&recording.times_s, restart, &base, noise_rad, width_s, &grid);
        recording.restarts.iter().filter_map(of).collect()
    };
    let windows: Vec<weak::Windows> = recordings.par_iter().map(windows_of).flatten_iter().collect();
    torque::torque_map(grid, &windows, coulomb_nm)
}

/// Root mean square.
pub fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len().max(1) as f64).sqrt()
}
