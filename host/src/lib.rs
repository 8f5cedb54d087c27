//! The pendulum rig on the PC.

#![forbid(unsafe_code)]

pub mod calibrate;
pub mod cli;
pub mod compare;
pub mod diagnose;
pub mod doctor;
pub mod error;
pub mod export;
pub mod files;
pub mod fit;
pub mod formula;
pub mod geometry;
pub mod improve;
pub mod lanes;
pub mod link;
pub mod noise;
mod now;
mod number;
pub mod operations;
pub mod pace;
pub mod paper;
pub mod plan;
pub mod plot;
pub mod record;
pub mod recording;
pub mod report;
pub mod responses;
pub mod rigfile;
pub mod rsm;
pub mod serve;
pub mod sim;
pub mod study;
pub mod swing;
pub mod trajectory;
pub mod update;
pub mod verdict;
pub mod watch;
pub mod zero_phase;
