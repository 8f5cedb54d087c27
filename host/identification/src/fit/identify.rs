//! The whole identification: response surfaces, least squares, or one after the other; from a rig and its swings to
//! numbers with uncertainties and warnings.

use super::by_least_squares::{fitted_as_it_is, least_squares, not_worse_than_given, polish};
use super::by_surfaces::{finish_surfaces, surfaces};
pub use super::error::FitError;
use super::fitted::Fitted;
pub use super::found::{Fit, Identified, Verdict};
pub use super::held_out::{Carries, HeldOut, held_out_rmse};
pub use super::of_rig::problem_of;
use super::problem::{Point, Problem};
pub use super::progress::Progress;
use super::ranges::Ranges;
use super::report::Report;
use super::runs::responses_at;
use super::scouts::scouted;
use super::sequential::Stage;
use super::short_memory::swings_in_what_is_left;
use super::tolerance::KnownRig;
use super::touch::Touch;
use super::{later, ranges, start, touch};
use crate::fit::tally::Tally;
use crate::geometry;
use crate::swing::{Swing, Window, one_kind};
use std::time::Instant;

/// How to identify.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Sequential response surface methodology, as in the paper.
    Rsm,
    /// Growing-window least squares.
    LeastSquares,
    /// Response surfaces, then least squares from there.
    Both,
}

/// What the user may choose.
#[derive(Clone, Debug)]
pub struct Options {
    /// How to identify.
    pub method: Method,
    /// Ranges by symbol; the others come from rig and recording.
    pub ranges: Vec<(String, f64, f64)>,
}

/// Identifies friction and inertia of a pendulum from its swings; `rig` gives geometry, first values and effects.
pub fn fit<'r>(
    swings: &[Swing],
    held_out: &[Swing],
    rig: impl Into<KnownRig<'r>>,
    options: &Options,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Fit, FitError> {
    let began = Instant::now();
    if swings.is_empty() {
        return Err(FitError::NoSwing);
    }
    one_kind(swings.iter().chain(held_out))?;
    let rig = rig.into();
    geometry::check(rig.parameters, swings)?;
    let count = Tally::default();
    let problem = problem_of(swings, rig, &count);
    let first = start::guess(&problem);
    let ranges = chosen_ranges(&problem, &first, &options.ranges)?;
    let responses_before = responses_at(&problem, &first, Window::Whole);
    let (model, stages) = found_by(options.method, &problem, &ranges, progress);
    let mut touches = touch::touches_of(&problem, &model);
    let is_anew = !touches.is_empty() && options.method != Method::Rsm;
    let parts = if is_anew { touch::parted(swings, &touches) } else { Vec::new() };
    let anew = is_anew.then(|| problem_of(&parts, rig, &count));
    let model = anew.as_ref().map_or(model, fitted_as_it_is);
    progress(Progress::Uncertainty);
    let on = anew.as_ref().unwrap_or(&problem);
    let in_noise = swings_in_what_is_left(on, &model);
    let in_noise_on = in_noise.as_ref().map(|(swings, _)| on.on(swings));
    let report = Report { problem: in_noise_on.as_ref().unwrap_or(on), model, given: &options.ranges };
    let built = report.build(held_out, responses_before, stages, &count, began);
    let mut fit = built.map_err(|fault| with_later_start(fault, swings, rig))?;
    if is_anew {
        fit.starts = touch::given_back(&fit.starts, swings.len(), &mut touches);
    }
    fit.warnings.splice(0..0, touches.iter().map(words_of));
    let unit = crate::swing::kind(swings).milli_unit();
    fit.warnings.extend(in_noise.map(|(_, told)| told.words(unit)));
    Ok(Fit { touches, ..fit })
}

/// The model by one of the ways, and the designs on the way to it.
fn found_by(
    method: Method,
    problem: &Problem,
    ranges: &Ranges,
    progress: &(dyn Fn(Progress) + Sync),
) -> (Fitted, Vec<Stage>) {
    match method {
        Method::Rsm => {
            let thin = thinned(problem);
            let designed = problem.on(&thin);
            let mut sequence = surfaces(&designed, ranges, progress);
            let model = finish_surfaces(&designed, &mut sequence);
            (model.evaluated(problem), sequence.stages)
        }
        Method::LeastSquares => {
            let found = scouted(problem, |few| least_squares(few, &start::guess(few), progress));
            (not_worse_than_given(problem, found), Vec::new())
        }
        Method::Both => {
            let mut stages = Vec::new();
            let found = scouted(problem, |few| {
                let (found, on_the_way) = both(few, ranges, progress);
                stages = on_the_way;
                found
            });
            (not_worse_than_given(problem, found), stages)
        }
    }
}

/// The same with a later start from which the swing would be followed.
fn with_later_start(fault: FitError, swings: &[Swing], rig: KnownRig<'_>) -> FitError {
    match fault {
        FitError::Hopeless { error, measured, .. } => {
            FitError::Hopeless { error, measured, follows_from_s: later::follows_from_s(swings, rig) }
        }
        other => other,
    }
}

/// What a touch does to the numbers, and what to do next.
fn words_of(touch: &Touch) -> String {
    let (words, alone) = (touch.words(), touch.alone("fit"));
    match touch.anew {
        Some(_) => format!(
            "{words}; the model begins anew behind it, so that it spoils no number; {alone} does without the rest"
        ),
        None => format!("{words}, which spoils the numbers; {alone} fits the longer part alone"),
    }
}

/// Response surfaces, then least squares from there.
fn both(problem: &Problem, ranges: &Ranges, progress: &(dyn Fn(Progress) + Sync)) -> (Fitted, Vec<Stage>) {
    let thin = thinned(problem);
    let designed = problem.on(&thin);
    let mut sequence = surfaces(&designed, ranges, progress);
    let ended = finish_surfaces(&designed, &mut sequence);
    let from_surfaces = polish(problem, &sequence.point, &ended, progress);
    // Surfaces from poor ranges may end in a wrong valley; least squares from the first guess then decides.
    let good = problem.rmse_rad(from_surfaces.cost) < GOOD_NOISES * problem.noise_rad();
    let model = match good {
        true => from_surfaces,
        false => from_surfaces.better(least_squares(problem, &start::guess(problem), progress)),
    };
    (model, sequence.stages)
}

/// Designs need many runs but not every sample.
fn thinned(problem: &Problem) -> Vec<Swing> {
    problem.swings.iter().map(|swing| swing.thinned(SURFACE_RATE_HZ / swing.pace)).collect()
}

/// Designs look at this many samples a second, at the usual pace.
const SURFACE_RATE_HZ: f64 = 200.0;

/// A polished fit within this many noises is not doubted.
const GOOD_NOISES: f64 = 1.5;

fn chosen_ranges(problem: &Problem, first: &Point, given: &[(String, f64, f64)]) -> Result<Ranges, FitError> {
    let inertia = problem.unknowns.iter().position(|unknown| unknown.name == "inertia");
    let inertia_kg_m2 = inertia.map_or(problem.template.pendulum.inertia_kg_m2, |index| first.values[index]);
    let mut ranges = ranges::from_recording(problem, inertia_kg_m2);
    for (symbol, low, high) in given {
        let index = problem.unknowns.iter().position(|unknown| unknown.symbol == symbol).ok_or_else(|| {
            let known: Vec<&str> = problem.unknowns.iter().map(|unknown| unknown.symbol).collect();
            FitError::UnknownRange { symbol: symbol.clone(), known: known.join(", ") }
        })?;
        let limit = problem.unknowns[index].low;
        let usable = low.is_finite() && high.is_finite() && low < high && *low >= limit;
        if !usable {
            return Err(FitError::BadRange { symbol: symbol.clone(), low: *low, high: *high, limit });
        }
        ranges.0[index] = (*low, *high);
    }
    Ok(ranges)
}
