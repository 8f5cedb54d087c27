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
    let few = scouts(problem.swings);
    carried(problem, &find(&problem.on(&few)))
}

/// Swings whose amplitudes cover those of all, the smallest and the largest among them.
fn scouts(swings: &[Swing]) -> Vec<Swing> {
    let largest = |swing: &Swing| swing.sizes_rad().fold(0.0_f64, |largest, size| largest.max(size.abs()));
    let mut by_size: Vec<(f64, &Swing)> = swings.iter().map(|swing| (largest(swing), swing)).collect();
    by_size.sort_by(|(a, one), (b, other)| a.total_cmp(b).then_with(|| one.name.cmp(&other.name)));
    (0..SCOUTS).map(|k| by_size[k * (swings.len() - 1) / (SCOUTS - 1)].1.clone()).collect()
}

/// A model of some swings, fitted to all.
fn carried(to: &Problem, model: &Fitted) -> Fitted {
    let anew = Fitted { starts: start::starts(to.swings), cost: f64::INFINITY, ..model.clone() };
    let band = if model.has_band() { Band::Free } else { Band::Level };
    anew.started(to).refined(to, band, Tolerance::JUDGE)
}
