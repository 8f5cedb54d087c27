//! A design made ready for surfaces.

use super::design::Design;
use super::error::FitError;
use super::least_squares::{LeastSquares, rank};
use super::term::Term;
use nalgebra::DMatrix;
use std::sync::Arc;

/// Its regression matrix is taken apart once, however many responses follow.
#[derive(Clone, Debug)]
pub struct Regression(Arc<Parts>);

#[derive(Debug)]
struct Parts {
    design: Design,
    terms: Vec<Term>,
    matrix: DMatrix<f64>,
    least_squares: LeastSquares,
}

impl Regression {
    /// Of a design whose runs tell all terms of the quadratic apart.
    pub fn new(design: &Design) -> Result<Self, FitError> {
        let terms = design.terms();
        let (n_runs, n_terms) = (design.n_runs(), terms.len());
        if n_runs < n_terms {
            return Err(FitError::TooFewRuns { n_runs, n_terms });
        }
        let matrix = design.model_matrix();
        let Some(least_squares) = LeastSquares::new(matrix.clone()) else {
            return Err(FitError::RankDeficient { rank: rank(&matrix), n_terms });
        };
        Ok(Self(Arc::new(Parts { design: design.clone(), terms, matrix, least_squares })))
    }

    /// Its design.
    pub fn design(&self) -> &Design {
        &self.0.design
    }

    /// The terms of the quadratic, one a column.
    pub fn terms(&self) -> &[Term] {
        &self.0.terms
    }

    /// The regression matrix, one row a run, one column a term.
    pub fn matrix(&self) -> &DMatrix<f64> {
        &self.0.matrix
    }

    /// The same taken apart.
    pub fn least_squares(&self) -> &LeastSquares {
        &self.0.least_squares
    }
}
