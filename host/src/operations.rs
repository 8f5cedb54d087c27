//! What a command does between its arguments and its words. The command line and the Python package both call these, so
//! that they can't come to different numbers; what `--json` prints and what Python hands out is one text.
//!
//! In: swings and a model, checked. Out: results that serialise to the fields of `--json`. This part neither prints nor
//! knows arguments.

mod covariance;
pub mod diagnose;
pub mod effects;
pub mod fit;
pub mod geometry;
pub mod given;
pub mod improve;
pub mod json;
pub mod model;
pub mod plan;
pub mod push;
pub mod reading;
pub mod record;
pub mod sensor;
pub mod simulate;
mod stages;
pub mod watch;
