//! A sensor as `--json` tells it.

use serde::Serializer;
use serde::ser::SerializeMap;
use shared::sensor::Sensor;

/// For `#[serde(serialize_with = …)]`. A potentiometer's fields are those that there were before there was another
/// sensor; any other one says its kind, and the numbers that model files have of it.
///
/// # Errors
/// Those of the serializer.
pub fn as_json<S: Serializer>(sensor: &Sensor, serializer: S) -> Result<S::Ok, S::Error> {
    let line = sensor.line();
    let mut map = serializer.serialize_map(None)?;
    map.serialize_entry("zero_code", &line.zero_code)?;
    map.serialize_entry("radian_per_code", &line.radian_per_code)?;
    map.serialize_entry("full_scale", &sensor.full_scale())?;
    if !matches!(sensor, Sensor::Potentiometer(_)) {
        map.serialize_entry("kind", sensor.name())?;
        for (known, value) in sensor.numbers() {
            match known.whole.is_some() {
                true => map.serialize_entry(known.key, &(value as i64))?,
                false => map.serialize_entry(known.key, &value)?,
            }
        }
    }
    map.end()
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::sensor::{Encoder, Potentiometer};

    #[derive(serde::Serialize)]
    struct Told(#[serde(serialize_with = "as_json")] Sensor);

    #[test]
    fn a_potentiometer_is_told_by_its_line_and_an_encoder_by_its_kind_too() {
        let potentiometer = Sensor::Potentiometer(Potentiometer::nominal(4095));
        let (line, told) = (potentiometer.line(), serde_json::to_value(Told(potentiometer)).unwrap());
        assert_eq!((&told["zero_code"], &told["full_scale"]), (&line.zero_code.into(), &4095.into()));
        assert_eq!((&told["radian_per_code"], told.get("kind")), (&line.radian_per_code.into(), None));
        let told = serde_json::to_value(Told(Sensor::Encoder(Encoder::new(4096)))).unwrap();
        assert_eq!(told["kind"], "encoder");
    }
}
