//! From recordings to numbers and missing physics: what needs neither a rig, nor a page, nor a command line.
//!
//! The program `host` and the Python package are made of it.

#![forbid(unsafe_code)]

pub mod compare;
mod cores;
pub mod diagnose;
pub mod fit;
pub mod formula;
pub mod geometry;
pub mod improve;
pub mod look;
pub mod pace;
pub mod paper;
pub mod plan;
pub mod plot;
pub mod responses;
pub mod rsm;
pub mod shorten;
pub mod swing;
pub mod verdict;
pub mod zero_phase;

pub use recording;
pub use recording::{files, noise, number, random};
pub use simulation::{self, lanes};
