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
