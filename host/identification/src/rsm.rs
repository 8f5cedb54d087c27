//! Response-surface statistics: from factor ranges to runs, from responses to surfaces, from surfaces to an optimum.
//!
//! The way through, one file a step:
//! `coding` (ranges) → `design` (runs) → `surface` (fit) → `coefficients`, `goodness`, `anova` (can it be believed?)
//! → `desirability`, `optimum` (where to go) → `narrowing` (next ranges).
//! Beside it: `canonical` (the surface's shape), `natural` and `misprints` (comparison with published equations).
//!
//! Nothing here knows of pendulums, files or clocks; points are coded units, −1 at a range's low end, +1 at its high end.
//!
//! Source: R. H. Myers, D. C. Montgomery, C. M. Anderson-Cook, "Response Surface Methodology", Wiley.

pub mod anova;
pub mod canonical;
pub mod coding;
pub mod coefficients;
pub mod design;
pub mod desirability;
mod error;
pub mod goodness;
pub mod least_squares;
pub mod misprints;
pub mod narrowing;
pub mod natural;
pub mod nelder_mead;
pub mod optimum;
pub mod random;
pub mod regression;
pub mod significance;
pub mod surface;
pub mod term;

pub use anova::{Anova, AnovaRow, LackOfFit, anova, factor_effects};
pub use canonical::{Canonical, StationaryKind, canonical};
pub use coding::{CodingError, Factor};
pub use coefficients::{Coefficient, coefficient_table};
pub use design::{COMPOSITE_FACTORS, Design, DesignError};
pub use desirability::{Composite, Desirability, DesirabilityError};
pub use error::FitError;
pub use goodness::{Goodness, goodness};
pub use misprints::{Misprint, MisprintError, PrintedEquation, misprints, read_equations};
pub use narrowing::{NarrowingError, narrow};
pub use natural::natural_coefficients;
pub use optimum::{Optimum, OptimumError, Search, optimum};
pub use regression::Regression;
pub use surface::Surface;
pub use term::Term;
