//! A friction curve for the terminal: in words, at a few speeds, and how to take it.

use super::table::wrapped;
use crate::diagnose::{Diagnosis, FrictionCurve};
use crate::number::with_spread;

/// Speeds that are told, spread over the knots whose torque is known.
const TOLD: usize = 4;

/// The curve for a person.
pub(super) fn in_words(diagnosis: &Diagnosis, curve: &FrictionCurve) -> String {
    let mut lines = vec![wrapped(&curve.in_words(diagnosis), 0)];
    lines.extend(told(curve).map(|(speed, torque, std)| {
        format!("  friction at {speed:.2} rad/s is {} mN·m", with_spread(1e3 * torque, std.map(|std| 1e3 * std)))
    }));
    lines.push("Take it: host improve … --add friction-curve -o rig.toml; draw it with --plot".to_owned());
    lines.join("\n")
}

/// Speed, torque and standard deviation at some knots.
fn told(curve: &FrictionCurve) -> impl Iterator<Item = (f64, f64, Option<f64>)> {
    let knots = curve.speeds.iter().zip(&curve.torques).zip(&curve.stds);
    let known: Vec<(f64, f64, Option<f64>)> = knots
        .filter(|(_, std)| std.is_some())
        .map(|((speed, torque), std)| (*speed, curve.built_up + torque, *std))
        .collect();
    let n_told = TOLD.min(known.len());
    (0..n_told).map(move |k| known[k * (known.len() - 1) / (n_told - 1).max(1)])
}
