//! Helpers of the integration tests.

pub mod device;
pub mod program;
