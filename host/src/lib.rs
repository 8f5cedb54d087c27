//! The pendulum rig on the PC.

pub mod diagnose;
pub mod fit;
pub mod lanes;
pub mod noise;
pub mod recording;
pub mod responses;
pub mod rsm;
pub mod swing;
pub mod trajectory;
pub mod zero_phase;
