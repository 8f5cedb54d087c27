//! Coefficients in natural units, for comparison with printed equations; never used for predictions.
//!
//! With x = u/h − c/h (centre c, half range h) each coded term becomes a few natural ones. A natural intercept is the
//! surface extrapolated to all factors at zero: a sum of huge parts that nearly cancel, so it is summed with
//! compensation.
//! Source: A. Neumaier, Z. Angew. Math. Mech. 54 (1974) 39 (summation).

use super::coding::Factor;
use super::surface::Surface;
use super::term::Term;
use nalgebra::DMatrix;

/// The coefficients in natural units, in the order of `Surface::terms`.
pub fn natural_coefficients(surface: &Surface) -> Vec<f64> {
    let expansion = natural_expansion(surface.terms(), surface.factors());
    let row_sum = |row_idx: usize| compensated_sum(expansion.row(row_idx).iter().zip(surface.coefficients()));
    (0..expansion.nrows()).map(row_sum).collect()
}

/// What each coded coefficient (column) adds to each natural coefficient (row); square, in the order of `terms`, which
/// must hold every term that an expansion can reach, as a full quadratic does.
pub fn natural_expansion(terms: &[Term], factors: &[Factor]) -> DMatrix<f64> {
    let mut expansion = DMatrix::zeros(terms.len(), terms.len());
    for (column_idx, &coded_term) in terms.iter().enumerate() {
        for (natural_term, weight) in expanded(coded_term, factors) {
            let row_idx = terms.iter().position(|&term| term == natural_term);
            expansion[(row_idx.expect("a full quadratic holds every term"), column_idx)] += weight;
        }
    }
    expansion
}

/// One coded term multiplied out in natural units.
fn expanded(coded_term: Term, factors: &[Factor]) -> Vec<(Term, f64)> {
    let slope = |idx: usize| 1.0 / factors[idx].half_range();
    let offset = |idx: usize| -factors[idx].centre() / factors[idx].half_range();
    match coded_term {
        Term::Intercept => vec![(Term::Intercept, 1.0)],
        Term::Linear(i) => vec![(Term::Linear(i), slope(i)), (Term::Intercept, offset(i))],
        Term::Square(i) => vec![
            (Term::Square(i), slope(i) * slope(i)),
            (Term::Linear(i), 2.0 * slope(i) * offset(i)),
            (Term::Intercept, offset(i) * offset(i)),
        ],
        Term::Interaction(i, j) => vec![
            (Term::Interaction(i, j), slope(i) * slope(j)),
            (Term::Linear(i), slope(i) * offset(j)),
            (Term::Linear(j), slope(j) * offset(i)),
            (Term::Intercept, offset(i) * offset(j)),
        ],
    }
}

fn compensated_sum<'a>(products: impl Iterator<Item = (&'a f64, &'a f64)>) -> f64 {
    let (mut sum, mut lost) = (0.0_f64, 0.0);
    for (weight, coefficient) in products {
        let part = weight * coefficient;
        let next = sum + part;
        lost += if sum.abs() >= part.abs() { (sum - next) + part } else { (part - next) + sum };
        lost += weight.mul_add(*coefficient, -part);
        sum = next;
    }
    sum + lost
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rsm::design::Design;

    #[test]
    fn a_quadratic_written_in_natural_units_comes_back() {
        let factors = vec![Factor::new("a", 1.0, 3.0).unwrap(), Factor::new("b", -4.0, 2.0).unwrap()];
        let design = Design::face_centred(factors, 1).unwrap();
        let known = [5.0, -2.0, 0.5, 3.0, -0.25, 1.5];
        let height = |run: &Vec<f64>| design.terms().iter().zip(known).map(|(term, b)| b * term.value(run)).sum();
        let responses: Vec<f64> = design.natural_runs().iter().map(height).collect();
        let found = natural_coefficients(&Surface::fit(&design, &responses).unwrap());
        for (found, known) in found.iter().zip(known) {
            assert!((found - known).abs() < 1e-12, "{found} is not {known}");
        }
    }

    #[test]
    fn parts_that_cancel_leave_their_small_remainder() {
        let (weights, coefficients) = ([1e20, 1.0, -1e20], [1.0, 0.5, 1.0]);
        assert_eq!(compensated_sum(weights.iter().zip(&coefficients)), 0.5);
    }
}
