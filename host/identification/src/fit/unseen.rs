//! What a velocity band that no swing shows makes of the other numbers.
//!
//! To turn within a band DV in which a level Ms holds takes 2·DV·Ms/(J·α²) longer, α being the angular acceleration there; a
//! larger inertia makes swings as much longer. A swing that never rests can't tell them apart. So the numbers are known no
//! better than what a band would move them by, from none to the widest that the swings allow, all equally likely.

use super::answered::{answers, likely_rise};
use super::covariance::Covariance;
use super::fitted::{Fitted, Stiction};
use super::linear::Linear;
use super::problem::Problem;
use super::ranges::WIDEST_BAND;
use shared::parameters::base;

/// Bands that are tried, in shares of the widest: the covariance grows with the square of the widest that is allowed. With
/// half as many, I was off by more than 1.96 of its ± on 19 % of 47 simulated rigs in which a band stays unseen.
const SHARES: [f64; 15] =
    [1.0, 0.8, 0.64, 0.51, 0.41, 0.33, 0.26, 0.21, 0.17, 0.134, 0.107, 0.086, 0.069, 0.055, 0.044];

/// The covariance of a model, with its `linear` form, and what an unseen band adds to it.
pub(super) fn with_unseen_band(covariance: Covariance, on: &Problem, model: &Fitted, linear: &Linear) -> Covariance {
    let (own, widest) = (model.stiction(), WIDEST_BAND / on.pace());
    // What holds a pendulum is no less than what brakes it.
    let coulomb_nm = model.parameters.values(base::COULOMB).map_or(0.0, |values| values[0]);
    if own.level_nm.max(coulomb_nm) == 0.0 {
        return covariance;
    }
    if model.has_band() {
        return with_other_levels(covariance, on, model, linear, coulomb_nm);
    }
    let level_nm = own.level_nm.max(USUAL_LEVEL * coulomb_nm);
    let wider = |share: &f64| Stiction { level_nm, velocity_band: share * widest };
    let tried: Vec<Stiction> = [own].into_iter().chain(SHARES.iter().map(wider)).collect();
    let found = answers(&model.problem(on), linear, &model.point(), &tried);
    let allowed = found[0].cost + likely_rise(on, linear);
    match found[1..].iter().find(|answer| answer.cost < allowed) {
        Some(answer) => covariance.with_any_share_of(&(&answer.step - &found[0].step)),
        None => covariance,
    }
}

/// The one in the middle of these. With Mc itself in its place, 8.5 % of the intervals of I missed the truth on 47 simulated rigs
/// in which a band stays unseen, 4.3 % with this; twice was not tried.
const USUAL_LEVEL: f64 = 1.4;

/// Levels that a band may hold, as multiples of Mc: Ms is seldom outside. Half and twice were not tried.
const LEVELS: [f64; 4] = [1.0, 1.4, 2.0, 2.8];

/// The same of a model with a band, which is narrower the higher the level: what other levels would make of the numbers, as
/// far as they explain the swings, each of them as likely.
fn with_other_levels(
    covariance: Covariance,
    on: &Problem,
    model: &Fitted,
    linear: &Linear,
    coulomb_nm: f64,
) -> Covariance {
    let own = model.stiction();
    let other = |times: &f64| {
        let level_nm = times * coulomb_nm;
        Stiction { level_nm, velocity_band: own.velocity_band * own.level_nm / level_nm }
    };
    let levels = LEVELS.iter().filter(|_| coulomb_nm > 0.0).map(other);
    let tried: Vec<Stiction> = [own].into_iter().chain(levels).collect();
    let found = answers(&model.problem(on), linear, &model.point(), &tried);
    let allowed = found[0].cost + likely_rise(on, linear);
    let likely = found[1..].iter().filter(|answer| answer.cost < allowed);
    let moves: Vec<_> = likely.map(|answer| &answer.step - &found[0].step).collect();
    moves.iter().fold(covariance, |covariance, step| covariance.with_share(step, moves.len()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::answered::stiction_unknowns;
    use crate::fit::covariance::covariance;
    use crate::fit::descent::Tolerance;
    use crate::fit::identify::problem_of;
    use crate::fit::problem::{Point, Start, Unknown};
    use crate::fit::refine::Band;
    use crate::fit::tally::Tally;
    use crate::swing::Swing;
    use nalgebra::DMatrix;
    use shared::model::Model;
    use shared::parameters::Parameters;
    use std::f64::consts::PI;

    const RELEASE_RAD: f64 = 0.2;

    const COULOMB_NM: f64 = 1e-4;

    /// Dry friction alone, on a pendulum that swings so many times slower.
    fn rig(slower: f64) -> Parameters<f64> {
        let mut pendulum = Parameters::paper().pendulum;
        pendulum.gravity_m_s2 /= slower * slower;
        let mut rig = Parameters::frictionless(pendulum);
        rig.set_friction(0.0, COULOMB_NM / (slower * slower), 0.0, 0.0);
        rig
    }

    fn swing(truth: &Parameters<f64>, slower: f64, noise_rad: f64) -> [Swing; 1] {
        let model = Model::new(truth);
        let mut state = model.release(RELEASE_RAD, 0.0);
        let times_s: Vec<f64> = (0..800).map(|i| slower * f64::from(i) / 100.0).collect();
        let mut angles_rad = Vec::new();
        for _ in &times_s {
            angles_rad.push(state.angle_rad);
            (0..10).for_each(|_| model.step(&mut state, slower * 1e-3));
        }
        [Swing::new("one", &times_s, &angles_rad, noise_rad)]
    }

    /// What an unseen band adds to the covariance of the inertia and of the start; seen from an inertia that is off.
    fn added(slower: f64) -> DMatrix<f64> {
        let (swings, count) = (swing(&rig(slower), slower, 1e-2), Tally::default());
        let mut off = rig(slower);
        off.pendulum.inertia_kg_m2 *= 1.001;
        let mut problem = problem_of(&swings, &off, &count);
        problem.unknowns.retain(|unknown| unknown.symbol == "I");
        let starts = vec![Start { angle_rad: RELEASE_RAD, velocity_rad_s: 0.0, offset_rad: 0.0 }];
        let model =
            Fitted::at(&problem, &Point { values: problem.template_values(), starts }).with_stiction(Stiction::NONE);
        let linear = model.linearised(&problem);
        let before = covariance(&linear).unwrap();
        with_unseen_band(before.clone(), &problem, &model, &linear).matrix - before.matrix
    }

    #[test]
    fn a_band_as_wide_as_can_be_lengthens_every_turn_as_a_larger_inertia_does() {
        let added = added(1.0);
        let pendulum = rig(1.0).pendulum;
        let (gravity_nm, pivot) = (pendulum.gravity_torque_nm(), pendulum.pivot_inertia_kg_m2());
        // Each half swing loses 2·Mc/mgl: halfway through the fifteen the amplitude is so much.
        let amplitude_rad = RELEASE_RAD - 15.0 * COULOMB_NM / gravity_nm;
        let turning = gravity_nm * amplitude_rad.sin() / pivot;
        let longer_s = 2.0 * WIDEST_BAND * USUAL_LEVEL * COULOMB_NM / (pivot * turning * turning);
        // A period is as the root of the inertia; any share of the band is as likely.
        let moved = 2.0 * pivot * longer_s / (PI * (pivot / gravity_nm).sqrt());
        let expected = moved / 3.0_f64.sqrt();
        assert!((added[(0, 0)].sqrt() / expected - 1.0).abs() < 0.2, "{} {expected}", added[(0, 0)].sqrt());
        // It moves all numbers at once.
        for j in 1..4 {
            let alone = added[(0, 0)] * added[(j, j)];
            assert!(alone > 0.0 && (added[(0, j)].powi(2) / alone - 1.0).abs() < 1e-6, "{added}");
        }
    }

    #[test]
    fn of_a_pendulum_that_is_twice_as_slow_the_inertia_is_as_uncertain() {
        let ratio = (added(2.0)[(0, 0)] / added(1.0)[(0, 0)]).sqrt();
        assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
    }

    /// What other levels of a band that is there add to the variance of the inertia, and what it would be by fits of inertia
    /// and band to each of them.
    fn added_by_levels(noise_rad: f64) -> [f64; 2] {
        let mut truth = rig(1.0);
        truth.set_friction(0.0, COULOMB_NM, 1.3 * COULOMB_NM, 0.06);
        let (swings, count) = (swing(&truth, 1.0, noise_rad), Tally::default());
        let mut problem = problem_of(&swings, &truth, &count);
        problem.unknowns.retain(|unknown| unknown.symbol == "I");
        let starts = vec![Start { angle_rad: RELEASE_RAD, velocity_rad_s: 0.0, offset_rad: 0.0 }];
        let mut model = Fitted::at(&problem, &Point { values: problem.template_values(), starts });
        model.unknowns.extend(stiction_unknowns(&truth).into_iter().filter(Unknown::is_band));
        let linear = model.linearised(&problem);
        let before = covariance(&linear).unwrap();
        let added = with_unseen_band(before.clone(), &problem, &model, &linear).matrix - before.matrix;
        let refitted = |times: &f64| {
            let level_nm = times * COULOMB_NM;
            let own = model.stiction();
            let begun = Stiction { level_nm, velocity_band: own.velocity_band * own.level_nm / level_nm };
            let fitted = model.with_stiction(begun).refined(&problem, Band::Held, Tolerance::LAST);
            fitted.parameters.pendulum.inertia_kg_m2 - truth.pendulum.inertia_kg_m2
        };
        let squares: Vec<f64> = LEVELS.iter().map(|times| refitted(times).powi(2)).collect();
        [added[(0, 0)], squares.iter().sum::<f64>() / LEVELS.len() as f64]
    }

    #[test]
    fn a_band_is_as_narrow_as_its_level_is_high_and_moves_the_inertia_by_what_a_fit_finds() {
        let [added, refitted] = added_by_levels(1e-2);
        assert!(added > 0.0 && (added / refitted).sqrt().ln().abs() < 0.3, "{added:e} {refitted:e}");
    }

    #[test]
    fn levels_that_do_not_explain_the_swings_add_nothing() {
        assert_eq!(added_by_levels(1e-12)[0], 0.0);
    }
}
