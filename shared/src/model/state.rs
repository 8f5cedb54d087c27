//! What a model remembers between two steps and between two readings.

use crate::effect::{MEMORY, SENSOR_MEMORY};
use crate::karnopp::Contact;
use crate::parameters::{MAX_MEMORIES, MAX_SENSORS};
use crate::real::Real;
use crate::rk4::Phase;

const STATE_NUMBERS: usize = 6 + MEMORY * MAX_MEMORIES;
const SENSOR_NUMBERS: usize = SENSOR_MEMORY * MAX_SENSORS;

/// What the pendulum knows of itself between two steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<R> {
    /// θ in rad.
    pub angle_rad: R,
    /// ω in rad/s.
    pub velocity_rad_s: R,
    /// Seconds since the release.
    pub time_s: R,
    /// Sliding, in the band, or at rest.
    pub contact: Contact<R>,
    pub(super) memories: [[R; MEMORY]; MAX_MEMORIES],
}

impl<R: Copy> State<R> {
    /// One number everywhere.
    pub(crate) const fn all(number: R) -> Self {
        let contact = Contact { slide: number, push: number, level_nm: number };
        let memories = [[number; MEMORY]; MAX_MEMORIES];
        Self { angle_rad: number, velocity_rad_s: number, time_s: number, contact, memories }
    }
}

impl<R: Real> State<R> {
    /// How many numbers a state is.
    pub const N_NUMBERS: usize = STATE_NUMBERS;

    /// The state as numbers: angle, velocity, time, direction of sliding, direction of the drive in the band, breakaway
    /// torque, memories.
    pub fn numbers(&self) -> [R; STATE_NUMBERS] {
        let Contact { slide, push, level_nm } = self.contact;
        let first = [self.angle_rad, self.velocity_rad_s, self.time_s, slide, push, level_nm];
        core::array::from_fn(|i| match first.get(i) {
            Some(number) => *number,
            None => self.memories.as_flattened()[i - first.len()],
        })
    }

    #[inline(always)]
    pub(super) fn go_to(&mut self, reached: Phase<R>, dt_s: R) {
        self.angle_rad = reached.angle;
        self.velocity_rad_s = reached.velocity;
        self.time_s = self.time_s + dt_s;
    }

    /// What effects remember.
    #[cfg(test)]
    pub(crate) fn memories(&self) -> &[[R; MEMORY]; MAX_MEMORIES] {
        &self.memories
    }

    /// The state that [`State::numbers`] gave.
    pub fn from_numbers(numbers: &[R; STATE_NUMBERS]) -> Self {
        let [angle_rad, velocity_rad_s, time_s, slide, push, level_nm, ..] = *numbers;
        let memories = core::array::from_fn(|m| core::array::from_fn(|i| numbers[6 + MEMORY * m + i]));
        Self { angle_rad, velocity_rad_s, time_s, contact: Contact { slide, push, level_nm }, memories }
    }
}

/// What the sensor effects remember between two readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorState<R>(pub(super) [[R; SENSOR_MEMORY]; MAX_SENSORS]);

impl<R: Copy> SensorState<R> {
    /// One number everywhere.
    pub(crate) const fn all(number: R) -> Self {
        Self([[number; SENSOR_MEMORY]; MAX_SENSORS])
    }
}

impl<R: Real> SensorState<R> {
    /// How many numbers it is.
    pub const N_NUMBERS: usize = SENSOR_NUMBERS;

    /// It as numbers, effect by effect.
    pub fn numbers(&self) -> [R; SENSOR_NUMBERS] {
        core::array::from_fn(|i| self.0.as_flattened()[i])
    }

    /// What [`SensorState::numbers`] gave.
    pub fn from_numbers(numbers: &[R; SENSOR_NUMBERS]) -> Self {
        Self(core::array::from_fn(|m| core::array::from_fn(|i| numbers[SENSOR_MEMORY * m + i])))
    }
}
