//! The whole identification: response surfaces, least squares, or one after the other; from a rig and its swings to
//! numbers with uncertainties and warnings.

use super::by_least_squares::{fitted_as_it_is, least_squares, not_worse_than_given, polish};
use super::by_surfaces::{finish_surfaces, surfaces};
pub use super::error::FitError;
use super::fitted::Fitted;
pub use super::found::{Fit, Identified, Verdict};
pub use super::held_out::{Carries, HeldOut, held_out_rmse};
use super::problem::{Point, Problem, Unknown};
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
use crate::formula::effect_of;
use crate::geometry;
use crate::recording::Measured;
use crate::swing::{Swing, Window, one_kind};
use shared::effect::Effect;
use shared::parameters::{Parameters, base};
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

/// The problem of a rig: its inertia and all numbers of its effects, in the paper's order; the base effects are always
/// there.
pub fn problem_of<'a, 'r>(swings: &'a [Swing], rig: impl Into<KnownRig<'r>>, count: &'a Tally) -> Problem<'a> {
    let KnownRig { parameters, tolerances } = rig.into();
    let mut template = tolerances.centred(parameters);
    for id in [base::VISCOUS, base::COULOMB, base::STICTION] {
        let n_values = Effect::<f64>::by_id(id).map_or(0, |effect| effect.parameters.len());
        if template.values(id).is_none() {
            // A rig file has room for the base effects: it is checked when read.
            let _ = template.set(id, &vec![0.0; n_values]);
        }
    }
    add_scale_of_rates(swings, &mut template);
    geometry::begin_with_the_period(&mut template.pendulum, swings);
    let of_effect =
        |id: u16| effect_of(&template, id).map_or(Vec::new(), |effect| Unknown::all_of_effect(effect, &template));
    let added = template.effects.iter().map(|effect| effect.id).filter(|id| *id > base::STICTION);
    let ids = [base::VISCOUS, base::COULOMB, base::STICTION].into_iter().chain(added);
    let ids = ids.filter(|id| template.curve.is_none() || *id == base::STICTION || !base::has(*id));
    let mut unknowns: Vec<Unknown> = ids.flat_map(of_effect).collect();
    let inertia_at = unknowns.iter().rposition(Unknown::is_stiction).map_or(0, |last| last + 1);
    unknowns.insert(inertia_at, Unknown::inertia_within(&tolerances, &template));
    Problem { tolerances, ..Problem::new(swings, &template, unknowns, count) }
}

/// A gyroscope's scale is known to some percent only, so that it is a number of every fit of rates; its bias is the free
/// offset of each swing.
fn add_scale_of_rates(swings: &[Swing], template: &mut Parameters<f64>) {
    let gain = Effect::<f64>::with(|rules| rules.is_calibrated).next();
    let is_rate = swings.iter().any(|swing| swing.measured == Measured::Rate);
    if let Some(gain) = gain.filter(|gain| is_rate && template.values(gain.id).is_none()) {
        // A model that is full keeps the scale that it has.
        let _ = template.set(gain.id, &[gain.parameters[0].start]);
    }
}

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
