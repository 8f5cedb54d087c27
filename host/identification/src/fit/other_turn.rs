//! Out of a side valley of dry friction, for swings that rest.
//!
//! From turn to turn the swings shrink by 2·Mc and by what viscous friction takes; without the last ones before rest either may
//! stand for the other, along a line of numbers that leave about the same. At which turn the pendulum stops decides between
//! them, but each time that it stops at another one the error has a kink, at which a descent ends. So the model is begun anew
//! with ever more of the last swings, of which each tells the numbers surely enough to follow the next.

use super::descent::Tolerance;
use super::fitted::Fitted;
use super::problem::Problem;
use super::refine::Band;
use crate::verdict::Left;

/// The better one of a model and what it comes to where it is led to its stop turn by turn.
pub(crate) fn or_of_another_turn(on: &Problem, found: Fitted) -> Fitted {
    if !on.comes_to_rest() || on.chi_square(found.cost).left() == Left::Noise {
        return found;
    }
    let calmed = found.calmed(on).refined(on, Band::Searched, Tolerance::JUDGE);
    found.better(calmed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::fitted::Stiction;
    use crate::fit::identify::problem_of;
    use crate::fit::problem::{Point, Quantity, Start, Unknown};
    use crate::fit::tally::Tally;
    use crate::fit::tests::PENDULUM;
    use crate::random::Noise;
    use crate::swing::Swing;
    use shared::model::Model;
    use shared::motion::Pendulum;
    use shared::parameters::{Parameters, base};

    const NOISE_RAD: f64 = 1e-3;

    /// A slow pendulum with 40 half swings to its rest, which viscous friction takes as much of as dry friction.
    fn to_rest(coulomb_share: f64, seed: u64) -> (Parameters<f64>, Swing) {
        let gravity_nm = PENDULUM.gravity_torque_nm();
        let mut truth = Parameters::frictionless(Pendulum { inertia_kg_m2: 5e-3, ..PENDULUM });
        truth.set_friction(6.35e-3 * gravity_nm, coulomb_share * gravity_nm, 1.16 * coulomb_share * gravity_nm, 0.0);
        let (model, mut noise) = (Model::new(&truth), Noise::new(seed));
        let mut state = model.release(0.37, 0.0);
        let times_s: Vec<f64> = (0..5750).map(|i| i as f64 / 250.0).collect();
        let mut angles_rad = Vec::new();
        for _ in &times_s {
            angles_rad.push(state.angle_rad + NOISE_RAD * noise.normal());
            (0..4).for_each(|_| model.step(&mut state, 1e-3));
        }
        (truth, Swing::new("to rest", &times_s, &angles_rad, NOISE_RAD))
    }

    /// Fitted to the lively swings with this share of Mc and no other friction to hold it.
    fn with_coulomb(on: &Problem, from: &Fitted, share: f64) -> Fitted {
        let is_coulomb = |unknown: &Unknown| matches!(unknown.quantity, Quantity::Effect { id: base::COULOMB, .. });
        let mut moved = from.with_stiction(Stiction::NONE);
        let coulomb = from.unknowns.iter().find(|unknown| is_coulomb(unknown)).unwrap();
        coulomb.set(&mut moved.parameters, share * coulomb.get(&from.parameters));
        moved.unknowns.retain(|unknown| !is_coulomb(unknown));
        let moved = moved.lively(on, Tolerance::ROUGH);
        Fitted { unknowns: from.unknowns.clone(), steps: None, ..moved }
    }

    #[test]
    fn the_turn_at_which_it_stops_is_found_from_a_side_valley() {
        for seed in [2, 12, 14] {
            let (truth, swing) = to_rest(1.865e-3 + 1e-5 * seed as f64, seed);
            let (swings, count) = ([swing], Tally::default());
            let problem = problem_of(&swings, &truth, &count);
            let starts = vec![Start { angle_rad: 0.37, velocity_rad_s: 0.0, offset_rad: 0.0 }];
            let begin = Fitted::at(&problem, &Point { values: problem.template_values(), starts });
            let aside = with_coulomb(&problem, &begin, 1.06).refined(&problem, Band::Level, Tolerance::JUDGE);
            assert!(aside.cost > 1.25 * problem.noise_cost(), "no case: {seed}");
            let found = or_of_another_turn(&problem, aside);
            assert!(found.cost < 1.05 * problem.noise_cost(), "{seed} {}", found.cost / problem.noise_cost());
        }
    }
}
