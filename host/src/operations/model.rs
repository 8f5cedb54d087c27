//! The numbers of a model.

use crate::rigfile::{Quantity, RigFile};
use serde::Serialize;

/// A number of the model, as `--json` shows it.
#[derive(Clone, Debug, Serialize)]
pub struct Value {
    /// Its symbol.
    pub symbol: &'static str,
    /// The effect it belongs to, `inertia` or `pendulum`.
    pub name: &'static str,
    /// In its unit.
    pub value: f64,
    /// Standard deviation, if one is known.
    pub std: Option<f64>,
    /// SI unit.
    pub unit: &'static str,
}

/// Every number of a model.
pub fn values(file: &RigFile) -> Vec<Value> {
    let describe = |quantity: Quantity| Value {
        symbol: quantity.symbol(),
        name: quantity.owner(),
        value: quantity.get(file.parameters()).unwrap_or_default(),
        std: file.knowledge(quantity).and_then(|knowledge| knowledge.std),
        unit: quantity.unit(),
    };
    Quantity::all(file.parameters()).into_iter().map(describe).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_that_is_known_has_its_standard_deviation() {
        let text = "format = 1\n[pendulum]\nmass = 0.1\nlength = { value = 0.2, std = 1e-3 }\ninertia = 1e-3\ngravity = 9.81\n";
        let values = values(&RigFile::parse("rig.toml", text).unwrap());
        let of = |symbol: &str| values.iter().find(|value| value.symbol == symbol).unwrap();
        assert_eq!((of("l").value, of("l").std, of("l").unit), (0.2, Some(1e-3), "m"));
        assert_eq!((of("m").value, of("m").std, of("m").name), (0.1, None, "pendulum"));
    }
}
