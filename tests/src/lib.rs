//! Helpers of the integration tests.

#[cfg(target_os = "linux")]
pub mod device;
pub mod hidden;
pub mod program;
