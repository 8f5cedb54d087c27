//! What could an effect gain, judged from one Gauss–Newton step over all parameters: the predicted reduction.
//!
//! Friction and inertia must be allowed to answer at once, or effects that resemble them are never found.

use super::closer;
use super::descent::Tolerance;
use super::fitted::Fitted;
use super::linear::{Linear, equations_with_added};
use super::problem::Problem;
use super::refine::{Band, levels};
use super::solve::ANSWER_DAMPING;
use super::step::{bounded_step, stepped};
use crate::cores::on_all_cores;
use crate::pace;
use crate::swing::Window;
use shared::effect::{Effect, MAX_VALUES};

/// What a start point of an effect promises.
#[derive(Clone, Debug)]
pub struct Prediction {
    /// The effect.
    pub effect: &'static Effect<f64>,
    /// The numbers of the effect that it was judged from.
    pub start: [f64; MAX_VALUES],
    /// By how much the cost would fall, rad²: the predicted reduction.
    pub reduction: f64,
    /// The model with the effect at its start, before the step.
    pub at_start: Fitted,
    /// The model after the step, not fitted yet.
    pub model: Fitted,
}

impl Prediction {
    /// Fits what it leads to, Ms and DV as they are; from before the step where that leads to worse.
    pub fn fitted(&self, on: &Problem) -> Fitted {
        let fitted = |model: &Fitted| model.refined(on, Band::Held, Tolerance::SCREEN);
        let led = fitted(&self.model);
        if led.cost > self.at_start.cost { led.better(fitted(&self.at_start)) } else { led }
    }

    /// Begun with the first swings: over many periods a step that changes the period leads into a side valley, or into one so
    /// narrow that a fit ends on the way.
    pub fn grown(&self, on: &Problem) -> Fitted {
        self.model.regrown(on).refined(on, Band::Held, Tolerance::ROUGH)
    }

    /// Led to its stop turn by turn, on decimated swings.
    pub fn stopped_anew(&self, decimated: &Problem) -> Fitted {
        levels(decimated, &self.model.calmed(decimated)).swap_remove(0)
    }
}

/// Predictions for all start points of all given effects on top of a model whose cost is that of these swings, the best
/// first.
pub fn predictions(on: &Problem, model: &Fitted, effects: &[&'static Effect<f64>]) -> Vec<Prediction> {
    let starts = effects.iter().flat_map(|effect| pace::starts(effect, on.pace()).map(|start| (*effect, start)));
    let known = model.linearised(on);
    let of = |(effect, start): (&'static Effect<f64>, [f64; MAX_VALUES])| prediction(on, model, &known, effect, &start);
    sorted(on_all_cores(starts, of).into_iter().flatten().collect())
}

/// The best of each effect's starts that lie closer than in the list, where it promises clearly more than all of the list: the best
/// first. They take as long as all starts of the list, so that third effects do without.
pub fn predictions_between(
    on: &Problem,
    model: &Fitted,
    effects: &[&'static Effect<f64>],
    of_list: &[Prediction],
) -> Vec<Prediction> {
    let known = model.linearised(on);
    let of_effect = |effect: &'static Effect<f64>| {
        let promised = of_list.iter().filter(|other| other.effect.id == effect.id).map(|other| other.reduction);
        let least = closer::WORTH_IT * promised.fold(0.0, f64::max);
        let of_row = |row| promising(on_all_cores(row, |start| prediction(on, model, &known, effect, &start)), least);
        sorted(closer::rows(effect, on).into_iter().flat_map(of_row).collect()).into_iter().next()
    };
    let effects = effects.iter().filter(|_| model.effects.len() < closer::MOST_BESIDE);
    sorted(effects.filter_map(|effect| of_effect(effect)).collect())
}

fn sorted(mut predictions: Vec<Prediction>) -> Vec<Prediction> {
    predictions.sort_by(|a, b| b.reduction.total_cmp(&a.reduction));
    predictions
}

/// Those of neighbouring starts that promise most, and more than this.
fn promising(mut row: Vec<Option<Prediction>>, least: f64) -> Vec<Prediction> {
    let promised = |of: &Option<Prediction>| of.as_ref().map_or(0.0, |prediction| prediction.reduction);
    let promised: Vec<f64> = row.iter().map(promised).collect();
    closer::peaks(&promised, least).filter_map(|i| row[i].take()).collect()
}

fn prediction(
    on: &Problem,
    model: &Fitted,
    known: &Linear,
    effect: &'static Effect<f64>,
    start: &[f64; MAX_VALUES],
) -> Option<Prediction> {
    let before = model.cost;
    let larger = model.with(effect, start)?;
    let (problem, point) = (larger.problem(on), larger.point());
    let equations = equations_with_added(&problem, &point, Window::Whole, known);
    let step = bounded_step(&problem, &point, &equations, ANSWER_DAMPING);
    let cost = equations.cost - equations.gain(&step);
    let stepped = Fitted::at(&problem, &stepped(&problem, &point, &step));
    let model = Fitted { effects: larger.effects.clone(), ..stepped };
    let at_start = Fitted { cost: equations.cost, ..larger };
    cost.is_finite().then_some(Prediction { effect, start: *start, reduction: before - cost, at_start, model })
}
