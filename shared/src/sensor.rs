//! What turns codes into angles: one file a sensor, one list of all.
//!
//! Board, messages, flash, recordings, model files and commands ask [`Sensor`]; none of them names one. To add a
//! sensor, write its file with a [`Calibration`] and its line in the list below (docs/add-a-sensor.md); the number of a
//! line is in messages and in flash, so lines are added at the end and never taken out.
//!
//! A code is what one sample brings, 0 … 65,535. A sensor that turns for ever begins again after its span; [`Reader`]
//! follows it, so that an angle goes on beyond a turn.

pub mod bytes;

use crate::protocol::{NEWEST_PROTOCOL, PROTOCOL};
use crate::units::{Code, Radian};
use core::fmt;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// A calibration has at most so many numbers.
pub const MAX_NUMBERS: usize = 4;

/// A gain further than this factor from the data sheet's is a mistake.
const GAIN_FACTOR: f32 = 2.0;

/// Least distance from zero, rad by the nominal gain, at which a gain can be calibrated.
const LEAST_GAIN_ANGLE_RAD: f32 = 0.2;

/// A straight line from codes to angles: angle = (code − zero) · gain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// The code (with a fraction, from averaging) at which the pendulum hangs at rest.
    pub zero_code: f32,
    /// Angle per code in radians; negative if the codes fall while the pendulum turns counter-clockwise.
    pub radian_per_code: f32,
}

/// A number of a calibration, as model files have it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Number {
    /// Its key.
    pub key: &'static str,
    /// What it is, with its unit.
    pub meaning: &'static str,
    /// The least and the largest that there is, of a whole number.
    pub whole: Option<[i32; 2]>,
}

/// Why a known angle gives no gain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoGain {
    /// The gain is a number of the sensor, with nothing to measure.
    Known,
    /// Too near zero, or a gain that no such sensor has.
    Absurd,
}

/// What a sensor knows of itself. Numbers in SI units and radians; positive is counter-clockwise.
pub trait Calibration: Copy + fmt::Display {
    /// Its name in model files, recordings and messages.
    const NAME: &'static str;

    /// Its numbers in model files. The zero is one of them only if it outlasts the power.
    const NUMBERS: &'static [Number];

    /// Does it know after power-up where it is? If not, zero is where the pendulum hangs then.
    const KEEPS_ZERO: bool;

    /// May it read one code for ever while the pendulum is still? If not, that is a broken wire.
    const IS_QUIET: bool;

    /// What its numbers have to be, for whoever gave others.
    const EXPECTED: &'static str;

    /// What to check where its readings mean nothing.
    const WIRES: &'static str;

    /// From the numbers of [`Calibration::NUMBERS`], in that order; [`Calibration::is_valid`] judges them.
    fn of_numbers(numbers: &[f64]) -> Self;

    /// The numbers of [`Calibration::NUMBERS`], in that order, as exact as they are known.
    fn numbers(&self) -> Vec<f32, MAX_NUMBERS>;

    /// Is this a calibration to compute with?
    fn is_valid(&self) -> bool;

    /// From code to angle.
    fn line(&self) -> Line;

    /// With its zero at another code.
    fn with_zero(self, zero_code: f32) -> Self;

    /// With another angle per code, rad; `None` where that follows from its numbers, with nothing to measure.
    fn with_step(self, radian_per_code: f32) -> Option<Self>;

    /// Does the code mean an angle?
    fn is_connected(&self, code: Code) -> bool;

    /// The codes after which it begins again; none for a sensor with ends. At most 65,536.
    fn span(&self) -> Option<u32>;

    /// The largest code.
    fn full_scale(&self) -> u16;

    /// Codes of a pendulum that is still spread less than this (standard deviation).
    fn still_codes(&self) -> f32;

    /// The size of a code step by the data sheet, rad.
    fn nominal_step_rad(&self) -> f32 {
        self.line().radian_per_code.abs()
    }

    /// Why it should be calibrated, if it should.
    fn complaint(&self) -> Option<&'static str>;
}

/// Makes each pair a file of this folder and an entry of [`Sensor`], and hands every question on to the one in use.
macro_rules! sensors {
    ($($module:ident: $name:ident,)*) => {
        $(pub mod $module;
        pub use $module::$name;)*

        /// The sensor of a rig, with its calibration.
        #[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
        pub enum Sensor {
            $(#[doc = concat!("See [`", stringify!($name), "`].")] $name($name),)*
        }

        $(impl From<$name> for Sensor {
            fn from(sensor: $name) -> Self {
                Self::$name(sensor)
            }
        })*

        impl fmt::Display for Sensor {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                match self { $(Self::$name(sensor) => sensor.fmt(f),)* }
            }
        }

        impl Sensor {
            /// The names of all.
            pub const NAMES: &'static [&'static str] = &[$($name::NAME),*];

            /// The numbers of the sensor of this name, if there is one.
            pub fn numbers_of(name: &str) -> Option<&'static [Number]> {
                $(if name == $name::NAME {
                    return Some($name::NUMBERS);
                })*
                None
            }

            /// The sensor of this name with the numbers that `number` gives; `None` if there is none of that name.
            ///
            /// # Errors
            /// Those of `number`.
            pub fn read<E>(
                name: &str,
                mut number: impl FnMut(&'static Number) -> Result<f64, E>,
            ) -> Result<Option<Self>, E> {
                $(if name == $name::NAME {
                    let mut numbers = Vec::<f64, MAX_NUMBERS>::new();
                    for wanted in $name::NUMBERS {
                        // A test counts the numbers of every sensor.
                        let _ = numbers.push(number(wanted)?);
                    }
                    return Ok(Some(Self::$name($name::of_numbers(&numbers))));
                })*
                Ok(None)
            }

            /// Its name in model files, recordings and messages.
            pub fn name(&self) -> &'static str {
                match self { $(Self::$name(_) => $name::NAME,)* }
            }

            /// Its numbers in model files: what they are, and their values.
            pub fn numbers(&self) -> impl Iterator<Item = (&'static Number, f32)> {
                let (known, values) = match self { $(Self::$name(sensor) => ($name::NUMBERS, sensor.numbers()),)* };
                known.iter().zip(values)
            }

            /// See [`Calibration::KEEPS_ZERO`].
            pub fn keeps_zero(&self) -> bool {
                match self { $(Self::$name(_) => $name::KEEPS_ZERO,)* }
            }

            /// See [`Calibration::IS_QUIET`].
            pub fn is_quiet(&self) -> bool {
                match self { $(Self::$name(_) => $name::IS_QUIET,)* }
            }

            /// See [`Calibration::EXPECTED`].
            pub fn expected(&self) -> &'static str {
                match self { $(Self::$name(_) => $name::EXPECTED,)* }
            }

            /// See [`Calibration::WIRES`].
            pub fn wires(&self) -> &'static str {
                match self { $(Self::$name(_) => $name::WIRES,)* }
            }

            /// Is this a calibration to compute with?
            pub fn is_valid(&self) -> bool {
                match self { $(Self::$name(sensor) => sensor.is_valid(),)* }
            }

            /// From code to angle.
            pub fn line(&self) -> Line {
                match self { $(Self::$name(sensor) => sensor.line(),)* }
            }

            /// With its zero at another code.
            #[must_use]
            pub fn with_zero(self, zero_code: f32) -> Self {
                match self { $(Self::$name(sensor) => Self::$name(sensor.with_zero(zero_code)),)* }
            }

            /// With another angle per code, rad; `None` where that follows from its numbers, with nothing to measure.
            pub fn with_step(self, radian_per_code: f32) -> Option<Self> {
                match self { $(Self::$name(sensor) => sensor.with_step(radian_per_code).map(Self::$name),)* }
            }

            /// Does the code mean an angle?
            pub fn is_connected(&self, code: Code) -> bool {
                match self { $(Self::$name(sensor) => sensor.is_connected(code),)* }
            }

            /// The codes after which it begins again; none for a sensor with ends.
            pub fn span(&self) -> Option<u32> {
                match self { $(Self::$name(sensor) => sensor.span(),)* }
            }

            /// The largest code.
            pub fn full_scale(&self) -> u16 {
                match self { $(Self::$name(sensor) => sensor.full_scale(),)* }
            }

            /// Codes of a pendulum that is still spread less than this (standard deviation).
            pub fn still_codes(&self) -> f32 {
                match self { $(Self::$name(sensor) => sensor.still_codes(),)* }
            }

            /// The size of a code step by the data sheet, rad.
            pub fn nominal_step_rad(&self) -> f32 {
                match self { $(Self::$name(sensor) => sensor.nominal_step_rad(),)* }
            }

            /// Why it should be calibrated, if it should.
            pub fn complaint(&self) -> Option<&'static str> {
                match self { $(Self::$name(sensor) => sensor.complaint(),)* }
            }
        }
    };
}

// Every sensor there is; see above before a line is moved.
sensors! {
    potentiometer: Potentiometer,
    encoder: Encoder,
}

impl Sensor {
    /// Where a sensor begins that does not know where it is: the middle of its codes.
    pub const BEGINS_AT: u16 = 0x8000;

    /// Are both of one kind, whatever their numbers?
    pub fn is_like(&self, other: &Self) -> bool {
        core::mem::discriminant(self) == core::mem::discriminant(other)
    }

    /// The protocol that a rig with this sensor says it speaks: a program from before there were others has to refuse
    /// it by name, and may go on using a potentiometer.
    pub fn protocol(&self) -> u16 {
        if matches!(self, Self::Potentiometer(_)) { PROTOCOL } else { NEWEST_PROTOCOL }
    }

    /// Angle of one code step in radians, never negative: what the reading is rounded to.
    pub fn step_rad(&self) -> f32 {
        self.line().radian_per_code.abs()
    }

    /// Is there nothing about its gain that could be measured?
    pub fn gain_is_known(&self) -> bool {
        self.with_step(self.line().radian_per_code).is_none()
    }

    /// With the gain that makes `code` mean this angle.
    ///
    /// # Errors
    /// None to be found.
    pub fn with_gain(self, code: f32, angle: Radian) -> Result<Self, NoGain> {
        let nominal = self.nominal_step_rad();
        let codes = code - self.line().zero_code;
        let radian_per_code = angle.0 / codes;
        let ratio = radian_per_code.abs() / nominal;
        let sensible =
            codes.abs() * nominal > LEAST_GAIN_ANGLE_RAD && (1.0 / GAIN_FACTOR..GAIN_FACTOR).contains(&ratio);
        match self.with_step(radian_per_code) {
            None => Err(NoGain::Known),
            Some(sensor) if sensible => Ok(sensor),
            Some(_) => Err(NoGain::Absurd),
        }
    }

    /// The angle at a place that a [`Reader`] gives.
    pub fn angle_at(&self, position: i32) -> Radian {
        let line = self.line();
        Radian((position as f32 - line.zero_code) * line.radian_per_code)
    }

    /// As it is after power-up: a sensor that does not keep its zero hangs at rest where it begins.
    #[must_use]
    pub fn at_power_up(self) -> Self {
        if self.keeps_zero() { self } else { self.with_zero(f32::from(Self::BEGINS_AT)) }
    }

    /// Taken over from a file or from flash while `in_use` is measuring: a zero that does not outlast the power is only
    /// known to the sensor that has it.
    #[must_use]
    pub fn taken_over(self, in_use: &Self) -> Self {
        match (self.keeps_zero(), self.is_like(in_use)) {
            (true, _) => self,
            (false, true) => self.with_zero(in_use.line().zero_code),
            (false, false) => self.at_power_up(),
        }
    }
}

/// Follows the codes of a sensor, beyond the end of its span too.
#[derive(Clone, Debug)]
pub struct Reader {
    sensor: Sensor,
    position: Option<i32>,
}

impl Reader {
    /// Before the first code, which is taken to be within half a span of zero.
    pub fn new(sensor: Sensor) -> Self {
        Self { sensor, position: None }
    }

    /// The sensor.
    pub fn sensor(&self) -> &Sensor {
        &self.sensor
    }

    /// The code without its wraps: the place nearest to the last one.
    pub fn follow(&mut self, code: Code) -> i32 {
        let code = i32::from(code.0);
        let Some(span) = self.sensor.span() else { return code };
        let (span, half) = (span as i32, span as i32 / 2);
        let last = self.position.unwrap_or(libm::roundf(self.sensor.line().zero_code) as i32);
        let ahead = (code.wrapping_sub(last).wrapping_add(half)).rem_euclid(span) - half;
        *self.position.insert(last.wrapping_add(ahead))
    }

    /// The angle that a code means; none where the sensor is not connected.
    pub fn read(&mut self, code: Code) -> Option<Radian> {
        let position = self.follow(code);
        self.sensor.is_connected(code).then(|| self.sensor.angle_at(position))
    }
}

#[cfg(test)]
mod tests;
