//! How much a diagnosis may take, so that a recording of an hour does not take hours.
//!
//! What counts is the Runge–Kutta step of one simulated swing. It is asked between the stages of a diagnosis, and a
//! stage that has begun is finished: so the result depends on the recordings alone, never on the machine.

use crate::fit::problem::Problem;
use crate::swing::Swing;
use serde::Serialize;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Steps of simulated swings on decimated samples after which no stage begins that can be left out: two cores take
/// about two seconds, at 35 ns a step of a model with an effect. Of the recordings that come with the project and the
/// eight examples the one of 371 s and the arm on ball bearings reach it, the arm with 32,700 simulations of 31,200.
/// Twice: neither would be bounded to speak of.
const MOST_STEPS: usize = 120_000_000;

/// What a diagnosis may take, and whether something was left out for it.
#[derive(Debug)]
pub struct Budget<'a> {
    count: &'a AtomicUsize,
    before: usize,
    most: usize,
    is_spent: AtomicBool,
}

/// The same, to be told.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Effort {
    /// So many swings could be simulated before stages were left out.
    pub simulations_at_most: usize,
    /// Were stages left out?
    pub reached: bool,
}

impl<'a> Budget<'a> {
    /// Of a problem with decimated swings, from here on.
    pub fn of(rough: &Problem<'a>) -> Self {
        let n_steps: usize = rough.swings.iter().map(Swing::n_steps).sum();
        let count = rough.n_simulations;
        Self {
            count,
            before: count.load(Ordering::Relaxed),
            most: MOST_STEPS * rough.swings.len() / n_steps.max(1),
            is_spent: AtomicBool::new(false),
        }
    }

    /// May another stage begin? If not, something is left out.
    pub fn allows_more(&self) -> bool {
        let is_left = self.count.load(Ordering::Relaxed) - self.before < self.most;
        self.is_spent.fetch_or(!is_left, Ordering::Relaxed);
        is_left
    }

    /// What there was, and whether it was used up.
    pub fn effort(&self) -> Effort {
        Effort { simulations_at_most: self.most, reached: self.is_spent.load(Ordering::Relaxed) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::parameters::Parameters;

    #[test]
    fn a_longer_recording_may_be_simulated_less_often() {
        let swing = |seconds: u32| {
            let times_s: Vec<f64> = (0..50 * seconds).map(|i| f64::from(i) * 0.02).collect();
            let angles_rad: Vec<f64> = times_s.iter().map(|t| (6.0 * t).cos() * (-0.01 * t).exp()).collect();
            Swing::new("cosine", &times_s, &angles_rad, 1e-3)
        };
        let count = AtomicUsize::new(7);
        let most = |seconds: u32| {
            let swings = [swing(seconds)];
            Budget::of(&Problem::new(&swings, &Parameters::paper(), Vec::new(), &count)).effort().simulations_at_most
        };
        let (short, long) = (most(20), most(200));
        assert!((9 * long..11 * long).contains(&short), "{short} {long}");
    }

    #[test]
    fn what_is_used_up_is_said_once_something_is_left_out() {
        let count = AtomicUsize::new(7);
        let budget = Budget { count: &count, before: 7, most: 10, is_spent: AtomicBool::new(false) };
        count.store(16, Ordering::Relaxed);
        assert!(budget.allows_more() && !budget.effort().reached);
        count.store(17, Ordering::Relaxed);
        assert!(!budget.effort().reached, "nothing was left out yet");
        assert!(!budget.allows_more() && budget.effort().reached);
    }
}
