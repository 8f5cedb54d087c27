//! What a velocity band that no swing shows makes of the other numbers.
//!
//! To turn within a band DV in which a level Ms holds takes 2·DV·Ms/(J·α²) longer, α being the angular acceleration there; a
//! larger inertia makes swings as much longer. A swing that never rests can't tell them apart. So the numbers are known no
//! better than what a band would move them by, from none to the widest that the swings allow, all equally likely.

use super::answered::answers;
use super::covariance::Covariance;
use super::fitted::{Fitted, Stiction};
use super::linear::Linear;
use super::problem::Problem;
use super::ranges::WIDEST_BAND;
use super::uncertainty::PROFILE_95;
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
    let variance = linear.equations.cost / linear.equations.n_samples.max(1) as f64;
    let allowed = found[0].cost + PROFILE_95 * variance.max(on.noise_rad().powi(2));
    match found[1..].iter().find(|answer| answer.cost < allowed) {
        Some(answer) => covariance.with_any_share_of(&(&answer.step - &found[0].step)),
        None => covariance,
    }
}

#[cfg(test)]
mod tests {
    use crate::fit::by_least_squares::fitted_as_it_is;
    use crate::fit::fitted::Stiction;
    use crate::fit::identify::problem_of;
    use crate::fit::tally::Tally;
    use crate::fit::uncertainty::uncertainty;
    use crate::swing::Swing;
    use shared::model::Model;
    use shared::parameters::Parameters;

    /// A swing that never rests, nearly without noise, of a bearing with a velocity band.
    fn large_swing(truth: &Parameters<f64>) -> Swing {
        let model = Model::new(truth);
        let mut state = model.release(1.4, 0.0);
        let times_s: Vec<f64> = (0..800).map(|i| f64::from(i) / 100.0).collect();
        let mut angles_rad = Vec::new();
        for i in 0..times_s.len() {
            let noise_rad = 5e-5 * if i % 2 == 0 { 1.0 } else { -1.0 };
            angles_rad.push(state.angle_rad + noise_rad);
            (0..5).for_each(|_| model.step(&mut state, 2e-3));
        }
        Swing::new("large", &times_s, &angles_rad, 5e-5)
    }

    #[test]
    fn an_inertia_is_known_no_better_than_a_band_that_no_swing_shows_lets_it_be() {
        let mut truth = Parameters::paper();
        truth.set_friction(2e-4, 2e-4, 2.4e-4, 0.03);
        let (swings, count) = ([large_swing(&truth)], Tally::default());
        let mut rig = truth.clone();
        Stiction::NONE.put_into(&mut rig);
        let problem = problem_of(&swings, &rig, &count);
        let found = uncertainty(&problem, &fitted_as_it_is(&problem));
        let inertia = found.numbers.iter().find(|number| number.unknown.symbol == "I").unwrap();
        let off = (inertia.value - truth.pendulum.inertia_kg_m2) / inertia.std.unwrap();
        assert!(off > 0.1 && off < 2.0, "{off}");
    }
}
