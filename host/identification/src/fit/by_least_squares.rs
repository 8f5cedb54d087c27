//! Least squares: from a first guess through growing windows, or from where response surfaces ended.

use super::added::or_added_anew;
use super::descent::Tolerance;
use super::fitted::{Fitted, Stiction};
use super::other_turn::or_of_another_turn;
use super::problem::{Point, Problem, Quantity, Unknown};
use super::progress::Progress;
use super::ranges::{self, largest_coulomb_nm};
use super::refine::Band;
use super::scouts::scouted;
use super::start;
use super::stiction::{FAR_FROM_NOISE, LARGEST_LEVEL, gain_worth_a_band};
use crate::swing::Window;
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
    or_of_another_turn(problem, grown.refined(problem, Band::Searched, Tolerance::JUDGE))
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
    let found = or_added_anew(problem, or_of_the_other_kind(problem, found));
    let nothing_to_gain = problem.chi_square(found.cost).left() == Left::Noise && found.cost <= given.cost;
    if nothing_to_gain || given.cost > WORTH_A_TRY * found.cost {
        return found;
    }
    found.better(given.refined(problem, Band::Free, Tolerance::JUDGE).better(given.clone()))
}

/// Where no swing rests, a velocity band imitates what is missing, or with a level far beyond what rubs no more than chance: it
/// would falsify the inertia, and hold a pendulum at 10° and more for ever. So it goes, unless the model that was given would be
/// lost with it, or more than noise be left for it.
fn without_a_band_unseen(problem: &Problem, model: Fitted, given: &Fitted) -> Fitted {
    let is_likely = || {
        let coulomb_nm = model.parameters.values(base::COULOMB).map_or(0.0, |values| values[0]);
        model.stiction().level_nm <= LARGEST_LEVEL * coulomb_nm
    };
    let is_seen = || {
        let rests = problem.comes_to_rest();
        rests || (model.cost < FAR_FROM_NOISE * problem.noise_cost() && is_likely())
    };
    if !model.has_band() || is_seen() {
        return model;
    }
    let free = model.with_stiction(Stiction::NONE).lively(problem, Tolerance::ROUGH);
    let free = free.refined(problem, Band::Level, Tolerance::JUDGE);
    let [left, left_without] = [&model, &free].map(|model| problem.chi_square(model.cost).left());
    let is_needless = left_without <= left && free.cost < MOST_IMITATED * model.cost;
    if free.cost <= given.cost && is_needless { free } else { model }
}

/// So many times what an imitated band leaves is left without it at most; three strangers' recordings have 2.9 to 7.4. A true one
/// that a filtered gyroscope saw, whose noise is five times what neighbours tell, had 34. Half of it would keep some of those
/// imitations, twice of it none more.
const MOST_IMITATED: f64 = 12.0;

/// Where physics is missing, dry and viscous friction may each imitate it, in a valley of its own: a fit ended with dry friction
/// alone at 3.0 mrad where mostly viscous friction leaves 1.8. So the model is begun once more with the kind that it has less of.
fn or_of_the_other_kind(problem: &Problem, found: Fitted) -> Fitted {
    let friction = |id: u16| {
        let is_it = |unknown: &&Unknown| unknown.quantity == Quantity::Effect { id, index: 0 };
        found.unknowns.iter().find(is_it)
    };
    let (Some(viscous), Some(coulomb)) = (friction(base::VISCOUS), friction(base::COULOMB)) else { return found };
    if found.cost < FAR_FROM_NOISE * problem.noise_cost() {
        return found;
    }
    let alone = ranges::friction_alone(problem, found.parameters.pendulum.inertia_kg_m2);
    let is_viscous = viscous.get(&found.parameters) / alone.viscous > coulomb.get(&found.parameters) / alone.coulomb_nm;
    let share = if is_viscous { LITTLE } else { 1.0 - LITTLE };
    let mut other = Fitted { starts: start::starts(problem.swings), ..found.with_stiction(Stiction::NONE) };
    viscous.set(&mut other.parameters, share * alone.viscous);
    coulomb.set(&mut other.parameters, (1.0 - share) * alone.coulomb_nm);
    let other = other.regrown(problem).refined(problem, Band::Level, Tolerance::JUDGE);
    found.better(other)
}

/// The share of what the swings lose with which a kind of friction begins that is nearly none: none at all would stay at its
/// bound. Half and twice were not tried.
const LITTLE: f64 = 0.1;

/// Does a model follow the swings at least roughly?
fn follows(problem: &Problem, model: &Fitted) -> bool {
    model.cost < HALF_LOST * problem.motion()
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
    let needless = !searched.has_band() && searched.cost < refined.cost + gain_worth_a_band(problem, problem);
    if needless { searched } else { searched.better(refined) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{effect, fitted, rig, simulated};
    use crate::fit::identify::problem_of;
    use crate::fit::tally::Tally;

    /// Does a model keep a band that does not belong there, of a swing whose sensor has this gain too much?
    fn keeps_its_band(gain: f64, level_nm: f64, velocity_band: f64, seconds: f64, given_cost: f64) -> bool {
        let (mut truth, base, count) = (rig(), rig(), Tally::default());
        truth.set(effect("sensor-gain").id, &[gain]).unwrap();
        let swings = [simulated("gain", &truth, seconds, 5)];
        let problem = problem_of(&swings, &base, &count);
        let model = fitted(&problem, &base).with_stiction(Stiction { level_nm, velocity_band });
        let given = Fitted { cost: given_cost, ..model.clone() };
        without_a_band_unseen(&problem, model.evaluated(&problem), &given).has_band()
    }

    /// Begun with dry friction where the truth rubs as the speed does.
    #[test]
    fn a_model_that_leaves_much_is_begun_with_the_other_kind_of_friction_too() {
        let (mut truth, base, count) = (rig(), rig(), Tally::default());
        truth.set_friction(2e-3, 1e-4, 0.0, 0.0);
        let swings = [simulated("viscous", &truth, 12.0, 4)];
        let problem = problem_of(&swings, &base, &count);
        let mut dry = fitted(&problem, &truth);
        dry.parameters.set_friction(0.0, 6e-3, 0.0, 0.0);
        let dry = dry.evaluated(&problem);
        let found = or_of_the_other_kind(&problem, dry.clone());
        let viscous = found.parameters.values(base::VISCOUS).unwrap()[0];
        assert!(dry.cost > 100.0 * found.cost && (viscous / 2e-3 - 1.0).abs() < 0.05, "{viscous} {}", found.cost);
        // Where little is left nothing is begun.
        let near = Fitted { cost: 1.9 * problem.noise_cost(), ..dry };
        assert_eq!(or_of_the_other_kind(&problem, near.clone()).parameters, near.parameters);
    }

    /// Is a band kept that holds so many times what rubs, where so strong a drag is missing, and which leaves so many
    /// noises or such a share of what is left without it?
    fn keeps_with_drag(drag: f64, level_times: f64, cost: impl Fn(f64, f64) -> f64) -> bool {
        let (mut truth, base, count) = (rig(), rig(), Tally::default());
        truth.set(effect("quadratic-drag").id, &[drag]).unwrap();
        let swings = [simulated("drag", &truth, 14.0, 1)];
        let problem = problem_of(&swings, &base, &count);
        let without = fitted(&problem, &base);
        assert!(without.cost > 5.0 * problem.noise_cost(), "no case: {}", without.cost / problem.noise_cost());
        let given = Fitted { cost: f64::INFINITY, ..without.clone() };
        let cost = cost(problem.noise_cost(), without.cost);
        let mut model = Fitted { cost, ..without };
        model.parameters.set_friction(5e-4, 1e-3, level_times * 1e-3, 0.03);
        without_a_band_unseen(&problem, model, &given).has_band()
    }

    #[test]
    fn a_band_that_holds_many_times_what_rubs_goes_sooner_and_one_that_matters_much_stays() {
        let near = |level_times: f64| keeps_with_drag(6e-5, level_times, |noise, _| 1.9 * noise);
        assert!(near(2.0) && !near(4.0));
        let much = |share: f64| keeps_with_drag(2e-4, 4.0, |_, without| share * without);
        assert!(!much(1.0 / 6.0) && much(1.0 / 24.0));
    }

    #[test]
    fn a_band_that_no_rest_shows_goes_where_much_is_missing() {
        assert!(!keeps_its_band(0.05, 8e-3, 0.03, 8.0, f64::INFINITY));
        // What was given would be lost.
        assert!(keeps_its_band(0.05, 8e-3, 0.03, 8.0, 0.0));
        // It rests in the end.
        assert!(keeps_its_band(0.05, 8e-3, 0.03, 120.0, f64::INFINITY));
        // It leaves little but noise …
        let mc_nm = rig().values(base::COULOMB).unwrap()[0];
        assert!(keeps_its_band(0.0, 2.0 * mc_nm, 1e-5, 8.0, f64::INFINITY));
        // … but holds more than usual, and without it nothing more is left.
        assert!(!keeps_its_band(0.0, 8.0 * mc_nm, 1e-5, 8.0, f64::INFINITY));
    }
}
