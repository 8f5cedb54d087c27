//! Text → model file.

use super::keys::{FORMULA_KEY, MEASURED_KEYS, PENDULUM_KEYS, SENSOR_KEYS, TOP_KEYS, VALUE_KEYS};
use super::reader::{Reader, Result, joined};
use super::{FORMAT_VERSION, Knowledge, Quantity, RigFile, RigFileError, Source, curve};
use crate::formula::{self, FormulaError, effect_of};
use crate::recording::Measured;
use shared::curve::Curve;
use shared::effect::{CURVE_ID, CURVE_NAME, CUSTOM_FORMULA_NAME, Effect};
use shared::motion::Pendulum;
use shared::parameters::{ParameterError, Parameters};
use shared::sensor::{Calibration, Number, Potentiometer, Sensor};
use toml_edit::{Document, Item, TableLike};

pub(super) fn parse(file: &str, text: &str) -> Result<RigFile> {
    let reader = Reader { file, text };
    let document = Document::parse(text.to_owned()).map_err(|error| reader.syntax(&error))?;
    let top = document.as_table();
    reader.check_format(top)?;
    reader.check_keys("", top, &TOP_KEYS)?;

    let mut knowledge = Vec::new();
    let pendulum_table = reader.table(top, "", "pendulum")?;
    let pendulum = reader.pendulum(pendulum_table, &mut knowledge)?;
    let mut parameters = Parameters::frictionless(pendulum);
    if let Some(item) = top.get("effect") {
        reader.effects(item, &mut parameters, &mut knowledge)?;
    }
    reader.check_model(top, &parameters)?;
    let normalised = reader.flag(pendulum_table, "pendulum", "normalised")?;
    let tolerances = reader.tolerances(pendulum_table, &parameters.pendulum, normalised)?;
    let sensor = top.get("sensor");
    let measured = |item| reader.measured(reader.as_table(item, "sensor")?, "sensor");
    let measured = sensor.map(measured).transpose()?.flatten();
    let is_only_measured =
        |item: &&Item| measured.is_some() && item.as_table_like().is_some_and(|keys| keys.len() == 1);
    let sensor = sensor.filter(|item| !is_only_measured(item)).map(|item| reader.sensor(item)).transpose()?;
    Ok(RigFile { document: document.into_mut(), parameters, knowledge, tolerances, sensor, measured, normalised })
}

impl Reader<'_> {
    fn check_format(&self, top: &dyn TableLike) -> Result<()> {
        let Some(item) = top.get("format") else {
            return Err(self.missing("format", format!("`format = {FORMAT_VERSION}` as the first line")));
        };
        match item.as_integer() {
            Some(version) if version > FORMAT_VERSION => {
                Err(RigFileError::Newer { file: self.file.to_owned(), version })
            }
            Some(version) if version > 0 => Ok(()),
            _ => Err(self.bad(item.span(), "format", format!("expected {FORMAT_VERSION}"))),
        }
    }

    fn pendulum(&self, table: &dyn TableLike, knowledge: &mut Vec<(Quantity, Knowledge)>) -> Result<Pendulum<f64>> {
        self.check_keys("pendulum", table, &PENDULUM_KEYS)?;
        let mut number = |quantity: Quantity| self.value(table, "pendulum", quantity, knowledge);
        Ok(Pendulum {
            mass_kg: number(Quantity::Mass)?,
            length_m: number(Quantity::Length)?,
            inertia_kg_m2: number(Quantity::Inertia)?,
            gravity_m_s2: number(Quantity::Gravity)?,
        })
    }

    fn effects(
        &self,
        item: &Item,
        parameters: &mut Parameters<f64>,
        knowledge: &mut Vec<(Quantity, Knowledge)>,
    ) -> Result<()> {
        let effects = self.as_table(item, "effect")?;
        for (name, item) in effects.iter() {
            if name == CURVE_NAME {
                let too_many =
                    |error: ParameterError| self.bad(item.span(), &joined("effect", name), error.to_string());
                parameters.set_curve(&self.curve(item)?).map_err(too_many)?;
                continue;
            }
            let known = if name == CUSTOM_FORMULA_NAME { Some(self.formula(item)?) } else { Effect::by_name(name) };
            let Some(effect) = known else {
                let span = effects.key(name).and_then(toml_edit::Key::span).or(item.span());
                let names = Effect::<f64>::ALL.iter().map(|effect| effect.name);
                let known: Vec<&str> = names.chain([CUSTOM_FORMULA_NAME, CURVE_NAME]).collect();
                let problem = format!("there is no such effect; known are {}", known.join(", "));
                return Err(self.bad(span, &joined("effect", name), problem));
            };
            let values = self.effect(effect, item, knowledge)?;
            let too_many = |error: ParameterError| self.bad(item.span(), &joined("effect", name), error.to_string());
            formula::add(parameters, effect, &values).map_err(too_many)?;
        }
        Ok(())
    }

    /// The knots of the friction curve.
    fn curve(&self, item: &Item) -> Result<Curve<f64>> {
        let name = joined("effect", CURVE_NAME);
        let table = self.as_table(item, &name)?;
        self.check_keys(&name, table, &curve::KEYS)?;
        curve::read(table).map_err(|(key, problem)| {
            let span = table.get(key).and_then(Item::span).or(item.span());
            self.bad(span, &joined(&name, key), problem)
        })
    }

    /// The law of the custom effect.
    fn formula(&self, item: &Item) -> Result<&'static Effect<f64>> {
        let name = joined("effect", CUSTOM_FORMULA_NAME);
        let (table, key) = (self.as_table(item, &name)?, joined(&name, FORMULA_KEY));
        let expected = "a formula, such as \"torque = -k*omega; k in 0..1e-3 N·m·s/rad\"";
        let item = table.get(FORMULA_KEY).ok_or_else(|| self.missing(&key, expected.to_owned()))?;
        let text = item.as_str().ok_or_else(|| self.bad(item.span(), &key, format!("expected {expected}")))?;
        formula::read(text).map_err(|error: FormulaError| self.bad(item.span(), &key, error.to_string()))
    }

    fn effect(
        &self,
        effect: &'static Effect<f64>,
        item: &Item,
        knowledge: &mut Vec<(Quantity, Knowledge)>,
    ) -> Result<Vec<f64>> {
        let name = joined("effect", effect.name);
        let table = self.as_table(item, &name)?;
        let mut keys: Vec<&str> = effect.parameters.iter().map(|parameter| parameter.symbol).collect();
        if effect.name == CUSTOM_FORMULA_NAME {
            keys.push(FORMULA_KEY);
        }
        self.check_former(effect, &name, table)?;
        self.check_keys(&name, table, &keys)?;
        Quantity::all_of_effect(effect).map(|quantity| self.value(table, &name, quantity, knowledge)).collect()
    }

    /// Numbers of an earlier version meant something else, and so did those of other effects beside them.
    fn check_former(&self, effect: &Effect<f64>, name: &str, table: &dyn TableLike) -> Result<()> {
        let Some(former) = effect.rules.former else { return Ok(()) };
        let Some((key, item)) = table.iter().find(|(key, _)| former.symbols.contains(key)) else { return Ok(()) };
        let span = table.key(key).and_then(toml_edit::Key::span).or(item.span());
        let problem = format!(
            "an earlier version wrote this: {}. Take [{name}] out and fit the recordings anew (host improve)",
            former.meaning
        );
        Err(self.bad(span, &joined(name, key), problem))
    }

    /// A number, or a table with the number and what is known of it.
    fn value(
        &self,
        table: &dyn TableLike,
        table_name: &str,
        quantity: Quantity,
        knowledge: &mut Vec<(Quantity, Knowledge)>,
    ) -> Result<f64> {
        let name = joined(table_name, quantity.key());
        let expected = || format!("{} in {}", quantity.meaning(), quantity.unit());
        let item = table.get(quantity.key()).ok_or_else(|| self.missing(&name, expected()))?;
        let Some(detailed) = item.as_table_like() else { return self.number(item, &name) };
        let known: &[&str] = if quantity.has_tolerance() { &MEASURED_KEYS } else { &VALUE_KEYS };
        self.check_keys(&name, detailed, known)?;
        let value = detailed.get("value").ok_or_else(|| self.missing(&joined(&name, "value"), expected()))?;
        let std = detailed.get("std").map(|item| self.number(item, &joined(&name, "std"))).transpose()?;
        knowledge.push((quantity, Knowledge { std, source: self.source(detailed, &name)? }));
        self.number(value, &joined(&name, "value"))
    }

    fn source(&self, table: &dyn TableLike, name: &str) -> Result<Option<Source>> {
        let text = |item: &Item, key: &str| {
            let problem = || self.bad(item.span(), &joined(name, key), "expected a text in quotes".into());
            item.as_str().map(str::to_owned).ok_or_else(problem)
        };
        let Some(method) = table.get("method") else { return Ok(None) };
        let method = text(method, "method")?;
        let recordings = match table.get("recordings") {
            None => Vec::new(),
            Some(item) => {
                let problem = || self.bad(item.span(), &joined(name, "recordings"), "expected a list of names".into());
                let list = item.as_array().ok_or_else(problem)?;
                list.iter().map(|name| name.as_str().map(str::to_owned).ok_or_else(problem)).collect::<Result<_>>()?
            }
        };
        let measured = self.measured(table, name)?.unwrap_or_default();
        Ok(Some(Source { method, recordings, measured }))
    }

    /// What recordings hold.
    fn measured(&self, table: &dyn TableLike, name: &str) -> Result<Option<Measured>> {
        let Some(value) = table.get("measured") else { return Ok(None) };
        let expected = "expected \"angle\" or \"rate\"";
        let problem = || self.bad(value.span(), &joined(name, "measured"), expected.to_owned());
        value.as_str().and_then(|text| text.parse().ok()).map(Some).ok_or_else(problem)
    }

    /// A file that does not say which sensor it means is from before there was another than the potentiometer.
    fn sensor(&self, item: &Item) -> Result<Sensor> {
        let table = self.as_table(item, "sensor")?;
        let kind_is_wrong = |item: &Item| {
            let known = Sensor::NAMES.join("\" or \"");
            self.bad(item.span(), "sensor.kind", format!("expected \"{known}\""))
        };
        let (name, numbers) = match table.get("kind") {
            None => (Potentiometer::NAME, Potentiometer::NUMBERS),
            Some(item) => {
                let name = item.as_str().ok_or_else(|| kind_is_wrong(item))?;
                (name, Sensor::numbers_of(name).ok_or_else(|| kind_is_wrong(item))?)
            }
        };
        let keys: Vec<&str> = SENSOR_KEYS.into_iter().chain(numbers.iter().map(|number| number.key)).collect();
        self.check_keys("sensor", table, &keys)?;
        let number = |wanted: &'static Number| self.sensor_number(table, wanted);
        let sensor = Sensor::read(name, number)?.ok_or_else(|| kind_is_wrong(item))?;
        if sensor.is_valid() { Ok(sensor) } else { Err(self.bad(item.span(), "sensor", sensor.expected().to_owned())) }
    }

    fn sensor_number(&self, table: &dyn TableLike, wanted: &Number) -> Result<f64> {
        let name = joined("sensor", wanted.key);
        let item = table.get(wanted.key).ok_or_else(|| self.missing(&name, wanted.meaning.to_owned()))?;
        let value = self.number(item, &name)?;
        match wanted.whole.map(|ends| ends.map(f64::from)) {
            Some(_) if value.fract() != 0.0 => {
                Err(self.bad(item.span(), &name, format!("{value} is not a whole number")))
            }
            Some([least, most]) if !(least..=most).contains(&value) => {
                Err(self.bad(item.span(), &name, format!("{value} cannot be; expected {least} to {most}")))
            }
            _ => Ok(value),
        }
    }

    /// The model's own check, told with the line of the value it complains of.
    fn check_model(&self, top: &dyn TableLike, parameters: &Parameters<f64>) -> Result<()> {
        let Err(error) = parameters.check() else { return Ok(()) };
        let quantity = match error {
            ParameterError::Pendulum { index } => Quantity::PENDULUM[usize::from(index)],
            ParameterError::OutOfRange { id: CURVE_ID, .. } => return Err(RigFileError::Model(error)),
            ParameterError::OutOfRange { id, index } => match effect_of(parameters, id) {
                Some(effect) => Quantity::of_effect(effect, usize::from(index)),
                None => return Err(RigFileError::Model(error)),
            },
            _ => return Err(RigFileError::Model(error)),
        };
        let owner = quantity.owner();
        let (table, name) = match quantity {
            Quantity::Effect { .. } | Quantity::Custom { .. } => {
                (top.get("effect").and_then(|item| item.get(owner)), joined("effect", owner))
            }
            _ => (top.get("pendulum"), owner.to_owned()),
        };
        let span = table.and_then(|item| item.get(quantity.key())).and_then(Item::span);
        let value = quantity.get(parameters).unwrap_or(f64::NAN);
        Err(self.bad(span, &joined(&name, quantity.key()), format!("{value} cannot be used: {error}")))
    }
}
