//! What may act on a pendulum, read from the one list.

use crate::error::Failure;
use serde::Serialize;
use shared::effect::{Action, Effect};

/// Effects, as `--json` shows them.
#[derive(Serialize)]
pub struct Shown {
    effects: Vec<Entry>,
}

#[derive(Serialize)]
struct Entry {
    id: u16,
    name: &'static str,
    acts_on: &'static str,
    summary: &'static str,
    formula: &'static str,
    source: &'static str,
    experiment: &'static str,
    parameters: Vec<Number>,
}

#[derive(Serialize)]
struct Number {
    symbol: &'static str,
    unit: &'static str,
    low: f64,
    high: f64,
    meaning: &'static str,
}

impl Shown {
    /// These effects.
    pub fn of(effects: &[&Effect<f64>]) -> Self {
        Self { effects: effects.iter().map(|effect| entry(effect)).collect() }
    }
}

/// The effect of this name, or all of them.
///
/// # Errors
/// There is none of this name.
pub fn chosen(name: Option<&str>) -> Result<Vec<&'static Effect<f64>>, Failure> {
    match name {
        None => Ok(Effect::ALL.iter().collect()),
        Some(name) => Ok(vec![Effect::by_name(name).ok_or_else(|| unknown(name))?]),
    }
}

fn unknown(name: &str) -> Failure {
    let names: Vec<&str> = Effect::<f64>::ALL.iter().map(|effect| effect.name).collect();
    let near: Vec<&str> = names.iter().copied().filter(|known| is_near(name, known)).collect();
    let next = if near.is_empty() {
        format!("choose one of {}", names.join(", "))
    } else {
        format!("did you mean {}? `host effects` lists all", near.join(" or "))
    };
    Failure::wrong_use(format!("there is no effect called {name}")).next(next)
}

/// Less of a name is part of too many.
const LEAST_PART: usize = 3;

/// Names that begin with so many letters alike are the same one mistyped, or of one kind.
const LEAST_BEGIN: usize = 5;

/// Is what was typed part of this name, or does it begin like it?
fn is_near(typed: &str, known: &str) -> bool {
    let typed = typed.trim().to_lowercase().replace(['_', ' '], "-");
    let n_alike = typed.chars().zip(known.chars()).take_while(|(a, b)| a == b).count();
    (typed.len() >= LEAST_PART && known.contains(&typed)) || n_alike >= LEAST_BEGIN
}

/// What an effect acts on, in words.
pub fn acts_on(effect: &Effect<f64>) -> &'static str {
    match effect.action {
        Action::Base => "base model",
        Action::Drive(_) | Action::Friction(_) | Action::Curve => "torque",
        Action::State(_) => "torque with memory",
        Action::Support(_) => "something that swings with it",
        Action::Sensor(_) => "sensor",
        Action::Formula(_) => "formula",
    }
}

fn entry(effect: &Effect<f64>) -> Entry {
    let number = |p: &shared::effect::Parameter| Number {
        symbol: p.symbol,
        unit: p.unit,
        low: p.low,
        high: p.high,
        meaning: p.meaning,
    };
    Entry {
        id: effect.id,
        name: effect.name,
        acts_on: acts_on(effect),
        summary: effect.summary,
        formula: effect.formula,
        source: effect.source,
        experiment: effect.experiment,
        parameters: effect.parameters.iter().map(number).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_effect_is_shown_as_the_list_has_it() {
        for effect in Effect::<f64>::ALL {
            let shown = serde_json::to_value(Shown::of(&[effect])).unwrap();
            let entry = &shown["effects"][0];
            let text = |key: &str| entry[key].as_str().unwrap().to_owned();
            let told = ["name", "summary", "formula", "source", "experiment"].map(text);
            assert_eq!(told, [effect.name, effect.summary, effect.formula, effect.source, effect.experiment]);
            for (shown, parameter) in entry["parameters"].as_array().unwrap().iter().zip(effect.parameters) {
                assert_eq!((&shown["symbol"], &shown["unit"]), (&parameter.symbol.into(), &parameter.unit.into()));
                assert_eq!((&shown["low"], &shown["high"]), (&parameter.low.into(), &parameter.high.into()));
            }
        }
        let on = |name: &str| acts_on(chosen(Some(name)).unwrap()[0]);
        assert_eq!(["coulomb", "quadratic-drag", "angle-offset"].map(on), ["base model", "torque", "sensor"]);
        assert_eq!(["presliding", "resonant-support"].map(on), ["torque with memory", "something that swings with it"]);
    }

    #[test]
    fn a_name_that_is_none_is_answered_by_those_that_are_near() {
        let next = |name: &str| chosen(Some(name)).unwrap_err().next_step().unwrap().to_owned();
        for typed in ["quadratic", "quadratik-drag", "Quadratic_Drag"] {
            assert_eq!(next(typed), "did you mean quadratic-drag? `host effects` lists all", "{typed}");
        }
        assert!(next("drag").contains("quadratic-drag or "), "{}", next("drag"));
        assert!(next("xyz").starts_with("choose one of "), "{}", next("xyz"));
    }
}
