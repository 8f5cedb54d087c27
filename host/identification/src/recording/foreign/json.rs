//! JSON: an object a line (`{"t": 0.01, "theta": 0.5}`), an array of such objects, or one object of arrays.

use super::{refused, text_of};
use crate::recording::error::Fault;
use serde_json::{Map, Value};

pub(super) fn table(bytes: &[u8]) -> Result<Vec<u8>, Fault> {
    let what = "JSON file";
    let expected =
        "expected an object a line such as {\"t\": 0.01, \"theta\": 0.5}, an array of them, or an object of arrays";
    let mut values = serde_json::Deserializer::from_slice(bytes).into_iter::<Value>();
    let (mut names, mut columns): (Vec<String>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
    let mut n_rows = 0;
    for value in values.by_ref() {
        let value = match value {
            Ok(value) => value,
            // The last line may have been cut off while it was written.
            Err(error) if error.is_eof() && n_rows > 0 => break,
            Err(error) => return Err(refused(what, &format!("{error}; {expected}"))),
        };
        match value {
            Value::Object(object) if object.values().any(Value::is_array) => {
                for (name, value) in object {
                    if let Value::Array(cells) = value {
                        names.push(name);
                        columns.push(cells.iter().map(number).collect());
                    }
                }
            }
            Value::Object(object) => take(&object, &mut names, &mut columns, &mut n_rows),
            Value::Array(rows) => {
                rows.iter()
                    .filter_map(Value::as_object)
                    .for_each(|row| take(row, &mut names, &mut columns, &mut n_rows));
            }
            _ => return Err(refused(what, expected)),
        }
    }
    if columns.is_empty() { Err(refused(what, expected)) } else { Ok(text_of(&names, &columns)) }
}

/// A row; names that are new begin with gaps.
fn take(row: &Map<String, Value>, names: &mut Vec<String>, columns: &mut Vec<Vec<f64>>, n_rows: &mut usize) {
    let nested = row.iter().filter_map(|(name, value)| Some((name, value.as_object()?)));
    let inner =
        nested.flat_map(|(outer, object)| object.iter().map(move |(name, value)| (format!("{outer}.{name}"), value)));
    let plain = row.iter().filter(|(_, value)| !value.is_object()).map(|(name, value)| (name.clone(), value));
    for (name, value) in plain.chain(inner) {
        let idx = names.iter().position(|known| *known == name).unwrap_or_else(|| {
            names.push(name.clone());
            columns.push(vec![f64::NAN; *n_rows]);
            names.len() - 1
        });
        columns[idx].push(number(value));
    }
    *n_rows += 1;
    columns.iter_mut().for_each(|column| column.resize(*n_rows, f64::NAN));
}

/// Text that is a number counts as one.
fn number(value: &Value) -> f64 {
    value.as_f64().or_else(|| value.as_str()?.trim().parse().ok()).unwrap_or(f64::NAN)
}
