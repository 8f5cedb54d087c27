//! The firmware without its board: samples and bytes in, frames and flash words out, all through traits.
//!
//! [`app::run`] connects [`shared::rig::Rig`] to a [`ports::Board`]. The boards themselves (pins, clocks, interrupts)
//! belong to the program, `main.rs`; everything here also runs in the tests on the PC.
#![no_std]
#![forbid(unsafe_code)]
#![allow(async_fn_in_trait, reason = "nobody else implements these traits, so nobody needs bounds on their futures")]

pub mod app;

pub mod frame_queue;
pub mod oversampling;
mod patient_flash;
pub mod ports;
pub mod ring;
pub mod spare;
pub mod store;
