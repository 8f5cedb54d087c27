//! Wider laws before second effects: a law that was found may have another shape than the usual one, and what that leaves
//! is easily taken for an effect that is not there.

use super::extension::grown;
use super::models::{NEAR, PROMISING, is_explained, near_the_best};
use super::physical::is_sound;
use super::strength::is_as_strong_as_can_be;
use crate::cores::on_all_cores;
use crate::fit::added;
use crate::fit::closer::reach_rad;
use crate::fit::descent::Tolerance;
use crate::fit::fitted::Fitted;
use crate::fit::prediction::{Prediction, predictions};
use crate::fit::problem::Problem;
use crate::fit::refine::{Band, levels};
use crate::fit::stiction::FAR_FROM_NOISE;
use shared::effect::{Effect, MAX_VALUES, Pattern};
use std::f64::consts::TAU;

/// The models of a sorted level that come near the best, each of their laws in its wider form where there is one, fitted
/// on decimated swings; and in its usual form again, where the way through the wider one led to a better minimum. None
/// where the best leaves no more than the noise.
pub(super) fn widened(rough: &Problem, level: &[Fitted]) -> Vec<Fitted> {
    let Some(best) = level.first() else { return Vec::new() };
    let is_told = is_explained(rough, best);
    if is_told && !repeats_unseen(rough, best) {
        return Vec::new();
    }
    let is_asked = |widening: &Widening| !is_told || widening.usual.rules.relaxes_at.is_some();
    let all: Vec<Widening> = near_the_best(level).iter().flat_map(widenings).filter(is_asked).collect();
    let fitted = on_all_cores(&all, |widening| widening.fitted(rough));
    fitted.into_iter().flatten().flatten().filter(|model| is_sound(rough, model)).collect()
}

/// The models of a sorted level that come near the best, each law with a special case that was not fitted in that form: it may
/// have promised too little beside a wrong stop level. Wider forms that follow their usual one were begun from it.
pub(super) fn narrowed(rough: &Problem, level: &[Fitted]) -> Vec<Fitted> {
    let is_lacking = |model: &Fitted, wide: &Effect<f64>| {
        let others = || model.effects.iter().filter(|other| other.id != wide.id);
        let is_it = |known: &Fitted, usual: &str| known.has(usual) && others().all(|other| known.has(other.name));
        let special = wide.generalises.filter(|_| !wide.rules.follows_special_case);
        special.is_some_and(|usual| !level.iter().any(|known| is_it(known, usual)))
    };
    let of_model = |model: &Fitted| -> Vec<Fitted> {
        let lacking = model.effects.iter().copied().filter(|wide| is_lacking(model, wide));
        lacking.filter_map(|wide| in_usual_form(rough, model, wide)).collect()
    };
    let narrow = on_all_cores(near_the_best(level), of_model);
    narrow.into_iter().flatten().filter(|model| is_sound(rough, model)).collect()
}

/// Models of a level with a law in its wider form that cost more than the same with its special case, begun anew from the
/// numbers of that: from its own starts a wider law may end in a side valley, and would be told as one that explains less. Those
/// that follow their special case were begun from it.
pub(super) fn begun_from_special_cases(rough: &Problem, level: &[Fitted]) -> Vec<Fitted> {
    let begun = at_special_cases(level, level, |wide| !wide.rules.follows_special_case);
    let begun = on_all_cores(&begun, |model| model.refined(rough, Band::Held, Tolerance::SCREEN));
    begun.into_iter().filter(|model| is_sound(rough, model)).collect()
}

/// The same of those that follow their special case, on all samples, where that is near the best: it may have come further since
/// they were begun from it.
pub(super) fn begun_from_last_digits(problem: &Problem, level: &[Fitted]) -> Vec<Fitted> {
    let begun = at_special_cases(level, near_the_best(level), |wide| wide.rules.follows_special_case);
    let begun = on_all_cores(&begun, |model| model.refined(problem, Band::Free, Tolerance::JUDGE));
    begun.into_iter().filter(|model| is_sound(problem, model)).collect()
}

/// Models of a level that cost more than the same with the special case of a law, with the numbers of that.
fn at_special_cases(level: &[Fitted], special_cases: &[Fitted], is_asked: fn(&Effect<f64>) -> bool) -> Vec<Fitted> {
    let of_law = |model: &Fitted, wide: &'static Effect<f64>| -> Option<Fitted> {
        let (at, value) = wide.rules.special_case_at.filter(|_| is_asked(wide))?;
        let special = Effect::by_name(wide.generalises?).filter(|special| !model.has(special.name))?;
        let is_it = |known: &&Fitted| {
            known.effects.len() == model.effects.len()
                && known.has(special.name)
                && model.effects.iter().all(|other| other.id == wide.id || known.has(other.name))
        };
        let best = special_cases.iter().filter(is_it).min_by(|a, b| a.cost.total_cmp(&b.cost))?;
        let mut values = wide.starts[0];
        values[usize::from(at)] = value;
        exchanged(best, special, wide, values).filter(|_| best.cost < model.cost)
    };
    level.iter().flat_map(|model| model.effects.iter().filter_map(move |wide| of_law(model, wide))).collect()
}

/// A model whose error is this share of the motion is late by up to a sixth of a radian in the end, where first-order answers err
/// by a tenth. A spring that hardens, before a gyroscope, is found only so, at 0.22; with none, another pair of laws was missed
/// for the time it takes. Half and twice were not tried.
const LOST_SHARE: f64 = 0.1;

/// Has a model a torque that repeats along the way, of which the swings pass less than a period? Then nobody has seen it repeat, and
/// a spring that grows stiffer or softer has the same shape.
fn repeats_unseen(problem: &Problem, model: &Fitted) -> bool {
    let amplitude_rad = reach_rad(problem);
    model.effects.iter().any(|effect| {
        let Some(Pattern::Periods(index)) = effect.rules.pattern else { return false };
        let n_a_turn = model.parameters.values(effect.id).map_or(0.0, |values| values[usize::from(index)]);
        2.0 * amplitude_rad * n_a_turn < TAU
    })
}

/// A law of a model, and its wider form.
struct Widening<'a> {
    model: &'a Fitted,
    usual: &'static Effect<f64>,
    wide: &'static Effect<f64>,
}

fn widenings(model: &Fitted) -> impl Iterator<Item = Widening<'_>> {
    model.effects.iter().filter_map(move |usual| Some(Widening { model, usual, wide: usual.wider_form()? }))
}

impl Widening<'_> {
    /// From the numbers of the usual law and from each start of what the wider one has beyond them the best.
    fn wide(&self, rough: &Problem) -> Option<Fitted> {
        let from_usual = self.wide.starts.iter().filter_map(|start| {
            let wide = exchanged(self.model, self.usual, self.wide, *start)?;
            Some(wide.refined(rough, Band::Held, Tolerance::SCREEN))
        });
        let mut fits: Vec<Fitted> = from_usual.collect();
        if !fits.iter().any(|wide| is_explained(rough, wide)) {
            fits.extend(self.anew(rough));
        }
        let best = fits.into_iter().min_by(|a, b| a.cost.total_cmp(&b.cost))?;
        Some(levels(rough, &best).swap_remove(0))
    }

    /// Begun as if the usual law had never been tried, where that is as strong as it can be, or what it was added to had lost the
    /// swings: then its numbers mean nothing, nor do those beside it.
    fn anew(&self, rough: &Problem) -> Vec<Fitted> {
        let rest = self.model.without(self.usual.id).refined(rough, Band::Held, Tolerance::SCREEN);
        if rough.share_of_motion(rest.cost) < LOST_SHARE && !is_as_strong_as_can_be(self.model, self.usual) {
            return Vec::new();
        }
        let fitted = |prediction: &Prediction| prediction.fitted(rough).better(prediction.grown(rough));
        predictions(rough, &grown(rough, &rest), &[self.wide]).iter().map(fitted).collect()
    }

    /// The same, and the usual law from there if that is better than it was.
    fn fitted(&self, rough: &Problem) -> Option<Vec<Fitted>> {
        let mut found = vec![self.wide(rough)?];
        let narrow = in_usual_form(rough, &found[0], self.wide)?;
        found.extend((narrow.cost < self.model.cost).then_some(narrow));
        Some(found)
    }
}

/// Where only two laws together explain the swings: one of them in its wider form in place of both, if that explains them too.
/// A law whose exponent is another one leaves more than others that are not there, so that it was not widened yet.
pub(super) fn alone_in_wider_form(
    problem: &Problem,
    rough: &Problem,
    bare: &Fitted,
    pair: &Fitted,
    tried: &[Fitted],
) -> Option<Fitted> {
    let is_tried = |wide: &Effect<f64>| tried.iter().any(|model| model.has(wide.name));
    let wide = pair.effects.iter().filter_map(|law| law.wider_form()).find(|wide| !is_tried(wide))?;
    explained_by(problem, rough, bare, wide)
}

/// The law in its wider form that promises most, where no law that was tried may be claimed: alone, if that explains the swings. Far
/// from its usual form nothing leads to it, as to a disc brake of which the swings pass the falling part.
pub(super) fn most_promising_wider_form(
    problem: &Problem,
    rough: &Problem,
    bare: &Fitted,
    candidates: &[&'static Effect<f64>],
    tried: &[Fitted],
) -> Option<Fitted> {
    let is_tried = |wide: &&'static Effect<f64>| tried.iter().any(|model| model.has(wide.name));
    let wide: Vec<_> = candidates.iter().filter_map(|law| law.wider_form()).filter(|wide| !is_tried(wide)).collect();
    let bare = bare.evaluated(rough);
    let best = predictions(rough, &bare, &wide).into_iter().next()?;
    let is_promising = best.reduction > PROMISING * (bare.cost - rough.noise_cost());
    is_promising.then(|| explained_by(problem, rough, &bare, best.effect)).flatten()
}

/// A model with one more law, if that explains the swings. An exponent on its bound is no finding yet: there a fit creeps along a
/// valley that is not the truth's, which another start may lead into.
fn explained_by(problem: &Problem, rough: &Problem, bare: &Fitted, wide: &'static Effect<f64>) -> Option<Fitted> {
    let begun = added::begun(rough, bare, wide)?;
    if begun.cost > FAR_FROM_NOISE * rough.noise_cost() {
        return None;
    }
    let finished = |model: &Fitted| {
        model.refined(rough, Band::Searched, Tolerance::JUDGE).refined(problem, Band::Free, Tolerance::JUDGE)
    };
    let mut best = finished(&begun);
    if added::is_at_an_end(&best, wide) {
        let led = |start: &Prediction| start.fitted(rough).refined(rough, Band::Held, Tolerance::LAST);
        let all = on_all_cores(&predictions(rough, &bare.evaluated(rough), &[wide]), led);
        let within = all.into_iter().filter(|other| !added::is_at_an_end(other, wide));
        best =
            within.min_by(|a, b| a.cost.total_cmp(&b.cost)).map_or(best.clone(), |other| finished(&other).better(best));
    }
    (is_explained(problem, &best) && is_sound(problem, &best)).then_some(best)
}

/// Where pairs of laws explain the swings: a law alone, if it does so too with the numbers that it has beside one that does
/// next to nothing. Alone it may have ended on its way there.
pub(super) fn alone_beside_nothing(problem: &Problem, rough: &Problem, pairs: &[Fitted]) -> Option<Fitted> {
    let alone = |pair: &Fitted| -> Vec<Fitted> {
        let limit = NEAR * pair.evaluated(rough).cost;
        let rests = pair.effects.iter().map(|law| pair.without(law.id));
        rests.filter(|rest| rest.evaluated(rough).cost < limit).collect()
    };
    let all: Vec<Fitted> = pairs.iter().filter(|pair| is_explained(problem, pair)).flat_map(alone).collect();
    let fitted = on_all_cores(&all, |rest| rest.refined(problem, Band::Free, Tolerance::JUDGE));
    let explaining = fitted.into_iter().filter(|law| is_explained(problem, law) && is_sound(problem, law));
    explaining.min_by(|a, b| a.cost.total_cmp(&b.cost))
}

/// A model with each of its laws in its wider form, fitted on decimated swings.
pub(super) fn in_wider_forms(rough: &Problem, model: &Fitted) -> Vec<Fitted> {
    let all: Vec<Widening> = widenings(model).collect();
    on_all_cores(&all, |widening| widening.wide(rough)).into_iter().flatten().collect()
}

/// A model with a law in its usual form in place of the wider one, fitted; `None` where it is no wider form, or the usual one
/// is there too.
pub(super) fn in_usual_form(on: &Problem, model: &Fitted, wide: &'static Effect<f64>) -> Option<Fitted> {
    let usual = Effect::by_name(wide.generalises?).filter(|usual| !model.has(usual.name))?;
    let narrow = exchanged(model, wide, usual, [0.0; MAX_VALUES])?;
    Some(narrow.refined(on, Band::Held, Tolerance::SCREEN))
}

/// A model with another law in place of one of its own, not fitted yet: with the numbers of that one, and `values` beyond
/// them.
pub(super) fn exchanged(
    model: &Fitted,
    own: &Effect<f64>,
    other: &'static Effect<f64>,
    mut values: [f64; MAX_VALUES],
) -> Option<Fitted> {
    values.iter_mut().zip(model.parameters.values(own.id)?).for_each(|(value, own)| *value = *own);
    model.without(own.id).with(other, &values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{effect, fitted, rig, simulated};
    use crate::fit::by_least_squares::fitted_as_it_is;
    use crate::fit::identify::problem_of;
    use crate::fit::own_swing::swing;
    use crate::fit::tally::Tally;
    use shared::parameters::Parameters;

    /// What is told of drag and gears that explain a swing together; and with the wider gears tried before.
    fn alone(truth: &Parameters<f64>) -> [Option<Vec<&'static str>>; 2] {
        let (swings, count) = ([simulated("gears", truth, 20.0, 7)], Tally::default());
        let problem = problem_of(&swings, &rig(), &count);
        let decimated = problem.decimated();
        let rough = problem.on(&decimated);
        let bare = fitted(&problem, &rig());
        let with = |name: &str| bare.with(effect(name), &effect(name).starts[0]).unwrap();
        let pair = with("stribeck").with(effect("gear-load"), &effect("gear-load").starts[0]).unwrap();
        let told = |tried: &[Fitted]| alone_in_wider_form(&problem, &rough, &bare, &pair, tried).map(|it| it.names());
        let stribeck = with("general-stribeck");
        [told(std::slice::from_ref(&stribeck)), told(&[stribeck, with("general-gear-load")])]
    }

    #[test]
    fn gears_of_another_exponent_are_told_in_place_of_gears_and_another_law() {
        let mut truth = rig();
        truth.set(effect("general-gear-load").id, &[0.02, 1.6, 0.3]).unwrap();
        assert_eq!(alone(&truth), [Some(vec!["general-gear-load"]), None]);
    }

    /// What is told of drag and gears, of which the gears are as strong as given.
    fn beside(gears: f64) -> Option<Vec<&'static str>> {
        let mut truth = rig();
        truth.set(effect("quadratic-drag").id, &[3e-4]).unwrap();
        truth.set(effect("gear-load").id, &[gears]).unwrap();
        let (swings, count) = ([simulated("drag", &truth, 20.0, 7)], Tally::default());
        let problem = problem_of(&swings, &rig(), &count);
        let decimated = problem.decimated();
        let pair = fitted(&problem, &truth);
        assert_eq!(pair.names(), ["quadratic-drag", "gear-load"]);
        alone_beside_nothing(&problem, &problem.on(&decimated), &[pair]).map(|it| it.names())
    }

    #[test]
    fn a_law_that_explains_the_swings_beside_one_that_does_nothing_is_told_alone() {
        assert_eq!(beside(0.0), Some(vec!["quadratic-drag"]));
        assert_eq!(beside(0.02), None);
    }

    #[test]
    fn a_wider_law_ends_no_higher_than_its_special_case() {
        let mut truth = rig();
        let (usual, wide) = (effect("shear-thinning"), effect("general-thinning"));
        truth.set(usual.id, &[4e-4, 1.0]).unwrap();
        let (swings, count) = ([simulated("grease", &truth, 20.0, 7)], Tally::default());
        let problem = problem_of(&swings, &rig(), &count);
        let special = fitted(&problem, &truth);
        let astray = special.without(usual.id).with(wide, &[4e-4, 3.0, 1.2]).unwrap().evaluated(&problem);
        let level = [special.clone(), astray];
        assert!(level[1].cost > level[0].cost && is_explained(&problem, &special));
        let begun = begun_from_last_digits(&problem, &level);
        assert!(begun.len() == 1 && begun[0].has("general-thinning") && begun[0].cost <= special.cost, "{begun:?}");
        assert!(begun_from_last_digits(&problem, &[special, begun[0].clone()]).is_empty());
    }

    #[test]
    fn two_laws_that_no_wider_form_stands_for_stay() {
        let mut truth = rig();
        truth.set(effect("gear-load").id, &[0.02]).unwrap();
        truth.set(effect("torsional-spring").id, &[0.02, 0.1]).unwrap();
        assert_eq!(alone(&truth), [None, None]);
    }

    /// Beyond its critical speed a disc brakes the less the faster it turns, which grease that thins never does.
    #[test]
    fn a_disc_brake_is_found_from_no_law_in_its_usual_form() {
        let disc = |_: f64, velocity: f64| -2.0 * 4e-3 * 3.0 * velocity / (9.0 + velocity * velocity);
        let (swings, count) = ([2.6, 1.6].map(|release_rad| swing(release_rad, disc)), Tally::default());
        let problem = problem_of(&swings, &rig(), &count);
        let decimated = problem.decimated();
        let rough = problem.on(&decimated);
        let bare = fitted_as_it_is(&problem);
        let laws = ["shear-thinning", "stribeck", "eddy-brake"].map(effect);
        let found = |tried: &[Fitted]| most_promising_wider_form(&problem, &rough, &bare, &laws, tried);
        let disc = found(&[]).unwrap();
        assert!(disc.has("general-thinning") && is_explained(&problem, &disc));
        // What was tried is not tried again, and nothing else explains them.
        assert!(found(&[disc]).is_none());
    }

    /// Half a notch has the shape of a spring that grows softer.
    #[test]
    fn a_spring_in_its_wider_form_is_asked_where_nobody_saw_a_notch_repeat() {
        let spring = |angle: f64, _: f64| -0.015 * ((angle - 0.1) - 0.12 * (angle - 0.1).powi(3));
        let swings = [swing(1.5, spring), swing(0.8, spring), swing(-1.1, spring)];
        let count = Tally::default();
        let problem = problem_of(&swings, &rig(), &count);
        let bare = fitted(&problem, &rig());
        let of = |name: &str, values: &[f64]| {
            bare.with(effect(name), values).unwrap().refined(&problem, Band::Held, Tolerance::JUDGE)
        };
        let (notch, usual) = (of("detent", &[1e-3, 0.0, 1.7]), of("torsional-spring", &[0.015, 0.1]));
        let asked = |level: &[Fitted]| widened(&problem, level).iter().any(|model| model.has("general-spring"));
        assert!(asked(&[notch.clone(), usual.clone()]));
        let mut many = notch;
        many.parameters.set(effect("detent").id, &[1e-3, 0.0, 12.0]).unwrap();
        assert!(!asked(&[many, usual]));
    }
}
