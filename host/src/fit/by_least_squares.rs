//! Least squares: from a first guess through growing windows, or from where response surfaces ended.

use super::descent::{Patience, descend};
use super::identify::Progress;
use super::linear::Steps;
use super::outcome::{Outcome, smooth, smooth_point};
use super::problem::{Point, Problem};
use super::sequential::Sequence;
use super::stiction::{self, Stiction, with_stiction};
use super::windows;
use crate::swing::Window;

/// Growing windows from a guess, then Ms and DV, then everything together.
pub(super) fn least_squares(problem: &Problem, first: &Point, progress: &(dyn Fn(Progress) + Sync)) -> Outcome {
    progress(Progress::Descent);
    let smooth = with_stiction(&smooth(problem), Stiction { level_nm: 0.0, velocity_band: 0.0 });
    let mut from = smooth_point(problem, first);
    start_in_the_middle(&smooth, &mut from);
    let grown = windows::grow(&smooth, &from);
    progress(Progress::Stiction);
    Outcome::settled(stiction::settle(&smooth, &grown.point, Patience::JUDGE))
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

/// Least squares from where the response surfaces ended: with the Ms and DV they found, and with a search of their own
/// that begins without a band. A band has to earn its place.
pub(super) fn polish(
    problem: &Problem,
    sequence: &Sequence,
    ended: &Outcome,
    progress: &(dyn Fn(Progress) + Sync),
) -> Outcome {
    progress(Progress::Descent);
    let smooth = smooth(problem);
    let from = smooth_point(problem, &sequence.point);
    let free = with_stiction(&smooth, Stiction { level_nm: 0.0, velocity_band: 0.0 });
    let grown = descend(&free, &from, Window::Lively, Patience::ROUGH, Steps::new(&free));
    progress(Progress::Stiction);
    let searched = Outcome::settled(stiction::settle(&free, &grown.point, Patience::FINE));
    let refined = Outcome::settled(stiction::refine(&smooth, &ended.point, ended.stiction, Patience::FINE));
    let needless = searched.stiction.velocity_band == 0.0
        && searched.cost < refined.cost + stiction::GAIN_WORTH_A_BAND * problem.noise_rad().powi(2);
    if needless { searched } else { searched.better(refined) }
}
