//! The pendulum rig on the PC.
pub mod noise;
pub mod recording;
