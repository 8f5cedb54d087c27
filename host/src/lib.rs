//! The pendulum rig on the PC.

pub mod responses;
