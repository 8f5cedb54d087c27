//! What a chip knows of itself, and how long its work takes.

use heapless::String;
use serde::{Deserialize, Serialize};

/// What only the chip knows of itself.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Chip {
    /// Its unique number as its bootloader and its USB give it, 12 hexadecimal digits; empty if it has none.
    pub serial: String<12>,
    /// What its cycles come from.
    pub clock: Clock,
    /// Cycles in a second; 0 if they are not counted.
    pub clock_hz: u32,
    /// Making a sample of its conversions.
    pub sample: Cycles,
    /// Potentiometer, filter and observer, for one sample.
    pub observer: Cycles,
    /// Encoding one frame.
    pub frame: Cycles,
    /// Saving to flash, with everything that goes on meanwhile.
    pub save: Cycles,
}

/// Where a chip's cycles come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Clock {
    /// It does not say.
    #[default]
    Unknown,
    /// A crystal, good for 50 ppm.
    Crystal,
    /// The chip's own oscillator, good for 1 % at 25 °C and 4 % from -10 to 85 °C, because the crystal does not run.
    Internal,
}

/// How long a stage of the work took, in processor cycles, since the last reset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cycles {
    /// How often.
    pub count: u32,
    /// On average, the last ten thousand times.
    pub mean: f32,
    /// At most.
    pub worst: u32,
}

impl Cycles {
    /// Once more.
    pub fn took(&mut self, cycles: u32) {
        const REMEMBERED: u32 = 10_000;
        self.count = self.count.saturating_add(1);
        self.mean += (cycles as f32 - self.mean) / self.count.min(REMEMBERED) as f32;
        self.worst = self.worst.max(cycles);
    }
}
