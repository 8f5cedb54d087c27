//! The torques at the knots of a friction curve as unknowns.

use super::problem::{Quantity, Unknown};
use shared::curve::MAX_KNOTS;
use shared::effect::CURVE_NAME;
use shared::parameters::Parameters;

/// Their symbols.
const SYMBOLS: [&str; MAX_KNOTS] = [
    "F1", "F2", "F3", "F4", "F5", "F6", "F7", "F8", "F9", "F10", "F11", "F12", "F13", "F14", "F15", "F16", "F17",
    "F18", "F19", "F20", "F21", "F22", "F23", "F24", "F25", "F26", "F27", "F28", "F29", "F30", "F31", "F32",
];

/// A knot may reach this share of m·g·l, and a change of so much of it matters.
const HIGHEST_SHARE: f64 = 2.0;
const SCALE_SHARE: f64 = 2e-3;

impl Unknown {
    /// The torques at the knots of the friction curve.
    pub fn knots(parameters: &Parameters<f64>) -> Vec<Self> {
        let n_knots = parameters.curve.as_ref().map_or(0, |curve| curve.torques_nm().len());
        let gravity_nm = parameters.pendulum.gravity_torque_nm();
        let knot = |(index, symbol): (usize, &&'static str)| Self {
            quantity: Quantity::Knot(index),
            symbol,
            name: CURVE_NAME,
            unit: "N·m",
            low: 0.0,
            high: HIGHEST_SHARE * gravity_nm,
            scale: SCALE_SHARE * gravity_nm,
            prior: None,
            own: 0.0,
        };
        SYMBOLS.iter().take(n_knots).enumerate().map(knot).collect()
    }
}
