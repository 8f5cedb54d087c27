//! The versions of what rig and PC say to each other.

/// Version of all messages but [`crate::wire::Hello`]: what programs say, and rigs whose sensor is a potentiometer.
pub const PROTOCOL: u16 = 1;

/// What rigs with another sensor say, so that a program that reads potentiometers only refuses them by name; see
/// [`crate::sensor::Sensor::protocol`]. In all else it is [`PROTOCOL`].
pub const NEWEST_PROTOCOL: u16 = 2;
