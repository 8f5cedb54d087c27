//! Recordings in the order in which they were taken: by the date they carry, if all of a rig do, else by their names
//! with numbers counted as numbers. The clock of the file system says when a file was copied, so it says nothing
//! here.

use super::row::Row;
use std::cmp::Ordering;

/// Sorts the oldest first, and says by what.
pub(super) fn in_order(mut rows: Vec<Row>) -> (Vec<Row>, &'static str) {
    rows.sort_by(|a, b| by_name(&a.key.recording, &b.key.recording));
    if rows.iter().filter(|row| row.found().is_some()).all(|row| row.recorded.is_some()) && !rows.is_empty() {
        // ISO 8601 sorts as text.
        rows.sort_by(|a, b| a.recorded.cmp(&b.recorded));
        return (rows, "by date");
    }
    (rows, "by name")
}

/// `swing-2` stands before `swing-10`.
fn by_name(a: &str, b: &str) -> Ordering {
    let (mut rest_a, mut rest_b) = (a, b);
    while !rest_a.is_empty() && !rest_b.is_empty() {
        let ((part_a, next_a), (part_b, next_b)) = (part(rest_a), part(rest_b));
        let is_number = |part: &str| part.starts_with(|first: char| first.is_ascii_digit());
        let order = if is_number(part_a) && is_number(part_b) {
            let (a, b) = (part_a.trim_start_matches('0'), part_b.trim_start_matches('0'));
            a.len().cmp(&b.len()).then(a.cmp(b))
        } else {
            part_a.cmp(part_b)
        };
        if order != Ordering::Equal {
            return order;
        }
        (rest_a, rest_b) = (next_a, next_b);
    }
    a.len().cmp(&b.len()).then(a.cmp(b))
}

/// The digits, or all but digits, that a text begins with, and the rest.
fn part(text: &str) -> (&str, &str) {
    let is_digit = text.starts_with(|first: char| first.is_ascii_digit());
    text.split_at(text.find(|each: char| each.is_ascii_digit() != is_digit).unwrap_or(text.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_names_count_as_numbers() {
        let mut names = vec!["swing-10.csv", "swing-9.csv", "swing-010.csv", "day2/swing-1.csv", "a", "swing-9b.csv"];
        names.sort_by(|a, b| by_name(a, b));
        assert_eq!(names, ["a", "day2/swing-1.csv", "swing-9.csv", "swing-9b.csv", "swing-10.csv", "swing-010.csv"]);
    }
}
