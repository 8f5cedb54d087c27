//! Discovery: which physical effect is missing from the model?
//!
//! The base model is fitted first, and the bank has a [`mod@first_look`] around it. If the model leaves more than the
//! noise, every effect of the list is tried: a score test ([`crate::fit::prediction`]) tells in one linearised step what
//! each could gain, the promising ones are fitted in earnest ([`crate::fit::refine`]), and [`mod@search`] goes on with
//! pairs until nothing significant is left. `verdict` says what may be claimed, what can't be told apart
//! ([`replacement`], `ties`), what is only a shifted zero of the sensor ([`zero`]), and what stays unexplained; nothing
//! is claimed that does not hold on every part of the swings ([`holds`]). Where more than the noise stays, the friction
//! [`levels`] of the releases may differ. For what is left, [`formulas`] searches small laws if somebody wishes.

mod budget;
mod conclusion;
pub mod curve;
mod curve_words;
mod doubt;
pub mod evidence;
mod extension;
pub mod first_look;
pub mod formulas;
pub mod holds;
pub mod levels;
mod models;
pub mod of_state;
mod of_state_words;
pub mod physical;
pub mod replacement;
pub mod resemblance;
mod rests;
pub mod search;
mod seen;
mod shape;
mod strength;
mod summary;
mod ties;
pub mod value;
mod verdict;
mod widening;
pub mod zero;
pub mod zero_of_rig;

pub use budget::Effort;
pub use curve::FrictionCurve;
pub use evidence::Evidence;
pub use first_look::first_look;
pub use holds::{Holding, Standing};
pub use levels::Levels;
pub use of_state::OfState;
pub use summary::{Diagnosis, NotTried, SpecialCase, Step, Suggestion};
pub use ties::FamilyClaim;
pub use value::{Candidate, Value};
pub use verdict::INDISTINGUISHABLE;

use crate::fit::by_least_squares::fitted_as_it_is;
use crate::fit::identify::problem_of;
use crate::fit::problem::Problem;
use crate::fit::tally::Tally;
use crate::fit::tolerance::KnownRig;
use crate::fit::touch;
use crate::formula::effect_of;
use crate::geometry;
use crate::look::Look;
use crate::recording::Measured;
use crate::swing::Swing;
use crate::verdict::Left;
use budget::Budget;
use conclusion::{Bench, Conclusion};
use shared::effect::{CUSTOM_FORMULA_ID, Effect};
use shared::parameters::base;
use std::time::Instant;
use summary::{Summary, is_suspect_enough};

/// Finds what is missing from the base model of a rig.
pub fn diagnose<'r>(swings: &[Swing], held_out: &[Swing], rig: impl Into<KnownRig<'r>>) -> Diagnosis {
    diagnose_with(swings, held_out, rig, Wishes::default())
}

/// What a diagnosis does beside trying the effects of the list.
#[derive(Clone, Copy, Default)]
pub struct Wishes {
    /// An effect that somebody typed, tried as well.
    pub typed: Option<&'static Effect<f64>>,
    /// Small formulas are searched for what no effect explains; that takes up to a minute.
    pub formulas: bool,
    /// Who is told the first look, long before the rest is known.
    pub at_first_look: Option<fn(&Look)>,
}

/// The same with more than the effects of the list; a typed one that the rig has already is tried in any case.
pub fn diagnose_with<'r>(
    swings: &[Swing],
    held_out: &[Swing],
    rig: impl Into<KnownRig<'r>>,
    wishes: Wishes,
) -> Diagnosis {
    diagnose_counted(swings, held_out, rig, wishes, &Tally::default())
}

/// The same for somebody who wants to see the count of simulated swings grow.
pub fn diagnose_counted<'r>(
    swings: &[Swing],
    held_out: &[Swing],
    rig: impl Into<KnownRig<'r>>,
    wishes: Wishes,
    count: &Tally,
) -> Diagnosis {
    let (began, rig) = (Instant::now(), rig.into());
    let problem = base_problem(swings, rig, count);
    let base = fitted_as_it_is(&problem);
    let touches = touch::touches_of(&problem, &base);
    if !touches.is_empty() {
        let mut found = diagnose_counted(&touch::longest(swings, &touches), held_out, rig, wishes, count);
        found.touches.splice(0..0, touches);
        return Diagnosis { seconds: began.elapsed().as_secs_f64(), ..found };
    }
    let first_look = first_look(swings, &base.parameters);
    if let (Some(look), Some(tell)) = (&first_look, wishes.at_first_look) {
        tell(look);
    }
    let (mut candidates, not_tried) = candidates(swings, !geometry::is_unknown(&rig.parameters.pendulum));
    candidates.extend(wishes.typed.or(effect_of(rig.parameters, CUSTOM_FORMULA_ID)));
    let decimated = problem.decimated();
    let rough = problem.on(&decimated);
    let budget = Budget::new(count);
    let bench = Bench { problem: &problem, rough: &rough, candidates: &candidates, budget: &budget, held_out, count };
    let alone = bench.concluded(&base);
    if let Some((swings, told)) = bench.swings_in_what_is_left(&alone) {
        let wishes = Wishes { at_first_look: None, ..wishes };
        let found = diagnose_counted(&swings, held_out, rig, wishes, count);
        // What only many effects together make of it is no noise.
        if found.left != Left::Missing {
            return Diagnosis { seconds: began.elapsed().as_secs_f64(), short_memory: Some(told), ..found };
        }
    }
    let (concluded, curve) = bench.with_curve(bench.with_levels_that_carry(&base, alone));
    let Conclusion { found, claimed, undecided, vetoed, unproven, holds_on, special_cases, offset_is_missing, others } =
        concluded;
    let judge = bench.judge(&found);
    // Who says that a law is likely and reaches the noise does not ask whether one is missing.
    let is_suspect_enough = is_suspect_enough(&problem, &claimed, &unproven);
    let of_state = if is_suspect_enough { None } else { judge.of_state(&claimed, curve.as_ref()) };
    let carries = judge.carries(&claimed, held_out, count);
    let parts = Summary {
        judge,
        base: base.clone(),
        first_look,
        claimed,
        curve,
        of_state,
        undecided,
        not_tried,
        vetoed,
        unproven,
        holds_on,
        carries,
        special_cases,
        offset_is_missing,
        others,
        held_out,
        began,
        count,
    };
    parts.build(wishes.formulas)
}

/// The effects that may be found missing: all but the base effects and what is fitted anyway; and those that these
/// swings could not tell, with the reason.
fn candidates(swings: &[Swing], is_geometry_known: bool) -> (Vec<&'static Effect<f64>>, Vec<NotTried>) {
    let (mut tried, mut not_tried) = (Vec::new(), Vec::new());
    // Of a sensor of rates the scale is free in every fit, as the offset is.
    let is_rate = swings.iter().any(|swing| swing.measured == Measured::Rate);
    let is_free = |effect: &Effect<f64>| effect.rules.is_free_offset || is_rate && effect.rules.is_calibrated;
    for effect in Effect::usual().filter(|effect| !is_free(effect)) {
        let reason = if effect.rules.needs_several_releases && swings.len() < 2 {
            "needs several releases: within one swing the amplitude falls as time goes by, so that it can't be told from a \
             law of speed or angle"
        } else if effect.rules.needs_geometry && !is_geometry_known {
            "needs the mass and how far from the pivot it is, in rig.toml: with an unknown geometry its torque is another one"
        } else if effect.rules.needs_angles && is_rate {
            "is an error of a sensor of angles, and this one reads rates"
        } else {
            tried.push(effect);
            continue;
        };
        not_tried.push(NotTried { effect: effect.name, reason: reason.to_owned() });
    }
    (tried, not_tried)
}

/// The rig without any added effect.
fn base_problem<'a>(swings: &'a [Swing], rig: KnownRig, count: &'a Tally) -> Problem<'a> {
    let mut bare = rig.parameters.clone();
    bare.effects.retain(|effect| effect.id <= base::STICTION);
    (bare.formula, bare.curve) = (None, None);
    problem_of(swings, KnownRig { parameters: &bare, ..rig }, count)
}

#[cfg(test)]
mod follow_tests;
#[cfg(test)]
mod stop_tests;
#[cfg(test)]
pub(crate) mod tests;
