//! Something that touched the pendulum on its way: a finger, a cable, a table that was pushed once.
//!
//! In: swings with a fitted model. Out: when the rate jumped, and by how much. Friction and inertia are fitted to all of a
//! swing, so that one jump of 0.02 rad/s moves them by many of their ±, and what is left then looks like missing physics.
//!
//! The scan asks every place of a swing which jump would explain the motion about it best. A model that errs smoothly errs
//! everywhere, and by no single jump. So a touch is a place where a jump is beyond chance, explains most of what is left
//! about it, and stands far out of what the other places of the same swing show. Where that can't be asked, because a swing
//! is short, both its parts must prove it (`proof.rs`), or nothing is said: missing physics that is taken for a touch would be
//! worse than a touch that is missed.

mod proof;
mod scan;

use super::fitted::Fitted;
use super::problem::{Problem, Start};
use crate::cores::on_all_cores;
use crate::number::with_spread;
use crate::swing::Swing;
use scan::{BESIDE, Place, places};
use serde::Serialize;
use shared::parameters::Parameters;
use std::ops::Range;

/// One recording without a touch in a thousand has a jump that chance alone makes, by the bound of Bonferroni. It guards
/// against white noise alone, where half and twice change the limit by 1.4 of some 25.
const ALPHA: f64 = 1e-3;

/// Independent jumps in a half swing: an early one and a late one, which span what a jump can do, each up and down.
const PER_HALF_SWING: f64 = 4.0;

/// A touch explains at least this share of what is left beyond the noise within its window. In 257 recordings of others
/// that are not known to be touched, no place with more stood out of the rest; with 0.5 one would be told. With 0.9 four
/// of 46 bumps of simulated swings are lost, those of 8 to 12 of their ±.
const LEAST_SHARE: f64 = 0.75;

/// It explains so many times as much as any place that has no part in it. Half of it: the largest jump of white noise is 1.5
/// to 3 times the next. Twice: 3 of 45 bumps of simulated swings are lost.
const STANDS_OUT: f64 = 4.0;

/// A push that lasts shows in places so many half swings away: their windows end beside it.
const REACH: usize = BESIDE + 2;

/// With fewer other places nobody knows what is usual in a swing. With twice as many, bumps in swings of less than some 30 half
/// swings are lost; with three the real recordings give no alarm either.
const FEWEST_OTHERS: usize = 4;

/// More touches in one swing are no single ones. Twice was not tried.
const MOST: usize = 3;

/// A jump is known no better than to this share: it is found to first order, and a push that lasts is none. Those of more than
/// 0.1 rad/s in simulated swings are off by 1.7 to 2 % rms. Half and twice state a ± that is so many times too small or large.
const FIRST_ORDER: f64 = 0.02;

/// On either side so much of a half swing is left out, for a push that lasts and a time that is not known better.
const MARGIN: f64 = 0.25;

/// A jump of the rate that gravity and friction do not explain.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Touch {
    /// Name of the recording.
    pub recording: String,
    /// When, s of the recording.
    pub time_s: f64,
    /// By how much the rate jumped, rad/s.
    pub jump_rad_s: f64,
    /// Its standard deviation, rad/s.
    pub std_rad_s: f64,
    /// What to look at alone: the longer of both parts begins here, s of the recording …
    pub from_s: Option<f64>,
    /// … or ends here.
    pub to_s: Option<f64>,
    /// Where the model begins anew behind it, if it was fitted so.
    #[serde(skip)]
    pub anew: Option<Start>,
    /// Which of the swings.
    #[serde(skip)]
    pub swing_idx: usize,
    /// The samples about it that belong to no part.
    #[serde(skip)]
    pub samples: Range<usize>,
}

impl Touch {
    fn of(swing_idx: usize, swing: &Swing, place: &Place) -> Self {
        let margin_s = MARGIN * place.half_swing_s;
        let [before_s, behind_s] = [place.time_s - margin_s, place.time_s + margin_s];
        let index = |time_s: f64| swing.times_s.partition_point(|t| *t < time_s);
        let is_early = place.time_s < 0.5 * swing.duration_s();
        Self {
            recording: swing.name.clone(),
            time_s: swing.from_s + place.time_s,
            jump_rad_s: place.jump_rad_s,
            std_rad_s: place.std_rad_s.hypot(FIRST_ORDER * place.jump_rad_s),
            from_s: is_early.then_some(swing.from_s + behind_s),
            to_s: (!is_early).then_some(swing.from_s + before_s),
            anew: None,
            swing_idx,
            samples: index(before_s)..index(behind_s),
        }
    }

    /// What happened, in words.
    pub fn words(&self) -> String {
        let jump = with_spread(self.jump_rad_s, Some(self.std_rad_s));
        format!(
            "something touched the pendulum at {:.2} s of {}, or its time jumped there: the rate changed at once by {jump} rad/s",
            self.time_s, self.recording
        )
    }

    /// The same as a sentence of its own.
    pub fn sentence(&self) -> String {
        let words = self.words();
        let (first, rest) = words.split_at(1);
        format!("{}{rest}.", first.to_uppercase())
    }

    /// The command that looks at the longer part alone.
    pub fn alone(&self, command: &str) -> String {
        let part = match (self.from_s, self.to_s) {
            (Some(from_s), _) => format!("--from {from_s:.2}"),
            (_, to_s) => format!("--to {:.2}", to_s.unwrap_or(self.time_s)),
        };
        format!("host {command} {} {part}", self.recording)
    }
}

/// What touched the swings of a model, in the order of swings and time. A driven pendulum is pushed all the time.
pub fn touches(swings: &[Swing], parameters: &Parameters<f64>, starts: &[Start]) -> Vec<Touch> {
    let of_swing = |(idx, swing): (usize, &Swing)| -> Vec<Touch> {
        let places = if swing.is_driven { Vec::new() } else { places(swing, parameters, starts[idx]) };
        outstanding(&places).into_iter().map(|at| Touch::of(idx, swing, &places[at])).collect()
    };
    on_all_cores(swings.iter().enumerate(), of_swing).concat()
}

/// The touches of the swings of a fitted model; of short ones one that both parts prove.
pub fn touches_of(on: &Problem, model: &Fitted) -> Vec<Touch> {
    let found = touches(on.swings, &model.parameters, &model.starts);
    if found.is_empty() { proof::proven(on, model).into_iter().collect() } else { found }
}

/// The places, in order, that stand far out of all others; as few as do.
fn outstanding(places: &[Place]) -> Vec<usize> {
    let gain = |at: &usize| places[*at].gain;
    let mut found: Vec<usize> = Vec::new();
    for _ in 0..MOST {
        let largest = others(places, &found).max_by(|a, b| gain(a).total_cmp(&gain(b)));
        let Some(next) = largest.filter(|at| is_a_jump(&places[*at], places.len())) else { break };
        found.push(next);
        let usual = others(places, &found).map(|at| gain(&at)).fold(0.0, f64::max);
        if others(places, &found).count() >= FEWEST_OTHERS && gain(&next) > STANDS_OUT * usual {
            found.sort_unstable();
            return found;
        }
    }
    Vec::new()
}

/// Is it beyond what chance makes of so many places, and does it leave little about it?
fn is_a_jump(place: &Place, n_places: usize) -> bool {
    // With two degrees of freedom, the jump and its time, a chi-square is beyond x by chance e^(−x/2).
    let limit = 2.0 * (PER_HALF_SWING * n_places as f64 / ALPHA).ln();
    place.chi_square > limit && place.share > LEAST_SHARE
}

/// Places that have no part in some touches.
fn others(places: &[Place], touched: &[usize]) -> impl Iterator<Item = usize> {
    let touched = touched.to_vec();
    (0..places.len()).filter(move |at| touched.iter().all(|touch| touch.abs_diff(*at) > REACH))
}

/// The samples of a swing that belong together, before, between and behind its touches.
fn ranges(idx: usize, swing: &Swing, touches: &[Touch]) -> Vec<Range<usize>> {
    let (mut parts, mut from) = (Vec::new(), 0);
    for touch in touches.iter().filter(|touch| touch.swing_idx == idx) {
        parts.push(from..touch.samples.start);
        from = touch.samples.end;
    }
    parts.push(from..swing.len());
    parts
}

/// The parts of all swings, one after the other, each with a start of its own.
pub fn parted(swings: &[Swing], touches: &[Touch]) -> Vec<Swing> {
    let parts = |(idx, swing): (usize, &Swing)| -> Vec<Swing> {
        let ranges = ranges(idx, swing, touches);
        if ranges.len() == 1 {
            vec![swing.clone()]
        } else {
            ranges.into_iter().map(|range| swing.part(range)).collect()
        }
    };
    swings.iter().enumerate().flat_map(parts).collect()
}

/// The longest part of each swing: what one release tells must not become what several do.
pub fn longest(swings: &[Swing], touches: &[Touch]) -> Vec<Swing> {
    let part = |(idx, swing): (usize, &Swing)| {
        let ranges = ranges(idx, swing, touches);
        let longest = ranges.into_iter().max_by_key(Range::len).filter(|range| range.len() < swing.len());
        longest.map_or_else(|| swing.clone(), |range| swing.part(range))
    };
    swings.iter().enumerate().map(part).collect()
}

/// The starts of parts, those behind a touch given to it; left are those of the swings.
pub fn given_back(parts: &[Start], n_swings: usize, touches: &mut [Touch]) -> Vec<Start> {
    let (mut parts, mut starts) = (parts.iter().copied(), Vec::new());
    for swing_idx in 0..n_swings {
        starts.extend(parts.next());
        touches.iter_mut().filter(|touch| touch.swing_idx == swing_idx).for_each(|touch| touch.anew = parts.next());
    }
    starts
}

#[cfg(test)]
mod tests;
