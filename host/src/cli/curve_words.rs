//! A friction curve for the terminal: in words, at a few speeds, and how to take it.

use super::table::wrapped;
use crate::diagnose::{Diagnosis, FrictionCurve};
use crate::fit::uncertainty::UNKNOWN_SHARE;
use crate::geometry::is_unknown;
use crate::number::with_spread;

/// Speeds that are told, spread over the knots whose torque is known.
const TOLD: usize = 4;

/// The curve for a person.
pub(super) fn in_words(diagnosis: &Diagnosis, curve: &FrictionCurve) -> String {
    let mut lines = vec![wrapped(&curve.in_words(diagnosis), 0)];
    let (unit, times) = if is_unknown(&diagnosis.parameters.pendulum) { ("m·g·l", 1.0) } else { ("mN·m", 1e3) };
    lines.extend(told(curve).map(|(speed, torque, std)| {
        format!("  friction at {speed:.2} rad/s is {} {unit}", with_spread(times * torque, Some(times * std)))
    }));
    lines.push("Take it: host improve … --add friction-curve -o rig.toml; draw it with --plot".to_owned());
    lines.join("\n")
}

/// Speed, torque and standard deviation at some of the knots whose torque is known.
fn told(curve: &FrictionCurve) -> impl Iterator<Item = (f64, f64, f64)> {
    let torques = curve.torques.iter().map(|torque| curve.built_up + torque);
    let known = known(curve.speeds.iter().copied().zip(torques), &curve.stds);
    let n_told = TOLD.min(known.len());
    (0..n_told).map(move |k| known[k * (known.len() - 1) / (n_told - 1).max(1)])
}

/// A torque that is known no better than a number that is not identified would only confuse.
fn known(points: impl Iterator<Item = (f64, f64)>, stds: &[Option<f64>]) -> Vec<(f64, f64, f64)> {
    let known = |((speed, torque), std): ((f64, f64), &Option<f64>)| {
        std.filter(|std| *std < UNKNOWN_SHARE * torque).map(|std| (speed, torque, std))
    };
    points.zip(stds).filter_map(known).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_torque_whose_uncertainty_is_as_large_as_itself_is_not_told() {
        let points = [(0.0, 0.241), (2.7, 5e-3), (4.9, 3e-3), (6.9, 13.6e-3)];
        let stds = [Some(0.192), Some(13e-3), None, Some(6e-3)];
        assert_eq!(known(points.into_iter(), &stds), [(6.9, 13.6e-3, 6e-3)]);
    }
}
