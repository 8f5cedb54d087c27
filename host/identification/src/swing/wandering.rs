//! A zero that wanders: the middle of the swings does not stay where one zero that is off would have it.

use super::Swing;
use crate::recording::turning::{TurningPoint, turning_points};

/// Zeros of several swings, and middles of one, may differ by this share of their mean.
pub(crate) const COMMON: f64 = 0.5;

/// What is said of a swing whose middle does not stay where a zero that is off by so much would have it.
pub fn words(swing: &Swing, off_rad: f64) -> Option<String> {
    let [low_rad, high_rad] = middles_rad(swing)?;
    let moves_rad = high_rad - low_rad;
    if moves_rad < COMMON * off_rad.abs() || moves_rad < MIDDLE_NOISES * swing.noise_rad {
        return None;
    }
    Some(format!(
        "no one zero is right for {}: the middle of its swings wanders between {low_rad:.3} and {high_rad:.3} rad ({:.1} to {:.1}°), \
         as where a hub or a magnet slips, the stand moves, or a wire pulls. Fasten it before host calibrate puts its zero right",
        swing.name,
        low_rad.to_degrees(),
        high_rad.to_degrees()
    ))
}

/// A middle of a swing is known to about a noise of the readings, so that by so many it has moved. Half and twice were not
/// tried.
const MIDDLE_NOISES: f64 = 3.0;

/// A tenth of the middles may lie outside to either side.
const OUTSIDE: f64 = 0.1;

/// Fewer middles wander by chance.
const FEWEST_MIDDLES: usize = 10;

/// Between what most middles of a swing's half swings there and back lie, rad.
fn middles_rad(swing: &Swing) -> Option<[f64; 2]> {
    let turns = turning_points(&swing.times_s, &swing.angles_rad, swing.noise_rad);
    let alternate = |three: &&[TurningPoint]| {
        three[0].is_maximum == three[2].is_maximum && three[0].is_maximum != three[1].is_maximum
    };
    let middle = |three: &[TurningPoint]| 0.25 * (three[0].angle_rad + 2.0 * three[1].angle_rad + three[2].angle_rad);
    let mut middles: Vec<f64> = turns.windows(3).filter(alternate).map(middle).collect();
    middles.sort_by(f64::total_cmp);
    let outside = (OUTSIDE * middles.len() as f64) as usize;
    (middles.len() >= FEWEST_MIDDLES).then(|| [middles[outside], middles[middles.len() - 1 - outside]])
}
