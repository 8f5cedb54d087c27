//! Accelerations without names, as the sensors of small boards give them: in steps of 4 or 16 thousandths of g, on two or
//! three axes, in g or in whole thousandths of it.

use super::error::{Fault, NoAngle};
use super::limits::MIN_SAMPLES;
use super::median;
use super::table::Table;
use std::ops::Range;

/// What one step of such a sensor is worth, in thousandths of g: up to 2 g in ten or in eight bits. A column of other whole
/// numbers has three of four off it.
const STEPS: [f64; 2] = [4.0, 16.0];

/// What they may be written in, in g: the number of a thousandth.
const UNITS: [(f64, &str); 2] = [(1.0, "thousandths of g"), (0.001, "g")];

/// All axes together are as long as gravity, but for what the swing adds and takes, in thousandths of g: of 21 files of strangers the
/// middle one of the lengths is 982 to 1352, of twelve more 965 to 1261. Half and twice were not tried.
const LENGTHS: std::ops::Range<f64> = 700.0..1800.0;

/// A number of steps may be off a whole one by so much, where it was written with a point.
const ROUNDED: f64 = 1e-6;

/// Why columns side by side can't be fitted that are such accelerations; `None` where there are none, or the columns have names.
pub(super) fn fault(table: &Table) -> Option<Fault> {
    if table.names.is_some() {
        return None;
    }
    let columns: Vec<Vec<f64>> = (0..table.n_columns).map(|idx| table.first_numbers(idx)).collect();
    let of = |n_axes: usize| {
        let found = columns.windows(n_axes).enumerate().find_map(|(first, axes)| Some((first, unit_of(axes)?)));
        found.map(|(first, (unit, step))| {
            NoAngle::BareAccelerations { columns: listed(first, n_axes), step, unit }.into()
        })
    };
    of(3).or_else(|| of(2)).or_else(|| of_brackets(table))
}

/// That nothing says which of several sensors the axes in brackets are of.
fn of_brackets(table: &Table) -> Option<Fault> {
    let vectors = table.vectors();
    // Of several the first one is an accelerometer's as a rule.
    let rate = vectors.get(1).or(vectors.first())?.start;
    let time = (0..table.n_columns).find(|idx| !vectors.iter().any(|vector| vector.contains(idx)));
    let time = time.map_or("...".to_owned(), |idx| idx.to_string());
    let place = |vector: &Range<usize>| format!("{} to {}", vector.start, vector.end - 1);
    let columns = vectors.iter().map(place).collect::<Vec<_>>().join(", ");
    Some(NoAngle::BareVectors { columns, example: format!("t={time},rate={rate}:deg/s") }.into())
}

/// The unit of axes, and their step in it.
fn unit_of(axes: &[Vec<f64>]) -> Option<(&'static str, f64)> {
    let n = axes.iter().map(Vec::len).min()?;
    // Counts, and places in a picture, have one sign, and a time goes on.
    let has_both_signs = axes.iter().flatten().any(|value| *value < 0.0);
    let goes_on = |axis: &Vec<f64>| axis.windows(2).all(|pair| pair[0] < pair[1]);
    let moves = |axis: &&Vec<f64>| axis.iter().any(|value| *value != axis[0]);
    if n < MIN_SAMPLES || !has_both_signs || axes.iter().any(goes_on) || axes.iter().filter(moves).count() < 2 {
        return None;
    }
    let length = |row: usize| axes.iter().map(|axis| axis[row].powi(2)).sum::<f64>().sqrt();
    let length = median(&mut (0..n).map(length).collect::<Vec<f64>>());
    let (worth, unit) = UNITS.into_iter().find(|(worth, _)| LENGTHS.contains(&(length / worth)))?;
    let has_steps = |step: &f64| axes.iter().flatten().all(|value| is_whole(value / (step * worth)));
    // What comes in steps of 16 does so in steps of 4 too.
    let step = STEPS.into_iter().rev().find(has_steps)?;
    Some((unit, step * worth))
}

fn is_whole(number: f64) -> bool {
    (number - number.round()).abs() < ROUNDED * number.abs().max(1.0)
}

fn listed(first: usize, n_axes: usize) -> String {
    let but_last: Vec<String> = (first..first + n_axes - 1).map(|idx| idx.to_string()).collect();
    format!("{} and {}", but_last.join(", "), first + n_axes - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two axes of a pendulum in thousandths of g, in steps.
    fn swinging(step: f64, worth: f64) -> Vec<Vec<f64>> {
        let in_steps = |value: f64| (value / step).round() * step * worth;
        let angle = |idx: i32| 0.6 * (0.1 * f64::from(idx)).cos();
        let across = (0..200).map(|idx| in_steps(70.0 * angle(idx).sin())).collect();
        let along = (0..200).map(|idx| in_steps(3000.0 * angle(idx).cos() - 1650.0)).collect();
        vec![across, along]
    }

    #[test]
    fn axes_in_steps_are_told_in_either_unit() {
        assert_eq!(unit_of(&swinging(4.0, 1.0)), Some(("thousandths of g", 4.0)));
        assert_eq!(unit_of(&swinging(16.0, 0.001)), Some(("g", 0.016)));
        assert_eq!(unit_of(&swinging(16.0, 1.0)), Some(("thousandths of g", 16.0)));
    }

    #[test]
    fn other_steps_other_lengths_counts_and_times_are_none() {
        assert_eq!(unit_of(&swinging(3.0, 1.0)), None);
        assert_eq!(unit_of(&swinging(4.0, 10.0)), None);
        let counts: Vec<Vec<f64>> =
            swinging(4.0, 1.0).into_iter().map(|axis| axis.iter().map(|value| value.abs()).collect()).collect();
        assert_eq!(unit_of(&counts), None);
        let times = (0..200).map(|idx| 8.0 * f64::from(idx) + 4.0).collect();
        assert_eq!(unit_of(&[times, swinging(4.0, 1.0).swap_remove(0)]), None);
    }
}
