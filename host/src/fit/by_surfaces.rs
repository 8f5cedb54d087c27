//! Response surfaces without least squares: through growing windows, then Ms and DV by search where that left errors.

use super::identify::Progress;
use super::outcome::{Outcome, full_values, pair_of, smooth, smooth_point};
use super::problem::{Point, Problem, Unknown};
use super::region::Region;
use super::sequential::{self, Ranges, Sequence};
use super::start;
use super::stiction::{self, Stiction, with_stiction};
use crate::swing::Window;

pub(super) fn surfaces(problem: &Problem, ranges: &Ranges, progress: &(dyn Fn(Progress) + Sync)) -> Sequence {
    sequential::sequence(problem, ranges, &start::starts(problem.swings), &|window| match window {
        Window::First(seconds) => progress(Progress::Surfaces(seconds.ceil() as u32)),
        Window::Lively => progress(Progress::Surfaces(0)),
        Window::Calming(_) | Window::Whole => (),
    })
}

/// The end of response surfaces without least squares: Ms and DV by search, then designs over the whole swing, first
/// of the smooth parameters, then of all.
pub(super) fn finish_surfaces(problem: &Problem, sequence: &mut Sequence) -> Outcome {
    let smooth = smooth(problem);
    let mut best = Outcome {
        point: smooth_point(problem, &sequence.point),
        stiction: pair_of(problem, &sequence.point),
        level_range_nm: (0.0, 0.0),
        cost: problem.costs(Window::Whole, std::slice::from_ref(&sequence.point))[0],
        converged: true,
    };
    for _ in 0..FINISHING_ROUNDS {
        if best.rmse_rad(problem) < GOOD_END_NOISES * problem.noise_rad() {
            break;
        }
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
    let ranges = Ranges(problem.unknowns.iter().zip(&sequence.region.ranges().0).filter_map(keep).collect());
    let from = Sequence { point: point.clone(), stages: Vec::new(), region: Region::of_ranges(&ranges) };
    let smooth_end = sequential::in_window(&fixed, from, Window::Whole);
    sequence.stages.extend(smooth_end.stages.iter().cloned());

    // Near the truth Ms and DV have smooth effects too.
    let values = full_values(problem, &smooth_end.point, pair);
    let mut smooth_ranges = smooth_end.region.ranges().0.into_iter();
    let range = |(unknown, value): (&Unknown, &f64)| {
        let beside = (value - STICTION_REACH * value, value + STICTION_REACH * value);
        if unknown.is_stiction() { beside } else { smooth_ranges.next().unwrap_or(beside) }
    };
    let ranges = Ranges(problem.unknowns.iter().zip(&values).map(range).collect());
    let point = Point { values, starts: smooth_end.point.starts.clone() };
    let from = Sequence { point, stages: Vec::new(), region: Region::of_ranges(&ranges) };
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

/// Surfaces that come this near to the noise need no search.
const GOOD_END_NOISES: f64 = 1.1;

/// Rounds of stiction search and designs at the end.
const FINISHING_ROUNDS: usize = 4;

/// The last designs reach this share to either side of Ms and DV.
const STICTION_REACH: f64 = 0.15;
