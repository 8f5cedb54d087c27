//! Numbers on the command line, checked where they enter.

use crate::formula;
use crate::operations::simulate::{Assignment, quantity};
use crate::rigfile::Quantity;
use shared::effect::Effect;
use std::ops::RangeInclusive;

/// Nobody stands longer at a rig, s.
const LONGEST_PATIENCE_S: f64 = 86_400.0;

/// Beyond them a rig's clock stands still, or no computer keeps up.
const SPEEDS: RangeInclusive<f64> = 1e-3..=1e6;

/// A finite number above zero.
pub(super) fn positive(text: &str) -> Result<f64, String> {
    let value = finite(text)?;
    if value > 0.0 { Ok(value) } else { Err("expected a number above zero, in SI units".into()) }
}

/// Seconds to wait: above zero, a day at most.
pub(super) fn patience(text: &str) -> Result<f64, String> {
    within(text, f64::MIN_POSITIVE..=LONGEST_PATIENCE_S).ok_or(format!("expected above 0 to {LONGEST_PATIENCE_S} s"))
}

/// How many times faster than real time.
pub(super) fn speed(text: &str) -> Result<f64, String> {
    let (least, most) = (SPEEDS.start(), SPEEDS.end());
    within(text, SPEEDS).ok_or_else(|| format!("expected {least} to {most}"))
}

fn within(text: &str, range: RangeInclusive<f64>) -> Option<f64> {
    finite(text).ok().filter(|value| range.contains(value))
}

/// A finite number, zero or above.
pub(super) fn not_negative(text: &str) -> Result<f64, String> {
    let value = finite(text)?;
    if value >= 0.0 { Ok(value) } else { Err("expected zero or a number above, in SI units".into()) }
}

/// A finite number.
pub(super) fn finite(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err("expected a finite number, such as 0.15".into()),
    }
}

/// Two numbers, such as `320,40`.
pub(super) fn point(text: &str) -> Result<[f64; 2], String> {
    let (x, y) = text.split_once(',').ok_or("expected X,Y, such as 320,40")?;
    Ok([finite(x.trim())?, finite(y.trim())?])
}

/// A formula, such as `torque = -k*omega; k in 0..1e-3 N·m`.
pub(super) fn custom_effect(text: &str) -> Result<&'static Effect<f64>, String> {
    // The command line's own sentence comes first; the formula with its mark begins on a line of its own.
    formula::read(text).map_err(|error| error.to_string())
}

impl std::str::FromStr for Assignment {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, value) = text.split_once('=').ok_or("expected NAME=VALUE, such as Cq=1e-4")?;
        Ok(Self { name: name.trim().to_owned(), value: finite(value)? })
    }
}

/// `NAME=LOW..HIGH`, the name a symbol such as `Mw`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range {
    pub(super) quantity: Quantity,
    pub(super) low: f64,
    pub(super) high: f64,
}

impl std::str::FromStr for Range {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let form = "expected NAME=LOW..HIGH, such as Mw=1e-4..1e-3";
        let (name, ends) = text.split_once('=').ok_or(form)?;
        let (low, high) = ends.split_once("..").ok_or(form)?;
        // It stands for its symbol: of several effects with it, the one that the model has is searched.
        let any = Quantity::all_of_name(name.trim()).first().copied();
        let (quantity, low, high) = (any.map_or_else(|| quantity(name), Ok)?, finite(low)?, finite(high)?);
        let symbol = quantity.symbol();
        match quantity {
            Quantity::Mass | Quantity::Length | Quantity::Gravity => {
                Err(format!("{symbol} cannot be found from a swing; give ranges for I and the effects only"))
            }
            _ if low == high => Err(format!("both ends are {low}; expected {symbol}=LOW..HIGH with LOW below HIGH")),
            _ if low > high => Err(format!("the ends are reversed; write {symbol}={high}..{low}")),
            _ => Ok(Self { quantity, low, high }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_no_clock_can_count_is_turned_down() {
        assert_eq!((patience("0.5"), speed("0.1")), (Ok(0.5), Ok(0.1)));
        for text in ["0", "-1", "1e300", "inf", "nan", "x"] {
            assert!(patience(text).unwrap_err().contains("86400 s"), "{text}");
            assert!(speed(text).unwrap_err().contains("0.001 to 1000000"), "{text}");
        }
        assert!(speed("1e-300").is_err());
    }

    #[test]
    fn ranges_are_read_and_reversed_ones_turned_down() {
        let range: Range = "Mw=1e-4..1e-3".parse().unwrap();
        assert_eq!((range.quantity.symbol(), range.low, range.high), ("Mw", 1e-4, 1e-3));
        assert_eq!("tau=0..1".parse::<Range>().unwrap().quantity.symbol(), "tau");
        let complaint = |text: &str| text.parse::<Range>().unwrap_err();
        assert!(complaint("Mw=1e-3..1e-4").contains("reversed; write Mw=0.0001..0.001"));
        assert!(complaint("Mw=1..1").contains("both ends"));
        assert!(complaint("Mx=0..1").contains("no parameter Mx; known are m, l, I, g, Mw"));
        assert!(complaint("m=0..1").contains("cannot be found from a swing"));
        assert!(complaint("Mw=0..inf").contains("finite"));
        assert!(complaint("Mw").contains("NAME=LOW..HIGH"));
    }
}
