//! Why a look names no effect.

use serde::{Deserialize, Serialize};

/// Why nothing is named.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Reason {
    /// The swings give too few windows yet.
    TooFewSwings,
    /// No friction and inertia make the model follow these swings.
    NotThisPendulum,
    /// What is wrong are the model's own numbers: with others it follows to the noise.
    WrongNumbers,
    /// Friction about rest differs from the model's, and may look like other effects.
    FrictionAboutRest,
    /// More than noise is left, but nothing in the list explains it on every part of the swings.
    Unexplained,
    /// The model follows to the noise.
    NothingMissing,
}
