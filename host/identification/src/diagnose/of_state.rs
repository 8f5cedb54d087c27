//! Does what nothing explains follow angle and speed? Then a law of the motion is missing; else it is the clock, the camera, the
//! sensor, play, something else that moves or changes in time, or a law that is too narrow for the grid.
//!
//! [`crate::fit::free_torque`] says how much a free torque of angle and speed would remove on parts of the swings that
//! it was not fitted to, and how much the same as an error of the readings. Within one release, and within releases of
//! one size, time goes by as the amplitude falls, so that state and time can't be told apart.

use super::curve::FrictionCurve;
use super::verdict::Judge;
use crate::fit::descent::Tolerance;
use crate::fit::fitted::Fitted;
use crate::fit::free_torque::{FreeTorque, free_torque};
use crate::fit::refine::Band;
use crate::recording::Measured;
use crate::swing::Swing;
use crate::verdict::Left;
use serde::Serialize;
use shared::effect::Effect;
use std::ops::RangeInclusive;

/// A torque that removes this share is a law …
///
/// Measured on simulated rigs around their base model, at seven to nine seeds of each kind: of 116 that hide a law, 108
/// were above it and 1 below [`IS_NONE`]; of 36 whose clock loses time, whose sensor has play, or whose friction differs
/// between releases or ages over several, none was above it and 34 below. With half of it 10 of these 36 would be laws;
/// at 0.9 there would be 10 laws fewer.
pub(super) const IS_LAW: f64 = 0.75;

/// … and one that removes less than this is none. With half of it 17 of the 36 would be none; at 0.75 so would 8 laws.
pub(super) const IS_NONE: f64 = 0.5;

/// An error of the readings explains as much as a torque does if it leaves at most so many times as much, and this much
/// more of the whole. Of 27 uneven scales and cameras all were so, of 26 springs, which a scale may imitate, 24, and of
/// 82 laws of friction 2. With half of both: 26, 18 and 0; with twice of both: 27, 26 and 8.
const LEAVES_TIMES: f64 = 2.0;
const LEAVES_MORE: f64 = 0.03;

/// By how many times the sizes of two releases differ where they tell state from time. Measured on friction that ages:
/// of releases of one size it was called a law in 4 of 4 cases, of 1.15 times the size in 1 of 4, of 1.3 and 1.6 in
/// none of 8; of twice the size in 1 and of 3 times in 3 of 4, as the smaller one then meets the larger one's end only.
const SIZES_DIFFER: RangeInclusive<f64> = 1.2..=1.8;

/// What is left, by what it follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// A torque of angle and speed.
    Law,
    /// Angle and speed, as a torque or as an uneven scale of the sensor or the camera.
    LawOrScale,
    /// Neither angle nor speed, as far as a law of them is wide enough for the grid.
    Elsewhere,
    /// Can't be told.
    Undecided,
}

/// An effect that only pictures have, and that would explain what is left.
#[derive(Clone, Debug, Serialize)]
pub struct OfPictures {
    /// The effect.
    pub effect: &'static str,
    /// Root mean square error with it, rad.
    pub rmse: f64,
}

/// What is left, split.
#[derive(Clone, Debug, Serialize)]
pub struct OfState {
    /// What it follows.
    pub kind: Kind,
    /// That for a person.
    pub words: String,
    /// Share of the excess over the noise, as a variance, that a free torque of angle and speed removes on blocks that
    /// it was not fitted to.
    pub torque_removes: f64,
    /// The same of a free error of the readings.
    pub reading_removes: f64,
    /// The same of a clock that goes wrong alike in each release; `None` of one release, and of rates.
    pub clock_removes: Option<f64>,
    /// How far apart the knots of the free torque are: along the angle, rad, and along the speed, rad/s.
    #[serde(skip)]
    pub(super) widths: [f64; 2],
    /// How many blocks there were, every third of which was left out at a time.
    pub blocks: usize,
    /// How many releases there were.
    pub releases: usize,
    /// Are there releases of several sizes, so that a law of the motion differs from one of time?
    pub time_differs: bool,
    /// Does a pendulum at rest tell how large the noise is?
    #[serde(skip)]
    pub(super) rest_is_seen: bool,
    /// What it is left of: the friction curve where there is one, else what is claimed.
    pub beside_curve: bool,
    /// What explains it if the readings come from pictures; `None` where nothing does.
    pub of_pictures: Option<OfPictures>,
}

impl Kind {
    fn of(FreeTorque { as_torque, as_reading, .. }: &FreeTorque) -> Self {
        let is_scale = removes_as_much(*as_reading, *as_torque);
        match *as_torque {
            share if share < IS_NONE => Self::Elsewhere,
            share if share < IS_LAW => Self::Undecided,
            _ if is_scale => Self::LawOrScale,
            _ => Self::Law,
        }
    }
}

impl OfState {
    fn new(found: &FreeTorque, swings: &[Swing], beside_curve: bool) -> Self {
        let mut own = Self {
            kind: Kind::of(found),
            words: String::new(),
            torque_removes: found.as_torque,
            reading_removes: found.as_reading,
            clock_removes: found.as_clock,
            widths: found.widths,
            blocks: found.n_blocks,
            releases: swings.len(),
            time_differs: sizes_differ(swings),
            rest_is_seen: swings.iter().any(Swing::comes_to_rest),
            beside_curve,
            of_pictures: None,
        };
        own.words = own.in_words();
        own
    }
}

impl Judge<'_, '_> {
    /// Of what the friction curve leaves, or else the claimed model.
    pub(super) fn of_state(&self, claimed: &Fitted, curve: Option<&FrictionCurve>) -> Option<OfState> {
        let swings = self.problem.swings;
        let model = curve.map_or(claimed, |curve| &curve.model);
        if self.problem.chi_square(model.cost).left() != Left::Missing || !Swing::driven(swings).is_empty() {
            return None;
        }
        let found = OfState::new(&free_torque(self.rough, model)?, swings, curve.is_some());
        Some(if found.kind == Kind::LawOrScale { found.with_pictures(self.of_pictures(model)) } else { found })
    }

    /// The effect of pictures that leaves no more than about the noise beside a model.
    fn of_pictures(&self, model: &Fitted) -> Option<OfPictures> {
        let problem = self.problem;
        if problem.swings.iter().any(|swing| swing.measured == Measured::Rate) {
            return None;
        }
        let with = |effect: &'static Effect<f64>| {
            let larger = model.with(effect, &effect.starts[0])?.refined(problem, Band::Held, Tolerance::JUDGE);
            let is_explained = problem.chi_square(larger.cost).left() != Left::Missing;
            is_explained.then(|| OfPictures { effect: effect.name, rmse: problem.rmse_rad(larger.cost) })
        };
        Effect::with(|rules| rules.is_of_pictures).filter_map(with).min_by(|a, b| a.rmse.total_cmp(&b.rmse))
    }
}

/// Does something else remove about as large a share as a torque does?
pub(super) fn removes_as_much(share: f64, as_torque: f64) -> bool {
    1.0 - share < LEAVES_TIMES * (1.0 - as_torque).max(0.0) + LEAVES_MORE
}

/// Are there two of sizes that differ enough, and not too much?
fn sizes_differ(swings: &[Swing]) -> bool {
    let sizes: Vec<f64> = swings.iter().map(Swing::largest_rad).collect();
    sizes.iter().any(|one| sizes.iter().any(|other| SIZES_DIFFER.contains(&(one / other))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rest_rules_noise_out_that_neighbours_share() {
        let times_s: Vec<f64> = (0..2000).map(|i| 0.02 * f64::from(i)).collect();
        let angles: Vec<f64> =
            times_s.iter().map(|time_s| (1.0 - time_s / 20.0).max(0.0) * (6.0 * time_s).cos()).collect();
        let found = FreeTorque { as_torque: -0.1, as_reading: -0.2, as_clock: None, n_blocks: 20, widths: [0.3, 2.0] };
        let split = OfState::new(&found, &[Swing::new("", &times_s, &angles, 1e-3)], false);
        assert!(split.rest_is_seen && !split.words.contains("neighbouring"), "{}", split.words);
    }

    fn said(as_torque: f64, as_reading: f64, releases_rad: &[f64]) -> OfState {
        let times_s: Vec<f64> = (0..200).map(|i| 0.02 * f64::from(i)).collect();
        let swing = |size: &f64| {
            let angles: Vec<f64> = times_s.iter().map(|time_s| size * (6.0 * time_s).cos()).collect();
            Swing::new("", &times_s, &angles, 1e-3)
        };
        let swings: Vec<Swing> = releases_rad.iter().map(swing).collect();
        let found = FreeTorque { as_torque, as_reading, as_clock: None, n_blocks: 20, widths: [0.3, 2.0] };
        OfState::new(&found, &swings, false)
    }

    #[test]
    fn a_clock_is_told_where_it_does_as_well_as_a_law_and_where_no_law_does() {
        let words = |as_torque: f64, as_clock: f64| {
            let law = said(as_torque, 0.3, &[1.2, 0.8]);
            OfState { clock_removes: Some(as_clock), ..law }.in_words()
        };
        assert!(words(0.9, 0.95).contains("So would a clock"), "{}", words(0.9, 0.95));
        assert!(!words(0.9, 0.3).contains("clock"), "{}", words(0.9, 0.3));
        // A magnet near the path.
        assert!(!words(0.79, 0.58).contains("clock"), "{}", words(0.79, 0.58));
        assert!(words(0.2, 0.9).contains("A clock that goes wrong alike in each release would remove 90 %"));
        assert!(!words(0.2, 0.1).contains("alike in each release"), "{}", words(0.2, 0.1));
    }

    #[test]
    fn the_words_say_what_it_follows_and_what_one_release_can_not_tell() {
        let law = said(0.85, 0.3, &[1.2, 0.8]);
        assert_eq!(law.kind, Kind::Law);
        assert!(
            law.words.contains("would remove 85 % of what is left") && !law.words.contains("time"),
            "{}",
            law.words
        );
        for (releases_rad, told) in
            [(&[1.2][..], "One release"), (&[1.2, 1.2], "These releases"), (&[1.2, 0.3], "These")]
        {
            let law = said(0.85, 0.3, releases_rad);
            assert!(law.words.contains(told), "{releases_rad:?}: {}", law.words);
        }
        let scale = said(0.99, 0.97, &[1.2, 0.8]);
        assert!(
            scale.kind == Kind::LawOrScale
                && scale.words.contains("or the scale of the sensor")
                && scale.words.contains("Either does it alone"),
            "{}",
            scale.words
        );
        let play = said(0.3, 0.65, &[1.2]);
        assert!(play.kind == Kind::Elsewhere && play.words.contains("would remove 65 %"), "{}", play.words);
        let clock = said(-0.1, -0.2, &[1.2]);
        assert!(clock.words.contains("removes 0 %") && clock.words.contains("clock, camera"), "{}", clock.words);
        // A law that the grid is too coarse for leaves as much.
        assert!(clock.words.contains("narrower than 0.30 rad or 2.00 rad/s") && clock.words.contains("20 blocks"));
        assert!(!clock.words.contains("No law"), "{}", clock.words);
        assert!(clock.words.contains("neighbouring readings share") && !scale.words.contains("neighbouring"));
        assert_eq!(said(0.6, 0.6, &[1.2]).kind, Kind::Undecided);
    }
}
