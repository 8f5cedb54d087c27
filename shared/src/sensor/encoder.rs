//! An incremental encoder: two square waves a quarter of a line apart, of which the board counts every edge.
//!
//! A count is a code. It says how far the pendulum has turned since power-up and nothing of where it was then, so zero
//! is where it hangs at that time, until it is calibrated. There is no noise: a reading is the angle rounded to a
//! count, and at rest it stays one number. The counter has 16 bits and begins again where they end; see
//! [`super::Reader`].

use super::{Calibration, Line, MAX_NUMBERS, Number, Sensor};
use crate::units::{Code, Radian};
use core::f32::consts::TAU;
use core::fmt;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Counts of the board's counter until it begins again.
const SPAN: u32 = 0x1_0000;

/// Fewer show no swing, and more than a swing's two turns of the counter's span cannot be told from it.
const COUNTS: core::ops::RangeInclusive<u32> = 16..=SPAN / 2;

/// Of a still pendulum readings spread less than so many rad, as of a potentiometer's (0.06 % of its travel) …
const STILL_RAD: f32 = 3.6e-3;

/// … or, of a coarse encoder that rests on an edge, a count.
const STILL_COUNTS: f32 = 1.0;

/// Calibration of the encoder.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Encoder {
    /// Counts a turn: four times the lines. Negative if they fall while the pendulum turns counter-clockwise.
    pub counts_per_turn: i32,
    /// The count (with a fraction, from averaging) at which the pendulum hangs at rest.
    pub zero_code: f32,
}

impl Encoder {
    /// With so many counts a turn, hanging since power-up.
    pub const fn new(counts_per_turn: i32) -> Self {
        Self { counts_per_turn, zero_code: Sensor::BEGINS_AT as f32 }
    }

    /// The count that an angle means, modulo the counter's span.
    pub fn code(&self, angle: Radian) -> Code {
        let Line { zero_code, radian_per_code } = self.line();
        Code(libm::roundf(angle.0 / radian_per_code + zero_code) as i32 as u16)
    }
}

impl Calibration for Encoder {
    const NAME: &'static str = "encoder";
    const NUMBERS: &'static [Number] = &[Number {
        key: "counts_per_turn",
        meaning: "counts a turn, four times the lines; negative if it counts down counter-clockwise",
        whole: Some([-(SPAN as i32 / 2), SPAN as i32 / 2]),
    }];
    const KEEPS_ZERO: bool = false;
    const IS_QUIET: bool = true;
    const EXPECTED: &'static str = "expected counts_per_turn of 16 to 32768, or as many negative ones";
    const WIRES: &'static str = "check the encoder's supply, its wires A and B, and their pull-ups";

    fn of_numbers(numbers: &[f64]) -> Self {
        Self::new(numbers.first().map_or(0, |counts| *counts as i32))
    }

    fn numbers(&self) -> Vec<f32, MAX_NUMBERS> {
        [self.counts_per_turn as f32].into_iter().collect()
    }

    fn is_valid(&self) -> bool {
        COUNTS.contains(&self.counts_per_turn.unsigned_abs()) && (0.0..SPAN as f32).contains(&self.zero_code)
    }

    fn line(&self) -> Line {
        Line { zero_code: self.zero_code, radian_per_code: TAU / self.counts_per_turn as f32 }
    }

    fn with_zero(self, zero_code: f32) -> Self {
        let span = SPAN as f32;
        let within = zero_code - span * libm::floorf(zero_code / span);
        // Just below zero it is rounded up to the span itself.
        Self { zero_code: if within < span { within } else { 0.0 }, ..self }
    }

    fn with_step(self, _: f32) -> Option<Self> {
        None
    }

    fn is_connected(&self, _: Code) -> bool {
        true
    }

    fn span(&self) -> Option<u32> {
        Some(SPAN)
    }

    fn full_scale(&self) -> u16 {
        u16::MAX
    }

    fn still_codes(&self) -> f32 {
        (STILL_RAD / self.line().radian_per_code.abs()).max(STILL_COUNTS)
    }

    fn complaint(&self) -> Option<&'static str> {
        None
    }
}

impl fmt::Display for Encoder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mrad = 1e3 * self.line().radian_per_code;
        write!(f, "{} counts a turn, {mrad:.5} mrad each, zero at count {:.1}", self.counts_per_turn, self.zero_code)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::Reader;

    #[test]
    fn a_turn_has_its_counts_either_way() {
        for counts in [4096, -4096, 400, -10_000] {
            let encoder = Encoder::new(counts);
            let turned = encoder.code(Radian(1.0)).0 as i32 - encoder.code(Radian(0.0)).0 as i32;
            assert_eq!(turned, libm::roundf(counts as f32 / TAU) as i32);
        }
    }

    #[test]
    fn the_angle_goes_on_where_the_counter_begins_again() {
        for counts in [4096, -1000, 30_000] {
            let encoder = Encoder::new(counts);
            let mut reader = Reader::new(encoder.into());
            let back_and_forth = (0..4000).chain((-4000..4000).rev());
            for step in back_and_forth {
                let angle_rad = 0.05 * step as f32;
                let Radian(read_rad) = reader.read(encoder.code(Radian(angle_rad))).unwrap();
                let tolerance_rad = 0.51 * reader.sensor().step_rad() + 1e-6 * angle_rad.abs();
                assert!((read_rad - angle_rad).abs() <= tolerance_rad, "{counts}: {read_rad} for {angle_rad}");
            }
        }
    }

    #[test]
    fn a_count_far_from_the_middle_is_a_zero_too() {
        let encoder = Encoder::new(4096).with_zero(70_000.25);
        assert_eq!(encoder.zero_code, 70_000.25 - 65_536.0);
        assert!(encoder.is_valid() && encoder.with_zero(-1e-4).is_valid());
        let mut reader = Reader::new(encoder.into());
        let Radian(read_rad) = reader.read(Code(65_000)).unwrap();
        // 5000 counts below zero, the other way round the counter.
        assert!((read_rad + 5000.25 * TAU / 4096.0).abs() < 1e-3, "{read_rad}");
    }

    #[test]
    fn too_few_and_too_many_counts_are_refused() {
        for counts in [0, 15, -15, 32_769, i32::MIN] {
            assert!(!Encoder::new(counts).is_valid(), "{counts}");
        }
        assert!(Encoder::new(16).is_valid() && Encoder::new(-32_768).is_valid());
    }
}
