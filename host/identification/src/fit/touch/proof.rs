//! A touch of a short swing, proven by both its parts.
//!
//! In a short swing a touch spoils the model everywhere, and no place stands far out of the others. But without it the swing is
//! two, which the same numbers and another start explain down to the noise. What a law lacks stays in both parts.

use super::scan::{Place, places};
use super::{Touch, is_a_jump, parted};
use crate::fit::by_least_squares::fitted_as_it_is;
use crate::fit::fitted::Fitted;
use crate::fit::problem::Problem;
use crate::verdict::Left;

/// So many times the variance of the noise must be left of a swing that is taken for two: less might be brought down to the
/// noise by the three numbers of another start. Half and twice were not tried.
const LEAST_LEFT: f64 = 4.0;

/// Longer swings show what is usual in them. Half and twice were not tried.
const MOST_PLACES: usize = 32;

/// A part has so many half swings at least, so that its start is not all that it tells.
const FEWEST_HALF_SWINGS: f64 = 5.0;

/// So many places, those that explain most, are tried.
const TRIED: usize = 3;

/// The touch of one short swing without which the base model explains the swings.
pub(super) fn proven(on: &Problem, model: &Fitted) -> Option<Touch> {
    if on.chi_square(model.cost).reduced < LEAST_LEFT {
        return None;
    }
    let mut tried: Vec<(usize, Place)> = Vec::new();
    for (idx, swing) in on.swings.iter().enumerate().filter(|(_, swing)| !swing.is_driven) {
        let places = places(swing, &model.parameters, model.starts[idx]);
        let is_inside = |place: &&Place| {
            let [before_s, behind_s] = [place.time_s, swing.duration_s() - place.time_s];
            before_s.min(behind_s) > FEWEST_HALF_SWINGS * place.half_swing_s
        };
        let jumps = places.iter().filter(|place| places.len() <= MOST_PLACES && is_a_jump(place, places.len()));
        tried.extend(jumps.filter(is_inside).map(|place| (idx, *place)));
    }
    tried.sort_by(|a, b| b.1.gain.total_cmp(&a.1.gain));
    tried.iter().take(TRIED).find_map(|(idx, place)| {
        let touch = Touch::of(*idx, &on.swings[*idx], place);
        is_explained_in_parts(on, &touch).then_some(touch)
    })
}

fn is_explained_in_parts(on: &Problem, touch: &Touch) -> bool {
    let parts = parted(on.swings, std::slice::from_ref(touch));
    let problem = on.on(&parts);
    problem.chi_square(fitted_as_it_is(&problem).cost).left() == Left::Noise
}
