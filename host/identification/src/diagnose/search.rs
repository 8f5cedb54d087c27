//! The search through models: one effect at a time, the most promising few kept at each level.

use super::budget::Budget;
use super::extension::{extensions, swings};
use super::models::{
    MOST_LEFT_UNEXPLAINED, NEAR, PROMISING, drop_doubles, excess, is_explained, is_well_explained, near_the_best, sort,
    worth_all_samples,
};
use super::physical::is_sound;
use super::widening::{
    alone_beside_nothing, alone_in_wider_form, begun_from_last_digits, begun_from_special_cases, narrowed, widened,
};
use crate::cores::on_all_cores;
use crate::fit::descent::{Termination, Tolerance};
use crate::fit::fitted::{Fitted, Stiction};
use crate::fit::problem::Problem;
use crate::fit::refine::{Band, levels, on_all};
use crate::fit::stiction::{gain_worth_a_band, lowest_with_band};
use crate::verdict::Left;
use shared::effect::{CUSTOM_FORMULA_NAME, Effect};

/// At most this many effects are added.
const MAX_ADDED: usize = 3;

/// Models kept from one level to the next.
const BEAM: usize = 2;

/// Models that cost this much more than the best are not gone on with.
const BEAM_REACH: f64 = 2.0;

/// Models of one level that are looked at again, at most, … Without any, forty simulated rigs are told alike, but the arm on
/// ball bearings ends at 12.8 in place of 9.8 mrad, and takes a third longer.
const MAX_LOOKED_AT: usize = 8;

/// … if they cost less than so many times the best one.
const WORTH_A_LOOK: f64 = 3.0;

/// From another side a velocity band of swings that do not rest is sought only if first-order answers promise this share of
/// the excess; of those that rest, whose answers mislead from another turn of their stop, it is sought in any case. Of 14
/// searches on the arm on ball bearings, the cup on a string and the example p04, 12 kept 0.003 at most; 0.012 and 0.024
/// were kept where 0.115 and 0.027 were promised. They took up to 46 % of a diagnosis. Half: the same searches there;
/// twice: the band that keeps 0.024 is not found.
const WORTH_SEEKING_A_BAND: f64 = 0.025;

/// A base with a velocity band is gone on with, beside the one without, if its cost is below this share.
const WORTH_KEEPING_THE_BAND: f64 = 0.8;

/// Models of one level that are finished, at most.
const MAX_FINISHED: usize = 4;

/// What a search found.
#[derive(Clone, Debug)]
pub struct Found {
    /// The base model.
    pub base: Fitted,
    /// Fitted models by the number of added effects (first: one), the lowest cost first; only the first few of each
    /// level are finished.
    pub levels: Vec<Vec<Fitted>>,
}

impl Found {
    /// The model with the lowest cost at a level; level 0 is the base.
    pub fn best(&self, level: usize) -> &Fitted {
        if level == 0 { &self.base } else { &self.levels[level - 1][0] }
    }

    /// One more model of as many effects as those of a level, or in place of one that has the same and costs more.
    pub(super) fn add(&mut self, model: Fitted) {
        let Some(level) = model.effects.len().checked_sub(1).and_then(|idx| self.levels.get_mut(idx)) else { return };
        level.push(model);
        sort(level);
        drop_doubles(level);
    }
}

/// Level by level, models with one more effect than those before, until one explains the swings; `rough` has decimated
/// swings, on which models are found.
pub fn search(
    problem: &Problem,
    rough: &Problem,
    base: &Fitted,
    candidates: &[&'static Effect<f64>],
    budget: &Budget,
) -> Found {
    let mut found = Found { base: base.clone(), levels: Vec::new() };
    if is_explained(problem, base) {
        return found;
    }
    let bare = without_band(problem, base);
    let mut beam = vec![bare.clone()];
    if base.cost < WORTH_KEEPING_THE_BAND * beam[0].cost {
        beam.push(base.clone());
    }
    for n_added in 0..MAX_ADDED {
        budget.keep_for_pairs(n_added == 0 && problem.swings.len() > 1);
        if n_added > 0 && !budget.allows_more() {
            break;
        }
        let level = next_level(problem, rough, &beam, candidates, budget);
        let before = found.best(found.levels.len());
        let Some(best) = level.first().filter(|best| best.cost < before.cost) else { break };
        let alone = || {
            let beside_nothing = alone_beside_nothing(problem, rough, &level);
            beside_nothing.or_else(|| alone_in_wider_form(problem, rough, &bare, best, &found.levels[0]))
        };
        if let Some(alone) = may_be_one_law(problem, best).then(alone).flatten() {
            found.add(alone);
            break;
        }
        let share_left = excess(problem, best) / excess(problem, before);
        // Further effects than the first shall remove what lets them be claimed.
        let is_last = is_explained(problem, best) || (n_added > 0 && share_left > MOST_LEFT_UNEXPLAINED);
        beam = kept(&level);
        found.levels.push(level);
        if is_last {
            break;
        }
    }
    budget.keep_for_pairs(false);
    found
}

/// May two laws stand for one in its wider form? They explain the swings, or nearly: what the one law is not, two hardly make up.
fn may_be_one_law(problem: &Problem, model: &Fitted) -> bool {
    model.effects.len() == 2 && problem.chi_square(model.cost).left() != Left::Missing
}

/// The models to go on with: the best few, and the best of those with the fewest numbers. One that swings beside the
/// pendulum takes several times as long as the others, and is gone on with only if it is the best.
fn kept(level: &[Fitted]) -> Vec<Fitted> {
    let is_near = |model: &Fitted| model.cost < BEAM_REACH * level[0].cost;
    let near = || level.iter().enumerate().filter(|(i, model)| is_near(model) && (*i == 0 || !swings(model)));
    let near = || near().map(|(_, model)| model);
    let mut beam: Vec<Fitted> = near().take(BEAM).cloned().collect();
    let simplest = near().min_by_key(|model| model.n_added());
    beam.extend(simplest.filter(|simple| beam.iter().all(|other| other.n_added() > simple.n_added())).cloned());
    // A support imitates the sum of two laws better than either of them.
    if beam.iter().all(swings) {
        beam.extend(level.iter().find(|model| !swings(model)).cloned());
    }
    beam
}

/// The base without a velocity band: a band that only imitates the missing effect would hide it.
pub(super) fn without_band(problem: &Problem, base: &Fitted) -> Fitted {
    if !base.has_band() {
        return base.clone();
    }
    let free = base.with_stiction(Stiction::NONE);
    free.lively(problem, Tolerance::ROUGH).refined(problem, Band::Level, Tolerance::JUDGE)
}

/// All models with one more effect than those of the beam that are worth fitting, the lowest cost first.
fn next_level(
    problem: &Problem,
    rough: &Problem,
    beam: &[Fitted],
    candidates: &[&'static Effect<f64>],
    budget: &Budget,
) -> Vec<Fitted> {
    let mut found = found_roughly(rough, beam, candidates, budget);
    found.extend(narrowed(rough, &found));
    found.extend(begun_from_special_cases(rough, &found));
    sort(&mut found);
    drop_doubles(&mut found);
    if budget.allows_wider_forms() {
        found.extend(widened(rough, &found));
        sort(&mut found);
        drop_doubles(&mut found);
    }
    let Some(lowest) = found.first().map(|best| best.cost) else { return found };
    let (mut level, mut rest) = best_on_all(problem, rough, found, budget);
    let best = level[0].clone();
    let has_another = |model: &Fitted| best.has_band() || model.has_band() || stops_elsewhere(&best, model);
    rest.extend(level.extract_if(1.., |model| has_another(model)));
    let others = rest.iter_mut().filter(|model| has_another(model) && model.cost < BEAM_REACH * lowest);
    on_all_cores(others, |model| *model = with_the_stiction_of(rough, best.stiction(), model));
    // Models far above the best one stay as they are: nothing that follows depends on their last digit.
    let reach = NEAR * best.evaluated(rough).cost.min(lowest);
    let left = |model: &Fitted| match model.cost < reach {
        true => model.refined(problem, Band::Free, Tolerance::ROUGH),
        false => model.evaluated(problem),
    };
    level.extend(on_all_cores(&rest, left));
    level.retain(|model| is_sound(problem, model));
    sort(&mut level);
    with_the_bands_they_lack(problem, rough, &mut level);
    level.extend(begun_from_last_digits(problem, &level));
    sort(&mut level);
    drop_doubles(&mut level);
    level
}

/// Where a model explains the swings, those of no more numbers that nearly do get a velocity band too, if one is worth it: a law
/// of many numbers imitates a band that is there, and would be claimed in place of the one that lacks it. Of swings that never
/// rest, whose period alone shows a band, first-order answers tell too little.
fn with_the_bands_they_lack(problem: &Problem, rough: &Problem, level: &mut [Fitted]) {
    let Some(n_most) = level.first().filter(|best| is_explained(problem, best)).map(Fitted::n_added) else { return };
    let least_gain = gain_worth_a_band(rough, problem);
    let never_rests = !problem.comes_to_rest();
    let may_lack = |model: &Fitted| {
        let is_near = problem.chi_square(model.cost).left() != Left::Missing;
        let promised = || model.evaluated(rough).cost - lowest_with_band(rough, model);
        is_near && !model.has_band() && model.n_added() <= n_most && (never_rests || promised() > least_gain)
    };
    on_all_cores(level.iter_mut(), |model| {
        if may_lack(model) {
            *model = model.refined(problem, Band::Searched, Tolerance::JUDGE).better(model.clone());
        }
    });
    sort(level);
}

/// Those of a sorted level that may be the best, fitted to all samples until nothing moves, the lowest cost first; and
/// the others as they are on decimated swings. The level must not be empty.
fn best_on_all(
    problem: &Problem,
    rough: &Problem,
    mut level: Vec<Fitted>,
    budget: &Budget,
) -> (Vec<Fitted>, Vec<Fitted>) {
    let n_near = near_the_best(&level).len().clamp(1, MAX_FINISHED);
    let mut rest = level.split_off(n_near);
    // Each with the stop levels that may suit it.
    let mut near: Vec<Vec<Fitted>> = on_all_cores(&level, |model| levels(rough, model));
    near.sort_by(|a, b| a[0].cost.total_cmp(&b[0].cost));
    let allows_more = budget.allows_more();
    if !is_well_explained(problem, &near[0][0]) && allows_more {
        // Of laws that are nearly alike, one that ended on the way, at another turning point, is taken for a wrong one.
        on_all_cores(near.iter_mut().filter(|levels| !swings(&levels[0])), |model| begun_anew(rough, model));
        near.sort_by(|a, b| a[0].cost.total_cmp(&b[0].cost));
    }
    if !is_well_explained(problem, &near[0][0]) && (rough.comes_to_rest() || allows_more) {
        let simplest = near.iter().rposition(|levels| is_usual_form_of(&levels[0], &near[0][0])).unwrap_or(0);
        // A support imitates a law and its band better than the law without it.
        let beside = near.iter().position(|levels| !swings(&levels[0])).filter(|_| swings(&near[0][0]));
        [Some(simplest), beside].into_iter().flatten().for_each(|idx| {
            seen_from_other_sides(problem, rough, &mut near[idx]);
        });
        near.sort_by(|a, b| a[0].cost.total_cmp(&b[0].cost));
    }
    let limit = worth_all_samples(rough, near[0][0].cost);
    let n_worth_it = near.iter().take_while(|levels| levels[0].cost <= limit).count().max(1);
    rest.extend(near.split_off(n_worth_it).into_iter().map(|mut levels| levels.swap_remove(0)));
    // What somebody typed deserves its last digit anyway.
    let typed: Vec<Fitted> = rest.extract_if(.., |model| model.has(CUSTOM_FORMULA_NAME)).collect();
    let mut best: Vec<Fitted> = on_all_cores(&near, |levels| on_all(problem, levels));
    best.extend(on_all_cores(&typed, |model| model.refined(problem, Band::Level, Tolerance::JUDGE)));
    sort(&mut best);
    (best, rest)
}

/// Has a model the same effects, or usual forms of these? A wider form that leaves much has bent to what is missing, and
/// to see it from other sides takes several times as long: half of the search, where a pair was missed for it.
fn is_usual_form_of(usual: &Fitted, model: &Fitted) -> bool {
    let is_form = |effect: &'static Effect<f64>, of: &'static Effect<f64>| {
        effect.id == of.id || effect.wider_form().is_some_and(|wide| wide.id == of.id)
    };
    let has_form = |of: &&'static Effect<f64>| usual.effects.iter().any(|effect| is_form(effect, of));
    usual.effects.len() == model.effects.len() && model.effects.iter().all(has_form)
}

/// Begins one that swings beside the pendulum anew with the first swings, as the others have been, then seeks a velocity band
/// for whatever it is, and keeps what is better.
fn seen_from_other_sides(problem: &Problem, rough: &Problem, model: &mut Vec<Fitted>) {
    if swings(&model[0]) {
        begun_anew(rough, model);
    }
    let is_worth_it = || rough.comes_to_rest() || band_is_promising(rough, &model[0]);
    if !is_well_explained(problem, &model[0]) && is_worth_it() {
        let with_band = model[0].refined(rough, Band::Searched, Tolerance::JUDGE);
        if with_band.cost < model[0].cost {
            *model = vec![with_band];
        }
    }
}

/// Begins a model anew with the first swings, if that is better; where it stops is found anew too.
fn begun_anew(rough: &Problem, model: &mut Vec<Fitted>) {
    let best = &model[0];
    let anew = levels(rough, &best.calmed(rough));
    if anew[0].cost < model[0].cost {
        *model = anew;
    }
}

/// May a velocity band remove enough of what a model leaves?
fn band_is_promising(rough: &Problem, model: &Fitted) -> bool {
    model.cost - lowest_with_band(rough, model) > WORTH_SEEKING_A_BAND * (model.cost - rough.noise_cost())
}

/// The same on decimated swings alone, not fitted to the last digit.
fn found_roughly(
    rough: &Problem,
    beam: &[Fitted],
    candidates: &[&'static Effect<f64>],
    budget: &Budget,
) -> Vec<Fitted> {
    let extended = |model: &Fitted| {
        let least = if model.effects.is_empty() { 0.0 } else { PROMISING };
        extensions(rough, &model.evaluated(rough), candidates, least, budget)
    };
    // What swings beside the pendulum takes longest and imitates much, so that the others come first, and are looked at again:
    // most that explain the swings do so only then.
    let (swinging, others): (Vec<&Fitted>, Vec<&Fitted>) = beam.iter().partition(|model| swings(model));
    let level = looked_at_again(rough, others.into_iter().flat_map(extended).collect());
    let nearly_explains = |model: &Fitted| rough.chi_square(model.cost).left() != Left::Missing;
    if swinging.is_empty() || !budget.allows_more() || level.iter().any(nearly_explains) {
        return level;
    }
    looked_at_again(rough, level.into_iter().chain(swinging.into_iter().flat_map(extended)).collect())
}

/// Without a velocity band, is the stop level of the best model one that would stop the swings of another one elsewhere?
fn stops_elsewhere(best: &Fitted, model: &Fitted) -> bool {
    let (low, high) = model.level_range_nm;
    !(low..=high).contains(&best.stiction().level_nm)
}

/// A model with the stiction of another one, which may be a property of the bearing and no merit of its effect; what a
/// model was begun with may have imitated the effect.
fn with_the_stiction_of(rough: &Problem, stiction: Stiction, model: &Fitted) -> Fitted {
    model.evaluated(rough).better(model.with_stiction(stiction).refined(rough, Band::Held, Tolerance::LONG))
}

/// A few steps more for models that came within reach of the best, in their new order: the first fits end early; and along
/// their curved valley for those that are not at its end by then. Not for wider forms, which bend to what is missing: one that
/// led a real swing took the place of two laws that hold on every part of it.
fn looked_at_again(problem: &Problem, mut level: Vec<Fitted>) -> Vec<Fitted> {
    level.retain(|model| is_sound(problem, model));
    sort(&mut level);
    drop_doubles(&mut level);
    let lowest = level.first().map_or(0.0, |best| best.cost);
    let n_near = level.iter().take(MAX_LOOKED_AT).take_while(|model| model.cost < WORTH_A_LOOK * lowest).count();
    let looked_at = |model: &mut Fitted| {
        *model = model.refined(problem, Band::Held, Tolerance::ROUGH);
        let is_usual = model.effects.iter().all(|effect| effect.generalises.is_none());
        let is_on_its_way = matches!(model.termination, Some(Termination::LostPatience | Termination::LeftValley));
        if is_on_its_way && is_usual && !swings(model) {
            *model = model.refined(problem, Band::Held, Tolerance::LAST);
        }
    };
    on_all_cores(&mut level[..n_near], looked_at);
    sort(&mut level);
    level
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{effect, fitted, rig, simulated};
    use crate::fit::identify::problem_of;
    use crate::fit::problem::Point;
    use crate::fit::tally::Tally;
    use crate::swing::Swing;
    use shared::effect::Action;

    /// Models with these effects and costs, not fitted.
    fn models(of: &[(&[&str], f64)]) -> Vec<Fitted> {
        let count = Tally::default();
        let problem = problem_of(&[], &rig(), &count);
        let base = Fitted::at(&problem, &Point { values: problem.template_values(), starts: Vec::new() });
        let model = |(names, cost): &(&[&str], f64)| {
            let with = |model: Fitted, name: &&str| model.with(effect(name), &effect(name).starts[0]).unwrap();
            Fitted { cost: *cost, ..names.iter().fold(base.clone(), with) }
        };
        of.iter().map(model).collect()
    }

    #[test]
    fn the_best_two_models_are_gone_on_with_and_the_best_simple_one() {
        let names = |of: &[(&[&str], f64)]| kept(&models(of)).iter().map(Fitted::name).collect::<Vec<_>>();
        let (drag, law, spring, support) = ("quadratic-drag", "power-law-drag", "torsional-spring", "pivot-compliance");
        assert_eq!(names(&[(&[law], 1.0), (&[spring], 1.5), (&[drag], 1.9)]), [law, spring, drag]);
        // One that costs twice as much is not near.
        assert_eq!(names(&[(&[law], 1.0), (&[spring], 1.5), (&[drag], 2.1)]), [law, spring]);
        assert_eq!(names(&[(&[drag], 1.0), (&[law], 1.5), (&[spring], 1.6)]), [drag, law]);
        if Effect::<f64>::by_name(support).is_some_and(|support| matches!(support.action, Action::Support(_))) {
            assert_eq!(names(&[(&[support], 1.0), (&[drag], 5.0)]), [support, drag]);
        }
    }

    #[test]
    fn two_laws_that_nearly_explain_the_swings_may_be_one() {
        let swings = [simulated("one", &rig(), 12.0, 1)];
        let count = Tally::default();
        let problem = problem_of(&swings, &rig(), &count);
        let is_one = |names: &[&str], noises: f64| {
            may_be_one_law(&problem, &models(&[(names, noises.powi(2) * problem.noise_cost())])[0])
        };
        let (one, two) = (&["stribeck"][..], &["stribeck", "shear-thinning"][..]);
        let nearly = [1.02, 1.04, 1.06, 1.08, 1.1]
            .into_iter()
            .find(|noises| problem.chi_square(noises * noises * problem.noise_cost()).left() == Left::Nearly);
        assert!(is_one(two, 1.0) && is_one(two, nearly.unwrap()) && !is_one(two, 3.0) && !is_one(one, 1.0));
    }

    #[test]
    fn a_usual_form_has_a_law_for_each_of_the_other_model() {
        let (stribeck, wide, spring) = ("stribeck", "general-stribeck", "torsional-spring");
        let found = |usual: &[&str], model: &[&str]| {
            let both = models(&[(usual, 1.0), (model, 1.0)]);
            is_usual_form_of(&both[0], &both[1])
        };
        assert!(found(&[stribeck], &[wide]) && found(&[wide], &[wide]) && found(&[spring, stribeck], &[wide, spring]));
        assert!(!found(&[wide], &[stribeck]) && !found(&[spring], &[wide]) && !found(&[stribeck], &[wide, spring]));
    }

    /// Torque and speed of grease that thins depend on each other, and on the friction beside it.
    #[test]
    fn a_fit_that_left_its_curved_valley_is_led_to_its_end() {
        let (mut truth, law, count) = (rig(), effect("shear-thinning"), Tally::default());
        truth.set_friction(7e-4, 2.5e-4, 0.0, 0.0);
        truth.set(law.id, &[4e-4, 0.7]).unwrap();
        let swings = [simulated("long", &truth, 30.0, 1), simulated("short", &truth, 20.0, 2)];
        let problem = problem_of(&swings, &rig(), &count);
        let begun = fitted(&problem, &rig()).with(law, &[4e-4, 3.0, 0.0, 0.0]).unwrap();
        let mut model = begun.refined(&problem, Band::Held, Tolerance::ROUGH);
        while model.termination == Some(Termination::LostPatience) {
            model = model.refined(&problem, Band::Held, Tolerance::ROUGH);
        }
        assert_eq!(model.termination, Some(Termination::LeftValley));
        let speed = |model: &Fitted| model.parameters.values(law.id).unwrap()[1];
        let led = looked_at_again(&problem, vec![model.clone()]).swap_remove(0);
        assert!((speed(&led) - 0.7).abs() < 0.05, "{} {}", speed(&led), speed(&model));
    }

    /// A swing down to where a velocity band would hold it.
    fn with_stiction(level_nm: f64, velocity_band: f64) -> [Swing; 1] {
        let mut truth = rig();
        truth.set_friction(5e-4, 6e-3, level_nm, velocity_band);
        [simulated("band", &truth, 16.0, 6)]
    }

    #[test]
    fn a_velocity_band_is_promising_where_there_is_one() {
        let promises = |swings: [Swing; 1]| {
            let count = Tally::default();
            let problem = problem_of(&swings, &rig(), &count);
            let decimated = problem.decimated();
            let rough = problem.on(&decimated);
            let model = fitted(&problem, &rig()).refined(&rough, Band::Held, Tolerance::JUDGE);
            band_is_promising(&rough, &model)
        };
        assert!(promises(with_stiction(9e-3, 0.3)) && !promises(with_stiction(0.0, 0.0)));
    }

    #[test]
    fn a_model_that_leaves_much_gets_a_velocity_band_if_it_is_better_with_one() {
        let (swings, count) = (with_stiction(9e-3, 0.3), Tally::default());
        let problem = problem_of(&swings, &rig(), &count);
        let decimated = problem.decimated();
        let rough = problem.on(&decimated);
        let model = fitted(&problem, &rig()).refined(&rough, Band::Held, Tolerance::JUDGE);
        let (best, rest) = best_on_all(&problem, &rough, vec![model.clone()], &Budget::new(&count));
        assert!(rest.is_empty() && best[0].has_band() && !model.has_band());
        assert!(best[0].cost < 0.5 * model.evaluated(&problem).cost, "{} {}", best[0].cost, model.cost);
    }

    #[test]
    fn a_law_that_lacks_a_band_gets_one_before_another_with_more_numbers_stands_for_both() {
        let (swings, count) = (with_stiction(9e-3, 0.3), Tally::default());
        let problem = problem_of(&swings, &rig(), &count);
        let decimated = problem.decimated();
        let rough = problem.on(&decimated);
        let with = |name: &str, cost: f64| {
            let model = fitted(&problem, &rig()).with(effect(name), &effect(name).starts[0]).unwrap();
            Fitted { cost, ..model }
        };
        let (noise, lacking) = (problem.noise_cost(), with("torsional-spring", 1.02 * problem.noise_cost()));
        let banded = |mut level: Vec<Fitted>| {
            with_the_bands_they_lack(&problem, &rough, &mut level);
            level.iter().filter(|model| model.has_band()).map(Fitted::name).collect::<Vec<_>>()
        };
        let lowest = with("general-stribeck", 1.001 * noise);
        assert_eq!(banded(vec![lowest.clone(), lacking.clone()]), ["torsional-spring"]);
        // One with more numbers, one far from the noise, or where nothing explains the swings.
        let simple = with("quadratic-drag", 1.001 * noise);
        let far = Fitted { cost: 2.0 * noise, ..lacking.clone() };
        for level in [vec![simple, lacking], vec![lowest, far.clone()], vec![far]] {
            assert!(banded(level.clone()).is_empty(), "{level:?}");
        }
    }

    #[test]
    fn one_more_model_takes_the_place_of_a_worse_one_with_the_same_effects() {
        let [base, worse, other, better] =
            models(&[(&[], 9.0), (&["stribeck"], 5.0), (&["detent"], 4.0), (&["stribeck"], 1.0)]).try_into().unwrap();
        let mut found = Found { base, levels: vec![vec![other, worse]] };
        found.add(better);
        let level: Vec<(String, f64)> = found.levels[0].iter().map(|model| (model.name(), model.cost)).collect();
        assert_eq!(level, [("stribeck".to_owned(), 1.0), ("detent".to_owned(), 4.0)]);
    }
}
