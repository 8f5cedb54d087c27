//! From a base model to what may be claimed beside it, the steps of a diagnosis in their order.

use super::budget::Budget;
use super::curve::FrictionCurve;
use super::extension::grown;
use super::holds::{Holding, Standing};
use super::levels;
use super::models::is_explained;
use super::physical::is_sound;
use super::rests::Rests;
use super::search::{Found, search, without_band};
use super::summary::SpecialCase;
use super::verdict::{INDISTINGUISHABLE, Judge};
use super::widening::most_promising_wider_form;
use super::zero::{self, Zero};
use crate::cores::on_all_cores;
use crate::fit::fitted::Fitted;
use crate::fit::identify::{Carries, HeldOut};
use crate::fit::prediction::{Prediction, predictions};
use crate::fit::problem::Problem;
use crate::fit::refine::{levels as levels_of, on_all};
use crate::fit::short_memory::{ShortMemory, swings_in_what_is_left};
use crate::fit::tally::Tally;
use crate::swing::{Swing, Window};
use crate::verdict::Left;
use shared::effect::Effect;

/// What a diagnosis works on.
pub(super) struct Bench<'a, 'b> {
    pub(super) problem: &'b Problem<'a>,
    /// The same with decimated swings.
    pub(super) rough: &'b Problem<'b>,
    pub(super) candidates: &'b [&'static Effect<f64>],
    pub(super) budget: &'b Budget<'b>,
    pub(super) held_out: &'b [Swing],
    pub(super) count: &'b Tally,
}

/// What may be claimed beside a base model.
pub(super) struct Conclusion {
    pub(super) found: Found,
    pub(super) claimed: Fitted,
    pub(super) undecided: Vec<&'static str>,
    pub(super) vetoed: Vec<&'static str>,
    pub(super) unproven: Vec<Holding>,
    pub(super) holds_on: Vec<Holding>,
    pub(super) special_cases: Vec<SpecialCase>,
    pub(super) offset_is_missing: bool,
    /// Models beside those of the search.
    pub(super) others: Vec<Fitted>,
}

/// Of the claims that were dropped on the way those that stay so: what does not hold beside another law may be claimed in the
/// end without that.
pub(super) fn not_claimed(unproven: Vec<Holding>, claimed: &Fitted) -> Vec<Holding> {
    let stay = unproven.into_iter().filter(|holding| !claimed.has(holding.effect));
    stay.map(|holding| holding.beside_claimed(claimed)).collect()
}

/// Did what remains of a claim explain the swings together with a law that is too slight to be claimed? Then what it leaves is
/// that law's, and speaks for no other one in its place.
fn is_rest_of_explained(problem: &Problem, dropped: &Holding) -> bool {
    let cost = dropped.rmse.powi(2) * problem.n_samples(Window::Whole) as f64;
    dropped.standing == Standing::Slight && problem.chi_square(cost).left() == Left::Noise
}

impl<'a, 'b> Bench<'a, 'b> {
    /// Who decides from what a search found.
    pub(super) fn judge<'c>(&'c self, found: &'c Found) -> Judge<'a, 'c>
    where
        'b: 'c,
    {
        let Self { problem, rough, candidates, budget, .. } = *self;
        Judge { problem, rough, found, candidates, budget, rests: Rests::default() }
    }

    /// Every effect is tried beside a base model, and judged.
    pub(super) fn concluded(&self, base: &Fitted) -> Conclusion {
        let Self { problem, rough, candidates, budget, .. } = *self;
        let first = self.judged(search(problem, rough, base, candidates, budget));
        let is_open = first.claimed.effects.is_empty() && !is_explained(problem, &first.claimed);
        if !is_open || !budget.allows_more() {
            return first;
        }
        let bare = without_band(problem, base);
        let tried = first.found.levels.first().map_or(&[][..], |level| level);
        let Some(wider) = most_promising_wider_form(problem, rough, &bare, candidates, tried) else { return first };
        let mut found = Found { levels: first.found.levels.into_iter().take(1).collect(), ..first.found };
        found.add(wider);
        self.judged(found)
    }

    /// What a search found, judged.
    fn judged(&self, found: Found) -> Conclusion {
        let problem = self.problem;
        let judge = self.judge(&found);
        let (claimed, mut others) = judge.refined(judge.claimed());
        let (claimed, wider) = judge.in_usual_forms(claimed);
        others.extend(wider);
        let mut undecided = judge.undecided(&claimed, &others);
        let n_claimed = claimed.effects.len();
        let Zero { model, mut offset_is_missing, alike } =
            zero::decide(problem, claimed, INDISTINGUISHABLE * judge.unit());
        // What the asymmetry explains, another effect may have imitated.
        let resembling = zero::resembling().map(|rival| rival.name);
        let claimed = if model.effects.len() > n_claimed { judge.pruned_but(model, resembling) } else { model };
        let before = claimed.names();
        let sure = judge.beyond_their_errors(claimed.clone());
        let vague = judge.vague_claims(&claimed, &sure);
        let (mut claimed, mut unproven, mut holds_on) = judge.holding(sure);
        let is_rest = unproven.iter().any(|holding| is_rest_of_explained(problem, holding));
        unproven.extend(vague);
        if problem.chi_square(claimed.cost).left() != Left::Noise && !is_rest {
            (claimed, holds_on) = judge.simpler(&claimed, &others).unwrap_or((claimed, holds_on));
        }
        if claimed.names() != before {
            undecided = judge.undecided(&claimed, &others);
            // A zero that showed beside a law may not show without it.
            offset_is_missing = offset_is_missing && zero::is_missing(problem, &claimed);
        }
        undecided.extend(alike.filter(|_| offset_is_missing));
        let in_time = self.changing_in_time(&judge, &claimed);
        let as_good = judge.undecided(&claimed, &in_time);
        undecided.extend(as_good.into_iter().filter(|name| !undecided.contains(name)).collect::<Vec<_>>());
        others.extend(in_time);
        if problem.chi_square(claimed.cost).left() != Left::Noise {
            let alike = judge.not_separated(&claimed, &others);
            undecided.extend(alike.into_iter().filter(|name| !undecided.contains(name)).collect::<Vec<_>>());
        }
        let special_cases = judge.special_cases(&claimed, &others, &mut undecided);
        let (claimed, vetoed) = judge.not_contradicted(claimed, self.held_out, self.count);
        holds_on.retain(|holding| claimed.has(holding.effect));
        offset_is_missing = offset_is_missing && (vetoed.is_empty() || zero::is_missing(problem, &claimed));
        let settled = claimed.clone().settled(problem);
        let settled = if is_sound(problem, &settled) { settled } else { claimed };
        let names = settled.names();
        let mut claimed = judge.beyond_their_errors(settled);
        if claimed.names() != names {
            let vague = holds_on.into_iter().filter(|holding| !claimed.has(holding.effect));
            unproven.extend(vague.map(|holding| Holding { standing: Standing::Vague, ..holding }));
            let dropped;
            (claimed, dropped, holds_on) = judge.holding(claimed);
            unproven.extend(dropped);
            undecided = judge.not_separated(&claimed, &others);
            offset_is_missing = offset_is_missing && zero::is_missing(problem, &claimed);
        }
        let unproven = not_claimed(unproven, &claimed);
        let holds_on = holds_on.into_iter().map(|holding| holding.beside_claimed(&claimed)).collect();
        Conclusion { found, claimed, undecided, vetoed, unproven, holds_on, special_cases, offset_is_missing, others }
    }

    /// The same with friction levels that differ, where they are worth it and the held-out swings allow it.
    pub(super) fn with_levels_that_carry(&self, base: &Fitted, alone: Conclusion) -> Conclusion {
        let levelled = self.with_levels(base, &alone);
        self.unless_refuted(base, alone, levelled)
    }

    /// A held-out release has a level of its own that nobody knows, so that its error may rise with levels that are right. Where
    /// more than noise is left even with levels, and the model that the releases share predicts it worse, they imitate what is
    /// missing.
    fn unless_refuted(&self, base: &Fitted, alone: Conclusion, levelled: Option<Conclusion>) -> Conclusion {
        let Some(levelled) = levelled else { return alone };
        let error = |model: &Fitted| HeldOut::of(self.held_out, &model.parameters, self.count);
        let rises = || match (error(&levelled.claimed), error(base)) {
            (Some(after), Some(before)) => after.after(&before) == Carries::Contradicted,
            _ => false,
        };
        let is_missing = self.problem.chi_square(levelled.claimed.cost).left() == Left::Missing;
        if is_missing && rises() {
            let vetoed = [alone.vetoed, vec![levels::STEP]].concat();
            return Conclusion { vetoed, ..alone };
        }
        levelled
    }

    /// The swings in the noise that the best model leaves, where that is one whose neighbours are alike: then what was concluded
    /// stands on too little noise.
    pub(super) fn swings_in_what_is_left(&self, concluded: &Conclusion) -> Option<(Vec<Swing>, ShortMemory)> {
        if self.problem.chi_square(concluded.claimed.cost).left() == Left::Noise {
            return None;
        }
        let judge = self.judge(&concluded.found);
        let best = concluded.found.levels.iter().flatten().chain([&concluded.claimed]);
        let best = best.min_by(|a, b| judge.criterion(a).total_cmp(&judge.criterion(b)))?;
        swings_in_what_is_left(self.problem, best)
    }

    /// Friction left free, where no named model reaches the noise. If the law that it resembles is fitted far better from
    /// there than the search had it, all is judged once more with that.
    pub(super) fn with_curve(&self, concluded: Conclusion) -> (Conclusion, Option<FrictionCurve>) {
        let judge = self.judge(&concluded.found);
        let curve = judge.friction_curve(&concluded.claimed);
        let Some(law) = curve.as_ref().and_then(|curve| judge.law_of(curve)) else { return (concluded, curve) };
        let mut found = concluded.found;
        found.add(law);
        let again = self.judged(found);
        let curve = self.judge(&again.found).friction_curve(&again.claimed);
        (again, curve)
    }

    /// What one release can't tell from a law of speed or angle, in place of what is claimed: it does as well, or it is none.
    fn changing_in_time(&self, judge: &Judge, claimed: &Fitted) -> Vec<Fitted> {
        if self.problem.swings.len() > 1 {
            return Vec::new();
        }
        let laws: Vec<_> = Effect::usual().filter(|effect| effect.rules.needs_several_releases).collect();
        let in_place_of = |effect: &&'static Effect<f64>| {
            let rest = judge.without(claimed, effect.id).swap_remove(0);
            // A fit from the whole swing easily ends in a side valley.
            let fitted = |prediction: &Prediction| grown(self.rough, &prediction.fitted(self.rough));
            let all = on_all_cores(&predictions(self.rough, &rest, &laws), fitted);
            let best = all.into_iter().min_by(|a, b| a.cost.total_cmp(&b.cost))?;
            Some(on_all(self.problem, &levels_of(self.rough, &best)))
        };
        let others = claimed.effects.iter().filter_map(in_place_of);
        others.filter(|other| is_sound(self.problem, other)).collect()
    }

    /// The same with friction levels that differ between the releases, where they explain most of what is left without
    /// them. One effect that explains the swings comes first, friction that changes with time alone only where it leaves less.
    /// The levels alone are one fit, whatever the search has taken.
    pub(super) fn with_levels(&self, base: &Fitted, alone: &Conclusion) -> Option<Conclusion> {
        let (problem, claimed) = (self.problem, &alone.claimed);
        let is_told = is_explained(problem, claimed) && claimed.effects.len() < 2 && !levels::is_drift_alone(claimed);
        if is_told || !levels::may_differ(problem) {
            return None;
        }
        let levelled = levels::fitted(problem, base);
        let are_worth_it = |model: &Fitted| levels::are_worth_it(problem, claimed, model);
        // Levels may show only once the effect beside them is in the model, and the effect only once levels are.
        let beside = [claimed, alone.found.best(alone.found.levels.len().min(1))];
        let may_be_tried = !is_explained(problem, claimed) && self.budget.allows_more();
        let beside = beside.into_iter().filter(|model| !model.effects.is_empty() && may_be_tried);
        let mut beside = beside.map(|model| levels::fitted(problem, model));
        let promise = are_worth_it(&levelled) || beside.any(|model| are_worth_it(&model));
        let other = promise.then(|| self.concluded(&levelled))?;
        levels::are_worth_it(problem, claimed, &other.claimed).then_some(other)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{rig, simulated};
    use crate::fit::by_least_squares::fitted_as_it_is;
    use crate::fit::identify::problem_of;
    use shared::parameters::base::COULOMB;

    #[test]
    fn friction_levels_are_asked_for_when_the_search_has_taken_all_it_may() {
        let of_level = |(i, share): (u64, f64)| {
            let mut other = rig();
            let coulomb_nm = rig().values(COULOMB).unwrap()[0];
            other.set(COULOMB, &[share * coulomb_nm]).unwrap();
            simulated(&format!("{i}"), &other, 14.0, i)
        };
        let swings = [(1, 0.8), (2, 1.0), (3, 1.2)].map(of_level);
        let count = Tally::default();
        let problem = problem_of(&swings, &rig(), &count);
        let (decimated, budget) = (problem.decimated(), Budget::new(&count));
        let rough = problem.on(&decimated);
        let bench =
            Bench { problem: &problem, rough: &rough, candidates: &[], budget: &budget, held_out: &[], count: &count };
        let base = fitted_as_it_is(&problem);
        count.add(&rig(), 4, 1_000_000_000);
        assert!(!budget.allows_more());
        let alone = bench.concluded(&base);
        let levelled = bench.with_levels(&base, &alone).expect("levels that differ").claimed;
        assert!(is_explained(&problem, &levelled) && !is_explained(&problem, &alone.claimed));
    }

    #[test]
    fn what_remains_beside_a_slight_law_is_the_rest_only_where_both_explain_the_swings() {
        let swings = [simulated("one", &rig(), 8.0, 1)];
        let count = Tally::default();
        let problem = problem_of(&swings, &rig(), &count);
        let is_rest = |standing: Standing, noises: f64| {
            let rmse = noises * problem.noise_rad();
            let (p, p_without_two, value, std) = (None, None, None, None);
            let (beside, parts) = (Vec::new(), Vec::new());
            let dropped = Holding {
                effect: "stribeck",
                standing,
                windows: 20,
                rmse,
                beside,
                p,
                p_without_two,
                value,
                std,
                parts,
            };
            is_rest_of_explained(&problem, &dropped)
        };
        assert!(is_rest(Standing::Slight, 1.0));
        assert!(!is_rest(Standing::Slight, 3.0) && !is_rest(Standing::Partly, 1.0));
    }

    /// As levels that imitate another law: the model that the releases share is far from that of any of them.
    #[test]
    fn levels_that_leave_more_than_noise_are_not_told_where_held_out_swings_contradict_them() {
        let (swings, held_out) = ([simulated("one", &rig(), 14.0, 1)], [simulated("other", &rig(), 8.0, 2)]);
        let count = Tally::default();
        let problem = problem_of(&swings, &rig(), &count);
        let (decimated, budget) = (problem.decimated(), Budget::new(&count));
        let rough = problem.on(&decimated);
        let (problem, rough, budget, candidates) = (&problem, &rough, &budget, &[]);
        let base = fitted_as_it_is(problem);
        let mut far = base.parameters.clone();
        far.set(COULOMB, &[3.0 * rig().values(COULOMB).unwrap()[0]]).unwrap();
        let told = |n_held_out: usize, cost: f64| {
            let held_out = &held_out[..n_held_out];
            let bench = Bench { problem, rough, candidates, budget, held_out, count: &count };
            let claimed = Fitted { parameters: far.clone(), cost, ..base.clone() };
            let levelled = Conclusion { claimed, ..bench.concluded(&base) };
            let told = bench.unless_refuted(&base, bench.concluded(&base), Some(levelled));
            (told.claimed.parameters.values(COULOMB) == far.values(COULOMB), told.vetoed)
        };
        assert_eq!(told(1, 4.0 * base.cost), (false, vec![levels::STEP]));
        // Levels that reach the noise need no held-out release, whose own level may be far from the mean.
        assert_eq!(told(1, base.cost), (true, Vec::new()));
        assert_eq!(told(0, 4.0 * base.cost), (true, Vec::new()));
    }
}
