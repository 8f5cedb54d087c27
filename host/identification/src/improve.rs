//! Adding and removing effects by hand, one step at a time, with the error before and after each.

use crate::diagnose::curve::added_curve;
use crate::diagnose::value::{Value, values};
use crate::fit::added;
use crate::fit::by_least_squares::fitted_as_it_is;
use crate::fit::descent::Tolerance;
use crate::fit::fitted::Fitted;
use crate::fit::identify::{Carries, HeldOut, problem_of};
use crate::fit::problem::Problem;
use crate::fit::refine::Band;
use crate::fit::tally::Tally;
use crate::fit::tolerance::{KnownRig, Tolerances};
use crate::swing::Swing;
use serde::Serialize;
use shared::effect::{CURVE_ID, CURVE_NAME, Effect};
use shared::parameters::Parameters;

/// What to do.
#[derive(Clone, Copy, Debug)]
pub enum Change {
    /// Add an effect.
    Add(&'static Effect<f64>),
    /// Take an effect out.
    Remove(&'static Effect<f64>),
}

/// The model after one change.
#[derive(Clone, Debug, Serialize)]
pub struct Step {
    /// What was done.
    pub words: String,
    /// Root mean square error, rad.
    pub rmse: f64,
    /// The same on held-out swings, rad.
    pub held_out: Option<f64>,
    /// What the held-out swings say to this step.
    pub carries: Option<Carries>,
    /// Noise, rad.
    pub noise: f64,
    /// All numbers of the model but Ms and DV.
    pub values: Vec<Value>,
    /// The model, refitted.
    #[serde(skip)]
    pub parameters: Parameters<f64>,
}

/// Why a change can't be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ChangeError {
    /// It is in already.
    #[error(
        "{name} is part of the model already; change its value in the model file, or take it out with --remove {name}"
    )]
    Present {
        /// The effect.
        name: &'static str,
    },
    /// It is not in.
    #[error("{name} is not part of the model; there is nothing to remove")]
    Absent {
        /// The effect.
        name: &'static str,
    },
    /// Every fit has it anyway.
    #[error(
        "{name} needs no adding: every fit takes the sensor's zero off each recording by itself; host calibrate puts it right \
         on a rig, --zero says what a sensor reads where the pendulum hangs"
    )]
    Free {
        /// The effect.
        name: &'static str,
    },
    /// No curve could be chosen.
    #[error("no friction curve was found that is better: the swings are too short, or the model follows them already")]
    TooShort,
    /// No fit with it came to anything.
    #[error("no fit with {name} succeeded; a model has at most {} effects", shared::parameters::MAX_EFFECTS)]
    Failed {
        /// The effect.
        name: &'static str,
    },
}

/// Refits the model as it is, then makes each change and refits everything.
pub fn change<'r>(
    swings: &[Swing],
    held_out: &[Swing],
    rig: impl Into<KnownRig<'r>>,
    changes: &[Change],
) -> Result<Vec<Step>, ChangeError> {
    let rig = rig.into();
    let bench = Bench { swings, held_out, tolerances: rig.tolerances, count: &Tally::default() };
    let (mut model, first) = bench.fitted(rig.parameters);
    let mut steps = vec![first];
    for change in changes {
        let (next, step) = bench.changed(&model, *change)?;
        model = next;
        steps.push(step);
    }
    Ok(steps)
}

/// What the changes of a model are judged by.
#[derive(Clone, Copy, Debug)]
pub struct Bench<'a> {
    /// Swings to fit.
    pub swings: &'a [Swing],
    /// Swings that take no part.
    pub held_out: &'a [Swing],
    /// How surely the geometry is known.
    pub tolerances: Tolerances,
    /// Simulated swings so far.
    pub count: &'a Tally,
}

impl<'a> Bench<'a> {
    fn problem_of(&self, parameters: &Parameters<f64>) -> Problem<'a> {
        problem_of(self.swings, KnownRig { parameters, tolerances: self.tolerances }, self.count)
    }

    /// The model as it is, refitted; further changes go on from the model.
    pub fn fitted(&self, rig: &Parameters<f64>) -> (Fitted, Step) {
        let problem = self.problem_of(rig);
        let model = fitted_as_it_is(&problem);
        let step = self.step("as it is".to_owned(), &problem, &model, None);
        (model, step)
    }

    /// The model after one more change, refitted from where it was.
    ///
    /// # Errors
    /// The effect is in already, is not in, or nothing with it could be fitted.
    pub fn changed(&self, model: &Fitted, change: Change) -> Result<(Fitted, Step), ChangeError> {
        if let Change::Add(effect) | Change::Remove(effect) = change
            && effect.id == CURVE_ID
        {
            return self.with_or_without_curve(model, change);
        }
        let problem = self.problem_of(&model.parameters);
        let (words, next) = match change {
            Change::Add(effect) => (format!("+ {}", effect.name), added(&problem, model, effect)?),
            Change::Remove(effect) => (format!("- {}", effect.name), removed(&problem, model, effect)?),
        };
        let step = self.step(words, &problem, &next, Some(model));
        Ok((next, step))
    }

    /// A friction curve stands in place of base effects, which come and go with it.
    fn with_or_without_curve(&self, model: &Fitted, change: Change) -> Result<(Fitted, Step), ChangeError> {
        let name = CURVE_NAME;
        let is_present = model.parameters.curve.is_some();
        match change {
            Change::Add(_) if is_present => Err(ChangeError::Present { name }),
            Change::Remove(_) if !is_present => Err(ChangeError::Absent { name }),
            Change::Add(_) => {
                let problem = self.problem_of(&model.parameters);
                let curve = added_curve(&problem, model).ok_or(ChangeError::TooShort)?;
                let mut step = self.step(format!("+ {name}"), &problem, &curve.model, Some(model));
                let knots = step.values.iter_mut().filter(|value| value.effect == name);
                knots.zip(&curve.stds).for_each(|(value, std)| value.std = *std);
                Ok((curve.model, step))
            }
            Change::Remove(_) => {
                let problem = self.problem_of(&model.without(CURVE_ID).parameters);
                let next = fitted_as_it_is(&problem);
                let step = self.step(format!("- {name}"), &problem, &next, Some(model));
                Ok((next, step))
            }
        }
    }

    fn step(&self, words: String, problem: &Problem, model: &Fitted, before: Option<&Fitted>) -> Step {
        let of = |model: &Fitted| HeldOut::of(self.held_out, &model.parameters, self.count);
        let held_out = of(model);
        let before = before.filter(|_| held_out.is_some()).and_then(of);
        Step {
            words,
            rmse: problem.rmse_rad(model.cost),
            held_out: held_out.as_ref().map(|held_out| held_out.rmse_rad),
            carries: held_out.zip(before).map(|(after, before)| after.after(&before)),
            noise: problem.noise_rad(),
            values: values(problem, model),
            parameters: problem.tolerances.settled(&model.parameters),
        }
    }
}

fn added(problem: &Problem, model: &Fitted, effect: &'static Effect<f64>) -> Result<Fitted, ChangeError> {
    let name = effect.name;
    if model.parameters.values(effect.id).is_some() {
        return Err(ChangeError::Present { name });
    }
    if effect.rules.is_free_offset {
        return Err(ChangeError::Free { name });
    }
    let settled = added::fitted(problem, model, effect).ok_or(ChangeError::Failed { name })?.settled(problem);
    // With no strength it is the model that it was added to.
    let absent = model.with(effect, &effect.starts[0]).map(|absent| absent.evaluated(problem));
    Ok(absent.into_iter().fold(settled, Fitted::better))
}

fn removed(problem: &Problem, model: &Fitted, effect: &'static Effect<f64>) -> Result<Fitted, ChangeError> {
    if model.parameters.values(effect.id).is_none() {
        return Err(ChangeError::Absent { name: effect.name });
    }
    let smaller = model.without(effect.id).refined(problem, Band::Held, Tolerance::SCREEN);
    Ok(smaller.refined(problem, Band::Level, Tolerance::JUDGE).settled(problem))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{rig, simulated};

    #[test]
    fn held_out_swings_confirm_an_effect_that_is_there_and_contradict_that_it_is_taken_out() {
        let drag = Effect::<f64>::by_name("quadratic-drag").unwrap();
        let mut truth = rig();
        truth.set(drag.id, &[2e-4]).unwrap();
        let swing = |seed: u64| [simulated("drag", &truth, 8.0, seed)];
        let said = |rig: &Parameters<f64>, change: Change| {
            let steps = super::change(&swing(1), &swing(2), rig, &[change]).unwrap();
            assert_eq!(steps[0].carries, None);
            (steps[1].words.clone(), steps[1].carries)
        };
        assert_eq!(said(&rig(), Change::Add(drag)), ("+ quadratic-drag".to_owned(), Some(Carries::Confirmed)));
        assert_eq!(said(&truth, Change::Remove(drag)), ("- quadratic-drag".to_owned(), Some(Carries::Contradicted)));
    }

    /// An effect that is not there, beside a drag that is not in the model: what refits the model may lead it astray.
    #[test]
    fn a_model_with_an_effect_added_is_never_worse_than_without() {
        let mut truth = rig();
        truth.set_friction(5e-4, 3e-3, 6e-3, 0.03);
        truth.set(Effect::<f64>::by_name("quadratic-drag").unwrap().id, &[2e-4]).unwrap();
        let swings = [simulated("drag", &truth, 20.0, 1)];
        for name in ["asymmetric-coulomb", "backlash", "zero-drift"] {
            let added = Change::Add(Effect::by_name(name).unwrap());
            let steps = super::change(&swings, &[], &rig(), &[added]).unwrap();
            assert!(steps[1].rmse <= steps[0].rmse, "{name}: {} instead of {}", steps[1].rmse, steps[0].rmse);
        }
    }
}
