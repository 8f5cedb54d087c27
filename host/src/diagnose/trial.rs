//! A model that is tried: the base effects and some added ones, fitted to the swings.

use super::excess::is_well_explained;
use crate::fit::covariance::covariance;
use crate::fit::descent::{Descent, Patience, descend};
use crate::fit::linear::{Steps, linearise};
use crate::fit::problem::{Point, Problem, Unknown};
use crate::fit::stiction::{self, Settled, Stiction, with_stiction};
use crate::fit::stop_level;
use crate::fit::windows;
use crate::formula::add;
use crate::swing::Window;
use serde::Serialize;
use shared::effect::Effect;
use shared::parameters::Parameters;

/// A fitted model.
#[derive(Clone, Debug)]
pub struct Trial {
    /// The added effects.
    pub effects: Vec<&'static Effect<f64>>,
    /// Unknowns without Ms and DV.
    pub unknowns: Vec<Unknown>,
    /// Parameters with all numbers fitted.
    pub parameters: Parameters<f64>,
    /// Ms and DV in them.
    pub stiction: Stiction,
    /// Values of the unknowns, and the starts.
    pub point: Point,
    /// Sum of squared errors, rad².
    pub cost: f64,
}

/// A fitted number.
#[derive(Clone, Debug, Serialize)]
pub struct Value {
    /// The effect whose number it is, or `inertia`.
    pub effect: &'static str,
    /// The literature's symbol.
    pub symbol: &'static str,
    /// The value.
    pub value: f64,
    /// Standard deviation, if the data give one.
    pub std: Option<f64>,
    /// SI unit.
    pub unit: &'static str,
}

/// All fitted numbers of a model with their uncertainties; Ms and DV, in which the error is not smooth, are not there.
pub fn values(of: &Problem, trial: &Trial) -> Vec<Value> {
    let problem = trial.problem(of);
    let mut steps = Steps::found(&problem, &trial.point);
    let covariance = covariance(&linearise(&problem, &trial.point, Window::Whole, &mut steps));
    let value = |(j, unknown): (usize, &Unknown)| Value {
        effect: unknown.name,
        symbol: unknown.symbol,
        value: trial.point.values[j],
        std: covariance.as_ref().and_then(|covariance| covariance.std(j)),
        unit: unknown.unit,
    };
    trial.unknowns.iter().enumerate().map(value).collect()
}

impl Trial {
    /// The trial that a search for Ms and DV ended with.
    pub fn settled(problem: &Problem, effects: Vec<&'static Effect<f64>>, settled: Settled) -> Self {
        Self::of(problem, effects, settled.stiction, settled.descent)
    }

    fn of(problem: &Problem, effects: Vec<&'static Effect<f64>>, stiction: Stiction, descent: Descent) -> Self {
        let fixed = with_stiction(problem, stiction);
        let parameters = fixed.parameters(&descent.point.values);
        Self { effects, unknowns: fixed.unknowns, parameters, stiction, point: descent.point, cost: descent.cost }
    }

    /// The problem of this trial.
    pub fn problem<'a>(&self, of: &Problem<'a>) -> Problem<'a> {
        Problem { template: self.parameters.clone(), unknowns: self.unknowns.clone(), ..of.clone() }
    }

    /// The same model, its cost that on the swings of another problem.
    pub fn judged(&self, of: &Problem) -> Self {
        let problem = with_stiction(&self.problem(of), self.stiction);
        let cost = problem.costs(Window::Whole, std::slice::from_ref(&self.point))[0];
        Self { cost, ..self.clone() }
    }

    /// Is an effect of this name among the added ones?
    pub fn has(&self, name: &str) -> bool {
        self.effects.iter().any(|effect| effect.name == name)
    }

    /// Names of the added effects.
    pub fn names(&self) -> Vec<&'static str> {
        self.effects.iter().map(|effect| effect.name).collect()
    }

    /// Numbers of the added effects.
    pub fn n_added(&self) -> usize {
        self.effects.iter().map(|effect| effect.parameters.len()).sum()
    }

    /// This model with one more effect, its values given, the others as fitted.
    pub fn with(
        &self,
        of: &Problem,
        effect: &'static Effect<f64>,
        values: &[f64],
    ) -> Option<(Vec<Unknown>, Parameters<f64>)> {
        let mut parameters = self.parameters.clone();
        add(&mut parameters, effect, values).ok()?;
        let mut unknowns = self.unknowns.clone();
        unknowns.extend(Unknown::all_of_effect(effect, &of.template));
        Some((unknowns, parameters))
    }
}

/// Fits a model roughly from a guess, Ms and DV fixed.
pub fn fit_from(problem: &Problem, effects: Vec<&'static Effect<f64>>, point: &Point, stiction: Stiction) -> Trial {
    let fixed = with_stiction(problem, stiction);
    let descent = descend(&fixed, point, Window::Whole, Patience::SCREEN, Steps::found(&fixed, point));
    Trial::of(&fixed, effects, stiction, descent)
}

/// Fits on, Ms and DV fixed.
pub fn refined(of: &Problem, trial: &Trial, patience: Patience) -> Trial {
    let problem = with_stiction(&trial.problem(of), trial.stiction);
    let descent = descend(&problem, &trial.point, Window::Whole, patience, Steps::new(&problem));
    Trial::of(&problem, trial.effects.clone(), trial.stiction, descent)
}

/// Fits on from where a trial is, Ms and DV too if it has a band.
pub fn fitted_on(of: &Problem, trial: &Trial, patience: Patience) -> Trial {
    if trial.stiction.velocity_band == 0.0 {
        return refined(of, trial, patience);
    }
    let problem = trial.problem(of);
    let settled = stiction::freed(&problem, &trial.point, trial.stiction, patience);
    Trial::settled(&problem, trial.effects.clone(), settled)
}

/// Begins again with the first swings, from where a fit got stuck.
fn regrown(of: &Problem, trial: &Trial) -> Trial {
    let problem = with_stiction(&trial.problem(of), trial.stiction);
    let grown = windows::grow(&problem, &trial.point);
    Trial::of(&problem, trial.effects.clone(), trial.stiction, grown)
}

/// A model fitted on sketches until little moves, with the levels of Ms that suit it there.
#[derive(Clone, Debug)]
pub struct Sketch {
    /// The model; its cost is that on the sketches.
    pub trial: Trial,
    levels: Vec<Settled>,
}

impl Sketch {
    /// Searches Ms on the sketches of `rough`; no velocity band is sought, but one that is there may stay.
    pub fn of(rough: &Problem, trial: &Trial) -> Self {
        let problem = trial.problem(rough);
        let levels = stop_level::levels(&problem, &trial.point);
        let best = Trial::settled(&problem, trial.effects.clone(), levels[0].clone());
        let has_band = trial.stiction.velocity_band > 0.0;
        let trial = if has_band { better(refined(rough, trial, Patience::ROUGH), best) } else { best };
        Self { trial, levels }
    }

    /// Begins anew with the first swings, then seeks a velocity band too, and keeps what is better.
    pub fn seen_from_other_sides(&mut self, problem: &Problem, rough: &Problem) {
        let anew = Self::of(rough, &regrown(rough, &self.trial));
        if anew.trial.cost < self.trial.cost {
            *self = anew;
        }
        if !is_well_explained(problem, &self.trial) {
            let with_band = finish_with_band(rough, &self.trial);
            self.trial = better(self.trial.clone(), with_band);
        }
    }

    /// The model fitted to all samples until nothing moves.
    pub fn on_all(&self, of: &Problem) -> Trial {
        if self.trial.stiction.velocity_band > 0.0 {
            return fitted_on(of, &self.trial, Patience::JUDGE);
        }
        let problem = self.trial.problem(of);
        let settled = stop_level::best_of(&self.levels, &problem, Patience::JUDGE);
        Trial::settled(&problem, self.trial.effects.clone(), settled)
    }
}

/// Fits on until nothing moves, and searches Ms.
pub fn finish(of: &Problem, trial: &Trial) -> Trial {
    let sketches = of.sketches();
    Sketch::of(&of.on(&sketches), trial).on_all(of)
}

/// The same with a velocity band, where the noise is not reached without.
pub fn finish_with_band(of: &Problem, trial: &Trial) -> Trial {
    let problem = trial.problem(of);
    let settled = stiction::settle(&problem, &trial.point, Patience::JUDGE);
    let settled = Trial::settled(&problem, trial.effects.clone(), settled);
    let has_band = trial.stiction.velocity_band > 0.0;
    if has_band { better(refined(of, trial, Patience::JUDGE), settled) } else { settled }
}

/// The one with the lower cost.
pub fn better(a: Trial, b: Trial) -> Trial {
    if b.cost < a.cost { b } else { a }
}
