//! Helpers of the integration tests.

pub mod image;
pub mod link;
pub mod plant;
pub mod qemu;
