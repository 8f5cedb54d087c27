//! A formula as an effect like those of the list.

use super::FormulaError;
use super::compile::compile;
use super::domain::{has_values, instants};
use super::parse::{Parsed, parse};
use super::ranges::Declared;
use shared::effect::{
    Action, CURVE_ID, CUSTOM_FORMULA_ID, CUSTOM_FORMULA_NAME, Effect, Family, MAX_VALUES, Parameter, Rules,
};
use shared::formula::{Formula, Program};
use shared::parameters::{ParameterError, Parameters};
use std::collections::HashMap;
use std::sync::{Mutex, OnceLock, PoisonError};

/// Where in its range the search for a parameter that is no strength begins, one start each.
const SHARES: [f64; 3] = [0.5, 0.2, 0.8];

/// A program that reads more different formulas than this was never meant to; each takes about a kilobyte.
const MOST_KEPT: usize = 10_000;

/// Effects by text. Everything that lists effects expects them to live for ever, so each formula is kept once.
fn known() -> &'static Mutex<HashMap<String, &'static Effect<f64>>> {
    static KNOWN: OnceLock<Mutex<HashMap<String, &'static Effect<f64>>>> = OnceLock::new();
    KNOWN.get_or_init(Mutex::default)
}

/// Reads a formula and makes an effect of it.
///
/// # Errors
/// What is wrong with it, and where; or that too many others were read before.
pub fn read(text: &str) -> Result<&'static Effect<f64>, FormulaError> {
    let parsed = parse(text)?;
    if let Some(effect) = kept_already(&parsed) {
        return Ok(effect);
    }
    let understood = understood(&parsed)?;
    let mut known = known().lock().unwrap_or_else(PoisonError::into_inner);
    if known.len() >= MOST_KEPT {
        let problem = format!("{MOST_KEPT} formulas were read already, and no more are kept; start the program again");
        return Err(FormulaError::whole(&parsed.text, problem));
    }
    let effect = *known.entry(parsed.text.clone()).or_insert_with(|| Box::leak(Box::new(effect(&parsed, understood))));
    Ok(effect)
}

/// Is this a formula? Says the same as [`read`], and keeps nothing.
///
/// # Errors
/// What is wrong with it, and where.
pub fn check(text: &str) -> Result<(), FormulaError> {
    understood(&parse(text)?).map(|_| ())
}

fn kept_already(parsed: &Parsed) -> Option<&'static Effect<f64>> {
    known().lock().unwrap_or_else(PoisonError::into_inner).get(&parsed.text).copied()
}

/// A formula that can be used, and where a search for its parameters begins.
struct Understood {
    formula: Formula,
    starts: Vec<[f64; MAX_VALUES]>,
}

fn understood(parsed: &Parsed) -> Result<Understood, FormulaError> {
    let formula = compile(parsed)?;
    has_values(parsed, &formula)?;
    let starts = starts(parsed, &formula);
    Ok(Understood { formula, starts })
}

/// Friction as a free curve of the speed.
pub static FRICTION_CURVE: Effect<f64> = shared::curve::effect();

/// The effect with an id, as it is meant in a set of parameters.
pub fn effect_of<R>(parameters: &Parameters<R>, id: u16) -> Option<&'static Effect<f64>> {
    match id {
        CUSTOM_FORMULA_ID => read(parameters.formula.as_ref()?.text()).ok(),
        CURVE_ID => Some(&FRICTION_CURVE),
        _ => Effect::by_id(id),
    }
}

/// Adds an effect with its values, a formula with its law.
pub fn add(parameters: &mut Parameters<f64>, effect: &Effect<f64>, values: &[f64]) -> Result<(), ParameterError> {
    match effect.action {
        Action::Formula(formula) => parameters.set_formula(formula, values),
        _ => parameters.set(effect.id, values),
    }
}

fn effect(parsed: &Parsed, Understood { formula, starts }: Understood) -> Effect<f64> {
    let parameter = |(index, declared): (usize, &Declared)| Parameter {
        symbol: kept(&declared.name),
        unit: kept(&declared.unit),
        low: declared.low,
        high: declared.high,
        start: starts[0][index],
        meaning: "parameter of the formula",
    };
    Effect {
        id: CUSTOM_FORMULA_ID,
        name: CUSTOM_FORMULA_NAME,
        summary: "A torque that was typed as a formula.",
        formula: kept(&parsed.text),
        source: "typed by the user",
        experiment: "Releases from several angles, small and large.",
        parameters: Vec::leak(parsed.parameters.iter().enumerate().map(parameter).collect()),
        family: Family::Typed,
        generalises: None,
        is_fine: true,
        rules: Rules::NONE,
        action: Action::Formula(Box::leak(Box::new(formula))),
        starts: Vec::leak(starts),
    }
}

fn kept(text: &str) -> &'static str {
    String::leak(text.to_owned())
}

/// Strengths begin at zero, what else there is within its range.
fn starts(parsed: &Parsed, formula: &Formula) -> Vec<[f64; MAX_VALUES]> {
    let law = Law { program: Program::new(formula), parameters: &parsed.parameters };
    let strengths = law.strengths();
    let start = |share: f64| {
        std::array::from_fn(|index| match parsed.parameters.get(index) {
            None => 0.0,
            Some(_) if strengths.contains(&index) => 0.0,
            Some(p) => p.low + share * (p.high - p.low),
        })
    };
    let only_strengths = strengths.len() == parsed.parameters.len();
    SHARES.into_iter().take(if only_strengths { 1 } else { SHARES.len() }).map(start).collect()
}

/// The torque as a function of its parameters.
struct Law<'a> {
    program: Program<f64>,
    parameters: &'a [Declared],
}

impl Law<'_> {
    /// Parameters that the torque is proportional to, and that may be zero: together zero without all torque gone for
    /// good, as it would be with both factors of a product.
    fn strengths(&self) -> Vec<usize> {
        let mut chosen: Vec<usize> = Vec::new();
        for index in (0..self.parameters.len()).filter(|index| self.is_linear(*index)) {
            let independent = chosen.iter().all(|other| self.is_there_without(*other) && self.is_there_without(index));
            if independent {
                chosen.push(index);
            }
        }
        chosen
    }

    fn is_linear(&self, index: usize) -> bool {
        let Declared { low, high, .. } = self.parameters[index];
        if !(low..=high).contains(&0.0) {
            return false;
        }
        let half_way = 0.5 * if high > 0.0 { high } else { low };
        let at = |value: f64| self.torques(&self.middle_but(index, value));
        let (nothing, half, whole) = (at(0.0), at(half_way), at(2.0 * half_way));
        let bend = |((nothing, half), whole): ((&f64, &f64), &f64)| (whole + nothing - 2.0 * half).abs();
        let size = |(nothing, whole): (&f64, &f64)| (whole - nothing).abs();
        let bent = nothing.iter().zip(&half).zip(&whole).map(bend).fold(0.0, f64::max);
        bent <= LINEAR * nothing.iter().zip(&whole).map(size).fold(0.0, f64::max)
    }

    /// Is there a torque though this parameter is zero?
    fn is_there_without(&self, index: usize) -> bool {
        self.torques(&self.middle_but(index, 0.0)).iter().any(|torque| *torque != 0.0)
    }

    fn middle_but(&self, index: usize, value: f64) -> [f64; MAX_VALUES] {
        // Not quite the middle, which is zero for a range around it.
        let inside = |p: &Declared| p.low + 0.61 * (p.high - p.low);
        std::array::from_fn(|i| if i == index { value } else { self.parameters.get(i).map_or(0.0, inside) })
    }

    fn torques(&self, values: &[f64; MAX_VALUES]) -> Vec<f64> {
        instants().map(|motion| self.program.raw_nm(&motion, values)).collect()
    }
}

/// What rounding leaves of a second difference, as a share of the first.
const LINEAR: f64 = 1e-9;
