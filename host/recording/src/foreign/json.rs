//! JSON: an object a line (`{"t": 0.01, "theta": 0.5}`), an array of such objects or of arrays (`[[0.01, 0.5], …]`), or one
//! object of arrays, however deep it lies, or in an array of its own.

use super::as_text::{refused, text_of};
use super::rate_beside;
use crate::clock::{self, Moment};
use crate::error::Fault;
use crate::words::{Meaning, meaning};
use serde_json::{Map, Value};

pub(super) fn table(bytes: &[u8], notes: &mut Vec<String>) -> Result<Vec<u8>, Fault> {
    let what = "JSON file";
    let expected =
        "expected an object a line such as {\"t\": 0.01, \"theta\": 0.5}, an array of them, or an object of arrays";
    let mut values = serde_json::Deserializer::from_slice(bytes).into_iter::<Value>();
    let (mut names, mut columns): (Vec<String>, Vec<Vec<f64>>) = (Vec::new(), Vec::new());
    let (mut n_rows, mut numbers) = (0, Vec::new());
    for value in values.by_ref() {
        let value = match value {
            Ok(value) => value,
            // The last line may have been cut off while it was written.
            Err(error) if error.is_eof() && n_rows > 0 => break,
            Err(error) => return Err(refused(what, &format!("{error}; {expected}"))),
        };
        match value {
            Value::Object(object) if is_of_arrays(&object, DEEPEST) => {
                add_arrays("", &object, &mut names, &mut columns, DEEPEST);
                add_numbers(&object, &mut numbers, DEEPEST);
                if is_lone_matrix(&names) {
                    names.clear();
                }
            }
            Value::Object(object) => take(&object, &mut names, &mut columns, &mut n_rows),
            Value::Array(rows) if rows.iter().any(Value::is_array) => add_rows("", &rows, &mut names, &mut columns),
            Value::Array(rows) if rows.iter().any(holds_recording) => {
                add_recordings("", &rows, &mut names, &mut columns, DEEPEST);
            }
            Value::Array(rows) => {
                rows.iter()
                    .filter_map(Value::as_object)
                    .for_each(|row| take(row, &mut names, &mut columns, &mut n_rows));
            }
            _ => return Err(refused(what, expected)),
        }
    }
    if columns.is_empty() {
        return Err(refused(what, expected));
    }
    let numbers = numbers.iter().map(|(name, number)| (name.as_str(), *number));
    let rate = rate_beside::line_above(numbers, &names, &columns, notes);
    let names = if names.len() == columns.len() { &names[..] } else { &[] };
    Ok([rate.into_bytes(), text_of(names, &columns)].concat())
}

/// Objects within objects, so deep.
const DEEPEST: usize = 8;

/// Arrays of so many numbers or fewer, beside numbers, belong to one row: the three axes of a sensor.
const MOST_AXES: usize = 16;

/// A matrix with more columns, and more rows, is a picture, not a table.
const MOST_COLUMNS: usize = 64;

/// Does an object hold a whole recording, and not one row of it?
fn is_of_arrays(object: &Map<String, Value>, deepest: usize) -> bool {
    let is_row = object.values().any(Value::is_number);
    object.values().any(|value| match value {
        Value::Array(cells) => !is_row || cells.len() > MOST_AXES,
        Value::Object(inner) => deepest > 0 && is_of_arrays(inner, deepest - 1),
        _ => false,
    })
}

/// Is it an object with an array that is longer than a row is wide?
fn holds_recording(value: &Value) -> bool {
    let is_long = |value: &Value| value.as_array().is_some_and(|cells| cells.len() > MOST_AXES);
    value.as_object().is_some_and(|object| object.values().any(is_long))
}

/// Is it a matrix that stands alone? What it is called after says nothing of its columns, unless it names what is read.
fn is_lone_matrix(names: &[String]) -> bool {
    let Some((matrix, "1")) = names.first().and_then(|name| name.rsplit_once(' ')) else { return false };
    let is_of_it = |(idx, name): (usize, &String)| *name == format!("{matrix} {}", idx + 1);
    names.len() > 1 && names.iter().enumerate().all(is_of_it) && meaning(matrix) == Meaning::Other
}

/// Numbers that stand alone, by the last of their names.
fn add_numbers(object: &Map<String, Value>, numbers: &mut Vec<(String, f64)>, deepest: usize) {
    for (name, value) in object {
        match value {
            Value::Object(inner) if deepest > 0 => add_numbers(inner, numbers, deepest - 1),
            Value::Number(number) => numbers.extend(number.as_f64().map(|number| (name.clone(), number))),
            _ => {}
        }
    }
}

/// The arrays of each; of several with their places in their names.
fn add_recordings(outer: &str, all: &[Value], names: &mut Vec<String>, columns: &mut Vec<Vec<f64>>, deepest: usize) {
    for (idx, recording) in all.iter().filter_map(Value::as_object).enumerate() {
        let outer = if all.len() == 1 { outer.to_owned() } else { format!("{outer}{}.", idx + 1) };
        add_arrays(&outer, recording, names, columns, deepest);
    }
}

/// Arrays of numbers, of arrays, or of objects, wherever they lie.
fn add_arrays(
    outer: &str,
    object: &Map<String, Value>,
    names: &mut Vec<String>,
    columns: &mut Vec<Vec<f64>>,
    deepest: usize,
) {
    for (name, value) in object {
        let name = format!("{outer}{name}");
        match value {
            Value::Array(rows) if deepest > 0 && rows.iter().any(holds_recording) => {
                add_recordings(&format!("{name}."), rows, names, columns, deepest - 1);
            }
            Value::Array(rows) if rows.iter().any(Value::is_object) => {
                let (mut own_names, mut own_columns, mut n_rows) = (Vec::new(), Vec::new(), 0);
                let rows = rows.iter().filter_map(Value::as_object);
                rows.for_each(|row| take(row, &mut own_names, &mut own_columns, &mut n_rows));
                names.extend(own_names);
                columns.extend(own_columns);
            }
            Value::Array(rows) if rows.iter().any(Value::is_array) => add_rows(&name, rows, names, columns),
            Value::Array(cells) => {
                names.push(name);
                columns.push(cells.iter().map(number).collect());
            }
            Value::Object(inner) if deepest > 0 => {
                add_arrays(&format!("{name}."), inner, names, columns, deepest - 1);
            }
            _ => {}
        }
    }
}

/// Arrays in an array: a row each, or where they are few and long a quantity each. The first may hold names.
fn add_rows(name: &str, rows: &[Value], names: &mut Vec<String>, columns: &mut Vec<Vec<f64>>) {
    let mut rows: Vec<&Vec<Value>> = rows.iter().filter_map(Value::as_array).collect();
    let is_word = |cell: &Value| cell.is_string() && number(cell).is_nan();
    let heading = rows.first().filter(|row| !row.is_empty() && row.iter().all(is_word)).map(|row| (*row).clone());
    if heading.is_some() {
        rows.remove(0);
    }
    let widest = rows.iter().map(|row| row.len()).max().unwrap_or(0);
    let is_lying = rows.len() < widest && rows.len() <= MOST_COLUMNS;
    let n_columns = if is_lying { rows.len() } else { widest.min(MOST_COLUMNS) };
    for idx in 0..n_columns {
        columns.push(match is_lying {
            true => rows[idx].iter().map(number).collect(),
            false => rows.iter().map(|row| row.get(idx).map_or(f64::NAN, number)).collect(),
        });
        match heading.as_ref().and_then(|heading| heading.get(idx)).and_then(Value::as_str) {
            Some(word) => names.push(word.to_owned()),
            None if !name.is_empty() => names.push(format!("{name} {}", idx + 1)),
            None => {}
        }
    }
}

/// A row; names that are new begin with gaps.
fn take(row: &Map<String, Value>, names: &mut Vec<String>, columns: &mut Vec<Vec<f64>>, n_rows: &mut usize) {
    for (name, value) in cells("", row, DEEPEST) {
        let idx = names.iter().position(|known| *known == name).unwrap_or_else(|| {
            names.push(name);
            columns.push(vec![f64::NAN; *n_rows]);
            names.len() - 1
        });
        columns[idx].push(number(value));
    }
    *n_rows += 1;
    columns.iter_mut().for_each(|column| column.resize(*n_rows, f64::NAN));
}

/// The cells of a row: what stands there plainly, then what lies in objects, then what lies in arrays.
fn cells<'a>(outer: &str, row: &'a Map<String, Value>, deepest: usize) -> Vec<(String, &'a Value)> {
    let is_plain = |(_, value): &(&String, &Value)| !value.is_object() && !value.is_array();
    let plain = row.iter().filter(is_plain).map(|(name, value)| (format!("{outer}{name}"), value));
    let nested = row.iter().filter_map(|(name, value)| Some((name, value.as_object().filter(|_| deepest > 0)?)));
    let inner = nested.flat_map(|(name, object)| cells(&format!("{outer}{name}."), object, deepest - 1));
    let lists = row.iter().filter_map(|(name, value)| Some((name, value.as_array()?)));
    let axes = lists.flat_map(|(name, list)| {
        list.iter().take(MOST_AXES).enumerate().map(move |(idx, cell)| (format!("{outer}{name} {}", idx + 1), cell))
    });
    plain.chain(inner).chain(axes).collect()
}

/// Text that is a number counts as one, and so does a moment, in seconds since 1970 or since midnight.
fn number(value: &Value) -> f64 {
    let of_text = |text: &str| text.trim().parse().ok().or_else(|| clock::read(text).map(Moment::seconds));
    value.as_f64().or_else(|| of_text(value.as_str()?)).unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_object_of_arrays_is_told_from_one_row() {
        let check =
            |text: &str| is_of_arrays(serde_json::from_str::<Value>(text).unwrap().as_object().unwrap(), DEEPEST);
        for row in [r#"{"t": 0, "theta": 1}"#, r#"{"t": 0, "axes": [1, 2, 3]}"#, r#"{"t": 0, "swing": {"theta": 1}}"#] {
            assert!(!check(row), "{row}");
        }
        let long = format!(r#"{{"rate": 100, "theta": {:?}}}"#, [1; 17]);
        for whole in [r#"{"t": [0, 1], "theta": [1, 2]}"#, r#"{"swing": {"theta": [1]}}"#, &long] {
            assert!(check(whole), "{whole}");
        }
    }

    #[test]
    fn what_lies_within_objects_within_a_row_is_a_cell_of_it() {
        let row: Value = serde_json::from_str(r#"{"t": 1, "a": {"b": {"c": 2, "list": [3, 4]}, "d": 5}}"#).unwrap();
        let cells = cells("", row.as_object().unwrap(), DEEPEST);
        let found: Vec<(&str, f64)> = cells.iter().map(|(name, value)| (name.as_str(), number(value))).collect();
        assert_eq!(found, [("t", 1.0), ("a.d", 5.0), ("a.b.c", 2.0), ("a.b.list 1", 3.0), ("a.b.list 2", 4.0)]);
    }

    fn angle_at(time_s: f64) -> f64 {
        0.4 * (-0.05 * time_s).exp() * (5.0 * time_s).cos()
    }

    fn read(json: &str) -> crate::Recording {
        crate::read_bytes("swing.json", json.as_bytes(), &crate::ReadOptions::default()).unwrap()
    }

    /// The value first, then when it was: no names tell, but one goes on evenly.
    #[test]
    fn pairs_under_a_name_that_says_nothing_are_a_table_without_names() {
        let pairs = (0..200).map(|idx| 10.0 + 0.1 * f64::from(idx)).map(|time_s| [angle_at(time_s - 10.0), time_s]);
        let pairs: Vec<[f64; 2]> = pairs.collect();
        let recording =
            read(&format!(r#"{{"name": "fading", "timestamp": "2026-03-01 12:00:00", "records": {pairs:?}}}"#));
        assert!((recording.step_s() - 0.1).abs() < 1e-9, "{}", recording.step_s());
        assert!((recording.angles_rad()[0] - 0.4).abs() < 1e-9);
    }

    #[test]
    fn pairs_under_the_name_of_what_is_read_keep_it() {
        assert!(is_lone_matrix(&["records 1".to_owned(), "records 2".to_owned()]));
        for names in [["theta 1", "theta 2"], ["t", "records 1"], ["gyro 1", "gyro 2"]] {
            assert!(!is_lone_matrix(&names.map(str::to_owned)), "{names:?}");
        }
    }

    #[test]
    fn a_recording_that_lies_in_an_array_is_read_by_the_rate_that_stands_beside_it() {
        let angles: Vec<f64> = (0..400).map(|idx| angle_at(f64::from(idx) / 50.0)).collect();
        let row = format!(r#"{{"type": "drop", "targets": ["friction"], "angle": {angles:?}}}"#);
        let recording =
            read(&format!(r#"{{"config": {{"sampling_rate_hz": 50, "limits": [-1, 1]}}, "data": [{row}]}}"#));
        assert_eq!((recording.len(), recording.rate_hz().round()), (400, 50.0));
        let alone = format!(
            r#"[{{"t": {:?}, "angle": {angles:?}}}]"#,
            (0..400).map(|idx| f64::from(idx) / 50.0).collect::<Vec<_>>()
        );
        assert_eq!(read(&alone).len(), 400);
    }
}
