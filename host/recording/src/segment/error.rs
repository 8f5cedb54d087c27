//! Why there is no free swing.

use super::{LONGEST_S, MIN_TURNING_POINTS};
use crate::number::significant;
use thiserror::Error;

/// Why there is no free swing.
#[derive(Debug, Error, PartialEq)]
pub enum SegmentError {
    /// Too short.
    #[error(
        "only {} of free swing in {duration_s:.2} s, expected at least \
         {MIN_TURNING_POINTS} (two swings); release from a larger angle, record longer, or choose the stretch with \
         --from and --to",
        turning_points(*n_turning_points)
    )]
    TooFewSwings {
        /// Turning points found.
        n_turning_points: usize,
        /// Length of the stretch, s.
        duration_s: f64,
    },
    /// Because a motor moves it most of the time.
    #[error(
        "only {} of free swing, because {column} moves it: it goes from {low} to {high} and is on in {percent:.0} % of the \
         recording; record how it swings with the motor off, or choose such a stretch with --from and --to",
        turning_points(*n_turning_points)
    )]
    Driven {
        /// Turning points found.
        n_turning_points: usize,
        /// What messages call the column of the motor.
        column: String,
        /// The smallest number in it, as shown.
        low: String,
        /// The largest one.
        high: String,
        /// Of the samples, at which it is on.
        percent: f64,
    },
    /// Because nothing between them is there.
    #[error(
        "of {n_samples} readings nearly each is a turning point: there are one or two in a half swing, or the turning points \
         alone were written down; how it swings shows from ten readings a swing on"
    )]
    OnlyTurns {
        /// Readings there are.
        n_samples: usize,
    },
    /// Because the sensor is too coarse for it.
    #[error(
        "it turns {n_turning_points} times in {duration_s:.2} s, but only {n_seen} of the ways between go farther than four steps of its sensor \
         ({step} {unit}), expected at least {}: so few steps are no swings; release from a larger angle, or \
         choose another stretch with --from and --to",
        MIN_TURNING_POINTS - 1
    )]
    WithinSteps {
        /// Turning points found.
        n_turning_points: usize,
        /// Length of the stretch, s.
        duration_s: f64,
        /// How often it goes farther.
        n_seen: usize,
        /// Of the sensor, as shown.
        step: String,
        /// Of the readings.
        unit: &'static str,
    },
    /// Something drives it.
    #[error(
        "its swings grow, from {} to {} {unit} to either side, where free ones die away: something drives it (a motor, a \
         hand, a support that moves); record it once it is let go and left alone, or choose the stretch in which it dies \
         away with --from and --to",
        significant(*from, 2),
        significant(*to, 2)
    )]
    Grows {
        /// Where they begin to grow, in the unit of the readings.
        from: f64,
        /// Where they end to, the same.
        to: f64,
        /// Of the readings.
        unit: &'static str,
    },
    /// Longer than any pendulum swings.
    #[error(
        "{duration_s:e} s of free swing, expected at most {LONGEST_S} s; is the time in seconds? Otherwise choose the \
         stretch with --from and --to"
    )]
    TooLong {
        /// Length of the stretch, s.
        duration_s: f64,
    },
    /// Limits that leave nothing.
    #[error(
        "--from {from_s} s and --to {to_s} s leave {n_samples} samples; the recording goes from {first_s} s to {last_s} s"
    )]
    NothingBetween {
        /// Lower limit, s.
        from_s: f64,
        /// Upper limit, s.
        to_s: f64,
        /// Samples between them.
        n_samples: usize,
        /// First time of the recording, s.
        first_s: f64,
        /// Last time, s.
        last_s: f64,
    },
}

fn turning_points(n: usize) -> String {
    if n == 1 { "one turning point".to_owned() } else { format!("{n} turning points") }
}
