//! Readings that repeat the one before while the swing goes on: a tracker lost what it followed, wrote its last place on
//! until it had it again, and then made up for all that at once.
//!
//! In: times and readings in any unit. Out: which readings to leave out, as gaps. Of a sensor whose steps are far below its
//! noise, [`straight`](super::straight) tells the same of any exact line; this holds for one in whole tenths of a degree too.

use super::noise::smallest_step;
use super::places::Places;
use super::spikes::{LEAST_SHARE, range};
use super::{GAP_STEPS, median_step_s};

/// It makes up for it with so many times what the fastest steps are, beyond what rounding makes of one. Half of it would take
/// every step behind a turning point of a coarse sensor for it; with twice of it a loss of two frames where it is fastest is
/// none. Looked at on 1,146 files of strangers, of which seven have such places.
const MADE_UP: f64 = 1.5;

/// … after so many readings that repeat one, at least: chance repeats one where it turns.
const FEWEST_REPEATS: usize = 2;

/// The fastest among so many moves on either side: they span a swing or more of a video, and of a fast encoder the moves beside
/// it are as fast as itself.
const MOVES_BESIDE: usize = 50;

/// Which readings repeat the one before while the swing goes on: the last place of a tracker that lost it.
pub(super) fn frozen(times: &[f64], readings: &[f64]) -> Vec<bool> {
    let steps = readings.windows(2).map(|pair| (pair[1] - pair[0]).abs()).enumerate();
    let moves: Vec<(usize, f64)> = steps.filter(|(_, step)| *step > 0.0).collect();
    let mut is_frozen = vec![false; readings.len()];
    if moves.len() < 2 * MOVES_BESIDE {
        return is_frozen;
    }
    let median_s = median_step_s(times);
    let lines = 2.0 * smallest_step(readings).unwrap_or(0.0);
    let least = LEAST_SHARE * range(readings);
    for (place, pair) in moves.windows(2).enumerate() {
        let [(before_idx, before), (idx, step)] = [pair[0], pair[1]];
        // Rows that are missing make a long step too.
        let is_whole = times[idx + 1] - times[idx] <= GAP_STEPS * median_s;
        if idx - before_idx <= FEWEST_REPEATS || step <= least || !is_whole {
            continue;
        }
        let usual = MADE_UP * fastest_beside(&moves, place + 1) + lines;
        // A loss that a bus fills with one value begins with a long step, and is a jump out of the swing and back.
        if before < usual && step > usual {
            // What stands at the begin is true.
            is_frozen[before_idx + 2..=idx].fill(true);
        }
    }
    is_frozen
}

/// What all but the fastest tenth of the moves beside one do not exceed.
fn fastest_beside(moves: &[(usize, f64)], place: usize) -> f64 {
    let near = place.saturating_sub(MOVES_BESIDE)..(place + MOVES_BESIDE).min(moves.len());
    let mut sizes: Vec<f64> = moves[near].iter().map(|(_, step)| *step).collect();
    let tenth = sizes.len() * 9 / 10;
    *sizes.select_nth_unstable_by(tenth, f64::total_cmp).1
}

/// What is said of them.
pub(super) fn note(is_frozen: &[bool], times_s: &[f64]) -> Option<String> {
    let places = Places::of(is_frozen)?;
    Some(format!(
        "{} readings repeat the one before at {} while the swing goes on, at {:.3} s{}, as when a tracker loses it: left out \
         as {}",
        places.n_rows,
        if places.n == 1 { "1 place".to_owned() } else { format!("{} places", places.n) },
        times_s[places.first_idx],
        if places.n == 1 { "" } else { " first" },
        places.as_gaps()
    ))
}

#[cfg(test)]
mod tests {
    use super::super::spikes::tests::swing;
    use super::*;

    #[test]
    fn a_tracker_that_writes_its_last_place_on_is_seen_when_it_makes_up_for_it_and_no_coarse_sensor() {
        let (times, mut readings) = swing();
        let rounded =
            |lines: f64| times.iter().map(|t| ((-t / 15.0).exp() * (6.3 * t).cos() * lines).round()).collect();
        let held = |every: usize| (0..1200).map(|idx| (6.3 * times[idx - idx % every]).cos()).collect();
        let stopped: Vec<f64> = readings.iter().map(|y| y.min(0.6)).collect();
        let let_go = readings.iter().enumerate().map(|(idx, y)| if idx < 60 { readings[60] } else { *y }).collect();
        let cases: [Vec<f64>; 7] = [rounded(4.0), rounded(10.0), rounded(100.0), held(3), held(10), stopped, let_go];
        for (case, coarse) in cases.iter().enumerate() {
            assert!(frozen(&times, coarse).iter().all(|is_frozen| !is_frozen), "{case}");
        }
        let lost = [101..108, 334..338, 641..655];
        for range in &lost {
            let last_seen = readings[range.start - 1];
            readings[range.clone()].fill(last_seen);
        }
        readings[900..904].fill(2.5);
        let found = frozen(&times, &readings);
        let found: Vec<usize> = (0..found.len()).filter(|idx| found[*idx]).collect();
        assert_eq!(found, lost.into_iter().flatten().collect::<Vec<_>>());
    }
}
