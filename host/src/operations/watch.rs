//! Watching a rig, release after release, until something is named. A rig that looks by itself has the last word.

use crate::error::Failure;
use crate::link::{SIMULATED, Session};
use crate::look::Look;
use crate::record::{End, Limits, listen};
use crate::watch::{Event, OwnLooks, Watcher, disconnected};
use std::sync::atomic::AtomicBool;

/// Simulated pendulums let go by themselves, at most so often.
const SIMULATED_SWINGS: u32 = 5;

/// Watches so many releases; without a number one, of a simulated rig until something is named.
///
/// # Errors
/// The link, or a swing that never began.
pub fn watch(
    session: &mut Session,
    n_swings: Option<u32>,
    limits: Limits,
    tell: &mut dyn FnMut(Event),
    stop: &AtomicBool,
) -> Result<Option<Look>, Failure> {
    let parameters = session.parameters()?.map(f64::from);
    let rate_hz = f64::from(session.settings()?.rate_hz);
    let is_simulated = is_simulated(session.port());
    let mut watcher = Watcher::new(parameters, rate_hz, tell);
    let mut last = None;
    let mut own_looks = OwnLooks::of(session)?;
    for _ in 0..n_swings.unwrap_or(if is_simulated { SIMULATED_SWINGS } else { 1 }) {
        let end = listen(session, limits, &mut watcher, stop)?;
        let mut look = watcher.rests();
        if own_looks.are_made() && matches!(end, End::AtRest | End::TimeLimit) {
            watcher.waits_for_rig();
            look = own_looks.wait(session)?.unwrap_or(look);
        }
        look.watched = look.watched.max(watcher.n_swings());
        let look = last.insert(look);
        let is_enough = n_swings.is_none() && !look.named.is_empty();
        if is_last(&end)? || is_enough {
            break;
        }
    }
    Ok(last)
}

/// Does the pendulum behind this port let go by itself?
pub fn is_simulated(port: &str) -> bool {
    port.split(':').next() == Some(SIMULATED)
}

/// Was this the last swing that can be watched?
fn is_last(end: &End) -> Result<bool, Failure> {
    match end {
        End::AtRest | End::TimeLimit => Ok(false),
        End::Stopped => Ok(true),
        End::Lost(error) => Err(Failure::failed(error).next(error.next_step())),
        End::Disconnected { code, sensor } => Err(disconnected(*code, sensor)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_simulated_pendulum_lets_go_by_itself() {
        assert!(["sim", "sim:drag"].into_iter().all(is_simulated));
        assert!(!["simple", "/dev/ttyACM0", "COM3"].into_iter().any(is_simulated));
    }
}
