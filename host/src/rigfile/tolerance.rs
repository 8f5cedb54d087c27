//! Mass, length and inertia that were measured to a tolerance: how they stand in the file.
//!
//! A `std` without a method is what somebody measured, `length = { value = 0.1562, std = 0.001 }`. Where the swings ask
//! for another length, a fit writes that one with the method, and what was measured stays beside it as `prior`, so that
//! the next fit does not count the same swings twice.

use super::keys::{PRIOR_KEY, PRIOR_KEYS};
use super::reader::{Reader, Result, joined};
use super::{Knowledge, Quantity, RigFile, RigFileError, USUAL_NAME, write};
use crate::fit::tolerance::{Known, Tolerances};
use shared::motion::Pendulum;
use toml_edit::{Item, TableLike};

/// A fit's value of a number with a tolerance has digits down to this share of where its ± would end them: the period
/// tells all of them together far better than each alone.
const SHARE_OF_STD: f64 = 1e-3;

impl Reader<'_> {
    /// How surely the geometry is known.
    pub(super) fn tolerances(
        &self,
        table: &dyn TableLike,
        pendulum: &Pendulum<f64>,
        normalised: bool,
    ) -> Result<Tolerances> {
        let tolerance = |quantity: Quantity| self.tolerance(table, pendulum, quantity);
        let found = Tolerances {
            mass: tolerance(Quantity::Mass)?,
            length: tolerance(Quantity::Length)?,
            inertia: tolerance(Quantity::Inertia)?,
        };
        if normalised && !found.are_none() {
            let problem = "the geometry is unknown, so that its numbers have no tolerance; take the std out";
            let span = table.get("normalised").and_then(Item::span);
            return Err(self.bad(span, "pendulum.normalised", problem.to_owned()));
        }
        Ok(found)
    }

    fn tolerance(&self, table: &dyn TableLike, pendulum: &Pendulum<f64>, quantity: Quantity) -> Result<Option<Known>> {
        let name = joined("pendulum", quantity.key());
        let Some((item, detailed)) = table.get(quantity.key()).and_then(|item| Some((item, item.as_table_like()?)))
        else {
            return Ok(None);
        };
        match detailed.get(PRIOR_KEY) {
            Some(prior) => {
                let name = joined(&name, PRIOR_KEY);
                self.check_keys(&name, self.as_table(prior, &name)?, &PRIOR_KEYS)?;
                self.known(prior, &name, pendulum, quantity).map(Some)
            }
            None if detailed.get("method").is_some() || detailed.get("std").is_none() => Ok(None),
            None => self.known(item, &name, pendulum, quantity).map(Some),
        }
    }

    fn known(&self, item: &Item, name: &str, pendulum: &Pendulum<f64>, quantity: Quantity) -> Result<Known> {
        let table = self.as_table(item, name)?;
        let number = |key: &str| {
            let (name, unit) = (joined(name, key), quantity.unit());
            let item = table.get(key).ok_or_else(|| self.missing(&name, format!("a number in {unit}")))?;
            self.number(item, &name)
        };
        let (value, std) = (number("value")?, number("std")?);
        // A bob on a thread has hardly any inertia, so that its tolerance is compared with that about the pivot.
        let (most, what) = match quantity {
            Quantity::Inertia => (pendulum.mass_kg * pendulum.length_m.powi(2), "m·l²"),
            _ => (value, "the value"),
        };
        if std > 0.0 && std <= most {
            return Ok(Known { value, std });
        }
        let without = if quantity == Quantity::Inertia { "any inertia may be found" } else { "it is exact" };
        let unit = quantity.unit();
        let problem = format!(
            "{std} {unit} is no standard deviation of {value} {unit}; expected a number above 0, no larger than \
             {what}; without a std {without}"
        );
        Err(self.bad(table.get("std").and_then(Item::span), &joined(name, "std"), problem))
    }
}

impl RigFile {
    /// The same, with how surely mass, length and inertia are known.
    ///
    /// # Errors
    /// A standard deviation that is none.
    pub fn measured_to(mut self, stds: [Option<f64>; 3]) -> std::result::Result<Self, RigFileError> {
        for (quantity, std) in [Quantity::Mass, Quantity::Length, Quantity::Inertia].into_iter().zip(stds) {
            let value = quantity.get(&self.parameters).unwrap_or_default();
            if std.is_some() {
                self.set(quantity, value, Knowledge { std, source: None })?;
            }
        }
        // Checked as it is where a file is read.
        Self::parse(USUAL_NAME, &self.to_string())
    }

    /// Was a number measured to a tolerance?
    pub fn has_tolerance(&self, quantity: Quantity) -> bool {
        let Tolerances { mass, length, inertia } = self.tolerances;
        match quantity {
            Quantity::Mass => mass.is_some(),
            Quantity::Length => length.is_some(),
            Quantity::Inertia => inertia.is_some(),
            _ => false,
        }
    }

    /// What stays known of a number from before the swings once it has a new value: all of it where that came from
    /// somewhere; what is typed now is what was measured.
    pub(super) fn tolerance_after(&mut self, quantity: Quantity, value: f64, knowledge: &Knowledge) -> Option<Known> {
        let place = match quantity {
            Quantity::Mass => &mut self.tolerances.mass,
            Quantity::Length => &mut self.tolerances.length,
            Quantity::Inertia => &mut self.tolerances.inertia,
            _ => return None,
        };
        if knowledge.source.is_none() {
            *place = knowledge.std.map(|std| Known { value, std });
        }
        *place
    }

    /// A value as it is written: with the digits that its ± gives a meaning, and six at least.
    pub(super) fn told(&self, quantity: Quantity, value: f64, knowledge: &Knowledge) -> f64 {
        match knowledge.std {
            Some(_) if quantity.has_tolerance() && knowledge.source.is_none() => value,
            Some(std) if quantity.has_tolerance() && !self.tolerances.are_none() => {
                write::rounded(value, Some(SHARE_OF_STD * std))
            }
            std => write::rounded(value, std),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tolerance_of_the_inertia_is_measured_by_that_about_the_pivot() {
        let file = |std: f64| {
            let text = format!(
                "format = 1\n[pendulum]\nmass = 0.1\nlength = 0.2\ninertia = {{ value = 1e-6, std = {std} }}\n\
                 gravity = 9.81\n"
            );
            RigFile::parse("rig.toml", &text)
        };
        // m·l² is 4e-3 kg·m².
        assert!(file(3e-3).unwrap().has_tolerance(Quantity::Inertia));
        let error = file(5e-3).unwrap_err().to_string();
        assert!(error.contains("no larger than m·l²; without a std any inertia may be found"), "{error}");
    }
}
