//! What the words of a column name mean, in English, German, French, Spanish and Italian, and the commonest ones in a
//! dozen languages more.
//!
//! `Time [s]`, `time_ms`, `thetaRad`, `Winkel / °`, `Temps (s)`. A name with a word of motion (`omega`, `vitesse`,
//! `theta_punkt`) is no angle, nor is one with a unit that no angle has (`position (m)`).

mod derivative;
mod drive;
mod hints;
mod meaning;
mod rotary;
mod sensors;
mod split;
mod unit_in_name;
mod vocabulary;

pub(super) use super::units::{angle_unit, rate_unit, time_unit};
pub(super) use drive::{is_of_drive, is_of_volts};
pub(super) use hints::{
    is_counter, is_estimate, is_estimate_of, is_of_carrier, is_of_pendulum, is_of_sine, is_size, is_stamp, is_step,
    is_target, says_nothing, says_nothing_else,
};
pub(super) use meaning::{Meaning, is_named_angle, is_other_quantity, is_unit, meaning};
pub(super) use rotary::{beside_alpha, beside_theta, is_rate_of_alpha, is_speed};
pub(super) use sensors::{
    is_acceleration, is_any_acceleration, is_distance, is_duration, is_gyroscope, is_length, is_orientation,
    is_quaternion, is_raw, is_turn_of_body, is_turn_sensor, may_be_acceleration, says_angles, says_turns, w_x_y_z,
};
