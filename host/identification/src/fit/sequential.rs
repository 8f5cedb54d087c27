//! Sequential response surface methodology: the paper's method, made to converge.
//!
//! Each stage runs a face-centred central composite design, fits the five response surfaces, and moves to their
//! optimum. The paper's own sequence does not converge from its own wide ranges: far from the truth the error surface
//! is no parabola and the next box shuts the truth out. Three things cure that: the time window grows, so that early
//! stages see a smooth error; a move is accepted only if the simulated error falls; a box is re-centred before its
//! width changes, and shrinks only when its optimum lies inside or its surface cannot be believed (it predicts runs
//! that were left out badly, or the simulation does not keep what it promised): a trust region of surfaces. The box
//! itself is in [`super::region`].

use super::problem::{Point, Problem, Start};
use super::proposal::{promised_gain, proposals};
use super::quality::Responses;
use super::ranges::Ranges;
use super::region::Region;
use super::runs::{first_runs, runs};
use super::windows::{CALMING, windows_s};
use crate::rsm::{Design, Factor, Goodness, Regression, Surface, goodness};
use crate::swing::Window;
use serde::Serialize;

/// Rounds of design and move within one window of lively motion.
const MAX_ROUNDS: usize = 24;

/// And with ever more of the last swings, where surfaces only creep: the error has kinks along Ms and DV, which are
/// searched separately in the end.
const MAX_CALMING_ROUNDS: usize = 4;

/// And over the whole swings.
const MAX_WHOLE_ROUNDS: usize = 8;

/// A window is left when so many rounds in turn gained little, however incredible their surfaces.
const MAX_IDLE_ROUNDS: usize = 3;

/// Below this predicted R² (PRESS) of mseA a surface is not believed.
const CREDIBLE_R_SQUARED: f64 = 0.9;

/// A surface is not believed either when the error falls by less than this share of what it promised.
const KEPT_PROMISE: f64 = 0.25;

/// A window is finished when a move lowers the sum of squares by less than so many noise variances.
const LITTLE_GAIN: f64 = 5.0;

/// One design and the move it led to.
#[derive(Clone, Debug, Serialize)]
pub struct Stage {
    /// Seconds of the swings it looked at; absent for all of them.
    pub window_s: Option<f64>,
    /// Symbols, low and high ends.
    pub ranges: Vec<(&'static str, f64, f64)>,
    /// Values after the move, in the order of the ranges.
    pub values: Vec<f64>,
    /// Responses at the box's centre.
    pub before: Responses,
    /// Responses after the move.
    pub after: Responses,
    /// How far each surface can be believed, in the order of [`Responses::NAMES`].
    #[serde(skip)]
    pub goodness: Vec<Goodness>,
    /// The surfaces themselves, in the same order, over the axes of the box.
    #[serde(skip)]
    pub surfaces: Vec<Surface>,
    /// The box: where its axes lie among the parameters.
    #[serde(skip)]
    pub region: Region,
    /// R² of the mseA surface, predicted by leaving runs out.
    pub r_squared_predicted: Option<f64>,
}

/// Where the sequence ended.
#[derive(Clone, Debug)]
pub struct Sequence {
    /// The best guess.
    pub point: Point,
    /// Each stage in turn.
    pub stages: Vec<Stage>,
    /// Where the next design would lie.
    pub region: Region,
}

impl Sequence {
    /// A box along the parameters, in whose middle the first guess lies.
    pub fn begin(ranges: &Ranges, starts: &[Start]) -> Self {
        let values = ranges.0.iter().map(|(low, high)| 0.5 * (low + high)).collect();
        let point = Point { values, starts: starts.to_vec() };
        Self { point, stages: Vec::new(), region: Region::of_ranges(ranges) }
    }
}

/// Goes through all windows from wide ranges, the whole swings last; `begins` is told each window.
pub fn sequence(problem: &Problem, ranges: &Ranges, starts: &[Start], begins: &dyn Fn(Window)) -> Sequence {
    let firsts = windows_s(problem.swings).map(Window::First);
    let mut sequence = Sequence::begin(ranges, starts);
    let lasts = CALMING.into_iter().map(Window::Calming).chain([Window::Whole]);
    for window in firsts.chain([Window::Lively]).chain(lasts) {
        begins(window);
        sequence = in_window(problem, sequence, window);
    }
    sequence
}

/// Designs and moves within one window until the noise or the gains are small.
pub fn in_window(problem: &Problem, from: Sequence, window: Window) -> Sequence {
    let mut now = from;
    let max_rounds = match window {
        Window::First(_) | Window::Lively => MAX_ROUNDS,
        Window::Calming(_) => MAX_CALMING_ROUNDS,
        Window::Whole => MAX_WHOLE_ROUNDS,
    };
    let mut n_idle = 0;
    let Some(regression) = face_centred(problem.unknowns.len()) else { return now };
    for _ in 0..max_rounds {
        match one_stage(problem, &mut now, window, &regression) {
            None | Some(Gain::Last) => break,
            Some(Gain::Little) => n_idle += 1,
            Some(Gain::Much) => n_idle = 0,
        }
        if n_idle == MAX_IDLE_ROUNDS {
            break;
        }
    }
    now
}

/// What a move brought.
enum Gain {
    /// So little that nothing is left to gain in this window, says a credible surface.
    Last,
    /// Little, but the surface is not credible.
    Little,
    /// Enough to go on.
    Much,
}

/// One design around the present guess and the move it leads to; none where there is no box left to lay a design in.
fn one_stage(problem: &Problem, now: &mut Sequence, window: Window, regression: &Regression) -> Option<Gain> {
    let region = now.region.around(&now.point.values, &problem.unknowns);
    if region.is_spent(&problem.unknowns) {
        return None;
    }
    let natural = |coded: &[Vec<f64>]| coded.iter().map(|c| region.natural(c, &problem.unknowns)).collect::<Vec<_>>();
    let planned = [vec![now.point.values.clone()], natural(regression.design().coded_runs())].concat();
    let (nuisance, mut tried) = first_runs(problem, &now.point, window, &planned);
    let here = tried.remove(0);
    let surfaces: Vec<Surface> = (0..Responses::NAMES.len())
        .map(|k| Surface::over(regression, &tried.iter().map(|run| run.responses.values()[k]).collect::<Vec<_>>()))
        .collect::<Result<_, _>>()
        .ok()?;
    let proposed = natural(&proposals(&surfaces, &tried));
    tried.extend(runs(problem, &now.point, window, &nuisance, &proposed));
    let best = tried.iter().min_by(|a, b| a.responses.mse_angle.total_cmp(&b.responses.mse_angle))?;
    let moves = best.responses.mse_angle < here.responses.mse_angle;
    let chosen = if moves { best } else { &here };

    let n_samples = problem.n_samples(window) as f64;
    let noises = n_samples / problem.noise_rad().powi(2);
    let gain = (here.responses.mse_angle - chosen.responses.mse_angle) * noises;
    let promised = promised_gain(&surfaces[0], &region.coded(&now.point.values)) * noises;
    let kept_promise = gain > KEPT_PROMISE * promised || promised < LITTLE_GAIN;
    let r_squared_predicted = goodness(&surfaces[0]).r_squared_predicted;
    let is_credible = kept_promise && r_squared_predicted.is_some_and(|r| r > CREDIBLE_R_SQUARED);
    now.region = if is_credible {
        region.canonical(&surfaces[0], &chosen.point.values, chosen.responses.mse_angle, n_samples)
    } else {
        region.halved()
    };
    now.stages.push(Stage {
        window_s: match window {
            Window::First(seconds) => Some(seconds),
            _ => None,
        },
        ranges: symbols(problem).zip(region.ranges().0).map(|(symbol, (low, high))| (symbol, low, high)).collect(),
        values: chosen.point.values.clone(),
        before: here.responses,
        after: chosen.responses,
        goodness: surfaces.iter().map(goodness).collect(),
        surfaces,
        region,
        r_squared_predicted,
    });
    now.point = chosen.point.clone();
    Some(match gain < LITTLE_GAIN {
        true if is_credible => Gain::Last,
        true => Gain::Little,
        false => Gain::Much,
    })
}

fn symbols(problem: &Problem) -> impl Iterator<Item = &'static str> {
    problem.unknowns.iter().map(|unknown| unknown.symbol)
}

/// The design of every stage, in coded units.
fn face_centred(n_factors: usize) -> Option<Regression> {
    let axes: Result<Vec<Factor>, _> =
        (1..=n_factors).map(|axis| Factor::new(format!("axis {axis}"), -1.0, 1.0)).collect();
    Regression::new(&Design::face_centred(axes.ok()?, 1).ok()?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_design_along_two_axes_has_its_corners_its_faces_and_its_middle() {
        let runs = face_centred(2).unwrap().design().natural_runs();
        for corner in [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]] {
            assert!(runs.iter().any(|run| *run == corner), "{runs:?}");
        }
        assert_eq!(runs.len(), 9);
    }
}
