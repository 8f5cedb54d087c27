//! The servo potentiometer: converter code to angle, and what a broken wire looks like.
//!
//! Vishay Spectrol 157 data sheet: electrical angle 340° ± 4°, linearity ± 2 %, end voltage at most 0.5 %.

use super::{Calibration, Line, MAX_NUMBERS, Number};
use crate::units::{Code, Radian};
use core::fmt;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Electrical travel of the Vishay 157 in radians (340°).
pub const ELECTRICAL_TRAVEL_RAD: f32 = 340.0 * core::f32::consts::PI / 180.0;

/// The electrical angle, and with it the gain, is within this share of it (4° of 340°).
pub const GAIN_TOLERANCE: f32 = 4.0 / 340.0;

/// The track is within this share of its travel of a line.
pub const LINEARITY: f32 = 0.02;

/// Full scale of the plain 12-bit converter.
pub const FULL_SCALE_12_BIT: u16 = 4095;

/// Readings this close to an end (as a share of full scale) are the dead zone, an end stop or a broken wire: the end voltage
/// of the data sheet and a little noise. Twice as much would cost 4° of the travel, half of it take wipers that have left the
/// track for good ones.
const END_SHARE: f32 = 0.006;

/// A converter this coarse shows no swing.
const MOST_RADIAN_PER_CODE: f32 = 1.0;

/// The pendulum counts as still while its codes spread less than this share of full scale (about 2.5 codes of 4096).
const STILL_SPREAD: f32 = 6e-4;

/// Calibration of the potentiometer: angle = (code − zero) · gain.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Potentiometer {
    /// The code (with a fraction, from averaging) at which the pendulum hangs at rest.
    pub zero_code: f32,
    /// Angle per code in radians; negative if the wiper turns the other way.
    pub radian_per_code: f32,
    /// The largest code of the converter, oversampling included.
    pub full_scale: u16,
}

impl Potentiometer {
    /// The data sheet's potentiometer on a converter with the given full scale, hanging pendulum in mid-travel.
    pub const fn nominal(full_scale: u16) -> Self {
        let steps = full_scale as f32 + 1.0;
        Self { zero_code: steps / 2.0, radian_per_code: ELECTRICAL_TRAVEL_RAD / steps, full_scale }
    }

    /// The angle that a code means.
    pub fn angle(&self, code: Code) -> Radian {
        Radian((f32::from(code.0) - self.zero_code) * self.radian_per_code)
    }

    /// The nearest code to an angle, held at the converter's ends.
    pub fn code(&self, angle: Radian) -> Code {
        let exact = angle.0 / self.radian_per_code + self.zero_code;
        Code(libm::roundf(exact).clamp(0.0, f32::from(self.full_scale)) as u16)
    }

    /// False near the ends of the travel, where the wiper has left the track or a wire is broken.
    pub fn is_connected(&self, code: Code) -> bool {
        let margin = END_SHARE * f32::from(self.full_scale);
        let code = f32::from(code.0);
        code > margin && code < f32::from(self.full_scale) - margin
    }

    /// Is this a calibration to compute with? Gain not zero and at most a radian a code, zero within the converter's
    /// range.
    pub fn is_valid(&self) -> bool {
        self.radian_per_code.is_normal()
            && self.radian_per_code.abs() <= MOST_RADIAN_PER_CODE
            && (0.0..=f32::from(self.full_scale)).contains(&self.zero_code)
    }
}

impl Calibration for Potentiometer {
    const NAME: &'static str = "potentiometer";
    const NUMBERS: &'static [Number] = &[
        Number { key: "zero_code", meaning: "the code at which the pendulum hangs", whole: None },
        Number { key: "radians_per_code", meaning: "the angle of one code in rad", whole: None },
        Number {
            key: "full_scale",
            meaning: "the converter's largest code, such as 4095",
            whole: Some([1, u16::MAX as i32]),
        },
    ];
    const KEEPS_ZERO: bool = true;
    const IS_QUIET: bool = false;
    const EXPECTED: &'static str =
        "expected radians_per_code not zero and at most 1, and zero_code between 0 and full_scale";
    const WIRES: &'static str = "check the potentiometer's three wires";

    fn of_numbers(numbers: &[f64]) -> Self {
        let number = |index: usize| numbers.get(index).copied().unwrap_or_default();
        Self { zero_code: number(0) as f32, radian_per_code: number(1) as f32, full_scale: number(2) as u16 }
    }

    fn numbers(&self) -> Vec<f32, MAX_NUMBERS> {
        [self.zero_code, self.radian_per_code, self.full_scale.into()].into_iter().collect()
    }

    fn is_valid(&self) -> bool {
        self.is_valid()
    }

    fn line(&self) -> Line {
        Line { zero_code: self.zero_code, radian_per_code: self.radian_per_code }
    }

    fn with_zero(self, zero_code: f32) -> Self {
        Self { zero_code, ..self }
    }

    fn with_step(self, radian_per_code: f32) -> Option<Self> {
        Some(Self { radian_per_code, ..self })
    }

    fn is_connected(&self, code: Code) -> bool {
        self.is_connected(code)
    }

    fn span(&self) -> Option<u32> {
        None
    }

    fn full_scale(&self) -> u16 {
        self.full_scale
    }

    fn still_codes(&self) -> f32 {
        STILL_SPREAD * f32::from(self.full_scale)
    }

    fn nominal_step_rad(&self) -> f32 {
        Self::nominal(self.full_scale).radian_per_code
    }

    fn complaint(&self) -> Option<&'static str> {
        let nominal =
            "this is the data sheet's, off by a percent and by wherever the shaft was clamped: `host calibrate`";
        (*self == Self::nominal(self.full_scale)).then_some(nominal)
    }
}

impl fmt::Display for Potentiometer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mrad = 1e3 * self.radian_per_code;
        write!(f, "zero at code {:.1} of {}, {mrad:.5} mrad a code", self.zero_code, self.full_scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_comes_back_from_its_angle() {
        let pot = Potentiometer::nominal(FULL_SCALE_12_BIT);
        for code in 0..=FULL_SCALE_12_BIT {
            assert_eq!(pot.code(pot.angle(Code(code))), Code(code));
        }
    }

    #[test]
    fn the_travel_is_340_degrees() {
        let pot = Potentiometer::nominal(FULL_SCALE_12_BIT);
        let travel = pot.angle(Code(4095)).0 - pot.angle(Code(0)).0;
        assert!((travel.to_degrees() - 340.0).abs() < 0.1);
    }

    #[test]
    fn the_ends_count_as_disconnected() {
        let pot = Potentiometer::nominal(FULL_SCALE_12_BIT);
        assert!(!pot.is_connected(Code(0)) && !pot.is_connected(Code(4095)));
        // The data sheet's end voltage: the wiper is off the track.
        let end = (0.005 * 4095.0) as u16;
        assert!(!pot.is_connected(Code(end)) && !pot.is_connected(Code(4095 - end)));
        // … and 168° are on it.
        assert!(pot.is_connected(pot.code(Radian(2.93))) && pot.is_connected(pot.code(Radian(-2.93))));
        assert!(pot.is_connected(Code(2048)));
    }

    #[test]
    fn angles_beyond_the_track_stay_on_the_converter() {
        let pot = Potentiometer::nominal(FULL_SCALE_12_BIT);
        assert_eq!(pot.code(Radian(10.0)), Code(4095));
        assert_eq!(pot.code(Radian(-10.0)), Code(0));
    }
}
