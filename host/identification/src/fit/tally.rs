//! What was simulated, and what it took: not in seconds, which depend on the machine, but in steps of the base model.
//!
//! A step with a power law takes four times as long as one without. So one step of each model is taken with a number
//! that counts what is asked of it.

use shared::effect::{Action, Effect};
use shared::model::Model;
use shared::parameters::{Parameters, base};
use shared::real::Real;
use simulation::LANES;
use std::cell::Cell;
use std::collections::BTreeMap;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

/// What all who share it have simulated so far.
#[derive(Debug, Default)]
pub struct Tally {
    simulations: AtomicUsize,
    /// Steps of whatever model.
    steps_taken: AtomicU64,
    operations: AtomicU64,
    /// Operations of a step, by the effects of the model.
    known: Mutex<BTreeMap<Vec<u16>, u64>>,
}

impl Tally {
    /// Takes in swings that were simulated side by side, each in so many steps; idle lanes take the time of busy ones. Wider
    /// registers are quicker, but must not change what is found.
    pub(crate) fn add(&self, parameters: &Parameters<f64>, n_swings: usize, n_steps: usize) {
        let n_lanes = n_swings.next_multiple_of(LANES);
        self.simulations.fetch_add(n_swings, Ordering::Relaxed);
        self.steps_taken.fetch_add((n_swings * n_steps) as u64, Ordering::Relaxed);
        let operations = self.operations_of_step(parameters) * (n_steps * n_lanes) as u64;
        self.operations.fetch_add(operations, Ordering::Relaxed);
    }

    /// Simulated swings.
    pub fn simulations(&self) -> usize {
        self.simulations.load(Ordering::Relaxed)
    }

    /// Their steps, whatever the model.
    pub fn steps_taken(&self) -> u64 {
        self.steps_taken.load(Ordering::Relaxed)
    }

    /// What they took, in steps of the base model.
    pub fn steps(&self) -> u64 {
        self.operations.load(Ordering::Relaxed) / self.operations_of_step(&bare())
    }

    /// What swings beside the pendulum takes several times as long, but is fitted in few models; were it charged, nothing
    /// would be left for the two laws that it imitates.
    fn operations_of_step(&self, parameters: &Parameters<f64>) -> u64 {
        let mut charged = parameters.clone();
        charged.effects.retain(|effect| !is_support(effect.id));
        let mut key: Vec<u16> = charged.effects.iter().map(|effect| effect.id).collect();
        key.push(parameters.curve.as_ref().map_or(0, |curve| curve.speeds_rad_s().len() as u16));
        let mut known = self.known.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        *known.entry(key).or_insert_with(|| operations_of_step(&charged))
    }
}

fn is_support(id: u16) -> bool {
    Effect::<f64>::by_id(id).is_some_and(|effect| matches!(effect.action, Action::Support(_)))
}

fn bare() -> Parameters<f64> {
    let mut parameters = Parameters::paper();
    parameters.effects.retain(|effect| effect.id <= base::STICTION);
    parameters
}

/// A usual step of a sliding pendulum: neither released nor near a turn.
fn operations_of_step(parameters: &Parameters<f64>) -> u64 {
    let model = Model::new(&parameters.map(Counted));
    let mut state = model.release(Counted(0.5), Counted(1.0));
    OPERATIONS.set(0);
    model.step(&mut state, Counted(0.01));
    OPERATIONS.get()
}

thread_local! {
    static OPERATIONS: Cell<u64> = const { Cell::new(0) };
}

/// A number that counts.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Counted(f64);

/// What operations take in a lane, in additions: measured times of steps with drag, Stribeck friction, a power law and
/// presliding come out to a fifth.
const DIVISION: u64 = 4;
const SINE: u64 = 20;
const EXPONENTIAL: u64 = 45;
const LOGARITHM: u64 = 55;
const POWER: u64 = 110;
const ROW: u64 = 20;

impl Counted {
    fn after(operations: u64, value: f64) -> Self {
        OPERATIONS.set(OPERATIONS.get() + operations);
        Self(value)
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $operator:tt, $operations:expr) => {
        impl $trait for Counted {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                Self::after($operations, self.0 $operator other.0)
            }
        }
    };
}

operator!(Add, add, +, 1);
operator!(Sub, sub, -, 1);
operator!(Mul, mul, *, 1);
operator!(Div, div, /, DIVISION);

impl Neg for Counted {
    type Output = Self;
    fn neg(self) -> Self {
        Self::after(1, -self.0)
    }
}

impl Real for Counted {
    type Mask = bool;

    fn of(value: f64) -> Self {
        Self(value)
    }
    fn lt(self, other: Self) -> bool {
        Self::after(1, 0.0);
        self.0 < other.0
    }
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        Self::after(1, if mask { yes.0 } else { no.0 })
    }
    fn abs(self) -> Self {
        Self::after(1, self.0.abs())
    }
    fn sqrt(self) -> Self {
        Self::after(DIVISION, self.0.sqrt())
    }
    fn sin(self) -> Self {
        Self::after(SINE, self.0.sin())
    }
    fn exp(self) -> Self {
        Self::after(EXPONENTIAL, self.0.exp())
    }
    fn ln(self) -> Self {
        Self::after(LOGARITHM, self.0.ln())
    }
    fn powf(self, exponent: Self) -> Self {
        Self::after(POWER, self.0.powf(exponent.0))
    }
    fn row<const N: usize>(self, rows: &[[Self; N]]) -> [Self; N] {
        Self::after(ROW, 0.0);
        rows[rows.partition_point(|row| row[0].0 <= self.0).saturating_sub(1)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps_of(effects: &[&str]) -> f64 {
        let mut parameters = bare();
        for name in effects {
            let effect = Effect::<f64>::by_name(name).unwrap();
            let values: Vec<f64> = effect.parameters.iter().map(|p| 0.5 * (p.low + p.high)).collect();
            parameters.set(effect.id, &values).unwrap();
        }
        operations_of_step(&parameters) as f64 / operations_of_step(&bare()) as f64
    }

    #[test]
    fn a_step_costs_what_was_measured() {
        // ns a lane beside the 15 of the base model (docs/performance.md).
        let measured = [("quadratic-drag", 20.0), ("stribeck", 44.0), ("power-law-drag", 68.0), ("presliding", 44.0)];
        for (name, measured) in measured {
            let counted = 15.0 * steps_of(&[name]);
            assert!((counted / measured - 1.0).abs() < 0.2, "{name}: {counted} in place of {measured} ns");
        }
    }

    #[test]
    fn lanes_take_as_long_with_one_swing_in_them_as_with_four() {
        let (tally, model) = (Tally::default(), bare());
        for n_swings in [1, 4] {
            let before = tally.steps();
            tally.add(&model, n_swings, 1000);
            assert_eq!(tally.steps() - before, 4000);
        }
        assert_eq!(tally.simulations(), 5);
    }
}
