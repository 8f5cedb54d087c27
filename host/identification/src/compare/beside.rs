//! The model beside all recordings: in which noise they are judged, how its runs begin, and whether its numbers are to
//! blame for what it leaves.

use super::measurement::Measurement;
use super::mismatch::{self, Mismatch};
use super::numbers::{self, Refit};
use super::recording::{self, Judged};
use super::verdict::Totals;
use super::{CompareError, Options, follow};
use crate::cores::on_all_cores;
use crate::fit::identify::Fit;
use crate::fit::problem::Start;
use crate::fit::short_memory::noises_left;
use crate::fit::tolerance::KnownRig;
use crate::fit::touch::{self, Touch};
use crate::swing::Swing;
use shared::parameters::Parameters;
use std::borrow::Cow;

/// Why swings were not compared as they are.
pub(super) enum Stop {
    Error(CompareError),
    /// What follows a touch would be blamed on the numbers, or taken for missing physics.
    Touched(Vec<Touch>),
}

impl<E: Into<CompareError>> From<E> for Stop {
    fn from(error: E) -> Self {
        Self::Error(error.into())
    }
}

/// A model beside recordings, and beside those that are held out.
pub(super) struct Beside<'a> {
    /// In the noise in which they are judged.
    pub(super) measurements: Cow<'a, [Measurement]>,
    pub(super) recordings: Vec<Judged>,
    pub(super) held_out: Vec<Judged>,
    pub(super) refit: Option<Refit>,
    pub(super) mismatches: Vec<Mismatch>,
}

impl<'a> Beside<'a> {
    pub(super) fn of(
        rig: KnownRig,
        swings: &[Swing],
        measurements: &'a [Measurement],
        held_out: &[Measurement],
        options: &Options,
    ) -> Result<Self, Stop> {
        let parameters = rig.parameters;
        let (measurements, as_fitted) = judged_in_their_noise(measurements, parameters, follow::follow);
        let is_asked = options.question_numbers && !options.fit_first;
        let fit = if is_asked { asked_fit(rig, swings, &as_fitted)? } else { None };
        let as_fitted = match &fit {
            Some(fit) => begun_as_fitted(&measurements, as_fitted, parameters, &fit.starts),
            None => as_fitted,
        };
        let noise_rad = Totals::of(&as_fitted).noise_rad;
        let refit = fit.filter(|_| has_more_than_noise(&as_fitted)).map(|fit| Refit::of(swings, &fit, noise_rad));
        // The numbers of another pendulum get no help from the start.
        let is_foreign = refit.is_some_and(|refit| refit.blames_the_numbers(Totals::of(&as_fitted).ratio));
        let follow: Follow = if is_foreign { follow::follow_of_another_pendulum } else { follow::follow };
        let recordings = if is_foreign { judged(&measurements, parameters, follow) } else { as_fitted };
        let (_, held_out) = judged_in_their_noise(held_out, parameters, follow);
        let mismatches = mismatches(swings, &recordings, parameters);
        Ok(Self { measurements, recordings, held_out, refit, mismatches })
    }

    /// Stops where something touched the pendulum on its way, as far as the model follows.
    pub(super) fn refuse_touched(&self, swings: &[Swing], parameters: &Parameters<f64>) -> Result<(), Stop> {
        if !self.mismatches.is_empty() {
            return Ok(());
        }
        let starts: Vec<_> = self.recordings.iter().map(|recording| recording.start).collect();
        let touches = touch::touches(swings, parameters, &starts);
        if touches.is_empty() { Ok(()) } else { Err(Stop::Touched(touches)) }
    }
}

/// The numbers that are compared: the rig's, or where it has none of its own yet those of a fit.
pub(super) fn fitted_first(swings: &[Swing], rig: KnownRig, options: &Options) -> Result<Parameters<f64>, Stop> {
    match options.fit_first {
        true => Ok(none_touched(numbers::least_squares(swings, rig)?)?.parameters),
        false => Ok(rig.parameters.clone()),
    }
}

/// A fit where more than the noise is left, if it comes to an end.
fn asked_fit(rig: KnownRig, swings: &[Swing], judged: &[Judged]) -> Result<Option<Fit>, Stop> {
    if !has_more_than_noise(judged) {
        return Ok(None);
    }
    numbers::least_squares(swings, rig).ok().map(none_touched).transpose()
}

fn judged(measurements: &[Measurement], parameters: &Parameters<f64>, follow: Follow) -> Vec<Judged> {
    on_all_cores(measurements, |measurement| {
        recording::judge(measurement, parameters, follow(&measurement.swing, parameters))
    })
}

/// Judged in the noise that they have, or in what the model leaves where that is noise too.
fn judged_in_their_noise<'a>(
    measurements: &'a [Measurement],
    parameters: &Parameters<f64>,
    follow: Follow,
) -> (Cow<'a, [Measurement]>, Vec<Judged>) {
    let as_they_are = judged(measurements, parameters, follow);
    match in_what_is_left(measurements, &as_they_are, parameters) {
        Some(louder) => {
            let again = judged(&louder, parameters, follow);
            (Cow::Owned(louder), again)
        }
        None => (Cow::Borrowed(measurements), as_they_are),
    }
}

/// A fit of swings that nothing touched on their way.
fn none_touched(fit: Fit) -> Result<Fit, Stop> {
    if fit.touches.is_empty() { Ok(fit) } else { Err(Stop::Touched(fit.touches)) }
}

/// How a run of the model beside a swing is begun.
type Follow = fn(&Swing, &Parameters<f64>) -> follow::Followed;

/// The measurements in the noise that the model leaves of them, where that is all it leaves.
fn in_what_is_left(
    measurements: &[Measurement],
    judged: &[Judged],
    parameters: &Parameters<f64>,
) -> Option<Vec<Measurement>> {
    if !has_more_than_noise(judged) {
        return None;
    }
    let swings: Vec<Swing> = measurements.iter().map(|measurement| measurement.swing.clone()).collect();
    let left: Vec<&[f64]> = judged.iter().map(|judged| judged.curves.residuals_rad.as_slice()).collect();
    let noises = noises_left(&swings, &left, &parameters.pendulum)?;
    Some(measurements.iter().zip(noises).map(|(measurement, noise)| measurement.in_noise(noise)).collect())
}

fn has_more_than_noise(recordings: &[Judged]) -> bool {
    recordings.iter().any(|recording| recording.verdict.more_than_noise)
}

/// The same, each run begun where a fit to the recordings begins it if that leaves less: what it begins with beside its start, such
/// as the play of a sensor, may hide a better one.
pub(super) fn begun_as_fitted(
    measurements: &[Measurement],
    as_fitted: Vec<Judged>,
    parameters: &Parameters<f64>,
    starts: &[Start],
) -> Vec<Judged> {
    let all: Vec<_> = measurements.iter().zip(as_fitted).zip(starts).collect();
    on_all_cores(all, |((measurement, judged), start)| {
        let begun = follow::follow_from(&measurement.swing, parameters, *start);
        let again = recording::judge(measurement, parameters, begun);
        if again.verdict.residual_rad < judged.verdict.residual_rad { again } else { judged }
    })
}

fn mismatches(swings: &[Swing], recordings: &[Judged], parameters: &Parameters<f64>) -> Vec<Mismatch> {
    let of = |(swing, judged): (&Swing, &Judged)| {
        let fits = judged.verdict.explained > mismatch::HOPELESS && !mismatch::is_upside_down(judged.start.offset_rad);
        (!fits).then(|| Mismatch::of(swing, parameters, judged))
    };
    swings.iter().zip(recordings).filter_map(of).collect()
}
