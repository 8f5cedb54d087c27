//! Helpers of the integration tests.

#[cfg(target_os = "linux")]
pub mod browser;
pub mod chance;
#[cfg(target_os = "linux")]
pub mod device;
pub mod edits;
pub mod faults;
pub mod hidden;
pub mod image;
pub mod innovation;
pub mod link;
pub mod measured;
pub mod memory;
#[cfg(unix)]
pub mod page;
pub mod paper_data;
pub mod plant;
pub mod program;
pub mod protocol_page;
#[cfg(unix)]
pub mod python;
#[cfg(unix)]
pub mod qemu;
