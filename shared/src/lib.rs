//! The pendulum rig's physics, filter, observer and messages, used alike by the board and the PC.
//!
//! No allocation, no input or output, no clock. Everything is in SI units and radians; the angle is zero when the
//! pendulum hangs at rest and grows counter-clockwise.
//!
//! Where to start: [`model::Model`] is the pendulum, [`effect`] lists what may act on it, [`rig::Rig`] is the
//! application that runs on the board, [`wire`] what it says to the PC.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod action;
pub mod bank;
pub mod curve;
pub mod dual;
pub mod effect;
pub mod filter;
pub mod formula;
pub mod karnopp;
mod limits;
pub mod measured;
pub mod model;
pub mod motion;
pub mod observer;
pub mod paper;
pub mod parameters;
mod protocol;
pub mod real;
mod reason;
pub mod rig;
mod rk4;
mod rules;
pub mod score;
pub mod sensor;
pub mod units;
pub mod wire;

pub use sensor::potentiometer;
