//! Numbers that write down what is done to them: run a program with them, and get its formulas.
//!
//! A symbol is the number of a node in a graph of this thread; equal nodes are one. What is known (two numbers added)
//! is computed at once.

use shared::real::{Mask, Real};
use std::cell::RefCell;
use std::collections::HashMap;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number in a formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Symbol(pub(super) usize);

/// A truth value in a formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Truth(pub(super) usize);

/// What stands at a node.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Node {
    /// A constant, by its bits.
    Number(u64),
    /// Something that is given.
    Name(String),
    Add(Symbol, Symbol),
    Subtract(Symbol, Symbol),
    Multiply(Symbol, Symbol),
    Divide(Symbol, Symbol),
    Negate(Symbol),
    Absolute(Symbol),
    Root(Symbol),
    Sine(Symbol),
    Exponential(Symbol),
    Logarithm(Symbol),
    Power(Symbol, Symbol),
    Select(Truth, Symbol, Symbol),
    Known(bool),
    Less(Symbol, Symbol),
    LessOrEqual(Symbol, Symbol),
    And(Truth, Truth),
    Or(Truth, Truth),
    Not(Truth),
}

/// All that was written down.
#[derive(Default)]
pub(super) struct Graph {
    pub(super) nodes: Vec<Node>,
    places: HashMap<Node, usize>,
    /// Questions that decided the way of the program; each was answered with yes.
    pub(super) questions: Vec<Truth>,
}

thread_local! {
    static GRAPH: RefCell<Graph> = RefCell::new(Graph::default());
}

/// Runs a program with symbols; gives what it gives and the graph.
pub(super) fn written_by<T>(program: impl FnOnce() -> T) -> (T, Graph) {
    GRAPH.take();
    let value = program();
    (value, GRAPH.take())
}

fn put(node: Node) -> usize {
    GRAPH.with_borrow_mut(|graph| {
        if let Some(place) = graph.places.get(&node) {
            return *place;
        }
        graph.nodes.push(node.clone());
        graph.places.insert(node, graph.nodes.len() - 1);
        graph.nodes.len() - 1
    })
}

impl Symbol {
    /// Something that is given.
    pub(super) fn named(name: &str) -> Self {
        Self(put(Node::Name(name.to_owned())))
    }

    fn known(self) -> Option<f64> {
        GRAPH.with_borrow(|graph| match graph.nodes[self.0] {
            Node::Number(bits) => Some(f64::from_bits(bits)),
            _ => None,
        })
    }

    fn of_one(self, compute: impl Fn(f64) -> f64, node: Node) -> Self {
        self.known().map_or_else(|| Self(put(node)), |value| Self::of(compute(value)))
    }

    fn of_two(self, other: Self, compute: impl Fn(f64, f64) -> f64, node: Node) -> Self {
        match (self.known(), other.known()) {
            (Some(a), Some(b)) => Self::of(compute(a, b)),
            _ => Self(put(node)),
        }
    }

    fn is(self, value: f64) -> bool {
        self.known() == Some(value)
    }
}

impl Truth {
    fn of(value: bool) -> Self {
        Self(put(Node::Known(value)))
    }

    fn known(self) -> Option<bool> {
        GRAPH.with_borrow(|graph| match graph.nodes[self.0] {
            Node::Known(value) => Some(value),
            _ => None,
        })
    }

    /// The program wants to know now; it is told yes, and the question is kept.
    fn asked(self) -> bool {
        self.known().unwrap_or_else(|| {
            GRAPH.with_borrow_mut(|graph| graph.questions.push(self));
            true
        })
    }
}

impl Add for Symbol {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        match (self.is(0.0), other.is(0.0)) {
            (true, _) => other,
            (_, true) => self,
            _ => self.of_two(other, |a, b| a + b, Node::Add(self, other)),
        }
    }
}

impl Sub for Symbol {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        if other.is(0.0) { self } else { self.of_two(other, |a, b| a - b, Node::Subtract(self, other)) }
    }
}

impl Mul for Symbol {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        match (self.is(1.0), other.is(1.0)) {
            _ if self.is(0.0) || other.is(0.0) => Self::of(0.0),
            (true, _) => other,
            (_, true) => self,
            _ => self.of_two(other, |a, b| a * b, Node::Multiply(self, other)),
        }
    }
}

impl Div for Symbol {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        if other.is(1.0) { self } else { self.of_two(other, |a, b| a / b, Node::Divide(self, other)) }
    }
}

impl Neg for Symbol {
    type Output = Self;
    fn neg(self) -> Self {
        self.of_one(|a| -a, Node::Negate(self))
    }
}

impl Mask for Truth {
    fn any(self) -> bool {
        self.asked()
    }
    fn all(self) -> bool {
        self.asked()
    }
    fn may_be(self) -> bool {
        self.known() != Some(false)
    }
    fn and(self, other: Self) -> Self {
        match (self.known(), other.known()) {
            (Some(false), _) | (_, Some(false)) => Self::of(false),
            (Some(true), _) => other,
            (_, Some(true)) => self,
            _ => Self(put(Node::And(self, other))),
        }
    }
    fn or(self, other: Self) -> Self {
        match (self.known(), other.known()) {
            (Some(true), _) | (_, Some(true)) => Self::of(true),
            (Some(false), _) => other,
            (_, Some(false)) => self,
            _ => Self(put(Node::Or(self, other))),
        }
    }
    fn not(self) -> Self {
        self.known().map_or_else(|| Self(put(Node::Not(self))), |value| Self::of(!value))
    }
}

impl Real for Symbol {
    type Mask = Truth;

    fn of(value: f64) -> Self {
        // One zero: its sign plays no part in the physics.
        Self(put(Node::Number((value + 0.0).to_bits())))
    }
    fn lt(self, other: Self) -> Truth {
        match (self.known(), other.known()) {
            (Some(a), Some(b)) => Truth::of(a < b),
            _ => Truth(put(Node::Less(self, other))),
        }
    }
    fn le(self, other: Self) -> Truth {
        match (self.known(), other.known()) {
            (Some(a), Some(b)) => Truth::of(a <= b),
            _ => Truth(put(Node::LessOrEqual(self, other))),
        }
    }
    fn select(mask: Truth, yes: Self, no: Self) -> Self {
        match mask.known() {
            Some(true) => yes,
            Some(false) => no,
            None if yes == no => yes,
            None => Self(put(Node::Select(mask, yes, no))),
        }
    }
    fn abs(self) -> Self {
        self.of_one(f64::abs, Node::Absolute(self))
    }
    fn sqrt(self) -> Self {
        self.of_one(f64::sqrt, Node::Root(self))
    }
    fn sin(self) -> Self {
        self.of_one(Real::sin, Node::Sine(self))
    }
    fn exp(self) -> Self {
        self.of_one(Real::exp, Node::Exponential(self))
    }
    fn ln(self) -> Self {
        self.of_one(Real::ln, Node::Logarithm(self))
    }
    fn powf(self, exponent: Self) -> Self {
        self.of_two(exponent, Real::powf, Node::Power(self, exponent))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_known_is_computed_and_equal_nodes_are_one() {
        let ((known, once, twice), graph) = written_by(|| {
            let x = Symbol::named("x");
            ((Symbol::of(2.0) + Symbol::of(3.0)).known(), x * x, x * x)
        });
        assert_eq!(known, Some(5.0));
        assert_eq!(once, twice);
        assert_eq!(graph.nodes.iter().filter(|node| matches!(node, Node::Multiply(..))).count(), 1);
        assert!(graph.questions.is_empty());
    }

    #[test]
    fn questions_are_kept() {
        let (answer, graph) = written_by(|| Symbol::named("x").lt(Symbol::of(1.0)).all());
        assert!(answer && graph.questions.len() == 1);
    }
}
