//! What an identification finds.

use super::problem::Start;
use super::quality::Responses;
use super::sequential::Stage;
use super::tolerance::{KnownRig, Tolerances};
use super::touch::Touch;
use super::uncertainty::Status;
use crate::verdict::Left;
use serde::Serialize;
use shared::parameters::Parameters;

/// An identified number.
#[derive(Clone, Debug, Serialize)]
pub struct Identified {
    /// The literature's symbol.
    pub symbol: &'static str,
    /// The effect, or `inertia`.
    pub name: &'static str,
    /// The value.
    pub value: f64,
    /// Standard deviation; absent if the data don't give one.
    pub std: Option<f64>,
    /// SI unit.
    pub unit: &'static str,
    /// How well the swings tell it.
    pub verdict: Verdict,
    /// How far it may be trusted.
    pub status: Status,
    /// With 95 % confidence it is not larger; where that is all the swings tell.
    pub upper: Option<f64>,
}

/// How well the swings tell a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Known within 10 %.
    Identified,
    /// Known within a factor of about two.
    Weak,
    /// The swings say next to nothing about it.
    Not,
}

/// The result of an identification.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The pendulum with all its effects.
    pub parameters: Parameters<f64>,
    /// How surely its geometry was known before.
    pub tolerances: Tolerances,
    /// The identified numbers.
    pub identified: Vec<Identified>,
    /// Correlations, a row and a column for each of `identified`, in that order; absent for numbers that the
    /// covariance says nothing about: those on a bound, and Ms and DV where the error depends on them in jumps.
    pub correlations: Vec<Vec<Option<f64>>>,
    /// How each swing began.
    pub starts: Vec<Start>,
    /// Root mean square error, rad.
    pub rmse_rad: f64,
    /// What the model leaves.
    pub left: Left,
    /// Is so much of the motion left, beyond the noise, that something else than an effect should be looked for first?
    pub hardly_follows: bool,
    /// What touched the pendulum on its way. The model begins anew behind each, unless response surfaces alone were asked for.
    pub touches: Vec<Touch>,
    /// Noise of the measurement, rad.
    pub noise_rad: f64,
    /// Root mean square error on the held-out swings, rad.
    pub held_out_rmse_rad: Option<f64>,
    /// The five responses before and after.
    pub responses_before: Responses,
    /// The five responses at the end.
    pub responses: Responses,
    /// The designs, if response surfaces were used.
    pub stages: Vec<Stage>,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// Simulated swings.
    pub n_simulations: usize,
    /// Time taken.
    pub seconds: f64,
}

impl Fit {
    /// The rig as it is known now.
    pub fn rig(&self) -> KnownRig<'_> {
        KnownRig { parameters: &self.parameters, tolerances: self.tolerances }
    }
}
