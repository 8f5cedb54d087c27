//! One fitted model: its parameters, Ms and DV among them, how each swing began, what it costs, and why the search for
//! it ended. [`Fitted::refined`] in [`super::refine`] is what makes a better one of it.

use super::descent::{Descent, Termination};
use super::linear::{Linear, Steps, linearise};
use super::problem::{Point, Problem, Quantity, Start, Unknown};
use crate::formula::{FRICTION_CURVE, add, effect_of};
use crate::swing::Window;
use shared::curve::Curve;
use shared::effect::{CURVE_ID, Effect};
use shared::parameters::{Parameters, base};

/// Ms and DV: the two parameters in which the error is not smooth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stiction {
    /// Ms, N·m.
    pub level_nm: f64,
    /// DV, rad/s.
    pub velocity_band: f64,
}

impl Stiction {
    /// Neither.
    pub const NONE: Self = Self { level_nm: 0.0, velocity_band: 0.0 };

    /// A level without a band.
    pub fn level(level_nm: f64) -> Self {
        Self { level_nm, velocity_band: 0.0 }
    }

    /// As parameters have it.
    pub fn of(parameters: &Parameters<f64>) -> Self {
        match parameters.values(base::STICTION) {
            Some(&[level_nm, velocity_band, ..]) => Self { level_nm, velocity_band },
            _ => Self::NONE,
        }
    }

    /// Into parameters.
    pub fn put_into(self, parameters: &mut Parameters<f64>) {
        // The base effects always have their place in the list.
        let _ = parameters.set(base::STICTION, &[self.level_nm, self.velocity_band]);
    }
}

/// A fitted model.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The effects beside the base, in the order in which they were added.
    pub effects: Vec<&'static Effect<f64>>,
    /// What is identified, but Ms and DV, in which the error is not smooth.
    pub unknowns: Vec<Unknown>,
    /// All numbers as fitted, Ms and DV among them.
    pub parameters: Parameters<f64>,
    /// How each swing began.
    pub starts: Vec<Start>,
    /// Sum of squared errors over the samples it was last fitted to or evaluated on, rad²; infinite before that.
    pub cost: f64,
    /// Other Ms between these stop the pendulum alike, N·m.
    pub level_range_nm: (f64, f64),
    /// Why the last descent ended; `None` if there was none yet.
    pub termination: Option<Termination>,
    /// Finite-difference steps to go on with.
    pub(crate) steps: Option<Steps>,
}

impl Fitted {
    /// The model of a problem at a guess, not fitted yet.
    pub fn at(problem: &Problem, point: &Point) -> Self {
        let parameters = problem.parameters(&point.values);
        let added = parameters.effects.iter().filter_map(|present| effect_of(&parameters, present.id));
        let level_nm = Stiction::of(&parameters).level_nm;
        let at_guess = |(unknown, value): (&Unknown, &f64)| Unknown { own: *value, ..unknown.clone() };
        let all = problem.unknowns.iter().zip(&point.values);
        Self {
            effects: added.filter(|effect| !effect.is_base() && !problem.is_free_scale(effect)).collect(),
            unknowns: all.filter(|(unknown, _)| !unknown.is_stiction()).map(at_guess).collect(),
            parameters,
            starts: point.starts.clone(),
            cost: f64::INFINITY,
            level_range_nm: (level_nm, level_nm),
            termination: None,
            steps: None,
        }
    }

    /// The unknowns' values and the starts.
    pub fn point(&self) -> Point {
        let values = self.unknowns.iter().map(|unknown| unknown.get(&self.parameters)).collect();
        Point { values, starts: self.starts.clone() }
    }

    /// What is to be identified of this model, from the swings of a problem.
    pub fn problem<'a>(&self, on: &Problem<'a>) -> Problem<'a> {
        Problem { template: self.parameters.clone(), unknowns: self.unknowns.clone(), ..on.clone() }
    }

    /// Ms and DV.
    pub fn stiction(&self) -> Stiction {
        Stiction::of(&self.parameters)
    }

    /// Does it have a velocity band?
    pub fn has_band(&self) -> bool {
        self.stiction().velocity_band > 0.0
    }

    /// The same with other Ms and DV; its cost is that from before.
    pub fn with_stiction(&self, stiction: Stiction) -> Self {
        let mut changed = self.clone();
        stiction.put_into(&mut changed.parameters);
        changed.level_range_nm = (stiction.level_nm, stiction.level_nm);
        changed
    }

    /// The same model with what it costs on the swings of a problem.
    pub fn evaluated(&self, on: &Problem) -> Self {
        let cost = self.problem(on).costs(Window::Whole, std::slice::from_ref(&self.point()))[0];
        Self { cost, ..self.clone() }
    }

    /// Where a descent of [`Fitted::problem`] ended.
    pub(super) fn after(&self, descent: Descent) -> Self {
        let mut moved = self.clone();
        for (unknown, value) in moved.unknowns.iter_mut().zip(&descent.point.values) {
            unknown.set(&mut moved.parameters, *value);
            unknown.own = *value;
        }
        let Descent { point, cost, steps, termination } = descent;
        Self { starts: point.starts, cost, steps: Some(steps), termination: Some(termination), ..moved }
    }

    /// The model linearised where it is, with steps of the right size.
    pub fn linearised<'a>(&self, on: &Problem<'a>) -> Linear<'a> {
        let (problem, point) = (self.problem(on), self.point());
        linearise(&problem, &point, Window::Whole, &mut Steps::found(&problem, &point))
    }

    /// The same with one more effect at some values, not fitted yet; `None` if there is no room for it.
    pub fn with(&self, effect: &'static Effect<f64>, values: &[f64]) -> Option<Self> {
        let mut larger = Self { cost: f64::INFINITY, termination: None, steps: None, ..self.clone() };
        add(&mut larger.parameters, effect, &values[..effect.parameters.len()]).ok()?;
        larger.unknowns.extend(Unknown::all_of_effect(effect, &self.parameters));
        larger.effects.push(effect);
        Some(larger)
    }

    /// The same with a friction curve in place of viscous and Coulomb friction, not fitted yet; `None` if there is no
    /// room for it.
    pub fn with_curve(&self, curve: &Curve<f64>) -> Option<Self> {
        let mut other = self.without(CURVE_ID);
        let replaced = |id: u16| id == base::VISCOUS || id == base::COULOMB;
        other.unknowns.retain(|unknown| !matches!(unknown.quantity, Quantity::Effect { id, .. } if replaced(id)));
        other.parameters.set(base::VISCOUS, &[0.0]).ok()?;
        other.parameters.set(base::COULOMB, &[0.0]).ok()?;
        other.parameters.set_curve(curve).ok()?;
        other.unknowns.extend(Unknown::knots(&other.parameters));
        other.effects.push(&FRICTION_CURVE);
        Some(other)
    }

    /// The same with viscous (N·m·s/rad) and Coulomb friction (N·m) in place of a friction curve, as another model has them
    /// to be identified, not fitted yet; `None` if the parameters have no place for them.
    pub fn with_straight_friction(&self, like: &Self, viscous: f64, coulomb_nm: f64) -> Option<Self> {
        let mut other = self.without(CURVE_ID);
        other.parameters.set(base::VISCOUS, &[viscous]).ok()?;
        other.parameters.set(base::COULOMB, &[coulomb_nm]).ok()?;
        let is_straight = |id: u16| id == base::VISCOUS || id == base::COULOMB;
        let is_it = |unknown: &&Unknown| matches!(unknown.quantity, Quantity::Effect { id, .. } if is_straight(id));
        other.unknowns.extend(like.unknowns.iter().filter(is_it).cloned());
        Some(other)
    }

    /// The same without an effect, not fitted yet.
    pub fn without(&self, id: u16) -> Self {
        let mut smaller = Self { cost: f64::INFINITY, termination: None, steps: None, ..self.clone() };
        smaller.parameters.remove(id);
        smaller.unknowns.retain(|unknown| !matches!(unknown.quantity, Quantity::Effect { id: of, .. } if of == id));
        smaller.unknowns.retain(|unknown| id != CURVE_ID || !matches!(unknown.quantity, Quantity::Knot(_)));
        smaller.effects.retain(|effect| effect.id != id);
        if id == base::STICTION { smaller.with_stiction(Stiction::NONE) } else { smaller }
    }

    /// Is an effect of this name among the added ones?
    pub fn has(&self, name: &str) -> bool {
        self.effects.iter().any(|effect| effect.name == name)
    }

    /// Names of the added effects.
    pub fn names(&self) -> Vec<&'static str> {
        self.effects.iter().map(|effect| effect.name).collect()
    }

    /// What people call it: its effects joined by `+`, `none` for the base model.
    pub fn name(&self) -> String {
        if self.effects.is_empty() { "none".to_owned() } else { self.names().join("+") }
    }

    /// How many numbers the added effects have.
    pub fn n_added(&self) -> usize {
        self.effects.iter().map(|effect| effect.parameters.len()).sum()
    }

    /// The one with the lower cost.
    pub fn better(self, other: Self) -> Self {
        if other.cost < self.cost { other } else { self }
    }
}

/// Puts the lowest cost first.
pub fn sort(models: &mut [Fitted]) {
    models.sort_by(|a, b| a.cost.total_cmp(&b.cost));
}
