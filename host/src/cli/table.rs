//! Tables for a person: one look for all commands, readable in 80 columns.

use comfy_table::{Cell, CellAlignment, LineStyle, Table, TableStyle};

/// A line under the header, and nothing else.
const LOOK: TableStyle = TableStyle::new().header_separator(LineStyle::none().fill('─').junction('─'));

/// A table of texts; the first `n_left` columns are aligned left, the others, numbers, right.
pub(super) fn table<H: Into<String>>(
    header: impl IntoIterator<Item = H>,
    rows: Vec<Vec<String>>,
    n_left: usize,
) -> String {
    let cell = |(column_idx, text): (usize, String)| {
        let alignment = if column_idx < n_left { CellAlignment::Left } else { CellAlignment::Right };
        Cell::new(text).set_alignment(alignment)
    };
    let mut table = Table::new();
    table.load_style(LOOK);
    table.set_header(header.into_iter().map(Into::into).enumerate().map(cell).collect::<Vec<Cell>>());
    table.add_rows(rows.into_iter().map(|row| row.into_iter().enumerate().map(cell).collect::<Vec<Cell>>()));
    table.column_iter_mut().for_each(|column| {
        column.set_padding((1, 0));
    });
    table.lines().map(|line| line.trim_end().to_owned()).collect::<Vec<_>>().join("\n")
}

/// Breaks a sentence into lines of at most 78 characters; all but the first are indented.
pub(super) fn wrapped(text: &str, indent: usize) -> String {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let line = lines.last_mut().expect("never empty");
        let room = if line.trim().is_empty() { 0 } else { 1 };
        if line.chars().count() + room + word.chars().count() > LINE && room > 0 {
            lines.push(format!("{}{word}", " ".repeat(indent)));
        } else {
            line.push_str(&" ".repeat(room));
            line.push_str(word);
        }
    }
    lines.join("\n")
}

/// Characters in a line.
const LINE: usize = 78;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_under_each_other() {
        let rows = vec![vec!["Mw".into(), "1.5".into()], vec!["I".into(), "-12.5".into()]];
        assert_eq!(table(["what", "value"], rows, 1), " what  value\n────────────\n Mw      1.5\n I     -12.5");
    }

    #[test]
    fn sentences_are_broken_and_indented() {
        let text = wrapped(&"word ".repeat(40), 2);
        assert!(text.lines().count() == 3 && text.lines().all(|line| line.len() <= 78));
        assert!(text.lines().skip(1).all(|line| line.starts_with("  word")));
    }
}
