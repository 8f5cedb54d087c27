//! The whole identification: response surfaces, least squares, or one after the other; from a rig and its swings to
//! numbers with uncertainties and warnings.

use super::covariance::{Covariance, covariance};
use super::descent::{Descent, Patience, descend};
use super::linear::{Steps, linearise};
use super::problem::{Point, Problem, Start, Unknown};
use super::quality::Responses;
use super::sequential::{self, Ranges, Sequence, Stage, responses_at};
use super::stiction::{self, Settled, Stiction, smooth_unknowns, with_stiction};
use super::{ranges, start, windows};
use crate::swing::{Swing, Window};
use serde::Serialize;
use shared::effect::Effect;
use shared::parameters::{Parameters, base};
use std::sync::atomic::{AtomicUsize, Ordering};
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

/// What happens, for a progress display.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// Designs of a window, in seconds (rounded); 0 for the whole.
    Surfaces(u32),
    /// Growing windows.
    Descent,
    /// Ms and DV.
    Stiction,
    /// Uncertainties and checks.
    Uncertainty,
}

impl std::fmt::Display for Progress {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Surfaces(0) => write!(out, "response surfaces over the whole swing"),
            Self::Surfaces(seconds) => write!(out, "response surfaces over the first {seconds} s"),
            Self::Descent => write!(out, "least squares"),
            Self::Stiction => write!(out, "stiction"),
            Self::Uncertainty => write!(out, "uncertainties"),
        }
    }
}

/// An identified number.
#[derive(Clone, Debug, Serialize)]
pub struct Identified {
    /// The literature's symbol.
    pub symbol: &'static str,
    /// The effect, or `inertia`.
    pub name: &'static str,
    /// The value.
    pub value: f64,
    /// Standard deviation; absent if the data don't give one.
    pub std: Option<f64>,
    /// SI unit.
    pub unit: &'static str,
    /// How well the swings tell it.
    pub verdict: Verdict,
}

/// How well the swings tell a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Known within 10 %.
    Identified,
    /// Known within a factor of about two.
    Weak,
    /// The swings say next to nothing about it.
    Not,
}

/// The result of an identification.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The pendulum with all its effects.
    pub parameters: Parameters<f64>,
    /// The identified numbers.
    pub identified: Vec<Identified>,
    /// Correlations of the identified numbers, in the same order; empty if there are none.
    pub correlations: Vec<Vec<f64>>,
    /// How each swing began.
    pub starts: Vec<Start>,
    /// Root mean square error, rad.
    pub rmse_rad: f64,
    /// Noise of the measurement, rad.
    pub noise_rad: f64,
    /// Root mean square error on the held-out swings, rad.
    pub held_out_rmse_rad: Option<f64>,
    /// The five responses before and after.
    pub responses_before: Responses,
    /// The five responses at the end.
    pub responses: Responses,
    /// The designs, if response surfaces were used.
    pub stages: Vec<Stage>,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// Simulated swings.
    pub n_simulations: usize,
    /// Time taken.
    pub seconds: f64,
}

/// Why nothing could be identified.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FitError {
    /// No swing at all.
    #[error("there is no swing to fit; give at least one recording")]
    NoSwing,
    /// A range for something that is not fitted.
    #[error("there is no parameter {symbol} to give a range for; expected one of {known}")]
    UnknownRange {
        /// As given.
        symbol: String,
        /// What there is.
        known: String,
    },
    /// A range that can't be used.
    #[error(
        "the range {low} … {high} of {symbol} can't be used; give two finite numbers, the smaller one first, not below {limit}"
    )]
    BadRange {
        /// Whose.
        symbol: String,
        /// As given.
        low: f64,
        /// As given.
        high: f64,
        /// The least value with a meaning.
        limit: f64,
    },
    /// The model never came near.
    #[error(
        "the model does not follow the swings at all: error {error_rad:.3} rad; is the angle in radians, zero where the pendulum hangs, and the geometry right?"
    )]
    Hopeless {
        /// Root mean square error, rad.
        error_rad: f64,
    },
}

/// Identifies friction and inertia of a pendulum from its swings; `rig` gives geometry, first values and effects.
pub fn fit(
    swings: &[Swing],
    held_out: &[Swing],
    rig: &Parameters<f64>,
    options: &Options,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Fit, FitError> {
    let began = Instant::now();
    if swings.is_empty() {
        return Err(FitError::NoSwing);
    }
    let count = AtomicUsize::new(0);
    let problem = problem_of(swings, rig, &count);
    let first = start::guess(&problem);
    let ranges = chosen_ranges(&problem, &first, &options.ranges)?;
    let responses_before = responses_at(&problem, &first, Window::Whole);

    // Designs need many runs but not every sample.
    let thin: Vec<Swing> = swings.iter().map(|swing| swing.thinned(SURFACE_RATE_HZ)).collect();
    let designed = Problem { swings: &thin, ..problem.clone() };

    let (outcome, stages) = match options.method {
        Method::LeastSquares => (least_squares(&problem, &first, progress), Vec::new()),
        Method::Rsm => {
            let mut sequence = surfaces(&designed, &ranges, progress);
            let outcome = finish_surfaces(&designed, &mut sequence);
            (outcome.on(&problem), sequence.stages)
        }
        Method::Both => {
            let mut sequence = surfaces(&designed, &ranges, progress);
            let ended = finish_surfaces(&designed, &mut sequence);
            let from_surfaces = polish(&problem, &sequence, &ended, progress);
            // Surfaces from poor ranges may end in a wrong valley; least squares from the first guess then decides.
            let noise = problem.noise_rad();
            let good = from_surfaces.rmse_rad(&problem) < GOOD_NOISES * noise;
            let best =
                if good { from_surfaces } else { from_surfaces.better(least_squares(&problem, &first, progress)) };
            (best, sequence.stages)
        }
    };
    progress(Progress::Uncertainty);
    let report = Report { problem: &problem, outcome, given: &options.ranges };
    report.build(held_out, responses_before, stages, &count, began)
}

/// Designs look at this many samples a second.
const SURFACE_RATE_HZ: f64 = 200.0;

/// A polished fit within this many noises is not doubted.
const GOOD_NOISES: f64 = 1.5;

/// Errors beyond this share of the motion mean that the model does not follow it.
const HOPELESS_SHARE: f64 = 0.6;

/// Values and stiction that an identification ended with.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The smooth unknowns and the starts.
    pub point: Point,
    /// Ms and DV.
    pub stiction: Stiction,
    /// Levels that give the same swings, N·m.
    pub level_range_nm: (f64, f64),
    /// Sum of squared errors, rad².
    pub cost: f64,
    /// False if the descent ran out of patience.
    pub converged: bool,
}

impl Outcome {
    fn better(self, other: Self) -> Self {
        if other.cost < self.cost { other } else { self }
    }

    /// The same values judged on all samples of a problem.
    fn on(self, problem: &Problem) -> Self {
        let fixed = with_stiction(&smooth(problem), self.stiction);
        let cost = fixed.costs(Window::Whole, std::slice::from_ref(&self.point))[0];
        Self { cost, ..self }
    }

    fn rmse_rad(&self, problem: &Problem) -> f64 {
        (self.cost / problem.n_samples(Window::Whole) as f64).sqrt()
    }

    fn settled(settled: Settled) -> Self {
        let Descent { point, cost, converged, .. } = settled.descent;
        Self { point, stiction: settled.stiction, level_range_nm: settled.level_range_nm, cost, converged }
    }
}

/// The problem of a rig: its inertia and all numbers of its effects, in the paper's order; the base effects are always
/// there.
pub fn problem_of<'a>(swings: &'a [Swing], rig: &Parameters<f64>, count: &'a AtomicUsize) -> Problem<'a> {
    let mut template = rig.clone();
    for id in [base::VISCOUS, base::COULOMB, base::STICTION] {
        let n_values = Effect::<f64>::by_id(id).map_or(0, |effect| effect.parameters.len());
        if template.values(id).is_none() {
            // A rig file has room for the base effects: it is checked when read.
            let _ = template.set(id, &vec![0.0; n_values]);
        }
    }
    let of_effect = |id: u16| Effect::by_id(id).map_or(Vec::new(), |effect| Unknown::all_of_effect(effect, &template));
    let added = template.effects.iter().map(|effect| effect.id).filter(|id| *id > base::STICTION);
    let ids = [base::VISCOUS, base::COULOMB, base::STICTION].into_iter().chain(added);
    let mut unknowns: Vec<Unknown> = ids.flat_map(of_effect).collect();
    let inertia_at = unknowns.iter().rposition(Unknown::is_stiction).map_or(0, |last| last + 1);
    unknowns.insert(inertia_at, Unknown::inertia(&template));
    Problem { swings, template, unknowns, offsets_are_free: true, n_simulations: count }
}

/// The same problem without Ms and DV among its unknowns.
pub fn smooth<'a>(problem: &Problem<'a>) -> Problem<'a> {
    Problem { unknowns: smooth_unknowns(&problem.unknowns), ..problem.clone() }
}

fn smooth_point(problem: &Problem, point: &Point) -> Point {
    let keep = |(unknown, value): (&Unknown, &f64)| (!unknown.is_stiction()).then_some(*value);
    let values = problem.unknowns.iter().zip(&point.values).filter_map(keep).collect();
    Point { values, starts: point.starts.clone() }
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

/// Growing windows from a guess, then Ms and DV, then everything together.
pub fn least_squares(problem: &Problem, first: &Point, progress: &(dyn Fn(Progress) + Sync)) -> Outcome {
    progress(Progress::Descent);
    let smooth = with_stiction(&smooth(problem), Stiction { level_nm: 0.0, velocity_band: 0.0 });
    let mut from = smooth_point(problem, first);
    start_in_the_middle(&smooth, &mut from);
    let grown = windows::grow(&smooth, &from);
    progress(Progress::Stiction);
    Outcome::settled(stiction::settle(&smooth, &grown))
}

/// Friction that is unknown starts at a usual value, because at zero its bound would hold it there.
fn start_in_the_middle(problem: &Problem, point: &mut Point) {
    for (unknown, value) in problem.unknowns.iter().zip(&mut point.values) {
        let is_friction = matches!(unknown.name, "viscous" | "coulomb");
        if is_friction && *value <= unknown.low {
            *value = unknown.scale;
        }
    }
}

fn surfaces(problem: &Problem, ranges: &Ranges, progress: &(dyn Fn(Progress) + Sync)) -> Sequence {
    sequential::sequence(problem, ranges, &start::starts(problem.swings), &|window| {
        progress(Progress::Surfaces(match window {
            Window::First(seconds) => seconds.ceil() as u32,
            _ => 0,
        }));
    })
}

/// The end of response surfaces without least squares: Ms and DV by search, then designs over the whole swing, first
/// of the smooth parameters, then of all.
fn finish_surfaces(problem: &Problem, sequence: &mut Sequence) -> Outcome {
    let smooth = smooth(problem);
    let mut best = Outcome {
        point: smooth_point(problem, &sequence.point),
        stiction: pair_of(problem, &sequence.point),
        level_range_nm: (0.0, 0.0),
        cost: problem.costs(Window::Whole, std::slice::from_ref(&sequence.point))[0],
        converged: true,
    };
    for _ in 0..FINISHING_ROUNDS {
        let pair = stiction::best_pair(&smooth, &best.point, Some(best.stiction));
        let next = finishing_round(problem, &smooth, sequence, &best.point, pair);
        let gain = best.cost - next.cost;
        if gain > 0.0 {
            best = next;
        }
        if gain < problem.noise_rad().powi(2) {
            break;
        }
    }
    best
}

fn finishing_round(
    problem: &Problem,
    smooth: &Problem,
    sequence: &mut Sequence,
    point: &Point,
    pair: Stiction,
) -> Outcome {
    let fixed = with_stiction(smooth, pair);
    let keep = |(unknown, range): (&Unknown, &(f64, f64))| (!unknown.is_stiction()).then_some(*range);
    let ranges = Ranges(problem.unknowns.iter().zip(&sequence.ranges.0).filter_map(keep).collect());
    let from = Sequence { point: point.clone(), stages: Vec::new(), ranges };
    let smooth_end = sequential::in_window(&fixed, from, Window::Whole);
    sequence.stages.extend(smooth_end.stages.iter().cloned());

    // Near the truth Ms and DV have smooth effects too.
    let values = full_values(problem, &smooth_end.point, pair);
    let mut smooth_ranges = smooth_end.ranges.0.iter();
    let range = |(unknown, value): (&Unknown, &f64)| {
        let beside = (value - STICTION_REACH * value, value + STICTION_REACH * value);
        if unknown.is_stiction() { beside } else { smooth_ranges.next().copied().unwrap_or(beside) }
    };
    let ranges = Ranges(problem.unknowns.iter().zip(&values).map(range).collect());
    let from =
        Sequence { point: Point { values, starts: smooth_end.point.starts.clone() }, stages: Vec::new(), ranges };
    let end = if pair.velocity_band > 0.0 { sequential::in_window(problem, from, Window::Whole) } else { from };
    sequence.stages.extend(end.stages.iter().cloned());
    let stiction = pair_of(problem, &end.point);
    Outcome {
        point: smooth_point(problem, &end.point),
        stiction,
        level_range_nm: (stiction.level_nm, stiction.level_nm),
        cost: problem.costs(Window::Whole, std::slice::from_ref(&end.point))[0],
        converged: true,
    }
}

/// Rounds of stiction search and designs at the end.
const FINISHING_ROUNDS: usize = 4;

/// The last designs reach this share to either side of Ms and DV.
const STICTION_REACH: f64 = 0.15;

/// All unknowns' values in the problem's order, from the smooth ones and Ms and DV.
fn full_values(problem: &Problem, smooth: &Point, stiction: Stiction) -> Vec<f64> {
    let mut smooth = smooth.values.iter();
    let mut pair = [stiction.level_nm, stiction.velocity_band].into_iter();
    let next = |unknown: &Unknown| {
        let value = if unknown.is_stiction() { pair.next() } else { smooth.next().copied() };
        value.unwrap_or(0.0)
    };
    problem.unknowns.iter().map(next).collect()
}

fn pair_of(problem: &Problem, point: &Point) -> Stiction {
    let value = |index: usize| {
        let of_stiction = problem.unknowns.iter().zip(&point.values).filter(|(unknown, _)| unknown.is_stiction());
        of_stiction.map(|(_, value)| *value).nth(index).unwrap_or(0.0)
    };
    Stiction { level_nm: value(0), velocity_band: value(1) }
}

/// Least squares from where the response surfaces ended: with the Ms and DV they found, and with a search of their own
/// that begins without a band. A band has to earn its place.
fn polish(problem: &Problem, sequence: &Sequence, ended: &Outcome, progress: &(dyn Fn(Progress) + Sync)) -> Outcome {
    progress(Progress::Descent);
    let smooth = smooth(problem);
    let from = smooth_point(problem, &sequence.point);
    let free = with_stiction(&smooth, Stiction { level_nm: 0.0, velocity_band: 0.0 });
    let grown = descend(&free, &from, Window::Lively, Patience::ROUGH, Steps::new(&free));
    progress(Progress::Stiction);
    let searched = Outcome::settled(stiction::settle(&free, &grown));
    let refined = Outcome::settled(stiction::refine(&smooth, &ended.point, ended.stiction));
    let needless = searched.stiction.velocity_band == 0.0
        && searched.cost < refined.cost + stiction::GAIN_WORTH_A_BAND * problem.noise_rad().powi(2);
    if needless { searched } else { searched.better(refined) }
}

/// Puts the result together.
struct Report<'a, 'b> {
    problem: &'b Problem<'a>,
    outcome: Outcome,
    given: &'b [(String, f64, f64)],
}

impl Report<'_, '_> {
    fn build(
        &self,
        held_out: &[Swing],
        responses_before: Responses,
        stages: Vec<Stage>,
        count: &AtomicUsize,
        began: Instant,
    ) -> Result<Fit, FitError> {
        let problem = self.problem;
        let rmse_rad = self.outcome.rmse_rad(problem);
        let motion = rms(problem.swings.iter().flat_map(|swing| swing.angles_rad.iter().copied()));
        if !rmse_rad.is_finite() || rmse_rad > HOPELESS_SHARE * motion {
            return Err(FitError::Hopeless { error_rad: rmse_rad });
        }
        let full = self.full_problem();
        let values = full_values(&full, &self.outcome.point, self.outcome.stiction);
        let point = Point { values, starts: self.outcome.point.starts.clone() };
        let (known, covariance) = self.uncertainty(&full, &point);
        let parameters = full.parameters(&point.values);
        let identified = self.identified(&full, &point, &known, covariance.as_ref());
        let correlations = correlations(&known, covariance.as_ref());
        let warnings = self.warnings(&identified, covariance.as_ref(), &stages, rmse_rad);
        let held_out_rmse_rad = (!held_out.is_empty()).then(|| held_out_rmse(held_out, &parameters, count));
        Ok(Fit {
            responses: responses_at(&full, &point, Window::Whole),
            parameters,
            identified,
            correlations,
            starts: point.starts,
            rmse_rad,
            noise_rad: problem.noise_rad(),
            held_out_rmse_rad,
            responses_before,
            stages,
            warnings,
            n_simulations: count.load(Ordering::Relaxed),
            seconds: began.elapsed().as_secs_f64(),
        })
    }

    fn full_problem(&self) -> Problem<'_> {
        with_stiction(self.problem, self.outcome.stiction)
    }

    /// The indices of the numbers that the data tell smoothly, and their covariance. Numbers on a bound are known to be
    /// there and take no part; neither does stiction without a band.
    fn uncertainty(&self, full: &Problem, point: &Point) -> (Vec<usize>, Option<Covariance>) {
        let has_band = self.outcome.stiction.velocity_band > 0.0;
        let takes_part = |j: &usize| {
            let (unknown, value) = (&full.unknowns[*j], point.values[*j]);
            let inside = value > unknown.low && value < unknown.high;
            inside && (has_band || !unknown.is_stiction())
        };
        let known: Vec<usize> = (0..full.unknowns.len()).filter(takes_part).collect();
        let covariance = covariance_of(full, point, &known);
        if covariance.is_some() || !has_band {
            return (known, covariance);
        }
        // Ms or DV without a smooth trace: the others still have their uncertainties.
        let known: Vec<usize> = known.into_iter().filter(|j| !full.unknowns[*j].is_stiction()).collect();
        let covariance = covariance_of(full, point, &known);
        (known, covariance)
    }

    fn identified(
        &self,
        full: &Problem,
        point: &Point,
        known: &[usize],
        covariance: Option<&Covariance>,
    ) -> Vec<Identified> {
        let (low, high) = self.outcome.level_range_nm;
        let identified = |(j, unknown): (usize, &Unknown)| {
            let smooth = known.iter().position(|k| *k == j).and_then(|column| covariance?.std(column));
            let is_level = unknown.is_stiction() && unknown.symbol == "Ms";
            // All levels within the range stop the pendulum alike: a uniform distribution.
            let uniform = (is_level && high > low).then(|| (high - low) / 12.0_f64.sqrt());
            let std = smooth.or(uniform);
            let value = point.values[j];
            let size = if unknown.name == "inertia" { full.template.pendulum.pivot_inertia_kg_m2() } else { value };
            let verdict = verdict(size, std);
            Identified { symbol: unknown.symbol, name: unknown.name, value, std, unit: unknown.unit, verdict }
        };
        full.unknowns.iter().enumerate().map(identified).collect()
    }

    fn warnings(
        &self,
        identified: &[Identified],
        covariance: Option<&Covariance>,
        stages: &[Stage],
        rmse_rad: f64,
    ) -> Vec<String> {
        let mut warnings = Vec::new();
        let noise = self.problem.noise_rad();
        if rmse_rad > MISSING_PHYSICS_NOISES * noise {
            warnings.push(format!(
                "the error is {:.1} times the noise: physics is missing from the model (host diagnose names it)",
                rmse_rad / noise
            ));
        }
        if covariance.is_some_and(|covariance| covariance.coloured) {
            warnings.push("the residuals are correlated in time; the uncertainties allow for it".to_owned());
        }
        if !self.outcome.converged {
            warnings.push("least squares ran out of patience; more or longer swings would help".to_owned());
        }
        for number in identified {
            warnings.extend(self.warning_of(number));
        }
        let last = stages.last().and_then(|stage| stage.r_squared_predicted);
        if let Some(r_squared) = last.filter(|r_squared| *r_squared < 0.5) {
            let percent = 100.0 * r_squared;
            warnings.push(format!(
                "the last surface of mseA predicts only {percent:.0} % of new runs: don't trust its optimum"
            ));
        }
        warnings
    }

    fn warning_of(&self, number: &Identified) -> Option<String> {
        let Identified { symbol, value, .. } = number;
        let given = self.given.iter().find(|(name, ..)| name == symbol);
        if let Some((_, low, high)) = given.filter(|(_, low, high)| value < low || value > high) {
            return Some(format!("{symbol} lies outside the range {low} … {high} that was given"));
        }
        match (number.verdict, number.name) {
            (Verdict::Not, "stiction") if *value == 0.0 => {
                Some(format!("{symbol} has no visible effect: zero explains the swings as well as any small value"))
            }
            (Verdict::Not, "stiction") => {
                Some(format!("{symbol} is hardly identifiable here; record several swings down to rest"))
            }
            (Verdict::Not, "viscous" | "coulomb") if *value == 0.0 => {
                Some(format!("{symbol} is zero within its uncertainty"))
            }
            (Verdict::Not, _) => {
                Some(format!("{symbol} is not identifiable from these swings; add a release at 1.4 rad or more"))
            }
            _ => None,
        }
    }
}

/// Errors above this many noises mean missing physics.
const MISSING_PHYSICS_NOISES: f64 = 1.1;

fn covariance_of(full: &Problem, point: &Point, known: &[usize]) -> Option<Covariance> {
    let part = Problem {
        unknowns: known.iter().map(|j| full.unknowns[*j].clone()).collect(),
        template: full.parameters(&point.values),
        ..full.clone()
    };
    let point = Point { values: known.iter().map(|j| point.values[*j]).collect(), starts: point.starts.clone() };
    let mut steps = Steps::new(&part);
    // The first linearisation finds the right steps, the second uses them.
    linearise(&part, &point, Window::Whole, &mut steps);
    covariance(&linearise(&part, &point, Window::Whole, &mut steps))
}

fn correlations(known: &[usize], covariance: Option<&Covariance>) -> Vec<Vec<f64>> {
    let Some(covariance) = covariance else { return Vec::new() };
    let row = |i: usize| (0..known.len()).map(|j| covariance.correlation(i, j).unwrap_or(0.0)).collect();
    (0..known.len()).map(row).collect()
}

fn verdict(size: f64, std: Option<f64>) -> Verdict {
    match std.map(|std| std / size.abs()) {
        Some(relative) if relative < 0.1 => Verdict::Identified,
        Some(relative) if relative < 0.5 => Verdict::Weak,
        _ => Verdict::Not,
    }
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0.0), |(sum, n), value| (sum + value * value, n + 1.0));
    if n > 0.0 { (sum / n).sqrt() } else { 0.0 }
}

/// Error on swings that took no part: only their starts are fitted.
pub fn held_out_rmse(held_out: &[Swing], parameters: &Parameters<f64>, count: &AtomicUsize) -> f64 {
    let problem = Problem {
        swings: held_out,
        template: parameters.clone(),
        unknowns: Vec::new(),
        offsets_are_free: true,
        n_simulations: count,
    };
    let point = Point { values: Vec::new(), starts: start::starts(held_out) };
    let first = windows::grow(&problem, &point);
    let last = descend(&problem, &first.point, Window::Whole, Patience::FINE, first.steps);
    (last.cost / problem.n_samples(Window::Whole).max(1) as f64).sqrt()
}
