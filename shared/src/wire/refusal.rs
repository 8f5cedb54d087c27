//! Why a rig did not do what it was asked.

use crate::curve::MAX_KNOTS;
use crate::parameters::ParameterError;
use serde::{Deserialize, Serialize};

/// Why a command was refused.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Refusal {
    /// The two speak different versions.
    Protocol {
        /// The PC's version.
        host: u16,
        /// The rig's version.
        rig: u16,
    },
    /// Parameters that can't be used.
    Parameters(ParameterError),
    /// Settings outside their range: which, by position in [`super::Settings`].
    Setting {
        /// 0 rate, 1 cut-off, 2 bandwidth, 3 sensor.
        index: u8,
    },
    /// The pendulum moves, so that it can't be calibrated now.
    NotStill,
    /// The known angle is too near zero, or the gain it gives is absurd.
    BadAngle,
    /// The potentiometer seems to be disconnected.
    SensorDisconnected,
    /// Flash could not be written or read back.
    Flash,
    /// There is nothing (usable) in flash.
    NothingStored,
    /// This board can't do that.
    NotHere,
    /// What came is no program of a formula that this firmware can run.
    Formula,
    /// The supply is too low to write to flash.
    Supply,
    /// The sensor's gain is a number of its own, which no angle can tell better.
    GainIsKnown,
    /// This board has no input for that sensor.
    NoSuchSensor,
    /// What came are no knots of a friction curve.
    Curve,
}

impl core::fmt::Display for Refusal {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Protocol { host, rig } => {
                write!(f, "the program speaks protocol {host}, the rig {rig}; update the older of the two")
            }
            Self::Parameters(error) => write!(f, "{error}"),
            Self::Setting { index: 3 } => {
                write!(
                    f,
                    "the sensor's calibration is outside its range, or its full_scale not that of this rig's converter"
                )
            }
            Self::Setting { index } => {
                let what = ["sampling rate", "filter cut-off", "observer bandwidth"];
                write!(f, "the {} is outside its range", what.get(usize::from(*index)).copied().unwrap_or("setting"))
            }
            Self::NotStill => write!(f, "the pendulum is moving; hold it still and ask again"),
            Self::BadAngle => write!(f, "that angle gives no sensible gain; hold it at 0.5 rad or more from zero"),
            Self::SensorDisconnected => write!(f, "the potentiometer reads an end of its range; check its wires"),
            Self::Flash => write!(f, "the flash memory could not be written"),
            Self::NothingStored => write!(f, "nothing usable is stored in flash"),
            Self::NotHere => write!(f, "this board cannot do that"),
            Self::Formula => write!(f, "its firmware cannot run this formula; is the firmware older?"),
            Self::Supply => write!(f, "its supply is below 2.9 V, too low to write to flash"),
            Self::GainIsKnown => {
                write!(f, "its sensor's gain follows from its counts a turn; there is nothing to measure")
            }
            Self::NoSuchSensor => write!(f, "this board has no input for that sensor"),
            Self::Curve => {
                write!(f, "the knots of the friction curve are not 2 to {MAX_KNOTS} speeds that rise from 0")
            }
        }
    }
}
