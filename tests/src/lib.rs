//! Helpers of the integration tests.

#[cfg(target_os = "linux")]
pub mod device;
pub mod image;
pub mod innovation;
pub mod link;
pub mod plant;
pub mod program;
#[cfg(unix)]
pub mod qemu;
