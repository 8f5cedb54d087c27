//! Where a model that does not follow a swing at all follows it from: a hand may lift the pendulum and lower it, in so few
//! readings that nothing tells the hand from the swing.
//!
//! It is fitted anew from the first turning points behind a thirty-second, a sixteenth … a half of the swing, the longest part
//! first, until one is followed.

use super::by_least_squares::fitted_as_it_is;
use super::of_rig::problem_of;
use super::tally::Tally;
use super::tolerance::KnownRig;
use crate::recording::turning::turning_points;
use crate::swing::Swing;

/// Shares of the swing that are left out, the smallest first.
const LEFT_OUT: [f64; 5] = [1.0 / 32.0, 1.0 / 16.0, 0.125, 0.25, 0.5];

/// Less than this share of the readings, root mean square, is left where a part is followed: a tenth of their squares, as of
/// a reason why a model does not fit at all.
const MOST_LEFT: f64 = 0.32;

/// On the clock of the recording (s), from when on the only swing is followed, if it is from a later start.
pub(super) fn follows_from_s(swings: &[Swing], rig: KnownRig<'_>) -> Option<f64> {
    let [swing] = swings else { return None };
    let turns_s: Vec<f64> = turning_points(&swing.times_s, &swing.angles_rad, swing.noise_rad)
        .into_iter()
        .map(|turn| turn.time_s)
        .collect();
    let behind = |share: f64| turns_s.iter().copied().find(|turn_s| *turn_s > share * swing.duration_s());
    let mut starts_s: Vec<f64> = LEFT_OUT.into_iter().filter_map(behind).collect();
    starts_s.dedup();
    let part = |start_s: f64| swing.part(swing.times_s.partition_point(|t| *t < start_s)..swing.len());
    let is_long = |part: &Swing| turns_s.iter().filter(|turn_s| **turn_s >= part.begins_s).count() >= FEWEST_TURNS;
    let begins_well = |part: &Swing| {
        let end_s = turns_s.iter().copied().filter(|turn_s| *turn_s >= part.begins_s).nth(GLANCE_TURNS);
        let first = end_s.map(|end_s| part.part(0..part.times_s.partition_point(|t| part.begins_s + t < end_s)));
        first.is_none_or(|first| is_followed(&first, rig))
    };
    let mut parts = starts_s.into_iter().map(part).filter(is_long);
    let found = parts.find(|part| begins_well(part) && is_followed(part, rig));
    found.map(|part| part.from_s)
}

/// What is not followed over so many turning points is not over more of them, which take longer to try: a sensor at rest, shaken
/// 2,000 times, is refused after 9.3 s of computing instead of 14.7. Half and twice were not tried.
const GLANCE_TURNS: usize = 24;

/// Fewer turning points any model follows.
const FEWEST_TURNS: usize = 6;

fn is_followed(part: &Swing, rig: KnownRig<'_>) -> bool {
    let count = Tally::default();
    let problem = problem_of(std::slice::from_ref(part), rig, &count);
    problem.share_of_motion(fitted_as_it_is(&problem).cost) < MOST_LEFT
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnose::tests::{rig, simulated};

    /// A hand lifts it to where it lets go, slowly, and a free swing begins.
    fn lifted(lift_s: f64) -> Swing {
        let free = simulated("lifted", &rig(), 12.0, 1).thinned(20.0);
        let step_s = free.times_s[1];
        let n_lifted = (lift_s / step_s) as usize;
        let lift = |i: usize| free.angles_rad[0] * i as f64 / n_lifted as f64;
        let angles_rad: Vec<f64> = (0..n_lifted).map(lift).chain(free.angles_rad.iter().copied()).collect();
        let times_s: Vec<f64> = (0..angles_rad.len()).map(|i| 5.0 + i as f64 * step_s).collect();
        Swing::new("lifted", &times_s, &angles_rad, free.noise_rad)
    }

    #[test]
    fn behind_a_hand_that_lifts_it_a_swing_is_followed() {
        let rig = rig();
        let from_s = follows_from_s(&[lifted(2.5)], (&rig).into()).unwrap();
        // Let go at 7.5 s of a clock that begins at 5 s; a turning point is seen to a few readings.
        assert!((7.4..9.5).contains(&from_s), "{from_s}");
    }

    #[test]
    fn of_what_is_nowhere_followed_nothing_is_said() {
        let rig = rig();
        let free = lifted(0.0);
        let steps: Vec<f64> = free.times_s.iter().map(|t| (t * t * 1.7).sin()).collect();
        let chirp = Swing::new("chirp", &free.times_s, &steps, free.noise_rad);
        assert_eq!(follows_from_s(&[chirp], (&rig).into()), None);
    }
}
