//! Least squares: from a first guess through growing windows, or from where response surfaces ended.

use super::descent::Tolerance;
use super::fitted::{Fitted, Stiction};
use super::problem::{Point, Problem, Quantity};
use super::progress::Progress;
use super::ranges::largest_coulomb_nm;
use super::refine::Band;
use super::scouts::scouted;
use super::start;
use super::stiction::{FAR_FROM_NOISE, GAIN_WORTH_A_BAND};
use crate::swing::{Swing, Window};
use crate::verdict::Left;
use shared::parameters::base;

/// The model of a rig fitted to the swings, whatever its numbers were, and never worse than with these.
pub fn fitted_as_it_is(problem: &Problem) -> Fitted {
    let found = scouted(problem, |few| least_squares(few, &start::guess(few), &|_| ()));
    not_worse_than_given(problem, found)
}

/// Growing windows from a guess, then Ms and DV, then everything together.
pub(super) fn least_squares(problem: &Problem, first: &Point, progress: &(dyn Fn(Progress) + Sync)) -> Fitted {
    progress(Progress::Descent);
    let mut begin = Fitted::at(problem, first).with_stiction(Stiction::NONE);
    start_in_the_middle(problem, &mut begin);
    let grown = begin.regrown(problem);
    progress(Progress::Stiction);
    grown.refined(problem, Band::Searched, Tolerance::JUDGE)
}

/// Friction that is unknown starts at a usual value, because at zero its bound would hold it there; dry friction at no
/// more than the swings have.
pub(super) fn start_in_the_middle(problem: &Problem, model: &mut Fitted) {
    for unknown in &model.unknowns {
        let most = match unknown.quantity {
            Quantity::Effect { id: base::VISCOUS, .. } => f64::INFINITY,
            Quantity::Effect { id: base::COULOMB, .. } => largest_coulomb_nm(problem),
            _ => continue,
        };
        if unknown.get(&model.parameters) <= unknown.low {
            unknown.set(&mut model.parameters, unknown.scale.min(most));
        }
    }
}

/// A model that begins anew may end in another valley than the one that was given, which may have been improved with
/// care: then that one is fitted on from where it is, and the better one counts, to the end of its valley.
pub(super) fn not_worse_than_given(problem: &Problem, found: Fitted) -> Fitted {
    let point = Point { values: problem.template_values(), starts: start::starts(problem.swings) };
    let given = Fitted::at(problem, &point).started(problem);
    let best = better_than_given(problem, found, &given);
    without_a_band_unseen(problem, best, &given).settled(problem)
}

fn better_than_given(problem: &Problem, found: Fitted, given: &Fitted) -> Fitted {
    let found = if follows(problem, &found) { found } else { found.better(from_the_period(problem)) };
    let nothing_to_gain = problem.chi_square(found.cost).left() == Left::Noise && found.cost <= given.cost;
    if nothing_to_gain || given.cost > WORTH_A_TRY * found.cost {
        return found;
    }
    found.better(given.refined(problem, Band::Free, Tolerance::JUDGE).better(given.clone()))
}

/// Where much is missing and no swing rests, a velocity band only imitates what is missing: it would falsify the inertia, and
/// hold a pendulum at 10° and more for ever. So it goes, unless the model that was given would be lost with it.
fn without_a_band_unseen(problem: &Problem, model: Fitted, given: &Fitted) -> Fitted {
    let is_seen = || {
        let rests = problem.swings.iter().any(Swing::comes_to_rest);
        rests || model.cost < FAR_FROM_NOISE * problem.noise_cost()
    };
    if !model.has_band() || is_seen() {
        return model;
    }
    let free = model.with_stiction(Stiction::NONE).lively(problem, Tolerance::ROUGH);
    let free = free.refined(problem, Band::Level, Tolerance::JUDGE);
    if free.cost <= given.cost { free } else { model }
}

/// Does a model follow the swings at least roughly?
fn follows(problem: &Problem, model: &Fitted) -> bool {
    let squares: f64 = problem.swings.iter().flat_map(|swing| &swing.angles_rad).map(|angle| angle * angle).sum();
    model.cost < HALF_LOST * squares
}

/// A model that leaves this share of the readings' squares has lost them: then the first second is no guide, because noise
/// or a hand fills it.
const HALF_LOST: f64 = 0.25;

/// Fitted from the inertia that the problem begins with, which is that of the period, with nothing that holds the swings.
fn from_the_period(problem: &Problem) -> Fitted {
    let point = start::without_what_holds(problem);
    let begin = Fitted::at(problem, &point).with_stiction(Stiction::NONE).started(problem);
    begin.refined(problem, Band::Free, Tolerance::JUDGE)
}

/// A given model is fitted on if, with its starts fitted alone, it costs no more than so many times the one begun anew.
const WORTH_A_TRY: f64 = 4.0;

/// Least squares from where the response surfaces ended: with the Ms and DV they found, and with a search of their own
/// that begins without a band. A band has to earn its place.
pub(super) fn polish(
    problem: &Problem,
    at_end: &Point,
    ended: &Fitted,
    progress: &(dyn Fn(Progress) + Sync),
) -> Fitted {
    progress(Progress::Descent);
    let free = Fitted::at(problem, at_end).with_stiction(Stiction::NONE);
    let grown = free.descended(problem, Window::Lively, Tolerance::ROUGH);
    progress(Progress::Stiction);
    let searched = grown.refined(problem, Band::Searched, Tolerance::FINE);
    let refined = ended.refined(problem, Band::Near, Tolerance::FINE);
    let needless =
        !searched.has_band() && searched.cost < refined.cost + GAIN_WORTH_A_BAND * problem.noise_rad().powi(2);
    if needless { searched } else { searched.better(refined) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{effect, fitted, rig, simulated};
    use crate::fit::identify::problem_of;
    use crate::fit::tally::Tally;

    /// Does a model keep a band that does not belong there, of a swing whose sensor has this gain?
    fn keeps_its_band(gain: f64, velocity_band: f64, seconds: f64, given_cost: f64) -> bool {
        let (mut truth, base, count) = (rig(), rig(), Tally::default());
        truth.set(effect("sensor-gain").id, &[gain]).unwrap();
        let swings = [simulated("gain", &truth, seconds, 5)];
        let problem = problem_of(&swings, &base, &count);
        let model = fitted(&problem, &base).with_stiction(Stiction { level_nm: 8e-3, velocity_band });
        let given = Fitted { cost: given_cost, ..model.clone() };
        without_a_band_unseen(&problem, model.evaluated(&problem), &given).has_band()
    }

    #[test]
    fn a_band_that_no_rest_shows_goes_where_much_is_missing() {
        assert!(!keeps_its_band(0.05, 0.03, 8.0, f64::INFINITY));
        // What was given would be lost.
        assert!(keeps_its_band(0.05, 0.03, 8.0, 0.0));
        // It rests in the end.
        assert!(keeps_its_band(0.05, 0.03, 120.0, f64::INFINITY));
        // It leaves little but noise.
        assert!(keeps_its_band(0.0, 1e-5, 8.0, f64::INFINITY));
    }
}
