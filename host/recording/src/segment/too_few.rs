//! Why hardly anything swings freely: a motor moves it most of the time, or its turning points alone were written down.

use super::super::Recording;
use super::SegmentError;
use super::motor::shown;
use std::ops::Range;

/// So much of a recording a motor moves it at least, if that is why it does not swing freely: most of it.
const MOST: f64 = 0.5;

/// So many readings of noise are turns by chance: two of three. With this share they are made so.
const NEARLY_ALL: f64 = 0.9;

/// The same refusal with its reason, where the file tells one.
pub(super) fn explained(fault: SegmentError, recording: &Recording, asked: &Range<usize>) -> SegmentError {
    let SegmentError::TooFewSwings { n_turning_points, .. } = fault else { return fault };
    let readings = &recording.angles_rad()[asked.clone()];
    if are_turns(readings) {
        return SegmentError::OnlyTurns { n_samples: readings.len() };
    }
    let moved = recording.drives.iter().find_map(|drive| Some((drive, drive.within(asked)?)));
    match moved.filter(|(_, (.., share))| *share > MOST) {
        Some((drive, (low, high, share))) => SegmentError::Driven {
            n_turning_points,
            column: drive.column.clone(),
            low: shown(low),
            high: shown(high),
            percent: (100.0 * share).round(),
        },
        None => fault,
    }
}

fn are_turns(readings: &[f64]) -> bool {
    let is_turn = |three: &&[f64]| (three[1] - three[0]) * (three[2] - three[1]) < 0.0;
    let n_turns = readings.windows(3).filter(is_turn).count();
    n_turns as f64 > NEARLY_ALL * readings.len().saturating_sub(2) as f64
}
