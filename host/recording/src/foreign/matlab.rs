//! MATLAB files of versions 4 to 7: every vector is a column of its name, every matrix has its columns numbered. A matrix
//! that stands alone is a table without names, unless cells hold as many texts as it has columns, or it is a time and what
//! the variable is called after.
//!
//! Of structures the fields count, and of those that Simulink logs (`Structure With Time`) each signal's values, under
//! its label, or else under the name of the variable. Several structures that are recordings are runs (`matlab_runs.rs`).

use super::as_text::{refused, text_of};
use super::mat5::{Problem, Variable};
use super::rate_beside::{self, rises};
use super::{mat4, mat5, matlab_runs};
use crate::error::Fault;
use crate::limits::MIN_SAMPLES;
use crate::words::{Meaning, meaning};

/// A matrix with more columns, and more rows, is a picture, not a table.
const MOST_COLUMNS: usize = 64;

pub(super) fn table(bytes: &[u8], notes: &mut Vec<String>) -> Result<Vec<u8>, Fault> {
    let what = "MATLAB file";
    let variables = if mat4::begins(bytes) { mat4::variables(bytes) } else { mat5::variables(bytes) };
    let variables = variables.map_err(|problem| match problem {
        Problem::TooLarge => Fault::TooLarge,
        Problem::Damaged => refused(what, "it is damaged; save it anew: save('swing.mat', 't', 'theta', '-v7')"),
    })?;
    let mut columns = Columns::default();
    for (name, variable) in &variables {
        columns.add(name, variable);
    }
    // A time alone beside timeseries is no recording either.
    if let (true, Some(how)) = (columns.numbers.len() < 2, how_to_save(&variables)) {
        return Err(refused(what, &how));
    }
    if columns.numbers.is_empty() {
        return Err(refused(
            what,
            "it holds no vectors, matrices of up to 64 columns or structures of numbers; tables and cells are not read: save \
             the vectors themselves, such as t = Time{1}; save('swing.mat', 't', 'theta', '-v7')",
        ));
    }
    if let Some(runs) = matlab_runs::table(&variables, columns.numbers.len()) {
        return Ok(runs);
    }
    let Some((first, matrix)) = columns.lone_matrix() else {
        columns.name_times();
        let rate = rate_beside::line_above(scalars(&variables), &columns.names, &columns.numbers, notes);
        return Ok([rate.into_bytes(), text_of(&columns.names, &columns.numbers)].concat());
    };
    let named = names_of(&variables, matrix.len());
    let by_variable = time_and(&columns.names[first], matrix);
    let names = if named.is_empty() { by_variable.as_slice() } else { named };
    Ok(text_of(names, matrix))
}

/// Numbers that stand alone.
fn scalars(variables: &[(String, Variable)]) -> impl Iterator<Item = (&str, f64)> {
    variables.iter().filter_map(|(name, variable)| match variable {
        Variable::Numbers { values, .. } if values.len() == 1 => Some((name.as_str(), values[0])),
        _ => None,
    })
}

/// The names of a time and an angle or a rate, where the variable is called after one and only the first column rises
/// throughout; none otherwise.
fn time_and(first: &str, matrix: &[Vec<f64>]) -> Vec<String> {
    let variable = first.strip_suffix(" 1").unwrap_or(first);
    let is_known = matches!(meaning(variable), Meaning::Angle { .. } | Meaning::Rate { .. });
    match matrix {
        [time, other] if is_known && rises(time) && !rises(other) => vec!["time".to_owned(), variable.to_owned()],
        _ => Vec::new(),
    }
}

/// The cells with a text for each of so many columns, a time or an angle among them; none where there are no such cells, or
/// several.
fn names_of(variables: &[(String, Variable)], n_columns: usize) -> &[String] {
    let is_known = |name: &String| matches!(meaning(name), Meaning::Time { .. } | Meaning::Angle { .. });
    let mut fitting = variables.iter().filter_map(|(_, variable)| match variable {
        Variable::Names(names) if names.len() == n_columns && names.iter().any(is_known) => Some(names.as_slice()),
        _ => None,
    });
    fitting.next().filter(|_| fitting.next().is_none()).unwrap_or_default()
}

/// What to do with timeseries, which Simulink writes `To Workspace`, by the name of the one that is likely the angle.
fn how_to_save(variables: &[(String, Variable)]) -> Option<String> {
    let is_series = |variable: &Variable| matches!(variable, Variable::Object(class) if class == TIMESERIES);
    let names: Vec<&str> = variables.iter().filter(|(_, it)| is_series(it)).map(|(name, _)| name.as_str()).collect();
    let is_angle = |name: &&str| matches!(meaning(name), Meaning::Angle { .. });
    let name = names.iter().copied().find(is_angle).or(names.first().copied())?;
    Some(format!(
        "it holds timeseries ({}), which only MATLAB reads; save their vectors there: t = {name}.Time; theta = {name}.Data; \
         save('swing.mat', 't', 'theta', '-v7')",
        names.join(", ")
    ))
}

/// The class of what Simulink logs where nothing else is chosen.
const TIMESERIES: &str = "timeseries";

/// What is found in a file.
#[derive(Default)]
struct Columns {
    names: Vec<String>,
    numbers: Vec<Vec<f64>>,
    /// How many columns each vector or matrix has.
    widths: Vec<usize>,
}

impl Columns {
    /// The columns of a variable, or of what lies in it.
    fn add(&mut self, name: &str, variable: &Variable) {
        match variable {
            Variable::Numbers { n_rows, n_columns, values } => self.add_numbers(name, *n_rows, *n_columns, values),
            Variable::Structure { fields, entries } => {
                entries.iter().for_each(|entry| self.add_entry(name, fields, entry));
            }
            Variable::Text(_) | Variable::Names(_) | Variable::Object(_) | Variable::Other => {}
        }
    }

    /// The fields of a structure; the values of a signal of Simulink have the signal's label.
    fn add_entry(&mut self, name: &str, fields: &[String], entry: &[Variable]) {
        let named = |wanted: &str| fields.iter().zip(entry).find(|(field, _)| *field == wanted).map(|(_, value)| value);
        let label = match named("label") {
            Some(Variable::Text(label)) if !label.is_empty() => label,
            _ => name,
        };
        let is_signal = named("values").is_some();
        for (field, value) in fields.iter().zip(entry) {
            match field.as_str() {
                "values" => self.add(label, value),
                "signals" if named("time").is_some() => self.add_signals(name, value),
                // How the signal is laid out and drawn.
                "dimensions" | "plotStyle" if is_signal => {}
                field => self.add(field, value),
            }
        }
    }

    /// The signals of a structure, each under its label; `To Workspace` gives none, and the variable has the name.
    fn add_signals(&mut self, name: &str, signals: &Variable) {
        let Variable::Structure { fields, entries } = signals else { return self.add(name, signals) };
        for (idx, entry) in entries.iter().enumerate() {
            let number = if entries.len() > 1 { format!(" {}", idx + 1) } else { String::new() };
            self.add_entry(&format!("{name}{number}"), fields, entry);
        }
    }

    fn add_numbers(&mut self, name: &str, n_rows: usize, n_columns: usize, values: &[f64]) {
        let is_vector = n_rows == 1 || n_columns == 1;
        // Samples are more than quantities: Simulink writes a quantity a row.
        let is_lying = !is_vector && n_columns > n_rows;
        let n_quantities = if is_vector { 1 } else { n_columns.min(n_rows) };
        // Scalars are settings, not measurements.
        if values.len() < 2 || n_quantities > MOST_COLUMNS {
            return;
        }
        for idx in 0..n_quantities {
            let number = if n_quantities > 1 { format!(" {}", idx + 1) } else { String::new() };
            self.names.push(format!("{name}{number}"));
            self.numbers.push(match (is_vector, is_lying) {
                (true, _) => values.to_vec(),
                (_, true) => values.iter().skip(idx).step_by(n_rows).copied().collect(),
                _ => values[idx * n_rows..(idx + 1) * n_rows].to_vec(),
            });
        }
        self.widths.push(n_quantities);
    }

    /// Matrices of different lengths have no rows in common: the first column of each is its own time, where it alone rises, as
    /// Simulink writes them To File.
    fn name_times(&mut self) {
        let lengths = || self.numbers.iter().map(Vec::len).filter(|length| *length >= MIN_SAMPLES);
        if lengths().min() == lengths().max() {
            return;
        }
        let mut first = 0;
        for width in &self.widths {
            let (idx, matrix) = (first, &self.numbers[first..first + width]);
            first += width;
            let is_recording = *width > 1 && matrix[0].len() >= MIN_SAMPLES;
            if is_recording && rises(&matrix[0]) && !matrix[1..].iter().any(|column| rises(column)) {
                let variable = self.names[idx].trim_end_matches(" 1").to_owned();
                self.names[idx] = format!("{variable} time");
            }
        }
    }

    /// The columns of a matrix beside which nothing is long enough to be a recording, and which column is its first.
    fn lone_matrix(&self) -> Option<(usize, &[Vec<f64>])> {
        let mut first = 0;
        let parts: Vec<(usize, &[Vec<f64>])> = self
            .widths
            .iter()
            .map(|width| {
                first += width;
                (first - width, &self.numbers[first - width..first])
            })
            .filter(|(_, columns)| columns[0].len() >= MIN_SAMPLES)
            .collect();
        let [(first, matrix)] = parts[..] else { return None };
        (matrix.len() > 1).then_some((first, matrix))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(values: &[f64]) -> Variable {
        Variable::Numbers { n_rows: values.len(), n_columns: 1, values: values.to_vec() }
    }

    fn structure(fields: &[(&str, Variable)]) -> Variable {
        let (names, entry) = fields.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).unzip();
        Variable::Structure { fields: names, entries: vec![entry] }
    }

    #[test]
    fn of_timeseries_it_is_said_how_to_save_the_one_that_is_the_angle() {
        let series = |name: &str| (name.to_owned(), Variable::Object(TIMESERIES.to_owned()));
        let other = ("x".to_owned(), Variable::Object("table".to_owned()));
        let told = how_to_save(&[series("input"), other.clone(), series("theta2")]).unwrap();
        assert!(told.starts_with("it holds timeseries (input, theta2)"), "{told}");
        assert!(told.contains("t = theta2.Time; theta = theta2.Data; save('swing.mat'"), "{told}");
        assert!(how_to_save(&[series("logged")]).unwrap().contains("t = logged.Time"));
        assert_eq!(how_to_save(&[other]), None);
    }

    #[test]
    fn cells_name_the_columns_where_they_are_as_many_and_say_what_is_measured() {
        let names = |names: &[&str]| {
            let names = names.iter().map(|name| (*name).to_owned()).collect();
            ("names".to_owned(), Variable::Names(names))
        };
        let (good, few, gains) = (names(&["time", "theta"]), names(&["time"]), names(&["kp", "kd"]));
        assert_eq!(names_of(&[few.clone(), gains.clone(), good.clone()], 2), ["time", "theta"]);
        assert!(names_of(&[few, gains], 2).is_empty() && names_of(&[good.clone(), good], 2).is_empty());
    }

    #[test]
    fn a_time_and_what_follows_it_have_the_name_of_the_variable() {
        let (time, swung) = (vec![0.0, 0.1, 0.2], vec![0.3, -0.1, 0.2]);
        let both = [time.clone(), swung.clone()];
        assert_eq!(time_and("yaw_speed 1", &both), ["time", "yaw_speed"]);
        assert_eq!(time_and("theta 1", &both), ["time", "theta"]);
        for (variable, matrix) in
            [("ans 1", &both), ("theta 1", &[swung.clone(), time.clone()]), ("theta 1", &[time.clone(), time.clone()])]
        {
            assert!(time_and(variable, matrix).is_empty(), "{variable} {matrix:?}");
        }
        assert!(time_and("theta 1", &[time, swung.clone(), swung]).is_empty());
    }

    #[test]
    fn matrices_of_different_lengths_have_times_of_their_own() {
        let logged = |n_columns: i32| {
            let row = |idx: i32| [f64::from(idx), f64::from(idx % 3)];
            let values = (0..n_columns).flat_map(row).collect();
            Variable::Numbers { n_rows: 2, n_columns: n_columns as usize, values }
        };
        let names = |lengths: [i32; 2]| {
            let mut columns = Columns::default();
            columns.add("swing", &logged(lengths[0]));
            columns.add("angle", &logged(lengths[1]));
            columns.name_times();
            columns.names
        };
        assert_eq!(names([60, 40]), ["swing time", "swing 2", "angle time", "angle 2"]);
        assert_eq!(names([60, 60]), ["swing 1", "swing 2", "angle 1", "angle 2"]);
    }

    #[test]
    fn a_scalar_tells_the_rate_of_data_without_a_time() {
        let scalar = |name: &str, value: f64| (name.to_owned(), numbers(&[value]));
        let line = |variables: &[(String, Variable)], column: &[f64]| {
            let mut columns = Columns::default();
            columns.add("data", &numbers(column));
            rate_beside::line_above(scalars(variables), &columns.names, &columns.numbers, &mut Vec::new())
        };
        let swung = [0.3, -0.1, 0.2];
        for it in
            [scalar("ActualRate", 1000.0), scalar("Fs", 1000.0), scalar("Ts", 0.001), scalar("SampleRate", 1000.0)]
        {
            assert_eq!(line(std::slice::from_ref(&it), &swung), "# Sampling rate: 1000 Hz\n", "{it:?}");
            assert_eq!(line(&[it], &[0.0, 0.1, 0.2]), "");
        }
        // Friction, too, is called so.
        assert_eq!(line(&[scalar("fs", 0.02), scalar("duration", 30.0)], &swung), "");
        assert_eq!(line(&[scalar("fs", 1000.0), scalar("dt", 0.01)], &swung), "");
    }

    #[test]
    fn a_signal_without_a_label_has_the_name_of_its_variable() {
        let logged = |label: &str| {
            let values = ("values", numbers(&[0.5, 0.4]));
            let signals =
                structure(&[values, ("dimensions", numbers(&[1.0])), ("label", Variable::Text(label.into()))]);
            structure(&[("time", numbers(&[0.0, 0.1])), ("signals", signals)])
        };
        let mut columns = Columns::default();
        columns.add("Theta1", &logged(""));
        columns.add("ScopeData", &logged("velocity"));
        assert_eq!(columns.names, ["time", "Theta1", "time", "velocity"]);
    }
}
