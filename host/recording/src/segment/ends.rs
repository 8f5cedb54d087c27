//! Where a hand lets go or catches, sample by sample: both ends of a free swing must follow from what lies between them.
//!
//! In: a free swing by its accelerations. Out: the samples of it that follow. A hand that pushes gently before it opens, or that
//! carries on what it catches, is lost in accelerations for up to a swing. As in [`backwards`](super::backwards) a law is fitted to
//! two swings and followed outward through the half swings that are doubted. What the law does not know of the pendulum
//! leads astray by and by, and in other half swings too; a hand does from one moment on.

use super::super::{Measured, median};
use super::Cut;
use super::backwards::{FEWEST_USUAL, FITTED, MOST_USUAL, Off};
use std::ops::Range;

// Tried on 167 simulated recordings with hands whose moves are known, of which 19 ends are cut here, all within 40 ms of where the hand
// took it and two of them more than 20 ms on its side, and on 911 files of strangers, of which six are, rightly as far as can be seen.

/// Turning points between the fitted half swings and the end that is doubted. Half and twice were not tried.
const DOUBTED: usize = 2;

/// Of so few steps of the sensor nobody can tell a hand from the dry friction that ends a swing. Half of it would do for the
/// recording that comes to rest in steps of 0.1° for which it was made; twice was not tried.
const FEWEST_STEPS: f64 = 10.0;

/// A hand moves it off by so many times what is usual at most as far outside of other half swings: with half of it 33 ends are cut,
/// eight of them at a wrong place, and 21 of strangers; with twice of it 14 and 3 …
const OFF_TIMES: f64 = 3.0;

/// … by this share of the amplitude: half and twice tell the same …
const OFF_SHARE: f64 = 0.005;

/// … and so many of the samples from there to the end are as far off. With half of it 11 of strangers are cut, with nearly all 18
/// and 6.
const STAYS_OFF: f64 = 0.75;

/// It is free as long as it is off to the other side, or by no more than this share of what is usual at most. Half of it cuts 18 and
/// 5, twice of it the same.
const QUIET: f64 = 0.33;

/// A hand takes it from there to where it is seen within this share of a half swing: with half of it 18 and 3 are cut, with twice
/// of it 22, four of them at a wrong place, and 10 of strangers …
const SUDDEN: f64 = 0.25;

/// … and until there it was off by no more than so many times what is usual at most. With half of it none are cut, with twice of it
/// 24, six of them at a wrong place, and 9 of strangers.
const CALM: f64 = 1.5;

impl Cut<'_> {
    /// The part of a free swing behind the hand at its beginning and before the one at its end, where these are doubted.
    pub(super) fn between_hands(&self, free: Range<usize>, is_doubted: [bool; 2]) -> Range<usize> {
        if self.recording.measured() == Measured::Rate || self.states.is_empty() || free.is_empty() {
            return free;
        }
        let index_of = |turn: &crate::turning::TurningPoint| self.recording.index_at(turn.time_s);
        let inward: Vec<usize> = self.turns_in(&free).into_iter().map(index_of).collect();
        let outward: Vec<usize> = inward.iter().rev().copied().collect();
        let [start, last] =
            [(inward, free.start), (outward, free.end - 1)].map(|(turned, end)| self.left_at(&turned, end));
        let start = start.filter(|_| is_doubted[0]).unwrap_or(free.start);
        let end = last.filter(|_| is_doubted[1]).map_or(free.end, |last| last + 1);
        start..end.max(start)
    }

    /// The last sample on the way to an end before something moves it, if something does; turning points from the end inward.
    fn left_at(&self, turned: &[usize], end: usize) -> Option<usize> {
        let origin = *turned.get(DOUBTED)?;
        let step_rad = self.whole_noise.lsb.unwrap_or(0.0);
        if self.amplitude_rad(self.times_s()[origin]) < FEWEST_STEPS * step_rad {
            return None;
        }
        let reach_s = self.times_s()[end] - self.times_s()[origin];
        let off = self.off_from(origin, *turned.get(DOUBTED + FITTED)?, end)?;
        let as_far = |look: usize| {
            let (from, far) = (*turned.get(look)?, *turned.get(look + FITTED)?);
            self.off_from(from, far, self.index_within(self.times_s()[from] + reach_s)?)
        };
        // Those that begin farther inward do not reach what is doubted.
        let usual: Vec<Vec<Off>> = (2 * DOUBTED + 1..turned.len()).map_while(as_far).take(MOST_USUAL).collect();
        if usual.len() < FEWEST_USUAL {
            return None;
        }
        let usual_rad = median(&mut usual.iter().map(|off| largest(off)).collect::<Vec<f64>>());
        let limit_rad = (OFF_TIMES * usual_rad).max(OFF_SHARE * self.amplitude_rad(self.times_s()[origin]));
        let seen = seen_from(&off, limit_rad)?;
        let side = off[seen].1.signum();
        let free = off[..seen].iter().rposition(|(_, off)| side * off < QUIET * usual_rad)?;
        let took_s = (self.times_s()[off[seen].0] - self.times_s()[off[free].0]).abs();
        let is_hand = took_s < SUDDEN * self.half_swing_s && largest(&off[..free]) < CALM * usual_rad;
        is_hand.then_some(off[free].0)
    }
}

fn largest(off: &[Off]) -> f64 {
    off.iter().fold(0.0, |largest, (_, off)| largest.max(off.abs()))
}

/// From where on it is off for good.
fn seen_from(off: &[Off], limit_rad: f64) -> Option<usize> {
    let is_off = |idx: &usize| off[*idx].1.abs() > limit_rad;
    let stays = |from: &usize| {
        let n_off = (*from..off.len()).filter(is_off).count();
        n_off as f64 > STAYS_OFF * (off.len() - from) as f64
    };
    (0..off.len()).filter(is_off).find(stays)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{STEP_S, find, moved_swing};

    /// Before it opens, a hand moves it so far within 0.15 s, ever faster.
    fn pushed(to_rad: f64) -> Vec<f64> {
        let share = |idx: i32| (f64::from(idx) / 30.0).powi(3);
        let speed_rad_s = to_rad * 3.0 / 0.15;
        let push = (0..30).map(|idx| 0.8 + to_rad * share(idx));
        let free = moved_swing(0.8 + to_rad, 20.0, |time_s| if time_s == 0.0 { speed_rad_s / 1e-4 } else { 0.0 });
        [vec![0.8; 200], push.collect(), free].concat()
    }

    #[test]
    fn a_hand_that_pushes_before_it_opens_is_no_swing() {
        let let_go = 230;
        for to_rad in [-0.01, 0.005, 0.01, 0.02] {
            let segments = find(&pushed(to_rad));
            let late_s = (segments.free.start as f64 - f64::from(let_go)) * STEP_S;
            assert!((-0.016..0.06).contains(&late_s), "{to_rad} {late_s} {segments:?}");
            assert!(segments.notes[0].contains("held still before the release"), "{:?}", segments.notes);
        }
    }

    /// Caught while it moves, and carried on to where it is held.
    fn caught(after: usize, to_rad: f64) -> Vec<f64> {
        let mut angles_rad = moved_swing(0.8, 30.0, |_| 0.0)[..after].to_vec();
        let (from_rad, n) = (angles_rad[after - 1], 160);
        let speed_rad = angles_rad[after - 1] - angles_rad[after - 2];
        // A cubic that begins with its speed and ends at rest.
        let carried = |idx: usize| {
            let s = idx as f64 / n as f64;
            let way = to_rad - from_rad;
            from_rad + n as f64 * speed_rad * s * (1.0 - s).powi(2) + way * s * s * (3.0 - 2.0 * s)
        };
        angles_rad.extend((1..=n).map(carried));
        angles_rad.extend([to_rad; 100]);
        angles_rad
    }

    #[test]
    fn a_hand_that_carries_on_what_it_catches_ends_the_swing() {
        for after in [2000, 2021, 2043, 2066, 2088] {
            for to_rad in [-0.5, 0.5] {
                let segments = find(&caught(after, to_rad));
                let late_s = (segments.free.end as f64 - after as f64) * STEP_S;
                assert!((-0.3..0.1).contains(&late_s), "{after} {to_rad} {late_s} {segments:?}");
            }
        }
    }

    /// A swing in air that takes much of the large ones, of which the law knows nothing.
    fn in_air(angle_rad: f64, drag: f64) -> Vec<f64> {
        let (mut angle, mut velocity) = (angle_rad, 0.0_f64);
        let step = |idx: usize| {
            let before = angle;
            velocity -= 1e-4 * (70.0 * angle.sin() + 0.1 * velocity.signum() + drag * velocity * velocity.abs());
            angle += 1e-4 * velocity;
            idx.is_multiple_of(50).then_some(before)
        };
        (0..150_000).filter_map(step).collect()
    }

    /// What the crude law lacks leads it astray, but not at once; twice the largest drag here costs a swing of 1.6 rad 0.3 s.
    #[test]
    fn what_no_hand_moves_is_free_from_its_beginning() {
        for angle_rad in [1.0, 1.3, 1.6, 1.9] {
            for drag in [0.05, 0.1] {
                assert_eq!(find(&in_air(angle_rad, drag)).free.start, 0, "{angle_rad} {drag}");
            }
        }
    }
}
