//! Identification: from swings to parameters with uncertainties.
//!
//! [`problem`] says what is unknown, [`descent`] lowers the squared error, [`windows`] keeps it out of local minima
//! by letting the time window grow, [`stiction`] and [`stop_level`] search the two parameters in which the error is not smooth, and
//! [`covariance`] tells how well each is known.

pub(crate) mod added;
mod answered;
pub mod apart;
pub mod arrow;
mod bend;
pub mod blocks;
pub mod by_least_squares;
mod by_surfaces;
mod clock_knots;
pub(crate) mod closer;
pub mod clusters;
pub mod covariance;
pub mod curve;
pub mod curve_parts;
mod descended;
pub mod descent;
mod error;
pub mod fitted;
pub mod found;
pub mod free_torque;
mod held;
pub mod held_out;
pub mod identify;
mod knots;
mod later;
mod left_out;
pub mod levels;
pub mod linear;
mod memory;
mod number;
mod of_rig;
pub(crate) mod other_turn;
mod phase;
pub mod prediction;
pub mod problem;
mod progress;
pub mod proposal;
pub mod quality;
pub mod ranges;
pub mod refine;
pub mod region;
mod report;
pub(crate) use report::LARGE_RELEASE_RAD;
pub mod response;
pub mod ridge;
mod rounded_stop;
mod rounding;
pub mod runs;
mod scouts;
pub mod sequential;
pub mod short_memory;
pub mod solve;
pub mod start;
pub mod state_grid;
pub mod step;
pub mod stiction;
mod stiction_bounds;
pub mod stop_level;
pub mod tally;
pub mod tolerance;
pub mod tolerated;
pub mod touch;
pub mod uncertainty;
mod unseen;
pub mod windows;

#[cfg(test)]
mod numbers_tests;
#[cfg(test)]
pub(crate) mod own_swing;
#[cfg(test)]
mod tests;
