//! MATLAB files of versions 4 to 7: every vector is a column of its name, every matrix has its columns numbered. A matrix
//! that stands alone is a table without names.
//!
//! Of structures the fields count, and of those that Simulink logs (`Structure With Time`) each signal's values, under
//! its label, or else under the name of the variable.

use super::as_text::{refused, text_of};
use super::mat5::{Problem, Variable};
use super::{mat4, mat5};
use crate::recording::error::Fault;
use crate::recording::limits::MIN_SAMPLES;

/// A matrix with more columns, and more rows, is a picture, not a table.
const MOST_COLUMNS: usize = 64;

pub(super) fn table(bytes: &[u8]) -> Result<Vec<u8>, Fault> {
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
    if columns.numbers.is_empty() {
        return Err(refused(
            what,
            "it holds no vectors, matrices of up to 64 columns or structures of numbers; tables, timeseries and cells are \
             not read: save the vectors themselves, such as t = Time{1}; save('swing.mat', 't', 'theta', '-v7')",
        ));
    }
    match columns.lone_matrix() {
        Some(matrix) => Ok(text_of(&[], matrix)),
        None => Ok(text_of(&columns.names, &columns.numbers)),
    }
}

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
            Variable::Text(_) | Variable::Other => {}
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

    /// The columns of a matrix beside which nothing is long enough to be a recording.
    fn lone_matrix(&self) -> Option<&[Vec<f64>]> {
        let mut first = 0;
        let parts: Vec<&[Vec<f64>]> = self
            .widths
            .iter()
            .map(|width| {
                first += width;
                &self.numbers[first - width..first]
            })
            .filter(|columns| columns[0].len() >= MIN_SAMPLES)
            .collect();
        let [matrix] = parts[..] else { return None };
        (matrix.len() > 1).then_some(matrix)
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
