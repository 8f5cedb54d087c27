//! Quantities with their unit, for the borders of the program; formulas inside use plain numbers with the unit in
//! the name.

use serde::{Deserialize, Serialize};

/// A reading of the analogue-to-digital converter, 0 … full scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Code(pub u16);

/// An angle in radians: 0 hanging down, positive counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Serialize, Deserialize)]
pub struct Radian(pub f32);

/// A frequency in hertz.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Serialize, Deserialize)]
pub struct Hertz(pub f32);
