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
