//! Simulated readings of a swing: what a fit asks for thousands of times.
//!
//! A crate of its own because nearly all time of a fit is spent here: it is compiled with every optimisation even where
//! the rest is not. So what others call is made for one number: what is generic would be compiled with them.

#![forbid(unsafe_code)]

mod follower;
pub mod lanes;
mod trajectory;

pub use follower::{Follower, Transition, inverse};
pub use trajectory::{AT_ONCE, LANES, Release, Schedule, readings, readings_of_each};
