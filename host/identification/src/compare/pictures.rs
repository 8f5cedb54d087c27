//! The pictures of a comparison, each with an explanation that a student understands.

mod against;
mod known;
mod loss;
mod map;
mod time;

use super::Comparison;
use crate::plot::Picture;
use crate::plot::friction::friction;
use crate::recording::Measured;

/// All pictures, in the order in which they are best read.
pub fn pictures(comparison: &Comparison) -> Vec<Picture> {
    let mut pictures = time::pictures(comparison);
    if comparison.measured == Measured::Angle {
        pictures.extend(loss::pictures(comparison));
        pictures.extend(map::pictures(comparison));
    }
    pictures.extend(against::pictures(comparison));
    pictures.extend(friction(&comparison.parameters, &[]));
    pictures.extend(known::pictures(comparison));
    pictures
}

/// Coordinates in thousandths of the unit.
fn milli(value: f64) -> f64 {
    1e3 * value
}

/// The part of a path that people call a recording.
pub fn short_name(name: &str) -> &str {
    name.rsplit(['/', '\\']).next().unwrap_or(name)
}
