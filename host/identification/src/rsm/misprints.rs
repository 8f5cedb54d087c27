//! Misprints: which printed coefficients of a published surface cannot come from its published table.
//!
//! A printed coefficient may differ from the refitted one for three reasons only, each with a known size:
//! - it was rounded to its printed digits: half a unit of its last digit;
//! - the table's responses were rounded before we refitted: half a unit of their last digit, times how strongly the
//!   coefficient depends on each run, added up without regard to sign;
//! - its author's software calculated in double precision: a tiny fraction of the responses in coded units, which is
//!   why coefficients of 1e-7 that should be zero are no misprints.
//!
//! What differs by more is a misprint. Both sides are natural units; the second and third allowance are carried there
//! from coded units, with all the cancellation that natural units bring to intercept and linear terms.

use super::natural::{natural_coefficients, natural_expansion};
use super::surface::Surface;
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

/// Rounding of double-precision regression in coded units, relative to the largest response; generous by a thousand.
const ARITHMETIC_ROUNDING: f64 = 1e-12;

/// One published equation: a response and its coefficients in natural units, digits as printed.
#[derive(Clone, Debug, PartialEq)]
pub struct PrintedEquation {
    /// Name of the response.
    pub response: String,
    /// Term name (`1`, `Mw`, `Mw^2`, `Mw*Mc`) and the coefficient as printed, in any order.
    pub coefficients: Vec<(String, String)>,
}

/// One printed coefficient that the table contradicts; natural units.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Misprint {
    /// Name of the response.
    pub response: String,
    /// Name of the term.
    pub term: String,
    /// The coefficient as printed.
    pub printed: String,
    /// The coefficient that the table gives.
    pub refitted: f64,
    /// The largest difference that rounding can explain.
    pub allowance: f64,
}

/// Why printed equations cannot be compared.
#[derive(Debug, thiserror::Error)]
pub enum MisprintError {
    /// The surface has no such term.
    #[error(
        "the equation for {response} has a term {term}, unknown to the surface; expected names such as Mw, Mw^2, Mw*Mc"
    )]
    UnknownTerm {
        /// Name of the response.
        response: String,
        /// The term as printed.
        term: String,
    },
    /// A coefficient is not a decimal number.
    #[error("the equation for {response} has the coefficient {text} at {term}; expected a decimal number")]
    NotANumber {
        /// Name of the response.
        response: String,
        /// The term as printed.
        term: String,
        /// The coefficient as printed.
        text: String,
    },
    /// The table is not readable.
    #[error("could not read the equations: {0}")]
    Csv(#[from] csv::Error),
}

/// Reads equations from CSV: a header `term,<response>,<response>…`, then one row a term.
pub fn read_equations(input: impl std::io::Read) -> Result<Vec<PrintedEquation>, MisprintError> {
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(input);
    let mut equations: Vec<PrintedEquation> = Vec::new();
    for response in reader.headers()?.iter().skip(1) {
        equations.push(PrintedEquation { response: response.to_string(), coefficients: Vec::new() });
    }
    for row in reader.records() {
        let row = row?;
        for (equation, text) in equations.iter_mut().zip(row.iter().skip(1)) {
            equation.coefficients.push((row[0].to_string(), text.to_string()));
        }
    }
    Ok(equations)
}

/// The misprints of one equation, in its own order. `response_half_unit` is half a unit of the last printed digit of
/// the table's responses: 5e-7 for six decimals, 0 for counts, which are exact.
pub fn misprints(
    equation: &PrintedEquation,
    surface: &Surface,
    response_half_unit: f64,
) -> Result<Vec<Misprint>, MisprintError> {
    let refit = Refit::of(surface, response_half_unit);
    let judged = equation.coefficients.iter().map(|(term, text)| refit.judge(&equation.response, term, text));
    judged.filter_map(Result::transpose).collect()
}

/// What the table says, in natural units, one entry a term.
struct Refit {
    names: Vec<String>,
    coefficients: Vec<f64>,
    allowances: DVector<f64>,
}

impl Refit {
    fn of(surface: &Surface, response_half_unit: f64) -> Self {
        Self {
            names: surface.term_names(),
            coefficients: natural_coefficients(surface),
            allowances: rounding_allowances(surface, response_half_unit),
        }
    }

    fn judge(&self, response: &str, term: &str, text: &str) -> Result<Option<Misprint>, MisprintError> {
        let (response, term, text) = (response.to_string(), term.to_string(), text.to_string());
        let Some(idx) = self.names.iter().position(|name| *name == term) else {
            return Err(MisprintError::UnknownTerm { response, term });
        };
        let Some((value, half_unit)) = decimal(&text) else {
            return Err(MisprintError::NotANumber { response, term, text });
        };
        let (refitted, allowance) = (self.coefficients[idx], half_unit + self.allowances[idx]);
        let contradicted = (value - refitted).abs() > allowance;
        Ok(contradicted.then_some(Misprint { response, term, printed: text, refitted, allowance }))
    }
}

/// How far each natural coefficient can move when every response moves within its rounding, plus arithmetic.
fn rounding_allowances(surface: &Surface, response_half_unit: f64) -> DVector<f64> {
    let expansion = natural_expansion(surface.terms(), surface.factors());
    let arithmetic = ARITHMETIC_ROUNDING * surface.responses().amax();
    let from_arithmetic = row_sums_of_magnitudes(&expansion) * arithmetic;
    let from_responses = row_sums_of_magnitudes(&(expansion * surface.sensitivity())) * response_half_unit;
    from_arithmetic + from_responses
}

fn row_sums_of_magnitudes(matrix: &DMatrix<f64>) -> DVector<f64> {
    matrix.abs().column_sum()
}

/// A decimal number and half a unit of its last digit.
fn decimal(text: &str) -> Option<(f64, f64)> {
    let value: f64 = text.parse().ok().filter(|value: &f64| value.is_finite())?;
    let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let n_decimals = mantissa.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let last_digit = exponent.parse::<i32>().ok()? - i32::try_from(n_decimals).ok()?;
    Some((value, 0.5 * 10f64.powi(last_digit)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rsm::coding::Factor;
    use crate::rsm::design::Design;

    /// y = 3 + 2·u + 0.125·u² over u = 0 … 4.
    fn surface() -> Surface {
        let runs = [0.0, 1.0, 2.0, 4.0].map(|u| vec![u]);
        let design = Design::from_natural(vec![Factor::new("u", 0.0, 4.0).unwrap()], &runs).unwrap();
        let responses = runs.map(|run| 3.0 + 2.0 * run[0] + 0.125 * run[0] * run[0]);
        Surface::fit(&design, &responses).unwrap()
    }

    fn flagged(text: &str, response_half_unit: f64) -> Vec<String> {
        let equation = read_equations(text.as_bytes()).unwrap().remove(0);
        misprints(&equation, &surface(), response_half_unit).unwrap().into_iter().map(|found| found.term).collect()
    }

    #[test]
    fn rounded_digits_are_no_misprints_but_a_wrong_digit_or_sign_is() {
        assert!(flagged("term,y\n1,3.00\nu,2\nu^2,0.13\n", 0.0).is_empty());
        assert_eq!(flagged("term,y\n1,3.00\nu,-2\nu^2,0.14\n", 0.0), ["u", "u^2"]);
        let equation = read_equations("term,y\nu,-2\n".as_bytes()).unwrap().remove(0);
        let found = misprints(&equation, &surface(), 0.0).unwrap().remove(0);
        assert!(found.printed == "-2" && (found.refitted - 2.0).abs() < 1e-9, "{found:?}");
        assert!((found.allowance - 0.5).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn rounded_responses_widen_the_allowance() {
        assert_eq!(flagged("term,y\nu^2,0.120\n", 0.0), ["u^2"]);
        assert!(flagged("term,y\nu^2,0.120\n", 0.05).is_empty());
    }

    #[test]
    fn the_last_printed_digit_sets_the_rounding() {
        for (text, value, half_unit) in
            [("-250", -250.0, 0.5), ("0.047", 0.047, 5e-4), ("+1.5", 1.5, 0.05), ("1.20e-3", 1.2e-3, 5e-6)]
        {
            let (found_value, found_half_unit) = decimal(text).unwrap();
            assert_eq!(found_value, value);
            assert!((found_half_unit / half_unit - 1.0).abs() < 1e-12);
        }
        assert!(["", "x", "nan", "inf", "1e", "1.2.3"].iter().all(|text| decimal(text).is_none()));
    }

    #[test]
    fn unknown_terms_and_words_are_refused_by_name() {
        let refused = |text: &str| {
            misprints(&read_equations(text.as_bytes()).unwrap()[0], &surface(), 0.0).unwrap_err().to_string()
        };
        assert!(refused("term,y\nv^2,1\n").contains("v^2"));
        assert!(refused("term,y\nu,two\n").contains("two"));
    }
}
