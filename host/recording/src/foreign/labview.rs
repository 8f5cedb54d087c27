//! LabVIEW measurement files (.lvm, text): a head of tags, a head of the segment, and rows of X and channels.
//!
//! `Separator`, `Decimal_Separator` and `X_Columns` (No, One, Multi) say how to read the rows; without X columns X0 and
//! Delta_X of the segment do. After the specification of LabVIEW measurement files, versions 1 and 2.

use super::as_text::refused;
use crate::error::Fault;

const END: &str = "***End_of_Header***";

pub(super) fn table(bytes: &[u8]) -> Result<Vec<u8>, Fault> {
    let text = String::from_utf8_lossy(bytes);
    let what = "LabVIEW measurement file";
    let separator =
        if tag(&text, "Separator", '\t').or(tag(&text, "Separator", ',')).is_some_and(|name| name.trim() == "Comma") {
            ','
        } else {
            '\t'
        };
    let n_heads = text.matches(END).count();
    if n_heads > 2 {
        return Err(refused(
            what,
            &format!("it has {} segments: save each in a file of its own, or one with a single header", n_heads - 1),
        ));
    }
    let Some(at) = text.rfind(END) else { return Err(refused(what, "its header does not end; export it again")) };
    let x_columns = tag(&text, "X_Columns", separator).unwrap_or("One").trim().to_owned();
    let first =
        |key: &str| tag(&text, key, separator).and_then(|value| value.split(separator).next()).map(comma_to_point);
    let mut rows = text[at..].lines().skip(1);
    let names: Vec<&str> = rows.next().unwrap_or_default().split(separator).map(str::trim).collect();
    let names: Vec<&str> = names.into_iter().take_while(|name| *name != "Comment").collect();
    let decimal_comma = tag(&text, "Decimal_Separator", separator).is_some_and(|mark| mark.trim() == ",");
    let mut table = format!("{}\n", names.iter().map(|name| named(name)).collect::<Vec<_>>().join(";"));
    let steps = match x_columns.as_str() {
        "No" => {
            let number = |key: &str| first(key).and_then(|value| value.parse::<f64>().ok());
            let step = number("Delta_X").filter(|step| *step > 0.0);
            Some((
                number("X0").unwrap_or(0.0),
                step.ok_or_else(|| refused(what, "it has neither X columns nor Delta_X; export it with one X column"))?,
            ))
        }
        _ => None,
    };
    for (row_idx, row) in rows.filter(|row| !row.trim().is_empty()).enumerate() {
        let mut cells: Vec<String> = row
            .split(separator)
            .take(names.len())
            .map(|cell| if decimal_comma { comma_to_point(cell) } else { cell.trim().to_owned() })
            .collect();
        if let (Some((begin, step)), Some(x)) = (steps, cells.first_mut()) {
            *x = (begin + step * row_idx as f64).to_string();
        }
        table.push_str(&cells.join(";"));
        table.push('\n');
    }
    Ok(table.into_bytes())
}

/// X is time in s.
fn named(name: &str) -> String {
    if name == "X_Value" { "time (s)".to_owned() } else { name.replace(';', " ") }
}

fn comma_to_point(cell: &str) -> String {
    cell.trim().replace(',', ".")
}

/// What stands behind a tag, if it is there; in the segment's head before the file's.
fn tag<'a>(text: &'a str, key: &str, separator: char) -> Option<&'a str> {
    let value = |line: &'a str| line.strip_prefix(key)?.strip_prefix(separator);
    text.lines().filter_map(value).next_back()
}
