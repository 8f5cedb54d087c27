//! The pendulum rig on the PC.
pub mod error;
pub mod link;
pub mod noise;
pub mod record;
pub mod recording;
pub mod rigfile;
pub mod sim;
