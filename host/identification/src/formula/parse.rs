//! Text → expression, by recursive descent; every complaint with its place.

use super::FormulaError;
use super::ranges::{Declared, declared};
use super::tokens::{Placed, Token, tokens};
use shared::formula::{MAX_TEXT, code};
use std::ops::Range;

/// Parentheses and signs inside each other, at most; a text that fits the rig can hardly have more.
const DEEPEST: usize = 40;

/// A function of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Function {
    /// An instruction of the program.
    Instruction(u8),
    /// Made of others.
    Tanh,
}

/// What was typed, as a tree.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Expression {
    Number(f64),
    /// The instruction that pushes it.
    Variable(u8),
    Parameter(usize),
    Of(Function, Box<Expression>),
    /// The instruction that joins two.
    Two(u8, Box<Expression>, Box<Expression>),
}

/// A formula that was read.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Parsed {
    /// With single spaces.
    pub(super) text: String,
    pub(super) torque: Expression,
    pub(super) parameters: Vec<Declared>,
}

/// Reads a formula.
pub(super) fn parse(typed: &str) -> Result<Parsed, FormulaError> {
    let text = typed.split_whitespace().collect::<Vec<_>>().join(" ");
    if text.len() > MAX_TEXT {
        let problem = format!("the formula has {} bytes, and the rig has room for {MAX_TEXT}; shorten it", text.len());
        return Err(FormulaError::whole(&text, problem));
    }
    let parts = parts(&text);
    let parameters = declared(&text, &parts[1..])?;
    let tokens = tokens(&text, after_equals(&text, parts[0].clone())?)?;
    let mut parser = Parser { text: &text, tokens, next: 0, depth: 0, parameters: &parameters };
    let torque = parser.whole()?;
    if let Some(unused) = (0..parameters.len()).find(|index| !torque.has(*index)) {
        let Declared { name, bytes, .. } = &parameters[unused];
        return Err(FormulaError::at(&text, bytes.clone(), format!("{name} has a range but is not in the formula")));
    }
    Ok(Parsed { torque, parameters, text: text.clone() })
}

/// The parts between semicolons.
fn parts(text: &str) -> Vec<Range<usize>> {
    let mut start = 0;
    let ends = text.match_indices(';').map(|(at, _)| at).chain([text.len()]);
    ends.map(|end| std::mem::replace(&mut start, end + 1)..end).collect()
}

/// What stands behind `torque =`, or all of it.
fn after_equals(text: &str, part: Range<usize>) -> Result<Range<usize>, FormulaError> {
    let Some(at) = text[part.clone()].find('=').map(|at| part.start + at) else { return Ok(part) };
    match text[part.start..at].trim() {
        "torque" => Ok(at + 1..part.end),
        other => {
            let problem = format!("a formula gives the torque: write torque = …, not {other} = …");
            Err(FormulaError::at(text, part.start..at, problem))
        }
    }
}

impl Expression {
    /// Is a parameter in it?
    fn has(&self, parameter: usize) -> bool {
        match self {
            Self::Number(_) | Self::Variable(_) => false,
            Self::Parameter(index) => *index == parameter,
            Self::Of(_, inner) => inner.has(parameter),
            Self::Two(_, left, right) => left.has(parameter) || right.has(parameter),
        }
    }
}

struct Parser<'a> {
    text: &'a str,
    tokens: Vec<Placed>,
    next: usize,
    depth: usize,
    parameters: &'a [Declared],
}

impl Parser<'_> {
    fn whole(&mut self) -> Result<Expression, FormulaError> {
        let torque = self.sum()?;
        match self.peek() {
            Token::End => Ok(torque),
            Token::Sign(')') => Err(self.complain("this parenthesis was never opened")),
            _ => Err(self.complain("expected an operator (+ - * / ^) or the end of the formula")),
        }
    }

    fn sum(&mut self) -> Result<Expression, FormulaError> {
        self.deeper()?;
        let mut left = self.product()?;
        while let Token::Sign(sign @ ('+' | '-')) = self.peek() {
            self.next += 1;
            let instruction = if sign == '+' { code::ADD } else { code::SUBTRACT };
            left = Expression::Two(instruction, Box::new(left), Box::new(self.product()?));
        }
        self.depth -= 1;
        Ok(left)
    }

    fn product(&mut self) -> Result<Expression, FormulaError> {
        let mut left = self.signed()?;
        while let Token::Sign(sign @ ('*' | '/')) = self.peek() {
            self.next += 1;
            let instruction = if sign == '*' { code::MULTIPLY } else { code::DIVIDE };
            left = Expression::Two(instruction, Box::new(left), Box::new(self.signed()?));
        }
        Ok(left)
    }

    /// A sign binds less than a power: −x^2 is −(x^2).
    fn signed(&mut self) -> Result<Expression, FormulaError> {
        let Token::Sign(sign @ ('+' | '-')) = self.peek() else { return self.power() };
        self.next += 1;
        self.deeper()?;
        let inner = self.signed()?;
        self.depth -= 1;
        let negate = Function::Instruction(code::NEGATE);
        Ok(if sign == '-' { Expression::Of(negate, Box::new(inner)) } else { inner })
    }

    fn power(&mut self) -> Result<Expression, FormulaError> {
        let base = self.atom()?;
        if self.peek() != Token::Sign('^') {
            return Ok(base);
        }
        self.next += 1;
        self.deeper()?;
        let exponent = self.signed()?;
        self.depth -= 1;
        Ok(Expression::Two(code::POWER, Box::new(base), Box::new(exponent)))
    }

    fn atom(&mut self) -> Result<Expression, FormulaError> {
        let at = self.next;
        match self.peek() {
            Token::Number(value) => {
                self.next += 1;
                Ok(Expression::Number(value))
            }
            Token::Sign('(') => self.in_parentheses(),
            Token::Name(name) => {
                self.next += 1;
                self.named(&name, at)
            }
            Token::End => Err(self.complain("the formula ends here; expected a number, a name or '('")),
            Token::Sign(sign) => Err(self.complain(format!("expected a number, a name or '(', not '{sign}'"))),
        }
    }

    fn in_parentheses(&mut self) -> Result<Expression, FormulaError> {
        let opened = self.next;
        self.next += 1;
        let inner = self.sum()?;
        match self.peek() {
            Token::Sign(')') => {
                self.next += 1;
                Ok(inner)
            }
            Token::End => {
                self.next = opened;
                Err(self.complain("this parenthesis is never closed"))
            }
            _ => Err(self.complain("expected an operator (+ - * / ^) or ')'")),
        }
    }

    fn named(&mut self, name: &str, at: usize) -> Result<Expression, FormulaError> {
        if let Some(function) = function(name) {
            if self.peek() != Token::Sign('(') {
                return Err(self.complain(format!("{name} is a function: expected '(', as in {name}(omega)")));
            }
            return Ok(Expression::Of(function, Box::new(self.in_parentheses()?)));
        }
        if let Some(index) = self.parameters.iter().position(|parameter| parameter.name == name) {
            return Ok(Expression::Parameter(index));
        }
        let known = match name {
            "theta" | "θ" => Expression::Variable(code::THETA),
            "omega" | "ω" => Expression::Variable(code::OMEGA),
            "load" => Expression::Variable(code::LOAD),
            "t" => Expression::Variable(code::TIME),
            "pi" | "π" => Expression::Number(std::f64::consts::PI),
            _ => return Err(self.unknown(name, at)),
        };
        Ok(known)
    }

    fn unknown(&self, name: &str, at: usize) -> FormulaError {
        let parameters = self.parameters.iter().map(|parameter| format!(", {}", parameter.name)).collect::<String>();
        let problem = format!(
            "{name} is unknown; there are theta, omega, load, t{parameters} and the functions abs, sgn, sin, cos, tanh, \
             exp, sqrt. For a parameter add its range: ; {name} in 0..1"
        );
        FormulaError::at(self.text, self.tokens[at].bytes.clone(), problem)
    }

    fn peek(&self) -> Token {
        self.tokens[self.next.min(self.tokens.len() - 1)].token.clone()
    }

    fn deeper(&mut self) -> Result<(), FormulaError> {
        self.depth += 1;
        if self.depth > DEEPEST { Err(self.complain("too many parentheses inside each other")) } else { Ok(()) }
    }

    fn complain(&self, problem: impl Into<String>) -> FormulaError {
        let bytes = self.tokens[self.next.min(self.tokens.len() - 1)].bytes.clone();
        FormulaError::at(self.text, bytes, problem)
    }
}

fn function(name: &str) -> Option<Function> {
    Some(match name {
        "abs" => Function::Instruction(code::ABS),
        "sgn" | "sign" => Function::Instruction(code::SIGN),
        "sin" => Function::Instruction(code::SINE),
        "cos" => Function::Instruction(code::COSINE),
        "exp" => Function::Instruction(code::EXP),
        "sqrt" => Function::Instruction(code::ROOT),
        "tanh" => Function::Tanh,
        _ => return None,
    })
}
