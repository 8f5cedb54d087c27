//! Accelerations without names, as the sensor of a micro:bit gives them: whole thousandths of g in steps of 4, on three axes.

use super::limits::MIN_SAMPLES;
use super::median;
use super::table::Table;

/// What one step of the sensor is worth, in thousandths of g. A column of other whole numbers has three of four off it.
const STEP: f64 = 4.0;

/// All axes together are as long as gravity, but for what the swing adds and takes: of 21 files of strangers the middle one of the
/// lengths is 982 to 1352. Half and twice were not tried.
const LENGTHS: std::ops::Range<f64> = 700.0..1800.0;

/// The first of three columns side by side that are such; none where the columns have names.
pub(super) fn first_axis(table: &Table) -> Option<usize> {
    let last = table.n_columns.checked_sub(2).filter(|_| table.names.is_none())?;
    (0..last).find(|first| are_axes([0, 1, 2].map(|axis| table.first_numbers(first + axis))))
}

fn are_axes(axes: [Vec<f64>; 3]) -> bool {
    let n = axes.iter().map(Vec::len).min().unwrap_or(0);
    let has_steps = |axis: &Vec<f64>| axis.iter().all(|value| value % STEP == 0.0);
    // Counts, and places in a picture, have one sign.
    let has_both_signs = axes.iter().flatten().any(|value| *value < 0.0);
    let length = |row: usize| axes.iter().map(|axis| axis[row].powi(2)).sum::<f64>().sqrt();
    let mut lengths: Vec<f64> = (0..n).map(length).collect();
    n >= MIN_SAMPLES && has_both_signs && axes.iter().all(has_steps) && LENGTHS.contains(&median(&mut lengths))
}
