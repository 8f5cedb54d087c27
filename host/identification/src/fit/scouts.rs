//! Many swings: a few of them find the way, all of them decide.
//!
//! Surfaces, growing windows and the search for Ms and DV cost the more the more swings there are, and find the same: a
//! few swings tell the numbers to a thousandth. From there all of them need some linearisations only.

use super::descent::Tolerance;
use super::fitted::Fitted;
use super::problem::Problem;
use super::refine::Band;
use super::start;
use crate::swing::Swing;

/// So many swings find the way.
const SCOUTS: usize = 8;

/// What is found on a few swings, fitted to all; found on all where these are few.
pub(super) fn scouted(problem: &Problem, find: impl FnOnce(&Problem) -> Fitted) -> Fitted {
    if problem.swings.len() <= SCOUTS {
        return find(problem);
    }
    let few: Vec<Swing> = scouts(problem.swings).into_iter().map(|idx| problem.swings[idx].clone()).collect();
    carried(problem, &find(&problem.on(&few)))
}

/// Swings whose amplitudes cover those of all, the smallest and the largest among them; all where these are few.
pub(super) fn scouts(swings: &[Swing]) -> Vec<usize> {
    if swings.len() <= SCOUTS {
        return (0..swings.len()).collect();
    }
    let sizes: Vec<f64> = swings.iter().map(Swing::largest_rad).collect();
    let mut by_size: Vec<usize> = (0..swings.len()).collect();
    by_size.sort_by(|a, b| sizes[*a].total_cmp(&sizes[*b]).then_with(|| swings[*a].name.cmp(&swings[*b].name)));
    (0..SCOUTS).map(|k| by_size[k * (swings.len() - 1) / (SCOUTS - 1)]).collect()
}

/// A model of some swings, fitted to all.
fn carried(to: &Problem, model: &Fitted) -> Fitted {
    let anew = Fitted { starts: start::starts(to.swings), cost: f64::INFINITY, ..model.clone() };
    let band = if model.has_band() { Band::Free } else { Band::Level };
    anew.started(to).refined(to, band, Tolerance::JUDGE)
}
