//! A [`Sensor`] in messages and in flash. A potentiometer has the bytes that it always had. Any other sensor stands
//! behind a potentiometer that no rig can have, with a full scale of 0: whoever knows potentiometers only finds bytes
//! left over, and refuses the whole instead of misreading it.

use super::{Potentiometer, Sensor};
use core::fmt;
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserializer, Serialize, Serializer};

/// Stands before every other sensor.
const ANOTHER: Potentiometer = Potentiometer { zero_code: 0.0, radian_per_code: 0.0, full_scale: 0 };

/// For `#[serde(with = …)]`.
///
/// # Errors
/// Those of the serializer.
pub fn serialize<S: Serializer>(sensor: &Sensor, serializer: S) -> Result<S::Ok, S::Error> {
    match sensor {
        Sensor::Potentiometer(potentiometer) => potentiometer.serialize(serializer),
        other => (ANOTHER, other).serialize(serializer),
    }
}

/// For `#[serde(with = …)]`.
///
/// # Errors
/// Those of the deserializer, or bytes that end too early.
pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Sensor, D::Error> {
    deserializer.deserialize_tuple(2, SensorVisitor)
}

struct SensorVisitor;

impl<'de> Visitor<'de> for SensorVisitor {
    type Value = Sensor;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a sensor")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Sensor, A::Error> {
        let missing = |n_found| A::Error::invalid_length(n_found, &self);
        let potentiometer: Potentiometer = sequence.next_element()?.ok_or(missing(0))?;
        if potentiometer.full_scale != ANOTHER.full_scale {
            return Ok(potentiometer.into());
        }
        sequence.next_element()?.ok_or(missing(1))
    }
}
