//! Did the sensor's zero move where the readings step?
//!
//! A clock that loses samples makes a step too, up on the way up and down on the way down; the middle between the turns stays
//! where it is. The middle between the turns before and behind a zero that moved, as when a hub, a wiper or a magnet slips, differs
//! by the step itself.

use super::turning::TurningPoint;

/// The middle moved if it did by more than this share of the step. It is all of it where the zero moved and none where it did not.
const MOVED: f64 = 0.5;

/// Does the middle of the swing move with a step of the readings at a time? Not where fewer than three turns are on either side.
pub(super) fn moves_the_middle(turns: &[TurningPoint], time_s: f64, step: f64) -> bool {
    let behind = turns.partition_point(|turn| turn.time_s <= time_s);
    let (before, after) = turns.split_at(behind);
    let [.., a, b, c] = before else { return false };
    let [d, e, f, ..] = after else { return false };
    (middle([d, e, f]) - middle([a, b, c])) / step > MOVED
}

/// Of a swing that becomes smaller evenly.
fn middle([one, two, three]: [&TurningPoint; 3]) -> f64 {
    (one.angle_rad + 2.0 * two.angle_rad + three.angle_rad) / 4.0
}

/// What is said of it.
pub(super) fn note(times_s: &[f64]) -> Option<String> {
    let first_s = times_s.first()?;
    let places = if times_s.len() == 1 { String::new() } else { format!(" and at {} more places", times_s.len() - 1) };
    Some(format!(
        "doubtful: the readings jump at {first_s:.2} s{places}, and the middle of the swing with them: the sensor's zero moved, as \
         when a hub, a wiper or a magnet slips; fasten it, or choose a stretch without with --from and --to"
    ))
}
