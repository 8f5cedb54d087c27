//! Several runs in one MATLAB file, each a structure with a time and an angle of its own: `data_1.time`, `data_1.angle`,
//! `data_2.time`, …, or the entries of an array of such structures.
//!
//! They become rows below each other, with a column that names the run.

use super::mat5::Variable;
use crate::limits::MIN_SAMPLES;
use crate::words::{Meaning, meaning};

/// A structure that is a recording.
struct Run<'a> {
    name: String,
    /// By the names of the fields, all of one length.
    columns: Vec<(&'a str, &'a [f64])>,
}

/// The table of all runs, where the variables hold so many columns and all of them are of runs.
pub(super) fn table(variables: &[(String, Variable)], n_columns: usize) -> Option<Vec<u8>> {
    let runs = beside_each_other(variables.iter().map(|(name, variable)| (name.clone(), variable)).collect())?;
    let is_all = runs.iter().map(|run| run.columns.len()).sum::<usize>() == n_columns;
    is_all.then(|| text_of(&runs))
}

/// The runs among these, else those within one of them.
fn beside_each_other(siblings: Vec<(String, &Variable)>) -> Option<Vec<Run<'_>>> {
    let entries = || siblings.iter().flat_map(|(name, variable)| entries_of(name, variable));
    let runs: Vec<Run> = entries().filter_map(|(name, fields, entry)| Run::of(name, fields, entry)).collect();
    if runs.len() > 1 && runs.iter().all(|run| without_digits(&run.name) == without_digits(&runs[0].name)) {
        return Some(runs);
    }
    entries().find_map(|(_, fields, entry)| beside_each_other(fields.iter().cloned().zip(entry).collect()))
}

/// The entries of a structure; of several each has its number.
fn entries_of<'a>(name: &str, variable: &'a Variable) -> Vec<(String, &'a [String], &'a [Variable])> {
    let Variable::Structure { fields, entries } = variable else { return Vec::new() };
    let number = |idx: usize| if entries.len() > 1 { format!("_{}", idx + 1) } else { String::new() };
    let named = |(idx, entry): (usize, &'a Vec<Variable>)| (format!("{name}{}", number(idx)), &fields[..], &entry[..]);
    entries.iter().enumerate().map(named).collect()
}

impl<'a> Run<'a> {
    fn of(name: String, fields: &'a [String], entry: &'a [Variable]) -> Option<Self> {
        let vector = |(field, value): (&'a String, &'a Variable)| match value {
            Variable::Numbers { n_rows, n_columns, values }
                if values.len() > 1 && (*n_rows == 1 || *n_columns == 1) =>
            {
                Some((field.as_str(), values.as_slice()))
            }
            _ => None,
        };
        let columns: Vec<(&str, &[f64])> = fields.iter().zip(entry).filter_map(vector).collect();
        let has = |is_it: fn(Meaning) -> bool| columns.iter().any(|(name, _)| is_it(meaning(name)));
        let n_rows = columns.first().map_or(0, |(_, values)| values.len());
        let are_alike = n_rows >= MIN_SAMPLES && columns.iter().all(|(_, values)| values.len() == n_rows);
        let is_recording =
            has(|it| matches!(it, Meaning::Time { .. })) && has(|it| matches!(it, Meaning::Angle { .. }));
        (are_alike && is_recording).then_some(Self { name, columns })
    }

    fn cell(&self, name: &str, row: usize) -> String {
        let column = self.columns.iter().find(|(column, _)| *column == name);
        column.map_or(f64::NAN, |(_, values)| values[row]).to_string()
    }
}

fn without_digits(name: &str) -> &str {
    name.trim_end_matches(|letter: char| letter.is_ascii_digit())
}

fn text_of(runs: &[Run]) -> Vec<u8> {
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in runs.iter().flat_map(|run| &run.columns) {
        if !names.contains(name) {
            names.push(name);
        }
    }
    let mut text = format!("{};run\n", names.join(";"));
    for run in runs {
        for row in 0..run.columns[0].1.len() {
            let cells: Vec<String> = names.iter().map(|name| run.cell(name, row)).collect();
            text.push_str(&format!("{};{}\n", cells.join(";"), run.name));
        }
    }
    text.into_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ReadOptions, read_runs_of_bytes};

    fn vector(values: Vec<f64>) -> Variable {
        Variable::Numbers { n_rows: values.len(), n_columns: 1, values }
    }

    fn structure(fields: Vec<(&str, Variable)>) -> Variable {
        let (fields, entry) = fields.into_iter().map(|(name, value)| (name.to_owned(), value)).unzip();
        Variable::Structure { fields, entries: vec![entry] }
    }

    /// So many rows of a swing of one second, from so many radians on.
    fn run(n_rows: usize, from_rad: f64) -> Vec<(&'static str, Variable)> {
        let times = || (0..n_rows).map(|row| 0.01 * row as f64);
        let angles = times().map(|time| from_rad * (std::f64::consts::TAU * time).cos());
        vec![("angle", vector(angles.collect())), ("time", vector(times().collect()))]
    }

    fn three(names: [&str; 3]) -> Vec<(String, Variable)> {
        let mut last = run(500, 0.5);
        last.push(("baseAngle", vector(vec![0.1; 500])));
        let all = names.into_iter().zip([run(600, 0.3), run(700, 0.4), last]);
        vec![("pendTest".to_owned(), structure(all.map(|(name, run)| (name, structure(run))).collect()))]
    }

    #[test]
    fn structures_that_differ_by_a_number_are_runs_of_one_file() {
        let text = table(&three(["data_1", "data_2", "data_3"]), 7).unwrap();
        let runs = read_runs_of_bytes("swing.csv", &text, &ReadOptions::default()).unwrap();
        let found: Vec<_> = runs.iter().map(|run| (run.name.as_deref().unwrap(), run.recording.len())).collect();
        assert_eq!(found, [("data_1", 600), ("data_2", 700), ("data_3", 500)]);
        assert!(runs.iter().zip([0.3, 0.4, 0.5]).all(|(run, rad)| (run.recording.angles_rad()[0] - rad).abs() < 1e-9));
        let chosen = ReadOptions { runs: vec!["data_2".to_owned()], ..ReadOptions::default() };
        assert_eq!(read_runs_of_bytes("swing.csv", &text, &chosen).unwrap()[0].recording.len(), 700);
    }

    #[test]
    fn entries_of_an_array_are_runs_too_and_an_arm_beside_a_pole_is_none() {
        let entry = |fields: Vec<(&str, Variable)>| fields.into_iter().map(|(_, value)| value).collect::<Vec<_>>();
        let fields = vec!["angle".to_owned(), "time".to_owned()];
        let entries = vec![entry(run(60, 0.3)), entry(run(50, 0.4))];
        let array = vec![("data".to_owned(), Variable::Structure { fields, entries })];
        let text = String::from_utf8(table(&array, 4).unwrap()).unwrap();
        assert!(text.starts_with("angle;time;run\n0.3;0;data_1\n") && text.contains("\n0.4;0;data_2\n"));
        assert!(table(&three(["arm", "pole", "cart"]), 7).is_none());
        // Something else stands in the file too.
        assert!(table(&three(["data_1", "data_2", "data_3"]), 8).is_none());
    }
}
