//! Custom formulas: from a text such as `torque = -k * omega * abs(omega)^p; k in 0..1e-3 N·m; p in 0..3` to an effect
//! like those of the list, with a program that PC and board both run ([`shared::formula`]).
//!
//! Before the first semicolon stands the torque in N·m, positive counter-clockwise; behind it each parameter with its
//! range and unit. Variables are `theta` (rad), `omega` (rad/s), `load` (the force on the bearing along the rod, N) and
//! `t` (seconds since the release). Functions: abs, sgn, sin, cos, tanh, exp, sqrt. −x^2 is −(x^2), and powers bind to
//! the right.

/// How to write one, for people.
pub const GUIDE: &str = "\
A formula gives a torque in N·m, counter-clockwise positive; behind semicolons stand its
parameters (at most 4), each with a range and a unit:

    torque = -k * omega * abs(omega)^p; k in 0..1e-3 N·m; p in 0..3

Variables: theta (rad), omega (rad/s), load (N, the rod's pull on the bearing), t (s since the release).
Functions: abs, sgn, sin, cos, tanh, exp, sqrt. Operators: + - * / ^; -x^2 is -(x^2).
What it gives at standstill acts at rest too, like a spring; the rest of it only while sliding.
`fit`, `diagnose`, `improve` and `simulate` take it with --effect; the model file keeps it as [effect.custom],
and `push` sends it to the rig, which runs the same program.";

mod compile;
mod domain;
mod effect;
mod error;
mod parse;
mod ranges;
mod tokens;

pub use effect::{FRICTION_CURVE, add, check, effect_of, read};
pub use error::FormulaError;

#[cfg(test)]
mod tests;
