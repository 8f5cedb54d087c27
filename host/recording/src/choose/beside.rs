//! What stands beside the readings and may move the pendulum: a motor, an arm, a cart.

use super::angle::angle_unit_of;
use super::rivals::movement;
use crate::carrier::Carrier;
use crate::chosen::{ReadingSource, Sources};
use crate::drive::Drive;
use crate::samples::Samples;
use crate::table::Table;
use crate::words::{self, Meaning, meaning};

/// What a voltage and the angle that was made of it have not in common: a hundredth of the motion is this share of its
/// square. With half of it a rounded angle would miss its voltage; with twice of it a motor that holds back would pass.
const MOST_APART: f64 = 1e-4;

/// What turns with the pendulum goes as far, and behind gears further. With twice of it rounding would make two of one, with
/// half of it a loose arm would be the same shaft.
const SAME_SHAFT: f64 = 0.9;

/// The columns that are looked at for that; of columns without names any may be the pendulum's own.
pub(super) fn beside(table: &Table, reading: &ReadingSource, is_told: bool) -> Vec<usize> {
    match (&table.names, reading) {
        (None, ReadingSource::Angle { .. }) if !is_told => {
            (0..table.n_columns).filter(|idx| table.is_of_numbers(*idx)).collect()
        }
        _ => drives_and_carriers(table, reading).collect(),
    }
}

impl Sources {
    /// What drives or carries the pendulum, from the numbers that were read. A voltage that goes with the angle is its
    /// sensor's, and an angle that does is that of the same shaft.
    pub(crate) fn others(&self, table: &Table, samples: &Samples, readings: &[f64]) -> (Vec<Drive>, Vec<Carrier>) {
        let (mut drives, mut carriers) = (Vec::new(), Vec::new());
        if table.names.is_none() {
            return (drives, carriers);
        }
        let raw = samples.readings.first().map_or(f64::NAN, |raw| movement(raw));
        for (idx, values) in self.others.iter().copied().zip(&samples.others) {
            let (name, values) = (table.column_name(idx), values.clone());
            let is_drive = table.says(idx, words::is_of_drive);
            let is_sensors = || table.says(idx, words::is_of_volts) && go_together(&values, readings);
            // An arm that is loose goes less far than the pendulum.
            let is_same_shaft = || movement(&values) > SAME_SHAFT * raw && go_together(&values, readings);
            match is_drive {
                true if !is_sensors() => drives.extend(Drive::of(name, values)),
                false if !is_same_shaft() => carriers.push(Carrier::new(name, values, raw / movement(readings))),
                _ => {}
            }
        }
        (drives, carriers)
    }
}

/// Are these two the same but for zero, scale and sign? Then their correlation leaves no more than noise.
fn go_together(a: &[f64], b: &[f64]) -> bool {
    let n = a.len().min(b.len()) as f64;
    let mean = |list: &[f64]| list.iter().take(n as usize).sum::<f64>() / n;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let sums = a.iter().zip(b).map(|(a, b)| (a - mean_a, b - mean_b));
    let (aa, ab, bb) = sums.fold((0.0, 0.0, 0.0), |(aa, ab, bb), (a, b)| (aa + a * a, ab + a * b, bb + b * b));
    ab * ab > (1.0 - MOST_APART) * aa * bb
}

/// Columns of numbers that are named after a motor, and angles in the same unit of what carries the pendulum.
fn drives_and_carriers(table: &Table, reading: &ReadingSource) -> impl Iterator<Item = usize> {
    let angle_idx = match reading {
        ReadingSource::Angle { idx, .. } => Some(*idx),
        _ => None,
    };
    let is_angle = |name: &str| matches!(meaning(name), Meaning::Angle { .. });
    let is_like =
        move |idx: usize| angle_idx.is_some_and(|angle| angle_unit_of(table, angle) == angle_unit_of(table, idx));
    let carries =
        move |idx: usize| table.says(idx, |name| words::is_of_carrier(name) && is_angle(name)) && is_like(idx);
    let is_one = move |idx: &usize| table.says(*idx, words::is_of_drive) || carries(*idx);
    // A run that comes first may not have it.
    (0..table.n_columns).filter(is_one).filter(|idx| table.is_of_numbers(*idx) || table.is_empty_at_first(*idx))
}
