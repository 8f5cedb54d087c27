//! The pendulum rig on the PC.

pub mod lanes;
pub mod responses;
