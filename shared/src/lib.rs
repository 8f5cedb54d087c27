//! The pendulum rig's physics and messages.
#![no_std]
#![forbid(unsafe_code)]
