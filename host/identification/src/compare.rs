//! Comparison: how good is a fitted model, where does it fail, and is that noise or physics?
//!
//! [`measurement`] takes a recording with what is known around its free swing; [`recording`] lets the model run beside
//! it; [`energy`] and [`torque`] look for patterns that can be named; [`knowledge`] asks what the recordings say about
//! the parameters; [`verdict`] puts it into words. The parameters stay as given; only the starts of the swings are
//! fitted, unless the rig is fresh and [`Options::fit_first`] is set.

mod beside;
pub mod binned;
pub mod colour;
pub mod energy;
pub mod follow;
pub mod grid;
pub mod halves;
pub mod knowledge;
pub mod limits;
pub mod measurement;
pub mod mismatch;
pub mod numbers;
pub mod per_swing;
pub mod pictures;
pub mod prediction;
pub mod recording;
pub mod restart;
mod slope;
pub mod torque;
pub mod verdict;
pub mod weak;

use crate::cores::on_all_cores;
use crate::fit::identify::FitError;
use crate::fit::tolerance::KnownRig;
use crate::fit::touch::Touch;
use crate::geometry::{self, GeometryError};
use crate::recording::Measured;
use crate::swing::{MixedReadings, Swing, one_kind};
use beside::{Beside, Stop, fitted_first};
use energy::Energy;
use grid::Grid;
use knowledge::Knowledge;
use measurement::Measurement;
use mismatch::Mismatch;
use numbers::Refit;
use per_swing::Place;
use recording::Judged;
use serde::Serialize;
use shared::parameters::{Parameters, base};
use torque::TorqueMap;
use verdict::{Answer, Seen, Totals};

/// Version of the record that `--json` shows.
pub const VERSION: u32 = 1;

/// What the user may choose.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options {
    /// Fit the parameters first: the rig file has none of its own yet.
    pub fit_first: bool,
    /// The numbers may come from elsewhere: where more than noise is left, a fit tells whether they are to blame.
    pub question_numbers: bool,
}

/// Why nothing could be compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CompareError {
    /// No recording at all.
    #[error("there is no recording to compare with; give at least one")]
    NoRecording,
    /// Mass, length or inertia are not those of the pendulum that swung.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// Angles and rates at once.
    #[error(transparent)]
    Mixed(#[from] MixedReadings),
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
    /// What the recordings hold: angles, or rates; of rates, what is called `…_rad` is in rad/s.
    pub measured: Measured,
    /// Were the parameters fitted to these recordings first?
    pub fitted_first: bool,
    /// The model that was compared.
    pub parameters: Parameters<f64>,
    /// Over all recordings that are not held out.
    pub totals: Totals,
    /// Over the held-out ones.
    pub held_out_totals: Option<Totals>,
    /// What touched the pendulum on its way.
    pub touches: Vec<Touch>,
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
    /// What the model leaves once it is fitted to these recordings; absent where nobody had to ask.
    pub refit: Option<Refit>,
    /// What can't be judged, in words.
    pub limits: Vec<String>,
}

/// Compares a model with recordings. What is fitted knows the geometry as surely as the rig says; the model itself, and
/// the starts that let it run, need no tolerance: they take the numbers as they are.
///
/// # Errors
/// No recording, or a first fit that failed.
pub fn compare<'r>(
    rig: impl Into<KnownRig<'r>>,
    measurements: &[Measurement],
    held_out: &[Measurement],
    options: &Options,
) -> Result<Comparison, CompareError> {
    if measurements.is_empty() {
        return Err(CompareError::NoRecording);
    }
    let rig = rig.into();
    match untouched(rig, measurements, held_out, options) {
        Ok(comparison) => Ok(comparison),
        Err(Stop::Error(error)) => Err(error),
        Err(Stop::Touched(touches)) => {
            let found = compare(rig, &measurement::longest(measurements, &touches), held_out, options)?;
            Ok(found.behind(touches))
        }
    }
}

impl Comparison {
    /// The same of the longest parts of swings that something touched.
    fn behind(mut self, touches: Vec<Touch>) -> Self {
        self.verdict.splice(1..1, touches.iter().map(verdict::touched));
        self.touches.splice(0..0, touches);
        self
    }
}

/// The torque map of all recordings together.
fn torque_of(recordings: &[Judged], parameters: &Parameters<f64>) -> Option<TorqueMap> {
    let restarts = || recordings.iter().flat_map(|recording| &recording.curves.restarts);
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
        let Some(half_swing_s) = recording.curves.half_swing_s else { return Vec::new() };
        let step_s = recording.duration_s / (recording.curves.times_s.len() - 1) as f64;
        let width_s = weak::half_width_s(half_swing_s, step_s);
        let noise_rad = recording.noise.level_rad();
        let of = |restart: &restart::Restart| {
            weak::windows(&recording.curves.times_s, restart, &base, noise_rad, width_s, &grid)
        };
        recording.curves.restarts.iter().filter_map(of).collect::<Vec<_>>()
    };
    let windows: Vec<weak::Windows> = on_all_cores(recordings, windows_of).into_iter().flatten().collect();
    torque::torque_map(grid, &windows, coulomb_nm)
}

/// The comparison of swings that nothing touched on their way.
fn untouched(
    rig: KnownRig,
    measurements: &[Measurement],
    held_out: &[Measurement],
    options: &Options,
) -> Result<Comparison, Stop> {
    let swings: Vec<Swing> = measurements.iter().map(|measurement| measurement.swing.clone()).collect();
    let measured = one_kind(swings.iter().chain(held_out.iter().map(|measurement| &measurement.swing)))?;
    geometry::check(rig.parameters, &swings)?;
    let parameters = fitted_first(&swings, rig, options)?;
    let rig = KnownRig { parameters: &parameters, ..rig };
    let beside = Beside::of(rig, &swings, measurements, held_out, options)?;
    beside.refuse_touched(&swings, &parameters)?;
    Ok(told(beside, rig, &swings, measured, options))
}

/// What the recordings say of a model that runs beside them.
fn told(beside: Beside, rig: KnownRig, swings: &[Swing], measured: Measured, options: &Options) -> Comparison {
    let Beside { measurements, recordings, held_out, refit, mismatches } = beside;
    let totals = Totals::of(&recordings);
    let held_out_totals = (!held_out.is_empty()).then(|| Totals::of(&held_out));
    let knowledge = mismatches.is_empty().then(|| {
        let followed: Vec<_> = recordings.iter().map(Judged::followed).collect();
        knowledge::knowledge(swings, rig, &followed)
    });
    let tables: Vec<_> = recordings.iter().map(|r| (r.swings.as_slice(), r.stop_angles_rad.is_some())).collect();
    let places = per_swing::places(&tables);
    let energy = energy::energy(&recordings.iter().map(Judged::pair).collect::<Vec<_>>());
    let shows_torque = mismatches.is_empty() && measured == Measured::Angle;
    let torque = shows_torque.then(|| torque_of(&recordings, rig.parameters)).flatten();
    let seen = Seen {
        measured,
        recordings: &recordings,
        held_out: &held_out,
        totals: &totals,
        held_out_totals: held_out_totals.as_ref(),
        places: &places,
        energy: &energy,
        torque: torque.as_ref(),
        knowledge: knowledge.as_ref(),
        mismatches: &mismatches,
        refit: refit.as_ref(),
    };
    let (answer, sentences) = (seen.answer(), seen.sentences());
    let verdict = match geometry::is_unknown(&rig.parameters.pendulum) {
        true => sentences.iter().map(|sentence| verdict::per_gravity(sentence)).collect(),
        false => sentences,
    };
    Comparison {
        measured,
        version: VERSION,
        answer,
        verdict,
        fitted_first: options.fit_first,
        limits: limits::limits(&measurements, &recordings),
        totals,
        held_out_totals,
        touches: Vec::new(),
        places,
        energy,
        torque,
        knowledge,
        mismatches,
        refit,
        recordings,
        held_out,
        parameters: rig.parameters.clone(),
    }
}

/// Root mean square.
pub fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

#[cfg(test)]
mod tests;
