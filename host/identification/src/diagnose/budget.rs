//! How much a diagnosis may take, so that a recording of an hour does not take hours.
//!
//! What counts is the Runge–Kutta step of the base model in one simulated swing, and what other models take beside it
//! ([`crate::fit::tally`]). It is asked between the stages of a diagnosis, and a stage that has begun is finished: so the
//! result depends on the recordings alone, never on the machine.

use crate::fit::tally::Tally;
use serde::Serialize;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Million steps after which no stage of the search begins that can be left out: two cores take about three seconds. Forty
/// simulated rigs are told exactly what they lack, as without it. With 280 one pair of them is told nothing. Twice: dynamicslab_single_arm takes twice as long, for the same verdict.
const MOST_OF_THE_SEARCH: u64 = 400;

/// … or so many steps of whatever models, which long recordings take first: the one of 371 s takes 14 s of a core without
/// this, and 9 with it. Half and twice were not tried.
const MOST_TAKEN: u64 = 120;

/// … and so many more before effects are tried beside a friction curve. The arm on ball bearings takes 30 by then, the
/// recording of 371 s 100. Half of it: the same; twice: an effect is tried beside the curve of 371 s, some 3 s of a core.
const MOST_OF_A_CURVE: u64 = 80;

/// One part of so many of either is for single effects, so that several long releases leave something for pairs. With all of it,
/// two of three such rigs that lack two effects were told of none or one, at 13 and 19 noises, which one release alone names;
/// a third was not tried. Of one release all is for single effects first, as it was measured; twelve seconds of a cart are told the
/// same with half.
const SHARE_OF_SINGLE_EFFECTS: u64 = 2;

/// What a diagnosis may take, and whether something was left out for it.
#[derive(Debug)]
pub struct Budget<'a> {
    tally: &'a Tally,
    before: u64,
    taken_before: u64,
    curve_began: AtomicU64,
    keeps_for_pairs: AtomicBool,
    is_spent: AtomicBool,
}

/// The same, to be told.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Effort {
    /// Million steps of the base model, or what others take beside it, that were simulated.
    pub million_steps: u64,
    /// After so many no stage of the search was begun that could be left out; of long recordings some earlier.
    pub million_steps_at_most: u64,
    /// Were stages left out?
    pub reached: bool,
}

impl<'a> Budget<'a> {
    /// From here on.
    pub fn new(tally: &'a Tally) -> Self {
        Self {
            tally,
            before: tally.steps(),
            taken_before: tally.steps_taken(),
            curve_began: AtomicU64::new(0),
            keeps_for_pairs: AtomicBool::new(false),
            is_spent: AtomicBool::new(false),
        }
    }

    /// May another stage of the search begin? If not, something is left out.
    pub fn allows_more(&self) -> bool {
        self.allows_one_of(if self.keeps_for_pairs.load(Ordering::Relaxed) { SHARE_OF_SINGLE_EFFECTS } else { 1 })
    }

    /// May wider forms of laws be tried? They come before pairs, and take of what is kept for these.
    pub fn allows_wider_forms(&self) -> bool {
        self.allows_one_of(1)
    }

    /// Is less taken than one of so many parts of what there is?
    fn allows_one_of(&self, share: u64) -> bool {
        let million_taken = (self.tally.steps_taken() - self.taken_before) / 1_000_000;
        self.allows(share * self.million_steps() < MOST_OF_THE_SEARCH && share * million_taken < MOST_TAKEN)
    }

    /// Is a part kept for pairs of effects from here on?
    pub fn keep_for_pairs(&self, is_kept: bool) {
        self.keeps_for_pairs.store(is_kept, Ordering::Relaxed);
    }

    /// From here on a friction curve is sought.
    pub fn begin_a_curve(&self) {
        self.curve_began.store(self.million_steps(), Ordering::Relaxed);
    }

    /// May effects be tried beside it?
    pub fn allows_more_beside_a_curve(&self) -> bool {
        self.allows(self.million_steps() - self.curve_began.load(Ordering::Relaxed) < MOST_OF_A_CURVE)
    }

    fn allows(&self, is_left: bool) -> bool {
        self.is_spent.fetch_or(!is_left, Ordering::Relaxed);
        is_left
    }

    /// What there was, and whether it was used up.
    pub fn effort(&self) -> Effort {
        let reached = self.is_spent.load(Ordering::Relaxed);
        Effort { million_steps: self.million_steps(), million_steps_at_most: MOST_OF_THE_SEARCH, reached }
    }

    fn million_steps(&self) -> u64 {
        (self.tally.steps() - self.before) / 1_000_000
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::problem::{Problem, Start};
    use crate::swing::Swing;
    use shared::parameters::Parameters;

    #[test]
    fn what_is_used_up_is_said_once_something_is_left_out() {
        let (tally, model) = (Tally::default(), Parameters::paper());
        let simulate = |million_steps: usize| tally.add(&model, 1, million_steps * 250_000);
        simulate(7);
        let several = Budget::new(&tally);
        several.keep_for_pairs(true);
        simulate(MOST_OF_THE_SEARCH as usize / 2);
        assert!(
            !several.allows_more() && several.allows_wider_forms(),
            "pairs have their part, of which wider forms may take"
        );
        several.keep_for_pairs(false);
        assert!(several.allows_more());
        let budget = Budget::new(&tally);
        simulate(MOST_OF_THE_SEARCH as usize - 1);
        assert!(budget.allows_more() && !budget.effort().reached);
        simulate(1);
        assert!(!budget.effort().reached, "nothing was left out yet");
        assert!(!budget.allows_more() && budget.effort().reached);
        budget.begin_a_curve();
        simulate(MOST_OF_A_CURVE as usize - 1);
        assert!(budget.allows_more_beside_a_curve());
        simulate(1);
        assert!(!budget.allows_more_beside_a_curve());
    }
    #[test]
    fn many_steps_are_enough_however_little_they_take() {
        let (tally, model) = (Tally::default(), Parameters::paper());
        let budget = Budget::new(&tally);
        let simulate = |million_steps: u64| tally.add(&model, 4, million_steps as usize * 250_000);
        simulate(MOST_TAKEN - 1);
        assert!(budget.allows_more());
        simulate(1);
        assert!(!budget.allows_more() && budget.effort().million_steps < MOST_OF_THE_SEARCH);
    }

    #[test]
    fn a_longer_recording_may_be_simulated_less_often() {
        let steps_of = |seconds: u32| {
            let times_s: Vec<f64> = (0..50 * seconds).map(|i| f64::from(i) * 0.02).collect();
            let angles_rad: Vec<f64> = times_s.iter().map(|t| (6.0 * t).cos() * (-0.01 * t).exp()).collect();
            let swings = [Swing::new("cosine", &times_s, &angles_rad, 1e-3)];
            let tally = Tally::default();
            let problem = Problem::new(&swings, &Parameters::paper(), Vec::new(), &tally);
            problem.predict(0, times_s.len(), &[(&[], Start { angle_rad: 1.0, velocity_rad_s: 0.0, offset_rad: 0.0 })]);
            tally.steps()
        };
        let (short, long) = (steps_of(20), steps_of(200));
        assert!((9 * short..11 * short).contains(&long), "{short} {long}");
    }
}
