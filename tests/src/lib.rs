//! Helpers of the integration tests.

use std::time::Duration;

/// Only what hangs takes so long, however slow or busy the computer is: the limit of every wait for something to happen.
pub const HANG: Duration = Duration::from_secs(900);

#[cfg(target_os = "linux")]
pub mod browser;
pub mod chance;
pub mod coded;
#[cfg(target_os = "linux")]
pub mod device;
pub mod edits;
#[cfg(unix)]
pub mod emulator;
pub mod faults;
pub mod hidden;
pub mod image;
pub mod innovation;
pub mod lab;
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
pub mod rates;
pub mod sizes;
pub mod verdicts;
pub mod workbench;
