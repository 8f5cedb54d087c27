//! A friction level that differs from swing to swing while its shape stays: of a bearing that was warm, cold or pushed
//! aside. Two factors a swing, one on dry friction and stiction, one on what grows with the speed.
//!
//! Their means are 1, so that the model's own numbers are those of the mean level: n factors are 1 plus n − 1
//! contrasts, at right angles and of length one (F. R. Helmert's), which all swings share as unknowns. A prior keeps
//! them near zero.

use super::fitted::Fitted;
use super::problem::{Part, Problem, Quantity, Unknown};
use super::tolerance::Prior;
use crate::formula::effect_of;
use shared::curve::Curve;
use shared::effect::{Action, Effect};
use shared::parameters::Parameters;

/// What levels are called among the unknowns.
pub const NAME: &str = "level";

/// Levels of the best known rig lie within 12 % of each other; with few releases nothing but this keeps them from
/// standing for whatever else is missing.
const USUAL_STD: f64 = 0.1;

/// From so many releases on their scatter shows by itself, and the prior is only to keep a part that no swing shows.
const MANY: usize = 4;
const WIDE_STD: f64 = 0.3;

/// No level is half another one: so far from the mean friction is another one.
const LARGEST: f64 = 0.6;

/// A change of a level that matters.
const SCALE: f64 = 0.02;

impl Unknown {
    /// The levels of so many swings as unknowns: all contrasts of the dry part, then those of the other.
    pub fn levels(n_swings: usize) -> Vec<Self> {
        let std = if n_swings < MANY { USUAL_STD } else { WIDE_STD };
        let of_part = |part: Part| {
            let symbol = if part == Part::Dry { "dry" } else { "speed" };
            (1..n_swings).map(move |contrast| Self {
                quantity: Quantity::Level { part, contrast },
                symbol,
                name: NAME,
                unit: "1",
                low: -LARGEST,
                high: LARGEST,
                scale: SCALE,
                prior: Some(Prior { value: 0.0, std, only_below: false }),
                own: 0.0,
            })
        };
        Part::ALL.into_iter().flat_map(of_part).collect()
    }
}

impl Fitted {
    /// The same model with a friction level of each swing, not fitted yet.
    pub fn with_levels(&self) -> Self {
        let mut larger = Self { cost: f64::INFINITY, termination: None, steps: None, ..self.clone() };
        larger.unknowns.extend(Unknown::levels(self.starts.len()));
        larger
    }
}

/// How much a contrast has of a swing.
pub fn share(contrast: usize, swing_idx: usize) -> f64 {
    let length = ((contrast * (contrast + 1)) as f64).sqrt();
    match swing_idx.cmp(&contrast) {
        std::cmp::Ordering::Less => 1.0 / length,
        std::cmp::Ordering::Equal => -(contrast as f64) / length,
        std::cmp::Ordering::Greater => 0.0,
    }
}

impl Problem<'_> {
    /// Are there levels among the unknowns?
    pub fn has_levels(&self) -> bool {
        self.unknowns.iter().any(|unknown| matches!(unknown.quantity, Quantity::Level { .. }))
    }

    /// Puts the level of a swing into parameters that are common to all.
    pub(super) fn put_level(&self, parameters: &mut Parameters<f64>, swing_idx: usize, values: &[f64]) {
        if !self.has_levels() {
            return;
        }
        let factor = |wanted: Part| {
            let all = self.unknowns.iter().zip(values);
            all.fold(1.0, |sum, (unknown, value)| match unknown.quantity {
                Quantity::Level { part, contrast } if part == wanted => sum + share(contrast, swing_idx) * value,
                _ => sum,
            })
        };
        scale(parameters, factor(Part::Dry), factor(Part::Speed));
    }
}

/// Multiplies the two parts of the friction.
fn scale(parameters: &mut Parameters<f64>, dry: f64, speed: f64) {
    let parts: Vec<Vec<Option<Part>>> =
        parameters.effects.iter().map(|present| parts(parameters, present.id)).collect();
    for (present, parts) in parameters.effects.iter_mut().zip(parts) {
        for (value, part) in present.values.iter_mut().zip(parts) {
            match part {
                Some(Part::Dry) => *value *= dry,
                Some(Part::Speed) => *value *= speed,
                None => {}
            }
        }
    }
    let Some([lowest, others @ ..]) = parameters.curve.as_mut().map(Curve::torques_nm_mut) else { return };
    others.iter_mut().for_each(|torque| *torque = *lowest * dry + (*torque - *lowest) * speed);
    *lowest *= dry;
}

fn parts(parameters: &Parameters<f64>, id: u16) -> Vec<Option<Part>> {
    effect_of(parameters, id)
        .map_or(Vec::new(), |effect| effect.parameters.iter().map(|parameter| part(effect, parameter.unit)).collect())
}

/// To which part a number of an effect belongs, by its unit: a friction torque, or one that needs a speed.
fn part(effect: &Effect<f64>, unit: &str) -> Option<Part> {
    let is_friction = matches!(effect.action, Action::Base | Action::Friction(_) | Action::Formula(_));
    match unit {
        _ if !is_friction => None,
        // N·m/s and N·m/rad are what dry and viscous friction grow by in a second.
        "N·m" | "m" | "N·m/s" => Some(Part::Dry),
        "N·m/rad" => Some(Part::Speed),
        _ if unit.starts_with("N·m") && unit.contains('s') => Some(Part::Speed),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contrasts_have_length_one_stand_at_right_angles_and_leave_the_mean() {
        let n_swings = 5;
        let product = |a: usize, b: usize| (0..n_swings).map(|k| share(a, k) * share(b, k)).sum::<f64>();
        for a in 1..n_swings {
            assert!((0..n_swings).map(|k| share(a, k)).sum::<f64>().abs() < 1e-12);
            for b in 1..n_swings {
                assert!((product(a, b) - f64::from(u8::from(a == b))).abs() < 1e-12, "{a} {b}");
            }
        }
    }

    #[test]
    fn coulomb_and_stiction_are_dry_and_drags_are_not() {
        let mut parameters = Parameters::paper();
        parameters.set(10, &[1e-5]).unwrap();
        let drift = Effect::<f64>::by_name("drifting-friction").unwrap().id;
        parameters.set(drift, &[1e-5, 1e-6, 10.0]).unwrap();
        let before = parameters.clone();
        scale(&mut parameters, 1.1, 0.8);
        let factor = |id: u16, index: usize| parameters.values(id).unwrap()[index] / before.values(id).unwrap()[index];
        let of_base = [(1, 0, 0.8), (2, 0, 1.1), (3, 0, 1.1), (3, 1, 1.0), (10, 0, 0.8)];
        for (id, index, expected) in of_base.into_iter().chain([(drift, 0, 1.1), (drift, 1, 0.8), (drift, 2, 1.0)]) {
            assert!((factor(id, index) - expected).abs() < 1e-12, "{id} {index}: {}", factor(id, index));
        }
    }
}
