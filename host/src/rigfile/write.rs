//! Model file → text: the first version with its comments, and updates that leave a person's own comments alone.

use super::keys::PRIOR_KEY;
use super::{FORMAT_VERSION, Knowledge, Quantity};
use crate::fit::tolerance::Known;
use crate::formula::effect_of;
use crate::recording::Measured;
use shared::effect::{Action, CURVE_ID, CURVE_NAME, CUSTOM_FORMULA_ID, CUSTOM_FORMULA_NAME, Effect};
use shared::parameters::Parameters;
use shared::sensor::Sensor;
use std::fmt::Write;
use toml_edit::{Array, DocumentMut, InlineTable, Item, Table, Value};

/// Digits of a value that are written beyond its standard deviation.
const DIGITS_BEYOND_STD: i32 = 3;

const HEAD: &str = "\
# The model of one pendulum rig, for the program `host`. SI units and radians.
# Edit it freely: comments and order are kept when a fit updates the values.
# A value is a plain number, or { value = …, std = …, method = \"…\", recordings = [\"…\"] }:
# the number, its standard deviation, how it was found and from what.
";

const NORMALISED: &str = "\
# The geometry is unknown: mass and length are chosen so that m·g·l = 1. Every torque and inertia below is per m·g·l;
# multiply by the real m·g·l to get SI units. What the period tells, (m·l² + I)/(m·g·l) of the real pendulum in s²,
# is the inertia below and length/gravity together.
";

/// A new file for parameters that passed their check.
pub(super) fn template(parameters: &Parameters<f64>, normalised: bool) -> String {
    let mut text = format!("{HEAD}format = {FORMAT_VERSION}\n\n[pendulum]\n");
    if normalised {
        text += NORMALISED;
        text += "normalised = true\n";
    }
    for quantity in Quantity::PENDULUM {
        let value = quantity.get(parameters).unwrap_or_default();
        let (unit, meaning) = (quantity.unit(), quantity.meaning());
        let _ = writeln!(text, "{} = {} # {unit}, {meaning}", quantity.key(), plain(value));
    }
    for present in &parameters.effects {
        let Some(effect) = effect_of(parameters, present.id) else { continue };
        let _ = write!(text, "\n[effect.{}]\n# {}\n", effect.name, effect.summary);
        if let Action::Formula(formula) = effect.action {
            let _ = writeln!(text, "formula = {}", Value::from(formula.text()));
        }
        for (parameter, value) in effect.parameters.iter().zip(&present.values) {
            let (symbol, unit, meaning) = (parameter.symbol, parameter.unit, parameter.meaning);
            let value = plain(*value);
            let _ = writeln!(text, "# {unit}, {meaning}\n{symbol} = {{ value = {value}, method = \"guess\" }}");
        }
    }
    text
}

/// Sets one value in its table, which must be there.
pub(super) fn set_value(
    document: &mut DocumentMut,
    quantity: Quantity,
    value: f64,
    knowledge: &Knowledge,
    prior: Option<Known>,
) {
    let table = match quantity {
        Quantity::Effect { .. } | Quantity::Custom { .. } => &mut document["effect"][quantity.owner()],
        _ => &mut document["pendulum"],
    };
    let Some(table) = table.as_table_like_mut() else { return };
    let new = described(value, knowledge, prior);
    match table.get_mut(quantity.key()) {
        // Only the value is replaced, so that the comment behind it stays.
        Some(Item::Value(old)) => {
            let decor = old.decor().clone();
            *old = new;
            *old.decor_mut() = decor;
        }
        Some(item) => *item = Item::Value(new),
        None => {
            table.insert(quantity.key(), Item::Value(new));
        }
    }
}

/// Adds the table of an effect, with a comment and its values.
pub(super) fn add_effect(document: &mut DocumentMut, quantity: Quantity, parameters: &Parameters<f64>) {
    let Some((id, _)) = quantity.place() else { return };
    let Some((effect, values)) = effect_of(parameters, id).zip(parameters.values(id)) else { return };
    let mut table = Table::new();
    table.decor_mut().set_prefix(format!("\n# {}\n", effect.summary));
    if let Action::Formula(formula) = effect.action {
        table.insert("formula", Item::Value(Value::from(formula.text())));
    }
    for (parameter, value) in effect.parameters.iter().zip(values) {
        table.insert(parameter.symbol, Item::Value(number(*value)));
        let comment = format!("# {}, {}\n", parameter.unit, parameter.meaning);
        if let Some(mut key) = table.key_mut(parameter.symbol) {
            key.leaf_decor_mut().set_prefix(comment);
        }
    }
    add_table(document, effect.name, table);
}

/// Adds an effect's table.
pub(super) fn add_table(document: &mut DocumentMut, name: &str, table: Table) {
    let implicit = || {
        let mut effects = Table::new();
        effects.set_implicit(true);
        Item::Table(effects)
    };
    let effects = document.entry("effect").or_insert_with(implicit);
    if let Some(effects) = effects.as_table_like_mut() {
        effects.insert(name, Item::Table(table));
    }
}

/// Takes the table of an effect out.
pub(super) fn remove_effect(document: &mut DocumentMut, id: u16) {
    let custom = (id == CUSTOM_FORMULA_ID).then_some(CUSTOM_FORMULA_NAME);
    let curve = (id == CURVE_ID).then_some(CURVE_NAME);
    let name = custom.or(curve).or(Effect::<f64>::by_id(id).map(|effect| effect.name));
    let effects = document.get_mut("effect").and_then(Item::as_table_like_mut);
    if let Some((effects, name)) = effects.zip(name) {
        effects.remove(name);
    }
}

/// Sets the table of the sensor. What another one had there goes; a potentiometer needs no name.
pub(super) fn set_sensor(document: &mut DocumentMut, sensor: &Sensor) {
    let fresh = || {
        let mut table = Table::new();
        let meaning = match sensor {
            Sensor::Potentiometer(_) => "Calibration: angle = (code - zero_code) * radians_per_code".to_owned(),
            other => format!("Calibration of the {}", other.name()),
        };
        table.decor_mut().set_prefix(format!("\n# {meaning}\n"));
        Item::Table(table)
    };
    let table = document.entry("sensor").or_insert_with(fresh);
    let has_other_name = table.get("kind").and_then(Item::as_str).is_some_and(|name| name != sensor.name());
    if has_other_name || (table.get("kind").is_none() && !matches!(sensor, Sensor::Potentiometer(_))) {
        let others = Sensor::NAMES.iter().filter_map(|name| Sensor::numbers_of(name)).flatten();
        let keys = others.map(|number| number.key).chain(["kind"]);
        keys.for_each(|key| drop(table.as_table_like_mut().and_then(|keys| keys.remove(key))));
    }
    if !matches!(sensor, Sensor::Potentiometer(_)) {
        table["kind"] = Item::Value(Value::from(sensor.name()));
    }
    for (known, value) in sensor.numbers() {
        let value = if known.whole.is_some() { Value::from(value as i64) } else { number(super::exactly(value)) };
        table[known.key] = Item::Value(value);
    }
}

fn described(value: f64, knowledge: &Knowledge, prior: Option<Known>) -> Value {
    if *knowledge == Knowledge::default() {
        return number(value);
    }
    let mut table = InlineTable::new();
    table.insert("value", number(value));
    if let Some(std) = knowledge.std {
        table.insert("std", number(format!("{std:.2e}").parse().unwrap_or(std)));
    }
    if let Some(source) = &knowledge.source {
        table.insert("method", Value::from(source.method.as_str()));
        if !source.recordings.is_empty() {
            table.insert("recordings", Value::Array(source.recordings.iter().map(String::as_str).collect::<Array>()));
        }
        if source.measured != Measured::default() {
            table.insert("measured", Value::from(source.measured.name()));
        }
        if let Some(Known { value, std }) = prior {
            let known = [("value", value), ("std", std)].into_iter().map(|(key, value)| (key, number(value)));
            table.insert(PRIOR_KEY, Value::InlineTable(known.collect()));
        }
    }
    Value::InlineTable(table)
}

/// Digits far below the standard deviation say nothing of a number alone. But swings tell the sum of some far better than each
/// of them, and rounded to their own ± these would not follow the swings any more: six digits stay.
pub(super) fn rounded(value: f64, std: Option<f64>) -> f64 {
    let Some(std) = std.filter(|std| *std > 0.0) else { return value };
    let n_decimals = DIGITS_BEYOND_STD - std.log10().floor() as i32;
    if !(0..=300).contains(&n_decimals) {
        return value;
    }
    let by_std = format!("{value:.precision$}", precision = n_decimals as usize).parse().unwrap_or(value);
    let by_digits = six_digits(value);
    if (by_std - value).abs() < (by_digits - value).abs() { by_std } else { by_digits }
}

/// As many as the numbers of a rig, of 32 bits, have for sure.
pub(super) fn six_digits(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

fn number(value: f64) -> Value {
    plain(value).parse().unwrap_or_else(|_| Value::from(value))
}

/// The shortest number that reads back the same; small ones with an exponent.
fn plain(value: f64) -> String {
    format!("{value:?}")
}
