//! A diagnosis as others read it, put together from what may be claimed.

use super::budget::Effort;
use super::curve::FrictionCurve;
use super::evidence::{Evidence, evidence};
use super::formulas::{Found as FoundFormula, OFFERED, formulas};
use super::holds::{Holding, Standing};
use super::levels::{Levels, STEP, levels};
use super::models::excess;
use super::of_state::OfState;
use super::ties::{FamilyClaim, family};
use super::value::{Candidate, Value};
use super::verdict::Judge;
use super::zero;
use crate::cores::on_all_cores;
use crate::fit::apart::apart_rmse;
use crate::fit::fitted::Fitted;
use crate::fit::identify::{Carries, held_out_rmse};
use crate::fit::problem::Problem;
use crate::fit::short_memory::ShortMemory;
use crate::fit::tally::Tally;
use crate::fit::touch::Touch;
use crate::look::{Look, of_reason};
use crate::recording::Measured;
use crate::swing::{Swing, Window};
use crate::verdict::{Left, hardly_follows};
use serde::Serialize;
use shared::bank::findings::Reason;
use shared::effect::{CUSTOM_FORMULA_NAME, Effect};
use shared::parameters::Parameters;
use std::time::Instant;

/// A formula for what no candidate explains.
#[derive(Clone, Debug, Serialize)]
pub struct Suggestion {
    /// The torque with its numbers, N·m: `-3.1e-5·|ω|^2.3·sgn ω`.
    pub words: String,
    /// The law as `--effect` takes it.
    pub formula: String,
    /// Root mean square error with it, rad.
    pub rmse: f64,
    /// What is left with it.
    pub left: Left,
    /// On held-out swings, rad.
    pub held_out: Option<f64>,
    /// Share of the excess over the noise (as a variance) that it removes.
    pub removed: f64,
    /// As of a candidate, with a penalty for length.
    pub criterion: f64,
    /// Its numbers.
    pub parameters: Vec<Value>,
    /// Effects of the verdict that it stands beside; it may explain more without them.
    pub beside: Vec<&'static str>,
    /// Largest angle it was seen at, rad.
    pub within_rad: f64,
}

/// A law that contains another one, and its number that says so.
#[derive(Clone, Debug, Serialize)]
pub struct SpecialCase {
    /// The wider law.
    pub effect: &'static str,
    /// Its number that decides.
    pub symbol: &'static str,
    /// As fitted.
    pub value: f64,
    /// Its standard deviation.
    pub std: f64,
    /// The law that it is.
    pub special: &'static str,
}

/// An effect that was left out of the search.
#[derive(Clone, Debug, Serialize)]
pub struct NotTried {
    /// The effect.
    pub effect: &'static str,
    /// Why.
    pub reason: String,
}

/// What is missing.
#[derive(Clone, Debug, Serialize)]
pub struct Diagnosis {
    /// Version of this record.
    pub version: u32,
    /// What the recordings hold; of rates, errors are in rad/s.
    pub measured: Measured,
    /// What a rig would say of these swings, which looks with the base model; `None` where the readings are rates or not
    /// even in time.
    pub first_look: Option<Look>,
    /// Recordings whose swings don't become smaller: something drives them, and no verdict on them means anything.
    pub driven: Vec<String>,
    /// What touched the pendulum on its way. All that is told is of the longest part of each swing that nothing touched.
    pub touches: Vec<Touch>,
    /// Present if the noise was told by what a model leaves.
    pub short_memory: Option<ShortMemory>,
    /// Does the model that is told follow the swings at all? If not, whatever is said of it means nothing.
    pub follows: bool,
    /// Is so much of the motion left, beyond the noise, that something else than an effect should be looked for first?
    pub hardly_follows: bool,
    /// What one model for each recording leaves (rad), where these do far better than one that hardly follows all of them.
    pub apart_rmse: Option<f64>,
    /// Effects claimed to be missing from the base model; empty: nothing is missing, or nothing could be named.
    pub verdict: Vec<&'static str>,
    /// Effects that the data can't tell from one of the verdict.
    pub undecided: Vec<&'static str>,
    /// The family they all belong to with the claimed effect: the law is of this kind, its shape undecided.
    pub family: Option<FamilyClaim>,
    /// Effects that were not tried, and why.
    pub not_tried: Vec<NotTried>,
    /// Effects that explained the fitted swings, but with which the error on held-out ones rises; and so `friction levels`.
    pub vetoed: Vec<&'static str>,
    /// Effects that would lower the error, but are not claimed: single parts of the swings carry them, or there are too few
    /// parts to say.
    pub unproven: Vec<Holding>,
    /// That of them which would explain most of what is left: likely the cause, though other releases must show it.
    pub suspect: Option<&'static str>,
    /// On which parts of the swings each claimed effect is seen.
    pub holds_on: Vec<Holding>,
    /// That the friction level differs between releases, where it does.
    pub levels: Option<Levels>,
    /// What the held-out swings say to the verdict.
    pub carries: Option<Carries>,
    /// Laws with a free exponent that turned out to be a special one.
    pub special_cases: Vec<SpecialCase>,
    /// Effects by how well each explains the swings, `none` where it belongs.
    pub ranked: Vec<&'static str>,
    /// Root mean square error of the base model without any offset, rad.
    pub rmse_before: f64,
    /// The same with all of the verdict, rad.
    pub rmse_after: f64,
    /// Nothing is claimed; but is the error far lower with a zero that the fit put right, and that these swings do not
    /// prove to be off?
    pub zero_is_doubtful: bool,
    /// On held-out swings before, rad.
    pub held_out_before: Option<f64>,
    /// On held-out swings after, rad.
    pub held_out_after: Option<f64>,
    /// Noise of the measurement, rad.
    pub noise: f64,
    /// Have the readings none of their own? Then `noise` is what a model is simulated to.
    pub has_no_noise: bool,
    /// What is left: noise, nearly, or missing physics.
    pub left: Left,
    /// True if it is missing physics.
    pub unexplained: bool,
    /// Time taken.
    pub seconds: f64,
    /// Simulated swings.
    pub simulations: usize,
    /// What that took, and what it may take before stages are left out.
    pub effort: Effort,
    /// Everything that was fitted, best first.
    pub candidates: Vec<Candidate>,
    /// Where no named law reaches the noise: friction as a free curve of the speed, if that explains more.
    pub curve: Option<FrictionCurve>,
    /// Where more than the noise remains: does that follow angle and speed, as a law of the motion does?
    pub of_state: Option<OfState>,
    /// Where more than the noise remains: small formulas that explain some of it, the best first.
    pub formulas: Vec<Suggestion>,
    /// What each claimed effect does to a swing.
    pub evidence: Vec<Evidence>,
    /// All numbers of the enlarged model but Ms and DV.
    pub values: Vec<Value>,
    /// The enlarged model.
    #[serde(skip)]
    pub parameters: Parameters<f64>,
    /// The claimed model and those that come closest to it, as fitted.
    #[serde(skip)]
    pub leading: Vec<Fitted>,
    /// The base model alone.
    #[serde(skip)]
    pub base_parameters: Parameters<f64>,
    /// Error after each added effect, base first: the staircase.
    pub staircase: Vec<Step>,
}

/// A claim that could not be proven is suspected if it would remove at least this share of what is left beyond the
/// noise.
const SUSPECTED_SHARE: f64 = 0.8;

/// A zero that leaves more of the error than this is no matter for words. With half of it one that halves the error
/// would not be told, and from 1 on one that changes nothing would be.
const VISIBLE_ZERO: f64 = 0.9;

impl Diagnosis {
    /// Is no law named, only the sensor's zero or the levels of the releases at most?
    pub fn has_no_law(&self) -> bool {
        self.staircase.iter().skip(1).all(|step| step.added == STEP)
    }

    /// How far the sensor's zero is off, in words, where that is claimed.
    pub fn zero_in_words(&self) -> Option<String> {
        let offset = zero::offset()?.name;
        let off = self.values.iter().find(|value| value.effect == offset)?;
        Some(format!("The sensor's zero is off by {}.", zero::off_in_words(off.value, off.std)))
    }

    /// What was tried and is worth a look, the best first: a candidate that is worse than the base model, or whose fit
    /// ran away, explains nothing.
    pub fn tried(&self) -> impl Iterator<Item = &Candidate> {
        let base = self.candidates.iter().find(|candidate| candidate.is_base()).map_or(f64::MAX, |base| base.rmse);
        self.candidates.iter().filter(move |candidate| candidate.rmse <= base)
    }

    /// Does a first look say otherwise than what was found thoroughly? What is likely, or not claimed only because no number of it
    /// is known, is told with its reason.
    pub fn contradicts_its_first_look(&self) -> bool {
        let Some(look) = &self.first_look else { return false };
        let is_missing = self.unexplained || !self.verdict.is_empty();
        let is_told = |claim: &Holding| Some(claim.effect) == self.suspect || claim.standing == Standing::Vague;
        let is_likely = |name: &&str| self.unproven.iter().any(|claim| claim.effect == *name && is_told(claim));
        let is_found =
            |name: &&'static str| self.verdict.contains(name) || self.undecided.contains(name) || is_likely(name);
        match look.named.is_empty() {
            true => is_missing && look.reason == Some(of_reason(Reason::NothingMissing)),
            false => !look
                .candidates
                .iter()
                .any(|candidate| (look.named.contains(&candidate.name) || candidate.tied) && is_found(&candidate.name)),
        }
    }

    /// The claim of the suspect.
    pub fn suspect(&self) -> Option<&Holding> {
        self.unproven.iter().find(|claim| Some(claim.effect) == self.suspect)
    }
}

/// Does the suspect leave no more than nearly the noise?
pub(super) fn is_suspect_enough(problem: &Problem, claimed: &Fitted, unproven: &[Holding]) -> bool {
    let suspect = suspect(unproven, problem.rmse_rad(claimed.cost), problem.noise_rad());
    let claim = unproven.iter().find(|claim| Some(claim.effect) == suspect);
    let cost = |claim: &Holding| claim.rmse.powi(2) * problem.n_samples(Window::Whole) as f64;
    claim.is_some_and(|claim| problem.chi_square(cost(claim)).left() != Left::Missing)
}

/// The unproven claim that would remove nearly all that is left beyond the noise, unless it would have to be stronger than it
/// can be, or nobody knows how strong it is.
fn suspect(unproven: &[Holding], rmse_after: f64, noise: f64) -> Option<&'static str> {
    let excess = |rmse: f64| rmse.powi(2) - noise.powi(2);
    let may_be = |claim: &&Holding| !matches!(claim.standing, Standing::OutOfRange | Standing::Vague);
    let lowest = unproven.iter().filter(may_be).min_by(|a, b| a.rmse.total_cmp(&b.rmse))?;
    let is_most = excess(lowest.rmse) < (1.0 - SUSPECTED_SHARE) * excess(rmse_after);
    is_most.then_some(lowest.effect)
}

/// One step of the staircase of errors.
#[derive(Clone, Debug, Serialize)]
pub struct Step {
    /// The effect that was added; `base` first, `friction levels` where each release has its own.
    pub added: &'static str,
    /// Root mean square error on the fitted swings, rad.
    pub rmse: f64,
    /// The same on the held-out swings, rad.
    pub held_out: Option<f64>,
}

/// Puts the result together.
pub(super) struct Summary<'a, 'b, 'c> {
    pub(super) judge: Judge<'a, 'b>,
    /// The model of the rig with one friction for all releases, whatever the search began with.
    pub(super) base: Fitted,
    pub(super) first_look: Option<Look>,
    pub(super) claimed: Fitted,
    pub(super) curve: Option<FrictionCurve>,
    pub(super) of_state: Option<OfState>,
    pub(super) undecided: Vec<&'static str>,
    pub(super) not_tried: Vec<NotTried>,
    pub(super) vetoed: Vec<&'static str>,
    pub(super) unproven: Vec<Holding>,
    pub(super) holds_on: Vec<Holding>,
    pub(super) carries: Option<Carries>,
    pub(super) special_cases: Vec<SpecialCase>,
    pub(super) offset_is_missing: bool,
    pub(super) others: Vec<Fitted>,
    pub(super) held_out: &'c [Swing],
    pub(super) began: Instant,
    pub(super) count: &'c Tally,
}

impl Summary<'_, '_, '_> {
    /// Of these models, the best one first, the ones that may be true in place of the claimed one: those with what it can't be told
    /// from first. A wider form of a claimed law holds that law, so that no swing would ever refute it.
    fn rivals<'f>(&self, models: &[&'f Fitted]) -> Vec<&'f Fitted> {
        let is_wider = |effect: &&Effect<f64>| effect.generalises.is_some_and(|special| self.claimed.has(special));
        let is_rival = |model: &&&Fitted| {
            model.names() != self.claimed.names() && !model.effects.iter().any(|effect| is_wider(&&**effect))
        };
        let is_undecided = |model: &&Fitted| model.names().iter().any(|name| self.undecided.contains(name));
        let mut rivals: Vec<&Fitted> = models.iter().filter(is_rival).copied().collect();
        rivals.sort_by_key(|model| !is_undecided(model));
        rivals.truncate(MAX_RIVALS);
        rivals
    }

    pub(super) fn build(self, with_formulas: bool) -> Diagnosis {
        let problem = self.judge.problem;
        let n_samples = problem.n_samples(Window::Whole) as f64;
        let base = &self.base;
        let rmse = |cost: f64| (cost / n_samples).sqrt();
        let noise = problem.noise_rad();
        let measured = problem.swings.first().map_or(Measured::Angle, |swing| swing.measured);
        // A gyroscope has a bias; an angle's zero may be right. Where it is no part of what is told, and nothing that it would imitate
        // is, it is free as in a fit.
        let resembles = zero::resembling().is_some_and(|effect| self.claimed.has(effect.name));
        let is_zero_told = self.offset_is_missing || self.claimed.effects.is_empty() || resembles;
        let rmse_before = match measured {
            Measured::Angle if is_zero_told => rmse(zero::cost_with_offsets_within(problem, base, 0.0)),
            _ => rmse(base.cost),
        };
        let rmse_after = rmse(self.claimed.cost);
        let held_out = |parameters: &Parameters<f64>| held_out_rmse(self.held_out, parameters, self.count);
        let mut verdict = self.claimed.names();
        let mut ranked = self.judge.ranked(&self.claimed);
        if let Some(offset) = zero::offset().filter(|_| self.offset_is_missing) {
            verdict.push(offset.name);
            let place = if self.claimed.effects.is_empty() { 0 } else { 1 };
            ranked.insert(place, offset.name);
        }
        let mut models: Vec<&Fitted> = vec![&self.claimed];
        let is_claimed = |model: &Fitted| model.names() == self.claimed.names();
        models.extend(
            self.judge.found.levels.iter().flatten().chain([&self.judge.found.base]).filter(|model| !is_claimed(model)),
        );
        models.sort_by(|a, b| self.judge.criterion(a).total_cmp(&self.judge.criterion(b)));
        let leading = std::iter::once(&self.claimed).chain(self.rivals(&models)).cloned().collect();
        let suspect = suspect(&self.unproven, rmse_after, noise);
        let likely = self.unproven.iter().find(|claim| Some(claim.effect) == suspect);
        let is_likely = |model: &Fitted| likely.is_some_and(|claim| claim.is_of(model, &self.claimed));
        let mut place = 0..;
        models.retain(|model| place.next() < Some(MAX_LISTED) || is_claimed(model) || is_likely(model));
        let staircase = self.staircase(rmse_before, &held_out);
        let left = problem.chi_square(self.claimed.cost).left();
        let unexplained = left == Left::Missing;
        let formulas = if unexplained && with_formulas { self.formulas(&held_out) } else { Vec::new() };
        let levels = levels(problem, &self.claimed);
        let mut values = self.judge.values_of(&self.claimed, &self.others);
        values.extend(zero::value(problem, &self.claimed).filter(|_| self.offset_is_missing));
        Diagnosis {
            version: 1,
            measured,
            first_look: self.first_look,
            driven: Swing::driven(problem.swings),
            touches: Vec::new(),
            short_memory: None,
            follows: problem.is_followed(self.claimed.cost),
            hardly_follows: unexplained && hardly_follows(problem.left_of_motion(self.claimed.cost)),
            apart_rmse: unexplained.then(|| apart_rmse(problem, &self.claimed)).flatten(),
            family: family(&self.claimed, &self.undecided),
            not_tried: self.not_tried.into_iter().filter(|it| !self.undecided.contains(&it.effect)).collect(),
            undecided: self.undecided,
            vetoed: self.vetoed,
            suspect,
            unproven: self.unproven,
            holds_on: self.holds_on,
            zero_is_doubtful: verdict.is_empty() && levels.is_none() && rmse_after < VISIBLE_ZERO * rmse_before,
            levels,
            carries: self.carries,
            special_cases: self.special_cases,
            rmse_before,
            rmse_after,
            held_out_before: held_out(&base.parameters),
            held_out_after: held_out(&self.claimed.parameters),
            noise,
            has_no_noise: problem.swings.iter().all(Swing::has_no_noise),
            left,
            unexplained,
            curve: self.curve,
            of_state: self.of_state,
            formulas,
            evidence: evidence(problem, &self.claimed.parameters),
            values,
            candidates: on_all_cores(models, |model| self.judge.candidate(model)),
            parameters: problem.tolerances.settled(&self.claimed.parameters),
            leading,
            base_parameters: problem.tolerances.settled(&base.parameters),
            staircase,
            seconds: self.began.elapsed().as_secs_f64(),
            simulations: self.count.simulations(),
            effort: self.judge.budget.effort(),
            verdict,
            ranked,
        }
    }

    fn formulas(&self, held_out: &dyn Fn(&Parameters<f64>) -> Option<f64>) -> Vec<Suggestion> {
        let problem = self.judge.problem;
        let weight = (problem.n_samples(Window::Whole) as f64).ln();
        let within_rad = problem.largest_rad();
        let before = excess(problem, &self.claimed);
        let suggestion = |found: FoundFormula| {
            let candidate = self.judge.candidate(&found.model);
            let parameters = candidate.parameters.into_iter().filter(|value| value.effect == CUSTOM_FORMULA_NAME);
            Suggestion {
                words: found.words,
                formula: found.typed,
                rmse: candidate.rmse,
                left: problem.chi_square(found.model.cost).left(),
                held_out: held_out(&found.model.parameters),
                removed: 1.0 - excess(problem, &found.model) / before,
                criterion: candidate.criterion + weight * found.length as f64,
                parameters: parameters.collect(),
                beside: found.model.names().into_iter().filter(|name| *name != CUSTOM_FORMULA_NAME).collect(),
                within_rad,
            }
        };
        if self.claimed.has(CUSTOM_FORMULA_NAME) {
            return Vec::new();
        }
        let on_top_of = |model: &Fitted| formulas(problem, model, |model| self.judge.criterion(model), weight);
        let mut found: Vec<Suggestion> = on_top_of(&self.claimed).into_iter().map(suggestion).collect();
        if !self.claimed.effects.is_empty() {
            // An effect that was claimed for want of a better one may be in the way.
            found.extend(on_top_of(&self.judge.found.base).into_iter().map(suggestion));
        }
        found.sort_by(|a, b| a.criterion.total_cmp(&b.criterion));
        found.retain(|found| found.removed > 0.0);
        found.truncate(OFFERED);
        found
    }

    fn staircase(&self, rmse_before: f64, held_out: &dyn Fn(&Parameters<f64>) -> Option<f64>) -> Vec<Step> {
        let found = self.judge.found;
        let n_samples = self.judge.problem.n_samples(Window::Whole) as f64;
        // What a fit of the base model leaves, which always takes the zero off.
        let with_zero = (self.base.cost / n_samples).sqrt();
        let zero =
            zero::offset().filter(|_| !self.claimed.effects.is_empty() && with_zero < VISIBLE_ZERO * rmse_before);
        // Of what was held out each zero is taken off.
        let of_held_out = held_out(&self.base.parameters);
        let mut steps =
            vec![Step { added: "base", rmse: rmse_before, held_out: of_held_out.filter(|_| zero.is_none()) }];
        steps.extend(zero.map(|zero| Step { added: zero.name, rmse: with_zero, held_out: of_held_out }));
        if found.base.problem(self.judge.problem).has_levels() {
            let rmse = (found.base.cost / n_samples).sqrt();
            steps.push(Step { added: STEP, rmse, held_out: held_out(&found.base.parameters) });
        }
        for n_added in 1..=self.claimed.effects.len() {
            let part = &self.claimed.effects[..n_added];
            let is_part =
                |model: &&Fitted| model.effects.len() == n_added && part.iter().all(|effect| model.has(effect.name));
            let model = if n_added == self.claimed.effects.len() {
                Some(&self.claimed)
            } else {
                found.levels.iter().flatten().find(is_part)
            };
            if let Some(model) = model {
                let rmse = (model.cost / n_samples).sqrt();
                steps.push(Step { added: part[n_added - 1].name, rmse, held_out: held_out(&model.parameters) });
            }
        }
        steps
    }
}

/// At most this many models are set against the claimed one.
const MAX_RIVALS: usize = 2;

/// At most this many models are listed.
const MAX_LISTED: usize = 12;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{rig, simulated};
    use crate::fit::by_least_squares::fitted_as_it_is;
    use crate::fit::identify::problem_of;

    #[test]
    fn what_explains_four_fifths_of_the_rest_is_suspected_unless_it_is_as_strong_as_it_can_be() {
        let claim = |standing, rmse: f64| Holding {
            effect: "quadratic-drag",
            standing,
            windows: 9,
            rmse,
            beside: Vec::new(),
            p: None,
            p_without_two: None,
            value: None,
            std: None,
            parts: Vec::new(),
        };
        let told = |standing, rmse: f64| suspect(&[claim(standing, rmse), claim(standing, 4e-3)], 5e-3, 3e-3);
        // 16 of (5² − 3²) are left; of a fifth, 3.2, the root with the noise is 3.493.
        assert_eq!([3.4e-3, 3.6e-3].map(|rmse| told(Standing::Partly, rmse)), [Some("quadratic-drag"), None]);
        assert_eq!([Standing::OutOfRange, Standing::Vague].map(|standing| told(standing, 3.4e-3)), [None, None]);
        assert_eq!(suspect(&[], 5e-3, 3e-3), None);
        let beside = [claim(Standing::OutOfRange, 3.1e-3), claim(Standing::Partly, 3.4e-3)];
        assert_eq!(
            suspect(&beside, 5e-3, 3e-3),
            Some("quadratic-drag"),
            "one that can't be is no reason to say nothing"
        );
        let (swings, count) = ([simulated("one", &rig(), 8.0, 1)], Tally::default());
        let problem = problem_of(&swings, &rig(), &count);
        let model = fitted_as_it_is(&problem);
        let claimed = Fitted { cost: 100.0 * model.cost, ..model };
        let is_enough = |noises: f64| {
            is_suspect_enough(&problem, &claimed, &[claim(Standing::TooShort, noises * problem.noise_rad())])
        };
        assert!(is_enough(1.0) && !is_enough(2.0));
    }
}
