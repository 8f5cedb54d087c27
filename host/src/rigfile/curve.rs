//! The friction curve in the model file: `[effect.friction-curve]` with the speeds of its knots and the friction there.

use super::{RigFile, RigFileError, Source, write};
use crate::fit::curve::KnownCurve;
use shared::curve::Curve;
use shared::effect::{CURVE_ID, CURVE_NAME};
use toml_edit::{Array, Item, Table, TableLike, Value};

/// Keys of the table: the first two make the curve.
pub(super) const KEYS: [&str; 6] = ["speed", "torque", "std", "method", "recordings", "measured"];

/// In place of a standard deviation that no two stretches of the swings agree on.
const UNKNOWN: &str = "unknown";

impl RigFile {
    /// Sets the friction curve, viscous and Coulomb friction being zero.
    ///
    /// # Errors
    /// As [`RigFile::set`].
    pub fn set_curve(&mut self, known: &KnownCurve, source: &Source) -> Result<(), RigFileError> {
        let rounded: Vec<f64> = known.curve.torques_nm().iter().copied().map(as_written).collect();
        let curve = Curve::new(known.curve.speeds_rad_s(), &rounded).unwrap_or_else(|| known.curve.clone());
        let mut parameters = self.parameters.clone();
        parameters.set_curve(&curve).map_err(RigFileError::Model)?;
        parameters.check().map_err(RigFileError::Model)?;
        self.parameters = parameters;
        self.remove_effect_text(CURVE_ID);
        write::add_table(
            &mut self.document,
            CURVE_NAME,
            table(&KnownCurve { curve, stds: known.stds.clone() }, source),
        );
        Ok(())
    }
}

/// Rounding says no more than the rig's numbers of 32 bits can; what came from a rig stays as it is.
fn as_written(torque_nm: f64) -> f64 {
    let is_of_rig = super::exactly(torque_nm as f32) == torque_nm;
    if is_of_rig { torque_nm } else { write::six_digits(torque_nm) }
}

fn table(known: &KnownCurve, source: &Source) -> Table {
    let mut table = Table::new();
    table
        .decor_mut()
        .set_prefix("\n# Friction as a free, smooth curve of the speed, in place of viscous and coulomb.\n");
    let speeds = known.curve.speeds_rad_s().iter().map(|speed| super::exactly(*speed));
    let mut insert = |key: &str, comment: &str, value: Value| {
        table.insert(key, Item::Value(value));
        if let Some(mut key) = table.key_mut(key).filter(|_| !comment.is_empty()) {
            key.leaf_decor_mut().set_prefix(format!("# {comment}\n"));
        }
    };
    insert("speed", "rad/s, the speeds of its knots", Value::Array(speeds.collect()));
    insert("torque", "N·m, the friction there", Value::Array(known.curve.torques_nm().iter().copied().collect()));
    if !known.stds.is_empty() {
        let std = |std: &Option<f64>| match std {
            Some(std) => Value::from(format!("{std:.2e}").parse().unwrap_or(*std)),
            None => Value::from(UNKNOWN),
        };
        let stds: Array = known.stds.iter().map(std).collect();
        insert("std", "N·m, their standard deviations", Value::Array(stds));
    }
    insert("method", "", Value::from(source.method.as_str()));
    if !source.recordings.is_empty() {
        insert("recordings", "", Value::Array(source.recordings.iter().map(String::as_str).collect()));
    }
    table
}

/// The curve of a table, or the key that is wrong and what was expected.
pub(super) fn read(table: &dyn TableLike) -> Result<Curve<f64>, (&'static str, String)> {
    let numbers = |key: &'static str, unit: &str| -> Result<Vec<f64>, (&'static str, String)> {
        let expected = || (key, format!("expected a list of numbers in {unit}, one a knot"));
        let list = table.get(key).and_then(Item::as_array).ok_or_else(expected)?;
        let number = |value: &Value| value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64));
        list.iter().map(|value| number(value).filter(|number| number.is_finite()).ok_or_else(expected)).collect()
    };
    let (speeds, torques) = (numbers("speed", "rad/s")?, numbers("torque", "N·m")?);
    if speeds.len() != torques.len() {
        return Err(("torque", format!("{} torques for {} speeds; give one each", torques.len(), speeds.len())));
    }
    let speeds: Vec<f32> = speeds.into_iter().map(|speed| speed as f32).collect();
    let expected = || ("speed", format!("expected 2 to {} speeds that rise from 0", shared::curve::MAX_KNOTS));
    Curve::new(&speeds, &torques).ok_or_else(expected)
}
