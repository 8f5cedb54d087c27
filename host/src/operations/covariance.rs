//! The covariance of what a fit found, from its standard deviations and correlations.

use crate::fit::identify::{Fit, Identified};
use serde::Serialize;

/// A covariance matrix with what its rows and columns are.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Covariance {
    /// The numbers' symbols, in the order of rows and columns.
    symbols: Vec<&'static str>,
    /// Their units; an entry is in the product of two.
    units: Vec<&'static str>,
    /// Absent where the swings give none: a number on its bound, or one in which the error jumps against the others.
    matrix: Vec<Vec<Option<f64>>>,
}

impl Covariance {
    /// Of all numbers that a fit found, in its order.
    pub(super) fn of(fit: &Fit) -> Self {
        let found = &fit.identified;
        let entry = |i: usize, j: usize| {
            let both = found[i].std? * found[j].std?;
            if i == j { Some(both) } else { fit.correlations[i][j].map(|correlation| correlation * both) }
        };
        let row = |i: usize| (0..found.len()).map(|j| entry(i, j)).collect();
        let texts = |text: fn(&Identified) -> &'static str| found.iter().map(text).collect();
        Self {
            symbols: texts(|number| number.symbol),
            units: texts(|number| number.unit),
            matrix: (0..found.len()).map(row).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::examples::fit;

    #[test]
    fn an_entry_is_the_correlation_times_both_standard_deviations() {
        let fit = fit();
        let found = Covariance::of(&fit);
        let of = |symbol: &str| found.symbols.iter().position(|other| *other == symbol).unwrap();
        let (mw, mc) = (of("Mw"), of("Mc"));
        let [std_mw, std_mc] = [mw, mc].map(|at| fit.identified[at].std.unwrap());
        let both = fit.correlations[mw][mc].unwrap() * std_mw * std_mc;
        assert!((found.matrix[mw][mc].unwrap() / both - 1.0).abs() < 1e-12);
        assert!((found.matrix[mc][mc].unwrap() / (std_mc * std_mc) - 1.0).abs() < 1e-12);
        assert_eq!((found.units[mw], found.units[mc]), ("N·m·s/rad", "N·m"));
    }
}
