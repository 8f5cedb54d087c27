//! The parameters of a formula: `k in 0..1e-3 N·m`.

use super::FormulaError;
use super::tokens::number;
use shared::effect::MAX_VALUES;
use std::ops::Range;

/// Names that mean something already.
const TAKEN: [&str; 17] = [
    "theta", "θ", "omega", "ω", "load", "t", "torque", "pi", "π", "abs", "sgn", "sign", "sin", "cos", "tanh", "exp",
    "sqrt",
];

/// A parameter as it was typed.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Declared {
    pub(super) name: String,
    pub(super) bytes: Range<usize>,
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) unit: String,
}

/// All parameters behind the first semicolon, each in its part of the text.
pub(super) fn declared(text: &str, parts: &[Range<usize>]) -> Result<Vec<Declared>, FormulaError> {
    let mut all: Vec<Declared> = Vec::new();
    for part in parts.iter().filter(|part| !text[(*part).clone()].trim().is_empty()) {
        let one = one(text, part.clone())?;
        let refuse = |problem: String| Err(FormulaError::at(text, one.bytes.clone(), problem));
        if TAKEN.contains(&one.name.as_str()) {
            return refuse(format!("{} has a meaning of its own; give the parameter another name", one.name));
        }
        if all.iter().any(|other| other.name == one.name) {
            return refuse(format!("{} has a range already", one.name));
        }
        if all.len() == MAX_VALUES {
            return refuse(format!("a formula has at most {MAX_VALUES} parameters"));
        }
        all.push(one);
    }
    Ok(all)
}

fn one(text: &str, part: Range<usize>) -> Result<Declared, FormulaError> {
    let form = "expected NAME in LOW..HIGH UNIT, such as k in 0..1e-3 N·m";
    let mut at = after_spaces(text, part.start, part.end);
    let is_in_name = |(place, c): (usize, char)| c.is_alphabetic() || c == '_' || (place > 0 && c.is_ascii_digit());
    let name: String = text[at..part.end].char_indices().take_while(|c| is_in_name(*c)).map(|(_, c)| c).collect();
    let bytes = at..at + name.len();
    if name.is_empty() {
        return Err(FormulaError::at(text, at..part.end, form));
    }
    at = after_spaces(text, bytes.end, part.end);
    let Some(_) = text[at..part.end].strip_prefix("in").filter(|rest| !rest.starts_with(char::is_alphabetic)) else {
        return Err(FormulaError::at(text, at..part.end, form));
    };
    let (low, after) = signed(text, after_spaces(text, at + 2, part.end), part.end)?;
    at = after_spaces(text, after, part.end);
    if !text[at..part.end].starts_with("..") {
        return Err(FormulaError::at(text, at..part.end, form));
    }
    let high_at = after_spaces(text, at + 2, part.end);
    let (high, end) = signed(text, high_at, part.end)?;
    if low >= high {
        let problem = format!("the range of {name} is empty: its low end {low} is not below its high end {high}");
        return Err(FormulaError::at(text, bytes.start..end, problem));
    }
    let unit = text[end..part.end].trim();
    let unit = if unit.is_empty() { "1" } else { unit }.to_owned();
    Ok(Declared { name, bytes, low, high, unit })
}

/// A number with its sign, and where it ends.
fn signed(text: &str, at: usize, end: usize) -> Result<(f64, usize), FormulaError> {
    let rest = &text[at..end];
    let (factor, length) = match rest.chars().next() {
        Some(sign @ ('-' | '−')) => (-1.0, sign.len_utf8()),
        Some('+') => (1.0, 1),
        Some(_) => (1.0, 0),
        None => return Err(FormulaError::at(text, at..end, "a range ends here; expected LOW..HIGH, such as 0..1e-3")),
    };
    let (value, digits) = match text[at + length..end].chars().next() {
        Some(c) if c.is_ascii_digit() || c == '.' => number(text, at + length..end)?,
        other => {
            let bytes = at + length..at + length + other.map_or(0, char::len_utf8);
            return Err(FormulaError::at(text, bytes, "expected a number, such as 1e-3"));
        }
    };
    Ok((factor * value, at + length + digits))
}

fn after_spaces(text: &str, at: usize, end: usize) -> usize {
    end - text[at..end].trim_start().len()
}
