//! Which columns are angular velocities, and in which unit.

use crate::chosen::ReadingSource;
use crate::options::ReadOptions;
use crate::samples::MOST_COLUMNS;
use crate::table::Table;
use crate::units::RateUnit;
use crate::words::{Meaning, is_size, meaning};

/// Columns of rates with the unit that was told, or that their names have.
pub(super) fn rates(
    table: &Table,
    options: &ReadOptions,
    columns: Vec<usize>,
    told: Option<RateUnit>,
) -> ReadingSource {
    let in_name = |idx: &usize| match meaning(table.names.as_ref()?.get(*idx)?) {
        Meaning::Rate { unit } => unit,
        _ => None,
    };
    let unit = options.angle_unit.map(RateUnit::per_second).or(told).or(columns.first().and_then(in_name));
    ReadingSource::Rates { columns, unit }
}

/// Columns that are named as angular velocities, without the size of all axes together, which has no sign; gx, gy and gz
/// are such where ax, ay and az stand beside them, and wx, wy and wz together.
pub(super) fn rate_columns(table: &Table) -> Vec<usize> {
    let has = |wanted: &str| table.names.iter().flatten().any(|name| name.eq_ignore_ascii_case(wanted));
    let has_six_axes = ["ax", "ay", "az", "gx", "gy", "gz"].into_iter().all(has);
    let has_omega = ["wx", "wy", "wz"].into_iter().all(has);
    let is_one_of = |axes: [&str; 3], name: &str| axes.iter().any(|axis| name.eq_ignore_ascii_case(axis));
    let is_rate = |name: &String| {
        (matches!(meaning(name), Meaning::Rate { .. }) && !is_size(name))
            || (has_six_axes && is_one_of(["gx", "gy", "gz"], name))
            || (has_omega && is_one_of(["wx", "wy", "wz"], name))
    };
    table
        .names
        .iter()
        .flatten()
        .enumerate()
        .filter(|(_, name)| is_rate(name))
        .map(|(idx, _)| idx)
        .take(MOST_COLUMNS)
        .collect()
}
