//! Eqs 18–22: every printed coefficient beside the one that Table 8 gives, misprints flagged.

use super::data::Published;
use super::designs::DesignComparison;
use crate::rsm::{Misprint, misprints, natural_coefficients};
use serde::Serialize;

/// The number of the first equation.
const FIRST_EQUATION: usize = 18;

/// Half a unit of the last printed digit of Table 8: six decimals for mean squares, exact counts.
const HALF_UNITS: [f64; 5] = [5e-7, 5e-7, 0.0, 0.0, 0.0];

/// One equation beside ours.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EquationComparison {
    /// 18 to 22.
    pub number: usize,
    /// The response that it predicts.
    pub response: String,
    /// Its terms in the paper's order, natural units.
    pub terms: Vec<TermComparison>,
}

impl EquationComparison {
    /// The terms that the table contradicts.
    pub fn misprints(&self) -> impl Iterator<Item = &TermComparison> {
        self.terms.iter().filter(|term| term.is_misprint)
    }
}

/// One coefficient beside ours.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TermComparison {
    /// `1`, `Mw`, `Mw^2`, `Mw*Mc`.
    pub term: String,
    /// As printed.
    pub printed: String,
    /// From the printed table.
    pub ours: f64,
    /// Do they differ by more than rounding can explain?
    pub is_misprint: bool,
}

/// Sets the printed equations beside the surfaces of design 3.
pub fn compare(published: &Published, third_design: &DesignComparison) -> Vec<EquationComparison> {
    let compare_one = |k: usize| {
        let (equation, surface) = (&published.equations[k], &third_design.surfaces[k]);
        let found: Vec<Misprint> = misprints(equation, surface, HALF_UNITS[k]).expect("embedded and tested");
        let (names, refitted) = (surface.term_names(), natural_coefficients(surface));
        let term = |(term, printed): &(String, String)| TermComparison {
            ours: names.iter().position(|name| name == term).map_or(f64::NAN, |idx| refitted[idx]),
            is_misprint: found.iter().any(|misprint| misprint.term == *term),
            term: term.clone(),
            printed: printed.clone(),
        };
        EquationComparison {
            number: FIRST_EQUATION + k,
            response: equation.response.clone(),
            terms: equation.coefficients.iter().map(term).collect(),
        }
    };
    (0..published.equations.len()).map(compare_one).collect()
}
