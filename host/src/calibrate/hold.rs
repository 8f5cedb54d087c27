//! Waiting until the pendulum is still at a new place, and the mean code there.

use crate::doctor::Signal;
use crate::link::{LinkError, Session};
use shared::sensor::Sensor;
use shared::units::Code;
use shared::wire::{Frame, Settings};
use std::collections::VecDeque;
use std::time::Duration;

/// Still is judged over two stretches of this length.
const STILL_S: f64 = 0.4;

/// A hand that creeps moves the mean from one stretch to the next by more codes than this.
const CREEP_CODES: f64 = 1.0;

/// Places nearer to each other than this (by the data sheet's gain) are the same place.
const LEAST_APART_RAD: f64 = 0.08;

/// A stream is looked for this often.
const LOOK_EVERY: Duration = Duration::from_millis(100);

/// Where the pendulum is still.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Still {
    /// Mean code.
    pub code: f64,
    /// Standard deviation of the codes.
    pub spread_codes: f64,
}

/// Why there is no such place.
#[derive(Debug, thiserror::Error)]
pub enum HoldError {
    /// Too long a wait.
    #[error("within {wait_s} s the pendulum was not still {whereabouts}")]
    Never {
        /// How long it was waited for.
        wait_s: f64,
        /// `at rest`, or `at a new angle`.
        whereabouts: &'static str,
    },
    /// The sensor has no contact.
    #[error("the {} reads code {code}, an end of its range", sensor.name())]
    Disconnected {
        /// The code.
        code: f64,
        /// Which sensor.
        sensor: Sensor,
    },
    /// The link broke.
    #[error(transparent)]
    Link(#[from] LinkError),
}

impl HoldError {
    /// What to do next.
    pub fn next_step(&self) -> String {
        match self {
            Self::Never { .. } => "hold it still for a second at each angle, or wait longer with --wait".to_owned(),
            Self::Disconnected { sensor, .. } => sensor.wires().to_owned(),
            Self::Link(error) => error.next_step(),
        }
    }
}

/// Waits on a running stream until the pendulum is still away from the places seen before (codes).
///
/// # Errors
/// It never is, the wiper has no contact there, or the link breaks.
pub fn hold(session: &mut Session, settings: &Settings, before: &[f64], wait_s: f64) -> Result<Still, HoldError> {
    let length = ((STILL_S * f64::from(settings.rate_hz)) as usize).max(2);
    let mut codes: VecDeque<u16> = VecDeque::with_capacity(2 * length);
    let give_up = session.elapsed() + Duration::from_secs_f64(wait_s);
    while session.elapsed() < give_up {
        let Some(Frame::Samples(samples)) = session.receive(LOOK_EVERY)? else { continue };
        codes.extend(&samples.codes);
        codes.drain(..codes.len().saturating_sub(2 * length));
        if codes.len() < 2 * length {
            continue;
        }
        let (earlier, later) = codes.make_contiguous().split_at(length);
        let Some(still) = still(&Signal::of_codes(earlier, settings), &Signal::of_codes(later, settings)) else {
            continue;
        };
        let sensor = settings.sensor;
        if !sensor.is_connected(Code(still.code as u16)) {
            return Err(HoldError::Disconnected { code: still.code, sensor });
        }
        if before.iter().all(|code| apart(&sensor, *code, still.code)) {
            return Ok(still);
        }
    }
    let whereabouts = if before.is_empty() { "at rest" } else { "at a new angle" };
    Err(HoldError::Never { wait_s, whereabouts })
}

fn still(earlier: &Signal, later: &Signal) -> Option<Still> {
    let stays = (later.mean_code - earlier.mean_code).abs() < CREEP_CODES;
    let code = 0.5 * (earlier.mean_code + later.mean_code);
    (stays && earlier.is_still() && later.is_still()).then_some(Still { code, spread_codes: later.spread_codes })
}

fn apart(sensor: &Sensor, a: f64, b: f64) -> bool {
    (a - b).abs() * f64::from(sensor.nominal_step_rad()) > LEAST_APART_RAD
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn still_is_the_middle_of_two_stretches_that_stand_alike() {
        let signal = |mean_code: f64| Signal { mean_code, spread_codes: 0.5, noise_codes: 0.5, ..Signal::default() };
        let found = still(&signal(2000.0), &signal(2000.5)).unwrap();
        assert_eq!((found.code, found.spread_codes), (2000.25, 0.5));
        assert_eq!(still(&signal(2000.0), &signal(2001.5)), None);
        let moves = Signal { spread_codes: 20.0, ..signal(2000.0) };
        assert_eq!(still(&signal(2000.0), &moves), None);
    }
}
