//! From recordings to numbers and missing physics: what needs neither a rig, nor a page, nor a command line.
//!
//! The program `host` and the Python package are made of it.
//!
//! To read `fit`: `problem.rs` (what is unknown) → `linear.rs`, `arrow.rs`, `solve.rs`, `step.rs`, `bend.rs`, `descent.rs`
//! (Levenberg–Marquardt, and its steps along curved valleys) → `fitted.rs`, `descended.rs`, `answered.rs` (what Ms and DV
//! cost, to first order), `refine.rs`, `windows.rs` → `identify.rs` → `uncertainty.rs` (standard deviations, bounds,
//! status; `clusters.rs` where the model errs, `unseen.rs` for a band that no swing shows, `rounding.rs`, `memory.rs` and
//! `rounded_stop.rs` for steps that no noise hides; `touch.rs` for what touched a swing on its way; `short_memory.rs` for
//! noise that only a model shows).
//!
//! Then `diagnose`: `first_look.rs` (what a rig would say; nothing builds on it) → `score.rs` (what each effect could gain)
//! → `extension.rs`, `search.rs` → `verdict.rs`, `replacement.rs`, `zero.rs`, `doubt.rs`, `strength.rs`, `holds.rs`,
//! `ties.rs` (what may be claimed) → `curve.rs`, `resemblance.rs` (friction that no law describes) → `of_state.rs` (is
//! what is left a law of the motion?) → `shape.rs` (how far friction and inertia depend on the shape of the laws) →
//! `summary.rs`. `conclusion.rs` has the steps up to what may be claimed in their order.

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
