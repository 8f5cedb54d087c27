//! Did the sensor's zero move while it swung? Between two readings a tracker, a hub or a magnet may slip by less than anything
//! that looks like a hand; the middle between the turns tells it, because it stays where it moved to.

use super::super::median;
use super::super::number::significant;
use super::Cut;
use super::half_swing::HalfSwing;
use std::ops::Range;

/// Middles before and behind a place that are compared: an eighth of all, so that there is an elsewhere to compare with …
const BESIDE_SHARE: usize = 8;

/// … so many at least, or nothing is said: with fewer it was said of seven of 363 recordings, whose middles wander …
const FEWEST_BESIDE: usize = 6;

/// … and so many at most. Half and twice of neither were tried.
const MOST_BESIDE: usize = 40;

/// There the middle moves by so many times what it moves by anywhere else, or it drifts. Half and twice were not tried.
const TIMES: f64 = 4.0;

/// … by so many noises (rms) of a reading …
const NOISES: f64 = 3.0;

/// … and by this share of the amplitude there: less is lost in what else a model leaves. Half and twice were not tried.
const SHARE: f64 = 0.02;

impl Cut<'_> {
    /// When (s) and by how much (rad) the middle of the swing moved once and for all, if it did.
    fn moved_middle(&self, free: &Range<usize>) -> Option<(f64, f64)> {
        let half_swings = self.half_swings_in(free);
        // A hole may hide where it turned.
        let is_one = |pair: &&[HalfSwing]| pair[0][1].time_s == pair[1][0].time_s;
        let swings: Vec<&[HalfSwing]> = half_swings.windows(2).filter(is_one).collect();
        let middles: Vec<f64> = swings.iter().map(|swing| middle(swing)).collect();
        let beside = Some((middles.len() / BESIDE_SHARE).min(MOST_BESIDE)).filter(|beside| *beside >= FEWEST_BESIDE)?;
        let of = |range: Range<usize>| median(&mut middles[range].to_vec());
        let moves: Vec<f64> = (beside..(middles.len() + 1).saturating_sub(beside))
            .map(|at| of(at..at + beside) - of(at - beside..at))
            .collect();
        let most = (0..moves.len()).max_by(|a, b| moves[*a].abs().total_cmp(&moves[*b].abs()))?;
        let elsewhere = (0..moves.len()).filter(|at| at.abs_diff(most) > 2 * beside).map(|at| moves[at].abs());
        let usual_rad = elsewhere.reduce(f64::max)?;
        let [from, to] = swings[most + beside][0];
        let amplitude_rad = (to.angle_rad - from.angle_rad).abs() / 2.0;
        let least_rad = (TIMES * usual_rad).max(NOISES * self.noise_rms_rad).max(SHARE * amplitude_rad);
        let is_sure = moves[most].abs() > least_rad;
        is_sure.then(|| (from.time_s, moves[most]))
    }

    /// That it did, and what to do.
    pub(super) fn moved_in_words(&self, free: &Range<usize>) -> Option<String> {
        let (time_s, moved_rad) = self.moved_middle(free)?;
        Some(format!(
            "doubtful: the middle of the swing moves by {} {} at {time_s:.1} s and stays there: the sensor's zero moved, as when \
             a hub, a magnet, a camera or what is tracked slips; fasten it, or take one part, --to {time_s:.1} or --from {time_s:.1}",
            significant(1e3 * moved_rad, 2),
            self.recording.measured().milli_unit()
        ))
    }
}

/// Of a half swing to one side and the one back, rad, which become smaller evenly.
fn middle(swing: &[HalfSwing]) -> f64 {
    let [before, turn, after] = [swing[0][0], swing[0][1], swing[1][1]].map(|turn| turn.angle_rad);
    (before + 2.0 * turn + after) / 4.0
}

#[cfg(test)]
mod tests {
    use super::super::tests::{STEP_S, moved_swing, noisy};
    use super::super::{Recording, SegmentOptions, segment};

    fn told(zero_rad: impl Fn(f64) -> f64) -> Option<String> {
        of_scale(1.0, zero_rad)
    }

    fn of_scale(scale: f64, zero_rad: impl Fn(f64) -> f64) -> Option<String> {
        let free = moved_swing(1.5, 40.0, |_| 0.0);
        let moved = |(idx, angle): (usize, &f64)| angle + zero_rad(idx as f64 * STEP_S);
        let seen = noisy(&free.iter().enumerate().map(moved).collect::<Vec<f64>>());
        let angles_rad = seen.angles_rad().iter().map(|angle| scale * angle).collect();
        let found =
            segment(&Recording::uniform(1.0 / STEP_S, angles_rad).unwrap(), &SegmentOptions::default()).unwrap();
        found.notes.into_iter().find(|note| note.contains("the middle of the swing moves"))
    }

    #[test]
    fn a_zero_that_moves_once_is_told_with_the_time_and_one_that_drifts_is_not() {
        // Over some readings, as where a tracker's point creeps along an edge.
        let said = told(|time_s| 0.02 * ((time_s - 9.0) / 0.4).clamp(0.0, 1.0)).unwrap();
        let time_s: f64 = said.split(" at ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        assert!((time_s - 9.1).abs() < 0.6 && said.contains("by 2"), "{said}");
        // Where degrees were taken for radians or the other way round, they are small and no zero.
        let small = of_scale(0.01, |time_s| 0.02 * ((time_s - 9.0) / 0.4).clamp(0.0, 1.0)).unwrap();
        assert!(small.contains("by 0.2"), "{small}");
        assert_eq!([told(|_| 0.0), told(|time_s| 3e-3 * time_s), told(|_| 0.05)], [None, None, None]);
    }
}
