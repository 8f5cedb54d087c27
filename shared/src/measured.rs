//! What a sensor measures of the pendulum: its angle, or how fast that changes.
//!
//! A recording holds readings of one kind throughout. What follows asks here for the unit; the model gives the reading
//! of either kind ([`crate::model::Model::read`], [`crate::model::Model::read_rate`]).

use core::str::FromStr;
use serde::Serialize;

/// What the readings of a recording are.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Measured {
    /// The angle, in rad: a potentiometer, an encoder, a video.
    #[default]
    Angle,
    /// The angular velocity, in rad/s: a gyroscope, a tachometer.
    Rate,
}

impl Measured {
    /// As it stands in files: `angle`, `rate`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Angle => "angle",
            Self::Rate => "rate",
        }
    }

    /// SI unit of a reading.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Angle => "rad",
            Self::Rate => "rad/s",
        }
    }

    /// Unit of a thousandth, in which errors and noise are shown.
    pub fn milli_unit(self) -> &'static str {
        match self {
            Self::Angle => "mrad",
            Self::Rate => "mrad/s",
        }
    }
}

impl FromStr for Measured {
    type Err = ();

    fn from_str(text: &str) -> Result<Self, ()> {
        let name = text.trim().trim_matches(['"', '\'']);
        [Self::Angle, Self::Rate].into_iter().find(|it| name.eq_ignore_ascii_case(it.name())).ok_or(())
    }
}
