//! Why a fit ends without numbers.

use crate::geometry::GeometryError;
use crate::recording::Measured;
use crate::swing::MixedReadings;

/// Why nothing could be identified.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FitError {
    /// No swing at all.
    #[error("there is no swing to fit; give at least one recording")]
    NoSwing,
    /// A range for something that is not fitted.
    #[error("there is no parameter {symbol} to give a range for; expected one of {known}")]
    UnknownRange {
        /// As given.
        symbol: String,
        /// What there is.
        known: String,
    },
    /// A range that can't be used.
    #[error(
        "the range {low} … {high} of {symbol} can't be used; give two finite numbers, the smaller one first, not below {limit}"
    )]
    BadRange {
        /// Whose.
        symbol: String,
        /// As given.
        low: f64,
        /// As given.
        high: f64,
        /// The least value with a meaning.
        limit: f64,
    },
    /// Mass, length or inertia are not those of the pendulum that swung.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// Angles and rates at once.
    #[error(transparent)]
    Mixed(#[from] MixedReadings),
    /// The model never came near.
    #[error(
        "the model does not follow the swings at all: error {error:.3} {unit}; {later}is the {name} in {unit}, zero where the \
         pendulum hangs, and the geometry right? Did nothing touch or drive it (--from, --to)?",
        later = later_words(*follows_from_s),
        unit = measured.unit(),
        name = measured.name()
    )]
    Hopeless {
        /// Root mean square error, in the unit of the readings.
        error: f64,
        /// What the readings are.
        measured: Measured,
        /// From when on it would, on the clock of the recording, if it would.
        follows_from_s: Option<f64>,
    },
}

/// What to do first where a later part is followed.
fn later_words(follows_from_s: Option<f64>) -> String {
    follows_from_s.map_or_else(String::new, |from_s| {
        format!("but it follows them from {from_s:.2} s on: --from {from_s:.2} leaves out what a hand did before. If that is not it: ")
    })
}
