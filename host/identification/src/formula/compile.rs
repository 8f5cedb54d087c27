//! Expression → program.

use super::FormulaError;
use super::parse::{Expression, Function, Parsed};
use shared::formula::{Formula, MAX_CODE, MAX_CONSTANTS, STACK, code};

/// The program of a formula.
pub(super) fn compile(parsed: &Parsed) -> Result<Formula, FormulaError> {
    let mut writer = Writer::default();
    writer.write(&folded(&parsed.torque));
    let too_much = |what: String| Err(FormulaError::whole(&parsed.text, format!("{what}; shorten the formula")));
    let (n_code, n_constants) = (writer.code.len(), writer.constants.len());
    if n_code > MAX_CODE {
        return too_much(format!("the formula needs {n_code} instructions, and the rig has room for {MAX_CODE}"));
    }
    if n_constants > MAX_CONSTANTS {
        return too_much(format!("the formula has {n_constants} constants, and the rig has room for {MAX_CONSTANTS}"));
    }
    match Formula::new(&writer.code, &writer.constants, parsed.parameters.len(), &parsed.text) {
        Some(formula) => Ok(formula),
        None => too_much(format!("more than {STACK} numbers have to wait for their operator")),
    }
}

/// The same with constant parts computed, and powers and functions in the program's terms.
fn folded(expression: &Expression) -> Expression {
    use Expression::{Number, Of, Two};
    match expression {
        Number(_) | Expression::Variable(_) | Expression::Parameter(_) => expression.clone(),
        Of(function, inner) => match (function, folded(inner)) {
            (Function::Instruction(code::NEGATE), Number(value)) => Number(-value),
            // Within one direction of sliding its sign must not flicker.
            (Function::Instruction(code::SIGN), Expression::Variable(code::OMEGA)) => {
                Expression::Variable(code::DIRECTION)
            }
            (Function::Tanh, inner) => tanh(inner),
            (function, inner) => Of(*function, Box::new(inner)),
        },
        Two(instruction, left, right) => match (*instruction, folded(left), folded(right)) {
            (code::POWER, base, Number(exponent)) => power(base, exponent),
            (instruction, Number(a), Number(b)) => computed(instruction, a, b),
            (instruction, left, right) => Two(instruction, Box::new(left), Box::new(right)),
        },
    }
}

fn computed(instruction: u8, a: f64, b: f64) -> Expression {
    let value = match instruction {
        code::ADD => a + b,
        code::SUBTRACT => a - b,
        code::MULTIPLY => a * b,
        _ => a / b,
    };
    // A constant that is no number stays as it was typed; the run shows where it leads.
    let as_typed = || Expression::Two(instruction, Box::new(Expression::Number(a)), Box::new(Expression::Number(b)));
    if (value as f32).is_finite() { Expression::Number(value) } else { as_typed() }
}

/// A whole power is a product, which a negative base has too.
fn power(base: Expression, exponent: f64) -> Expression {
    use Expression::{Number, Of, Two};
    let whole = exponent.abs();
    if whole.fract() != 0.0 || whole > 15.0 {
        return Two(code::POWER, Box::new(base), Box::new(Number(exponent)));
    }
    let product = match (whole as u8, base) {
        (0, _) => return Number(1.0),
        (1, base) => base,
        (n, Number(value)) if (value.powi(i32::from(n)) as f32).is_finite() => Number(value.powi(i32::from(n))),
        (n, base) => Of(Function::Instruction(code::WHOLE_POWER + n), Box::new(base)),
    };
    if exponent < 0.0 { Two(code::DIVIDE, Box::new(Number(1.0)), Box::new(product)) } else { product }
}

/// tanh x = 1 − 2/(1 + e^(2x)), which overflows to the right value.
fn tanh(x: Expression) -> Expression {
    use Expression::{Number, Of, Two};
    let two = |instruction, a, b| Two(instruction, Box::new(a), Box::new(b));
    let doubled = two(code::MULTIPLY, x, Number(2.0));
    let exponential = Of(Function::Instruction(code::EXP), Box::new(doubled));
    let below = two(code::ADD, exponential, Number(1.0));
    two(code::SUBTRACT, Number(1.0), two(code::DIVIDE, Number(2.0), below))
}

#[derive(Default)]
struct Writer {
    code: Vec<u8>,
    constants: Vec<f32>,
}

impl Writer {
    fn write(&mut self, expression: &Expression) {
        match expression {
            Expression::Number(value) => self.constant(*value as f32),
            Expression::Variable(instruction) => self.code.push(*instruction),
            Expression::Parameter(index) => self.code.push(code::PARAMETER + *index as u8),
            Expression::Of(function, inner) => {
                self.write(inner);
                if let Function::Instruction(instruction) = function {
                    self.code.push(*instruction);
                }
            }
            Expression::Two(instruction, left, right) => {
                self.write(left);
                self.write(right);
                self.code.push(*instruction);
            }
        }
    }

    fn constant(&mut self, value: f32) {
        let known = self.constants.iter().position(|other| *other == value);
        let index = known.unwrap_or(self.constants.len());
        if known.is_none() {
            self.constants.push(value);
        }
        // Too many are refused when all is written.
        self.code.push(code::CONSTANT + index.min(15) as u8);
    }
}
