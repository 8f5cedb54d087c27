//! A first guess from the swings themselves.

use super::problem::{Point, Problem, Quantity, Start};
use super::ranges::largest_coulomb_nm;
use super::windows::WINDOWS_S;
use crate::swing::{Swing, Window};
use shared::motion::Pendulum;
use shared::parameters::base;

/// Moments about the pivot that are tried are up to this factor smaller and larger than the one assumed. Half and twice were
/// not tried.
const FARTHEST_FACTOR: f64 = 4.0;

/// So many are: each is 6 % larger than the one before. Half and twice were not tried.
const TRIED_FACTORS: usize = 48;

/// Start angles and velocities read off the swings, offset zero where they swing about there.
pub fn starts(swings: &[Swing]) -> Vec<Start> {
    swings
        .iter()
        .map(|swing| {
            let (angle_rad, velocity_rad_s) = swing.start_guess();
            let offset_rad = swing.first_zero();
            Start { angle_rad: angle_rad - offset_rad, velocity_rad_s, offset_rad }
        })
        .collect()
}

/// The template's values, dry friction no more than the swings have, with the inertia that follows their first second
/// best.
pub fn guess(problem: &Problem) -> Point {
    let mut here = given_but_coulomb(problem);
    let Some(inertia) = problem.unknowns.iter().position(|unknown| unknown.quantity == Quantity::Inertia) else {
        return here;
    };
    let unknown = &problem.unknowns[inertia];
    let pivot = problem.template.pendulum.pivot_inertia_kg_m2();
    let trials: Vec<Point> = tried_factors()
        .map(|factor| about_centre(&problem.template.pendulum, factor * pivot))
        .filter(|inertia_kg_m2| (unknown.low..=unknown.high).contains(inertia_kg_m2))
        .map(|inertia_kg_m2| {
            let mut trial = here.clone();
            trial.values[inertia] = inertia_kg_m2;
            without_stiction(problem, &mut trial.values);
            trial
        })
        .collect();
    // The period shows in the first window already.
    let costs = problem.costs(Window::First(WINDOWS_S[0] * problem.pace()), &trials);
    let best = costs.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1)).map(|(index, _)| index);
    if let Some(best) = best {
        here.values[inertia] = trials[best].values[inertia];
    }
    here
}

/// The template's values without Ms and DV, and no more dry friction than the swings have.
pub(super) fn without_what_holds(problem: &Problem) -> Point {
    let mut here = given_but_coulomb(problem);
    without_stiction(problem, &mut here.values);
    here
}

/// The template's values; dry friction of another rig may end small swings at once.
fn given_but_coulomb(problem: &Problem) -> Point {
    let mut here = Point { values: problem.template_values(), starts: starts(problem.swings) };
    let most_nm = largest_coulomb_nm(problem);
    for (unknown, value) in problem.unknowns.iter().zip(&mut here.values) {
        if matches!(unknown.quantity, Quantity::Effect { id: base::COULOMB, .. }) {
            *value = value.min(most_nm);
        }
    }
    here
}

/// Stiction of another rig may hold them where they were let go: then no inertia follows them.
fn without_stiction(problem: &Problem, values: &mut [f64]) {
    let stiction = problem.unknowns.iter().zip(values).filter(|(unknown, _)| unknown.is_stiction());
    stiction.for_each(|(unknown, value)| *value = unknown.low);
}

fn tried_factors() -> impl Iterator<Item = f64> {
    let ratio = FARTHEST_FACTOR * FARTHEST_FACTOR;
    (0..TRIED_FACTORS).map(move |i| ratio.powf(i as f64 / (TRIED_FACTORS - 1) as f64) / FARTHEST_FACTOR)
}

fn about_centre(pendulum: &Pendulum<f64>, pivot_inertia: f64) -> f64 {
    pivot_inertia - pendulum.mass_kg * pendulum.length_m * pendulum.length_m
}
