//! The pendulum rig on the PC.

#![forbid(unsafe_code)]

pub mod calibrate;
pub mod cli;
pub mod doctor;
pub mod error;
#[cfg(test)]
mod examples;
pub mod export;
pub mod link;
mod now;
pub mod operations;
pub mod record;
pub mod report;
pub mod rigfile;
pub mod serve;
pub mod sim;
pub mod study;
pub mod update;
pub mod watch;
pub mod web;

pub use identification::{
    compare, diagnose, files, fit, formula, geometry, improve, lanes, look, noise, number, pace, paper, plan, plot,
    random, recording, responses, rsm, shorten, simulation, swing, verdict, zero_phase,
};
