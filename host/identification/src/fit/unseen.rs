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

/// Bands that are tried, in shares of the widest: the covariance grows with the square of the widest that is allowed.
const SHARES: [f64; 5] = [1.0, 0.5, 0.25, 0.12, 0.06];

/// The covariance of a model, with its `linear` form, and what an unseen band adds to it.
pub(super) fn with_unseen_band(covariance: Covariance, on: &Problem, model: &Fitted, linear: &Linear) -> Covariance {
    let (own, widest) = (model.stiction(), WIDEST_BAND / on.pace());
    // What holds a pendulum is no less than what brakes it.
    let coulomb_nm = model.parameters.values(base::COULOMB).map_or(0.0, |values| values[0]);
    let level_nm = own.level_nm.max(coulomb_nm);
    let wider = |share: &f64| Stiction { level_nm, velocity_band: own.velocity_band + share * widest };
    let tried: Vec<Stiction> = [own].into_iter().chain(SHARES.iter().map(wider)).collect();
    let found = answers(&model.problem(on), linear, &model.point(), &tried);
    let allowed = found[0].cost + likely_rise(on, linear);
    match found[1..].iter().find(|answer| answer.cost < allowed) {
        Some(answer) => covariance.with_any_share_of(&(&answer.step - &found[0].step)),
        None => covariance,
    }
}
