//! Discovery: which physical effect is missing from the model?
//!
//! The base model is fitted first. If it leaves more than the noise, every effect of the list is tried: a score test
//! ([`score`]) tells in one linearised step what each could gain, the promising ones are fitted in earnest
//! ([`trial`]), and [`mod@search`] goes on with pairs until nothing significant is left. `verdict` says what may be
//! claimed, what can't be told apart ([`replacement`]), what is only a shifted zero of the sensor ([`zero`]), and what
//! stays unexplained; for that, [`formulas`] searches small laws if somebody wishes.

pub mod evidence;
pub mod excess;
mod extension;
pub mod formulas;
mod level;
pub mod physical;
pub mod replacement;
pub mod score;
pub mod search;
mod summary;
pub mod trial;
mod verdict;
pub mod zero;

pub use evidence::Evidence;
pub use summary::{Candidate, Diagnosis, Step, Suggestion};
pub use trial::Value;

use crate::fit::descent::Patience;
use crate::fit::identify::{problem_of, smooth};
use crate::fit::problem::Problem;
use crate::fit::stiction::{self, Settled, Stiction, with_stiction};
use crate::fit::{start, windows};
use crate::formula::effect_of;
use crate::swing::Swing;
use search::search;
use shared::effect::{CUSTOM_FORMULA_ID, Effect};
use shared::parameters::{Parameters, base};
use std::sync::atomic::AtomicUsize;
use std::time::Instant;
use summary::Summary;
use verdict::{INDISTINGUISHABLE, Judge};
use zero::{ANGLE_OFFSET, ASYMMETRIC, Zero};

/// Finds what is missing from the base model of a rig.
pub fn diagnose(swings: &[Swing], held_out: &[Swing], rig: &Parameters<f64>) -> Diagnosis {
    diagnose_with(swings, held_out, rig, Wishes::default())
}

/// What a diagnosis does beside trying the effects of the list.
#[derive(Clone, Copy, Default)]
pub struct Wishes {
    /// An effect that somebody typed, tried as well.
    pub typed: Option<&'static Effect<f64>>,
    /// Small formulas are searched for what no effect explains; that takes up to a minute.
    pub formulas: bool,
}

/// The same with more than the effects of the list; a typed one that the rig has already is tried in any case.
pub fn diagnose_with(swings: &[Swing], held_out: &[Swing], rig: &Parameters<f64>, wishes: Wishes) -> Diagnosis {
    diagnose_counted(swings, held_out, rig, wishes, &AtomicUsize::new(0))
}

/// The same for somebody who wants to see the count of simulated swings grow.
pub fn diagnose_counted(
    swings: &[Swing],
    held_out: &[Swing],
    rig: &Parameters<f64>,
    wishes: Wishes,
    count: &AtomicUsize,
) -> Diagnosis {
    let began = Instant::now();
    let problem = base_problem(swings, rig, count);
    let base = fit_base(&problem);
    let mut candidates = candidates(swings);
    candidates.extend(wishes.typed.or(effect_of(rig, CUSTOM_FORMULA_ID)));
    let sketches = problem.sketches();
    let rough = problem.on(&sketches);
    let found = search(&problem, &rough, &base, &candidates);
    let judge = Judge { problem: &problem, rough: &rough, found: &found, candidates: &candidates };
    let (claimed, others) = judge.refined(judge.claimed());
    let mut undecided = judge.undecided(&claimed, &others);
    let n_claimed = claimed.effects.len();
    let Zero { model, offset_is_missing, alike } = zero::decide(&problem, claimed, INDISTINGUISHABLE * judge.unit());
    // What the asymmetry explains, another effect may have imitated.
    let claimed = if model.effects.len() > n_claimed { judge.pruned_but(model, Some(ASYMMETRIC)) } else { model };
    undecided.extend(alike);
    Summary { judge, claimed, undecided, offset_is_missing, held_out, began, count }.build(wishes.formulas)
}

/// The effects that may be found missing: all but the base effects and the offset, which is fitted anyway. In a single
/// swing the amplitude falls as time goes by, so that no drift can be told from a law of speed or angle.
fn candidates(swings: &[Swing]) -> Vec<&'static Effect<f64>> {
    let is_candidate = |effect: &&Effect<f64>| {
        let needs_more = effect.name == DRIFTING && swings.len() < 2;
        !effect.is_base() && effect.name != ANGLE_OFFSET && !needs_more
    };
    Effect::ALL.iter().filter(is_candidate).collect()
}

/// Only several releases tell it from the rest.
const DRIFTING: &str = "drifting-friction";

fn base_problem<'a>(swings: &'a [Swing], rig: &Parameters<f64>, count: &'a AtomicUsize) -> Problem<'a> {
    let mut bare = rig.clone();
    bare.effects.retain(|effect| effect.id <= base::STICTION);
    bare.formula = None;
    let mut problem = smooth(&problem_of(swings, &bare, count));
    for (unknown, start) in problem.unknowns.clone().iter().zip(problem.template_values()) {
        if unknown.name != "inertia" && start <= unknown.low {
            unknown.set(&mut problem.template, unknown.scale);
        }
    }
    with_stiction(&problem, Stiction { level_nm: 0.0, velocity_band: 0.0 })
}

fn fit_base(problem: &Problem) -> Settled {
    let grown = windows::grow(problem, &start::guess(problem));
    stiction::settle(problem, &grown.point, Patience::JUDGE)
}
