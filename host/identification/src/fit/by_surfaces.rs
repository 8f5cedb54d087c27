//! Response surfaces without least squares: through growing windows, then Ms and DV by search where that left errors.

use super::covariance::covariance;
use super::fitted::{Fitted, Stiction};
use super::problem::{Point, Problem, Unknown};
use super::progress::Progress;
use super::ranges::Ranges;
use super::region::Region;
use super::sequential::{self, Sequence};
use super::{start, stiction};
use crate::rsm::COMPOSITE_FACTORS;
use crate::swing::Window;

pub(super) fn surfaces(problem: &Problem, ranges: &Ranges, progress: &(dyn Fn(Progress) + Sync)) -> Sequence {
    let starts = start::starts(problem.swings);
    let begins = |window: Window| match window {
        Window::First(seconds) => progress(Progress::Surfaces(seconds.ceil() as u32)),
        Window::Lively => progress(Progress::Surfaces(0)),
        Window::Calming(_) | Window::Whole => (),
    };
    if COMPOSITE_FACTORS.contains(&problem.unknowns.len()) {
        return sequential::sequence(problem, ranges, &starts, &begins);
    }
    // Too many for one design: Ms and DV wait until the end.
    let smooth_sequence =
        sequential::sequence(&problem.without_stiction(), &smooth_ranges(problem, ranges), &starts, &begins);
    let mut ended = smooth_sequence.region.ranges().0.into_iter();
    let range = |(unknown, range): (&Unknown, &(f64, f64))| match unknown.is_stiction() {
        true => *range,
        false => ended.next().unwrap_or(*range),
    };
    let region = Region::of_ranges(&Ranges(problem.unknowns.iter().zip(&ranges.0).map(range).collect()));
    let own = problem.template_values();
    let values = problem.with_values_but_stiction(&own, &smooth_sequence.point.values);
    Sequence { point: Point { values, ..smooth_sequence.point }, stages: smooth_sequence.stages, region }
}

/// The ranges without those of Ms and DV.
fn smooth_ranges(problem: &Problem, ranges: &Ranges) -> Ranges {
    let keep = |(unknown, range): (&Unknown, &(f64, f64))| (!unknown.is_stiction()).then_some(*range);
    Ranges(problem.unknowns.iter().zip(&ranges.0).filter_map(keep).collect())
}

/// The end of response surfaces without least squares: Ms and DV by search, then designs over the whole swing, first
/// of the smooth parameters, then of all.
pub(super) fn finish_surfaces(problem: &Problem, sequence: &mut Sequence) -> Fitted {
    let begin = Fitted::at(problem, &sequence.point).evaluated(problem);
    let searches: [Search; 2] = [stiction::best_pair, stiction::best_pair_as_shown];
    searches.into_iter().fold(begin, |begin, search| finished(problem, sequence, begin, search))
}

/// A search for Ms and DV from where a model is.
type Search = fn(&Problem, &Fitted) -> Option<Stiction>;

fn finished(problem: &Problem, sequence: &mut Sequence, begin: Fitted, search: Search) -> Fitted {
    let mut best = begin;
    for _ in 0..FINISHING_ROUNDS {
        if problem.rmse_rad(best.cost) < GOOD_END_NOISES * problem.noise_rad() {
            break;
        }
        let Some(pair) = search(problem, &best) else { break };
        let next = finishing_round(problem, sequence, &best.with_stiction(pair));
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

fn finishing_round(problem: &Problem, sequence: &mut Sequence, from: &Fitted) -> Fitted {
    let ranges = finishing_ranges(problem, &sequence.region, from);
    let begin = Sequence { point: from.point(), stages: Vec::new(), region: Region::of_ranges(&ranges) };
    let smooth_end = sequential::in_window(&from.problem(problem), begin, Window::Whole);
    sequence.stages.extend(smooth_end.stages.iter().cloned());

    // Near the truth Ms and DV have smooth effects too.
    let own: Vec<f64> = problem.unknowns.iter().map(|unknown| unknown.get(&from.parameters)).collect();
    let values = problem.with_values_but_stiction(&own, &smooth_end.point.values);
    let mut smooth_ranges = smooth_end.region.ranges().0.into_iter();
    let range = |(unknown, value): (&Unknown, &f64)| {
        let beside = (value - STICTION_REACH * value, value + STICTION_REACH * value);
        if unknown.is_stiction() { beside } else { smooth_ranges.next().unwrap_or(beside) }
    };
    let ranges = Ranges(problem.unknowns.iter().zip(&values).map(range).collect());
    let point = Point { values, starts: smooth_end.point.starts.clone() };
    let begin = Sequence { point, stages: Vec::new(), region: Region::of_ranges(&ranges) };
    let end = if from.has_band() { sequential::in_window(problem, begin, Window::Whole) } else { begin };
    sequence.stages.extend(end.stages.iter().cloned());
    Fitted::at(problem, &end.point).evaluated(problem)
}

/// A box for the smooth parameters: that in which the sequence ended, widened to a few standard deviations where it
/// shrank in vain against another Ms and DV.
fn finishing_ranges(problem: &Problem, ended: &Region, from: &Fitted) -> Ranges {
    let (known, point) = (covariance(&from.linearised(problem)), from.point());
    let widened = |(k, (low, high)): (usize, (f64, f64))| {
        let std = known.as_ref().and_then(|known| known.std(k)).unwrap_or(0.0);
        let half = (0.5 * (high - low)).max(FINISHING_STDS * std);
        (point.values[k] - half, point.values[k] + half)
    };
    Ranges(smooth_ranges(problem, &ended.ranges()).0.into_iter().enumerate().map(widened).collect())
}

/// The last designs begin with boxes at least so many standard deviations wide to either side.
const FINISHING_STDS: f64 = 3.0;

/// Surfaces that come this near to the noise need no search.
const GOOD_END_NOISES: f64 = 1.1;

/// Rounds of each stiction search and designs at the end.
const FINISHING_ROUNDS: usize = 4;

/// The last designs reach this share to either side of Ms and DV.
const STICTION_REACH: f64 = 0.15;
