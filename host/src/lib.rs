//! The pendulum rig on the PC.
pub mod error;
pub mod noise;
pub mod recording;
pub mod rigfile;
