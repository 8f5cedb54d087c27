//! What a file of another program becomes: a table of text, or a refusal.

use crate::error::Fault;

/// A format that is known, in a form that is not read.
pub(super) fn refused(format: &'static str, problem: &str) -> Fault {
    Fault::Foreign { format, problem: problem.to_owned() }
}

/// A table of numbers as text, with a line of names if there are some; shorter columns end in empty cells.
pub(super) fn text_of(names: &[String], columns: &[Vec<f64>]) -> Vec<u8> {
    let quoted = |name: &String| format!("\"{}\"", name.replace(['"', '\n', '\r'], " "));
    let mut text = names.iter().map(quoted).collect::<Vec<_>>().join(";");
    if !names.is_empty() {
        text.push('\n');
    }
    let n_rows = columns.iter().map(Vec::len).max().unwrap_or(0);
    for row in 0..n_rows {
        for (idx, column) in columns.iter().enumerate() {
            if idx > 0 {
                text.push(';');
            }
            if let Some(number) = column.get(row) {
                text.push_str(&number.to_string());
            }
        }
        text.push('\n');
    }
    text.into_bytes()
}
